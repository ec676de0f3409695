"""Feet on the ground: which joints are feet, when they stand, how much they skate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.spans import Spans
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.geometry.symmetry import is_left, other_side
from roundelay.geometry.thresholds import CONTACTS, LIMBS

__all__ = [
    "Foot",
    "contacts",
    "find_feet",
    "foot_pairs",
    "foot_points",
    "free_limbs",
    "left_and_right",
    "shoulders",
    "skate",
]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_NAMES = ("foot", "toe", "ankle", "hoof", "paw")
_HANDS = ("hand", "wrist", "finger", "thumb", "arm")


@dataclass(frozen=True)
class Foot:
    """Describe a leg that can stand: two bones and the point that touches the ground.

    Parameters
    ----------
    hip, knee, ankle : int
        Joints of the limb's two longest consecutive bones.
    joint : int
        The joint that carries the point: the ball of the foot, else the ankle.
    offset : (float, float, float)
        The point relative to that joint.
    """

    hip: int
    knee: int
    ankle: int
    joint: int
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)


def find_feet(skeleton: Skeleton, positions: Array, up: int) -> tuple[Foot, ...]:
    """Find the feet of any skeleton: limbs named so, and limbs whose ends come near the ground.

    Parameters
    ----------
    skeleton : Skeleton
    positions : (F, J, 3) ndarray
        Global joint positions of a motion.
    up : int
        The vertical axis.

    Returns
    -------
    tuple of Foot
        Empty if no limb of two bones comes near the ground.
    """
    heights = np.quantile(positions[:, :, up], LIMBS.lowest, axis=0)
    near = float(heights.min()) + LIMBS.low * skeleton.size
    found: dict[int, Foot] = {}
    for leaf in sorted(set(range(skeleton.n_joints)) - set(skeleton.parents)):
        limb = _limb(skeleton, leaf)
        named = any(_called(skeleton.names[joint], _NAMES) for joint in limb)
        if len(limb) > 2 and (named or heights[leaf] < near):
            foot = _foot(skeleton, limb)
            found.setdefault(foot.ankle, foot)
    return tuple(found.values())


def foot_pairs(skeleton: Skeleton, feet: tuple[Foot, ...]) -> list[tuple[int, int]]:
    """Return the numbers of feet that are partners by their names, the left one of each first.

    Those that are called feet come first, then those of the first joints; what is called a hand is
    none, though it may come near the ground.

    Parameters
    ----------
    skeleton : Skeleton
    feet : tuple of Foot
        As from `find_feet`.

    Returns
    -------
    list of (int, int)
        Places in `feet`.
    """
    number = {skeleton.names[foot.ankle]: place for place, foot in enumerate(feet)}
    pairs = [(name, other_side(name, number)) for name in number]
    known = [
        (name, other)
        for name, other in pairs
        if other in number and is_left(name, other) and not _called(name, _HANDS)
    ]
    known.sort(key=lambda pair: not _called(pair[0], _NAMES))
    return [(number[name], number[other]) for name, other in known]


def left_and_right(skeleton: Skeleton, feet: tuple[Foot, ...]) -> tuple[int, int] | None:
    """Return the first of `foot_pairs`, which tells the arguments; None where no two are partners.

    Parameters
    ----------
    skeleton : Skeleton
    feet : tuple of Foot
    """
    return next(iter(foot_pairs(skeleton, feet)), None)


def _called(name: str, words: Sequence[str]) -> bool:
    return any(word in name.lower() for word in words)


def free_limbs(skeleton: Skeleton, positions: Array, up: int) -> list[int]:
    """Return the joints of long limbs that are no legs: the arms of a person.

    Arguments as for `find_feet`.
    """
    return sorted({joint for limb in _arms(skeleton, positions, up) for joint in limb})


def shoulders(skeleton: Skeleton, positions: Array, up: int) -> list[int]:
    """Return the joint at which each free limb turns as a whole: a person's shoulders.

    It lies above the bone that is long itself and has much below it: an upper arm, neither a
    collar bone nor a forearm.

    Arguments as for `find_feet`.
    """
    lengths = np.linalg.norm(skeleton.offsets, axis=1)
    arms = sorted(_arms(skeleton, positions, up), key=lambda limb: lengths[limb[1:]].sum())
    found = {}
    for limb in arms:
        bones = lengths[limb[1:]]
        below = np.cumsum(bones[::-1])[::-1] - bones
        # Thumb and fingers end one arm: the longest way down comes last and counts.
        found[limb[0]] = limb[int(np.argmax(np.minimum(bones, below)))]
    return sorted(found.values())


def _arms(skeleton: Skeleton, positions: Array, up: int) -> list[list[int]]:
    legs = {foot.hip for foot in find_feet(skeleton, positions, up)}
    lengths = np.linalg.norm(skeleton.offsets, axis=1)
    leaves = set(range(skeleton.n_joints)) - set(skeleton.parents)
    limbs = [_limb(skeleton, leaf) for leaf in sorted(leaves)]
    long = LIMBS.long * skeleton.size
    return [x for x in limbs if legs.isdisjoint(x) and lengths[x[1:]].sum() > long]


def _limb(skeleton: Skeleton, leaf: int) -> list[int]:
    """List the joints from below the nearest branching of the body down to a leaf."""
    reach = np.zeros(skeleton.n_joints)
    limbs = np.zeros(skeleton.n_joints, int)
    lengths = np.linalg.norm(skeleton.offsets, axis=1)
    for joint, offset in skeleton.end_sites:
        reach[joint] = max(reach[joint], float(np.linalg.norm(offset)))
    for joint in range(skeleton.n_joints - 1, 0, -1):
        parent = skeleton.parents[joint]
        limbs[parent] += reach[joint] + lengths[joint] > LIMBS.limb * skeleton.size
        reach[parent] = max(reach[parent], reach[joint] + lengths[joint])
    limb = [leaf]
    while skeleton.parents[limb[0]] > 0 and limbs[skeleton.parents[limb[0]]] < 2:
        limb.insert(0, skeleton.parents[limb[0]])
    return limb


def _foot(skeleton: Skeleton, limb: list[int]) -> Foot:
    """Take a limb's two longest consecutive bones, and the point below them."""
    bones = np.linalg.norm(skeleton.offsets[limb[1:]], axis=1)
    first = int(np.argmax(bones[:-1] + bones[1:]))
    hip, knee, ankle = limb[first : first + 3]
    least = LIMBS.least * skeleton.size
    below = [joint for joint in limb[first + 3 :] if np.any(abs(skeleton.offsets[joint]) > least)]
    ends = [offset for joint, offset in skeleton.end_sites if joint == ankle]
    if below:
        return Foot(hip, knee, ankle, below[0])
    if ends:
        x, y, z = max(ends, key=np.linalg.norm).tolist()
        return Foot(hip, knee, ankle, ankle, (x, y, z))
    return Foot(hip, knee, ankle, ankle)


