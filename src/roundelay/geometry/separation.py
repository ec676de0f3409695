"""Turn shoulders and hips a little so that limbs no longer pass through each other ([A] section 7).

A joint j turns in its parent's frame by a vector g_j(t): an axis times the tangent of half the
angle. Of all turns that open the gaps, the least and smoothest are sought,

    minimise  sum_j m_j |g_j|^2   subject to   sum_j l_cj . g_j(t_c) >= b_c  for every c,

c being a pair of bones at a time t_c, l_cj the joint's lever on their gap, b_c what the gap lacks.
The weights m_j are the lengths of the bones that a joint moves, which stand for their mass: an arm
gives way before a leg. The norm is that of the functions whose reproducing kernel k is a Gaussian
of time, so that the solution is a sum of bumps (representer theorem),

    g_j(t) = f_j(t) / m_j  sum_c lambda_c f_j(t_c) k(t - t_c) l_cj,   lambda_c >= 0,

where f_j, between 0 and 1, tells when a joint is free to turn: the hip of a standing leg is not.
Gaps are not linear in the turns; they are linearised anew a few times.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import SMALLEST, TINY
from roundelay.geometry import rotations as rot
from roundelay.geometry.collision import Capsules, collisions
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.geometry.skeleton import Skeleton
from roundelay.geometry.thresholds import SEPARATION

__all__ = ["Body", "Separation", "deepest", "separate", "turned"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Pair = tuple[str, str]


@dataclass(frozen=True, eq=False)
class Body:
    """Describe a motion and what of it may turn.

    Attributes
    ----------
    skeleton : Skeleton
    rotations : (F, J, 4) ndarray
        Local rotations.
    translations : (F, J, 3) ndarray or None
        See `roundelay.geometry.kinematics.forward_kinematics`.
    joints : (k,) ndarray of int
        The joints that may turn.
    freedom : (F, k) ndarray
        How far they may, from 0 to 1.
    fps : float
    closed : bool
        Whether the first frame follows the last.
    """

    skeleton: Skeleton
    rotations: Array
    translations: Array | None
    joints: NDArray[np.intp]
    freedom: Array
    fps: float
    closed: bool

    def placed(self, turns: Array) -> tuple[Array, Array]:
        """Return positions and orientations of all joints after turns (F, k, 3)."""
        rotations = self.rotations.copy()
        rotations[:, self.joints] = rot.normalize(turned(rotations[:, self.joints], turns))
        return forward_kinematics(self.skeleton, rotations, translations=self.translations)

    def kernel(self, frames: NDArray[np.intp]) -> Array:
        """Return the bumps (F, n) about frames (n,)."""
        apart = (np.arange(len(self.rotations))[:, None] - frames) / self.fps
        if not self.closed:
            return np.asarray(np.exp(-0.5 * (apart / SEPARATION.bump) ** 2))
        period = len(self.rotations) / self.fps
        around = apart + period * np.arange(-2, 3)[:, None, None]
        return np.asarray(np.exp(-0.5 * (around / SEPARATION.bump) ** 2).sum(axis=0))


@dataclass(frozen=True, eq=False)
class Separation:
    """Hold turns and what they part.

    Attributes
    ----------
    turns : (F, k, 3) ndarray
        Axes times the tangent of half the angle, in the frames of the joints' parents.
    met : dict
        For each pair of bones that is parted, the frames (F,) in which it was too deep.
    angles : dict
        For each of them, the largest angle in radians by which a joint turns to part it.
    """

    turns: Array
    met: dict[Pair, Mask]
    angles: dict[Pair, float]


def turned(rotations: Array, turns: Array) -> Array:
    """Turn quaternions (..., 4) in their parents' frames by vectors (..., 3).

    A product of polynomials: not normalised.
    """
    half = np.concatenate([np.ones_like(turns[..., :1]), turns], axis=-1)
    return rot.multiply(half, rotations)


def deepest(
    skeleton: Skeleton, rotations: Array, translations: Array | None = None
) -> dict[Pair, float]:
    """Return how deep each pair of bones that meets is in each other at most, in body sizes."""
    found: dict[Pair, float] = {}
    for met in collisions(skeleton, rotations, translations=translations):
        found[met.bones] = max(found.get(met.bones, 0.0), met.depth / skeleton.size)
    return found


def separate(body: Body, limits: Mapping[Pair, float]) -> Separation:
    """Part the bones that are deeper in each other than their limits.

    A pair that no small turn parts, or only so that other bones meet, stays as it is.

    Parameters
    ----------
    body : Body
    limits : mapping
        Depths in body sizes that pairs of bones may have, by the joints at their lower ends;
        0 for all others.

    Returns
    -------
    Separation
    """
    capsules, clearance = Capsules.of(body.skeleton), SEPARATION.clearance * body.skeleton.size
    largest = np.radians(SEPARATION.largest)
    names = [(body.skeleton.names[a], body.skeleton.names[b]) for a, b in capsules.lower]
    limit = body.skeleton.size * np.array([limits.get(pair, 0.0) for pair in names])
    still = np.zeros((*body.freedom.shape, 3))
    before = _depths(body, capsules, still)
    over = before.max(axis=1, initial=-np.inf) - limit
    left = [int(pair) for pair in np.flatnonzero(over > 0.0)]
    aims = np.repeat(limit[:, None] - clearance, before.shape[1], axis=1)
    moves: Mask = np.any(_moves(body, capsules), axis=1)
    while left:
        turns = _least_turns(body, capsules, aims)
        excess = (_depths(body, capsules, turns) - aims).max(axis=1)
        angles = _angles(turns)
        if angles.max(initial=0.0) <= largest and excess.max() <= clearance:
            return Separation(
                turns,
                {names[pair]: before[pair] > limit[pair] for pair in left},
                {names[pair]: float(angles[moves[pair]].max(initial=0.0)) for pair in left},
            )
        # First what stays, else what turns a joint too far, else all: the deepest is given up.
        stays = [pair for pair in left if excess[pair] > clearance]
        far = [pair for pair in left if np.any(moves[pair] & (angles > largest))]
        given_up = max(stays or far or left, key=lambda pair: float(over[pair]))
        left.remove(given_up)
        aims[given_up] = np.maximum(aims[given_up], before[given_up])
    return Separation(still, {}, {})


def _depths(body: Body, capsules: Capsules, turns: Array) -> Array:
    """Return how deep pairs are in each other (P, F); -inf where they are far apart."""
    near = capsules.near(body.placed(turns)[0])
    depths = np.full((len(capsules.reach), len(turns)), -np.inf)
    depths[near.pair, near.frame] = near.depth
    return depths


def _moves(body: Body, capsules: Capsules) -> Mask:
    """Tell which bones of the pairs each joint moves, (P, 2, k)."""
    moved = np.zeros((body.skeleton.n_joints, len(body.joints)), bool)
    for column, joint in enumerate(body.joints):
        moved[body.skeleton.descendants(joint)[1:], column] = True
    return moved[capsules.lower]


def _least_turns(body: Body, capsules: Capsules, aims: Array) -> Array:
    """Return the least turns (F, k, 3) that bring pairs to depths of at most `aims` (P, F)."""
    turns = np.zeros((*body.freedom.shape, 3))
    scale = 1.0 / np.sqrt(body.skeleton.moved_lengths[body.joints] / body.skeleton.size)
    clearance, largest = SEPARATION.clearance * body.skeleton.size, np.radians(SEPARATION.largest)
    for _ in range(SEPARATION.rounds):
        frame, lever, wanted, lack = _gaps(body, capsules, aims, turns)
        if lack.max(initial=0.0) <= SEPARATION.lacking * clearance:
            break
        lever = lever * (body.freedom[frame] * scale)[..., None]
        bumps = body.kernel(frame)
        gram = np.einsum("cjx,djx->cd", lever, lever) * bumps[frame]
        # Neighbouring frames ask for nearly the same.
        gram += SEPARATION.ridge * np.diag(gram).mean() * np.eye(len(gram))
        push = _non_negative(gram, wanted, SEPARATION.settled * clearance)
        turns = np.einsum("fc,c,cjx->fjx", bumps, push, lever, optimize=True)
        turns *= (body.freedom * scale)[..., None]
        if _angles(turns).max(initial=0.0) > SEPARATION.overshoot * largest:
            break
    return turns


def _angles(turns: Array) -> Array:
    """Return the largest angle (k,) by which each joint turns."""
    return np.asarray(2.0 * np.arctan(np.linalg.norm(turns, axis=-1)).max(axis=0))


def _gaps(
    body: Body, capsules: Capsules, aims: Array, turns: Array
) -> tuple[NDArray[np.intp], Array, Array, Array]:
    """Linearise gaps that are, or nearly are, too small.

    Returns
    -------
    frame : (n,) ndarray of int
    lever : (n, k, 3) ndarray
        How fast the gap grows with the joints' turns.
    wanted : (n,) ndarray
        What lever times turns has to be.
    lack : (n,) ndarray
        By how much the gap is too small.
    """
    size = body.skeleton.size
    places, orientations = body.placed(turns)
    near = capsules.near(places, SEPARATION.watched * size)
    lack, frame = near.depth - aims[near.pair, near.frame], near.frame
    apart = near.first - near.second
    normal = apart / np.maximum(np.linalg.norm(apart, axis=-1, keepdims=True), TINY)
    first, second = np.moveaxis(_moves(body, capsules)[near.pair], 1, 0)
    moved = np.where(first[..., None], near.first[:, None], near.second[:, None])
    arm = np.cross(moved - places[frame][:, body.joints], normal[:, None])
    above = orientations[frame][:, np.array(body.skeleton.parents)[body.joints]]
    # A turn by the tangent g of half an angle is one by 2 g, nearly.
    sign = 2.0 * (first.astype(float) - second)
    lever = sign[..., None] * rot.rotate(rot.conjugate(above), arm)
    wanted = lack + np.einsum("cjx,cjx->c", lever, turns[frame])
    free = np.linalg.norm(lever * body.freedom[frame][..., None], axis=(1, 2))
    use = np.flatnonzero((lack > -SEPARATION.watched * size) & (free > SEPARATION.lever * size))
    use = use[np.argsort(-lack[use], kind="stable")[: SEPARATION.most]]
    return frame[use], lever[use], wanted[use], lack[use]


def _non_negative(gram: Array, target: Array, tolerance: float) -> Array:
    """Minimise x.Gx / 2 - x.t over x >= 0 by active sets (Lawson & Hanson 1974, ch. 23)."""
    count = len(target)
    x, free = np.zeros(count), np.zeros(count, bool)
    for _ in range(3 * count):
        slope = np.where(free, -np.inf, target - gram @ x)
        if slope.max() <= tolerance:
            break
        free[slope.argmax()] = True
        trial = _solution(gram, target, free)
        while np.any(trial[free] <= 0.0):
            down = free & (trial <= 0.0)
            step = np.min(x[down] / np.maximum(x[down] - trial[down], SMALLEST))
            x += step * (trial - x)
            free &= x > TINY * x.max()
            trial = _solution(gram, target, free)
        x = trial
    return x


def _solution(gram: Array, target: Array, free: Mask) -> Array:
    """Solve for the free unknowns, the others being 0."""
    x = np.zeros(len(target))
    x[free] = np.linalg.solve(gram[np.ix_(free, free)], target[free])
    return x