def foot_points(feet: tuple[Foot, ...], positions: Array, orientations: Array) -> Array:
    """Return where feet touch the ground, (F, n, 3), from forward kinematics' results."""
    joints = [foot.joint for foot in feet]
    offsets = np.reshape([foot.offset for foot in feet], (-1, 3))
    return positions[:, joints] + rot.rotate(orientations[:, joints], offsets)


def contacts(points: Array, *, fps: float, size: float, up: int) -> Mask:
    """Tell when points stand on the ground: low and slow, with hysteresis.

    Parameters
    ----------
    points : (F, n, 3) ndarray
        As from `foot_points`.
    fps : float
    size : float
        The skeleton's size.
    up : int
        The vertical axis.

    Returns
    -------
    (F, n) ndarray of bool
    """
    height = _above_ground(points, fps, size, up)
    reach = max(1, round(CONTACTS.reach * fps))
    ahead = np.clip(np.arange(len(points)) + reach, 0, len(points) - 1)
    behind = np.clip(np.arange(len(points)) - reach, 0, len(points) - 1)
    moved = np.linalg.norm(points[ahead] - points[behind], axis=-1)
    speed = moved * fps / (np.maximum(ahead - behind, 1)[:, None] * size)
    begins = (height < CONTACTS.begins_below) & (speed < CONTACTS.begins_slower)
    holds = (height < CONTACTS.ends_above) & (speed < CONTACTS.ends_faster)
    shortest = max(2, round(CONTACTS.shortest * fps))
    columns = [_hysteresis(b, h, shortest) for b, h in zip(begins.T, holds.T, strict=True)]
    return np.stack(columns, axis=-1) if columns else np.zeros((len(points), 0), bool)


def _above_ground(points: Array, fps: float, size: float, up: int) -> Array:
    """Return heights (F, n) above the ground where each point stands, in sizes.

    The ground is each point's lowest height within a stride or so, since the floor of many
    captures is not level; but not much above the lowest of all.
    """
    height = points[:, :, up] / size
    reach = min(round(CONTACTS.stride * fps), len(height) - 1)
    padded = np.pad(height, ((reach, reach), (0, 0)), mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1, axis=0)
    return height - np.minimum(windows.min(axis=-1), height.min(axis=0) + CONTACTS.unlevel)


def _hysteresis(begins: Mask, holds: Mask, shortest: int) -> Mask:
    """Keep the stretches of `holds` in which `begins` lasts, and join near ones."""
    result = np.zeros(len(holds), bool)
    for start, stop in Spans.of_mask(holds):
        if begins[start:stop].sum() >= shortest:
            result[start:stop] = True
    for start, stop in Spans.of_mask(~result):
        if start > 0 and stop < len(result) and stop - start < shortest:
            result[start:stop] = True
    return result


def skate(points: Array, *, fps: float, size: float, up: int) -> float:
    """Return how far points slide along the ground, in sizes, summed over points and frames.

    A slide counts in full on the ground and less above it: by 2 - 2^(h / H) up to the height
    H of a hundredth of the body (Zhang et al. 2018, "Mode-adaptive neural networks").

    Parameters
    ----------
    points : (F, n, 3) ndarray
        As from `foot_points`.
    fps : float
    size : float
        The skeleton's size.
    up : int
        The vertical axis.
    """
    level = np.delete(points, up, axis=2)
    slide = np.linalg.norm(np.diff(level, axis=0), axis=-1) / size
    height = _above_ground(points, fps, size, up) / CONTACTS.skate_height
    weight = np.clip(2.0 - 2.0 ** (0.5 * (height[1:] + height[:-1])), 0.0, 1.0)
    return float(np.sum(weight * slide))
