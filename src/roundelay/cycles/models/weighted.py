"""[C]'s own regression as a method of the main job: velocity and acceleration as constraints.

The frames and the circular coordinate are those that the main job found; from there on it is
[C] 3.2-3.7 and 3.9::

    coordinate -> ranks (3.20) -> angles, root's path -> weighted regression (3.14, 3.27) -> cycle

Where this is not [C] to the letter (`roundelay.reproduction.raunio` is):

- *Angles* are rotation vectors about each joint's mean rotation, in radians. Unlike Euler angles
  they have no order of axes, no gimbal, and no border within a whole turn of the mean. A joint
  that makes whole turns, which [C] 6.4 leaves open, has them about a steady turn.
- *Period*: N of eq. 3.25 and of the loop is the cycle's. The slope of a line over ranks ([C] 3.6)
  is up to 5 % off below two repetitions.
- *Heading*: what the root's heading gains from period to period is no periodic angle. It stays the
  cycle's steady turning, and the path is fitted in the heading that turns along.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import ROUNDING
from roundelay.cycles.continuity import Followed, followed_poses
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.models.constrained import Fit, Model, fit_model
from roundelay.cycles.models.regression import fit_cycle
from roundelay.cycles.thresholds import WEIGHTED
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion
from roundelay.phase.harmonic import HarmonicCurve
from roundelay.phase.phase_map import rank_remap
from roundelay.timeline.evidence import Evidence
from roundelay.timeline.options import Options

__all__ = ["Paper", "paper_cycle"]

Array = NDArray[np.float64]


class Paper:
    """[C]'s model: weighted regression of angles."""

    name = "paper"

    def fit(self, motion: Motion, phase: Array, evidence: Evidence, options: Options) -> Cycle:
        """Fit the cycle; see `roundelay.cycles.models.CycleModel`."""
        count = options.harmonics
        cycle = fit_cycle(motion, phase, evidence.runs, harmonics=count, evidence=evidence)
        return paper_cycle(
            cycle,
            motion,
            harmonics=count,
            velocity=options.velocity,
            acceleration=options.acceleration,
            root=options.root_models,
        )


def paper_cycle(
    cycle: Cycle,
    motion: Motion,
    *,
    harmonics: int | None = None,
    velocity: bool = True,
    acceleration: bool = True,
    root: Mapping[int, str] | None = None,
) -> Cycle:
    """Replace the poses and the travel of a cycle by [C]'s regression of the same frames.

    Parameters
    ----------
    cycle : Cycle
        Found in the capture, with its evidence.
    motion : Motion
        The capture.
    harmonics : int, optional
        K; by default [C]'s 20, or as many as the frames of a period can tell apart.
    velocity, acceleration : bool
        Constrain the regression by them ([C] 5.3 items 20, 21), where the frames are more
        than the coefficients.
    root : mapping of int to {"line", "periodic", "none"}, optional
        Models of the path by axis ([C] 3.9): a line with harmonics, harmonics alone, or no
        movement. By default a line along what is level, and upwards where the cycle climbs.

    Raises
    ------
    ValueError
        If the cycle carries no evidence, or a joint turns so that no angles follow it.
    """
    if cycle.evidence is None:
        raise ValueError("expected a cycle found in a capture, with its evidence")
    motion, runs, period = motion.with_root_motion(), cycle.evidence.runs, cycle.period * cycle.fps
    if harmonics is None:
        harmonics = min(WEIGHTED.harmonics, max(1, (int(period) - 1) // 2))
    model = Model(harmonics, velocity=velocity, acceleration=acceleration)
    phase = _ranked(cycle.evidence)
    poses = followed_poses(motion, phase, runs, harmonics)
    inside = runs.frames
    fit = partial(fit_model, phase[inside], period=period, model=model, runs=runs.joined)
    centre = _centre(cycle, poses, inside)
    angles = fit(_angles(centre(phase[inside]), poses, inside, cycle.skeleton)).curve
    path = np.concatenate([_walked(poses.steps(motion)[start : stop - 1]) for start, stop in runs])
    travel, height = fit(path, line=True), fit(motion.root_path[inside, motion.up, None]).curve
    # Only a cycle that climbs has a line along the vertical, as [C] 5.3 items 12-14 choose by hand.
    climbs = cycle.velocity.constant[cycle.up] != 0.0
    keep = (np.arange(3) != cycle.up) | climbs
    if root:
        travel, height, keep = _along_axes(travel, height, keep, fit(path).curve, cycle.up, root)
        climbs = bool(keep[cycle.up])
    even, odd = _poses(centre, angles)
    moved = None
    if motion.translations is not None:
        moved = fit(motion.translations[inside].reshape(len(inside), -1)).curve
    return replace(
        cycle,
        pose=even,
        odd_pose=odd,
        velocity=_velocity(travel, keep),
        height=_mean(cycle.height) if climbs else height,
        translations=moved,
        phase=phase,
    )


def _mean(curve: HarmonicCurve) -> HarmonicCurve:
    """Return the constant of a curve alone."""
    return replace(curve, sine=0.0 * curve.sine, cosine=0.0 * curve.cosine)


def _along_axes(
    travel: Fit,
    height: HarmonicCurve,
    keep: NDArray[np.bool_],
    periodic: HarmonicCurve,
    up: int,
    root: Mapping[int, str],
) -> tuple[Fit, HarmonicCurve, NDArray[np.bool_]]:
    """Choose the model of the path by axis ([C] 3.9 and 5.3 items 12 to 14).

    Upwards, what is no line is the height's: its harmonics, or its mean alone.
    """
    sine, cosine = travel.curve.sine.copy(), travel.curve.cosine.copy()
    slope, kept = travel.slope.copy(), keep.copy()
    for axis, kind in root.items():
        kept[axis] = kind == "line" or (kind == "periodic" and axis != up)
        if kind == "periodic":
            sine[:, axis], cosine[:, axis] = periodic.sine[:, axis], periodic.cosine[:, axis]
            slope[axis] = 0.0
    if root.get(up) == "none":
        height = _mean(height)
    curve = replace(travel.curve, sine=sine, cosine=cosine)
    return replace(travel, curve=curve, slope=slope), height, kept


def _ranked(evidence: Evidence) -> Array:
    """Return the coordinate by ranks (F,), in turns ([C] eq. 3.20); NaN outside the runs.

    One closed period is in proportion to time already.
    """
    if evidence.closed:
        return evidence.turns
    inside = evidence.runs.frames
    result = np.full(len(evidence.turns), np.nan)
    result[inside] = np.floor(evidence.turns[inside]) + rank_remap(evidence.turns[inside])
    return result


def _walked(steps: Array) -> Array:
    """Return the path (n + 1, 3) of steps (n, 3) from the origin."""
    return np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])


@dataclass(frozen=True)
class _Centre:
    """Rotations from which angles are measured: means, or steady turns.

    At phase x a joint's is cos(2 pi f x) c + sin(2 pi f x) s: with f = 0 its mean, with f = n / 2
    n whole turns a period about one axis.
    """

    frequency: Array
    cosine: Array
    sine: Array

    def __call__(self, phase: Array) -> Array:
        """Return rotations (n, J, 4) at unwrapped phases (n,)."""
        angle = 2 * np.pi * phase[:, None, None] * self.frequency[:, None]
        return np.cos(angle) * self.cosine + np.sin(angle) * self.sine


def _centre(cycle: Cycle, poses: Followed, inside: NDArray[np.intp]) -> _Centre:
    """Choose means, and steady turns for joints that go all around theirs."""
    local = poses.local[inside]
    mean = rot.mean(local)
    frequency, sine = np.zeros(len(mean)), np.zeros_like(mean)
    cosine = np.einsum("njq,jq->nj", local, mean)
    around = poses.odd | ((cosine * _sign(cosine.sum(axis=0))).min(axis=0) < WEIGHTED.farthest)
    for joint in np.flatnonzero(around & ~poses.jumps):
        frequency[joint], mean[joint], sine[joint] = _steady_turn(cycle, joint)
    return _Centre(frequency, mean, sine)


def _steady_turn(cycle: Cycle, joint: np.intp) -> tuple[float, Array, Array]:
    """Return the great circle of quaternions nearest to a joint's strongest frequency."""
    curves = [cycle.pose] + ([] if cycle.odd_pose is None else [cycle.odd_pose])
    own = slice(4 * joint, 4 * joint + 4)
    frequencies = np.concatenate([curve.frequencies for curve in curves])
    cosine = np.concatenate([curve.cosine[:, own] for curve in curves])
    sine = np.concatenate([curve.sine[:, own] for curve in curves])
    strongest = int(np.argmax(np.sum(cosine**2 + sine**2, axis=1)))
    pair = np.stack([cosine[strongest], sine[strongest]], axis=1)
    left, _, right = np.linalg.svd(pair, full_matrices=False)
    return float(frequencies[strongest]), *(left @ right).T


def _sign(cosine: Array) -> Array:
    return np.where(cosine < 0.0, -1.0, 1.0)


def _angles(centre: Array, poses: Followed, inside: NDArray[np.intp], skeleton: Skeleton) -> Array:
    """Return rotation vectors (n, 3 J) from centres (n, J, 4), smooth up to a whole turn.

    Those of a joint that jumps are within half a turn instead.
    """
    apart = rot.multiply(rot.conjugate(centre), poses.local[inside])
    cosine = apart[..., 0]
    apart *= np.where(poses.jumps, _sign(cosine), _sign(cosine.sum(axis=0)))[..., None]
    far = np.flatnonzero(apart[..., 0].min(axis=0) < WEIGHTED.farthest)
    if len(far):
        names = ", ".join(skeleton.names[joint] for joint in far)
        raise ValueError(
            'the method "paper" needs angles about a mean or a steady turn, and these joints '
            f"have none: {names}"
        )
    length = np.linalg.norm(apart[..., 1:], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(length, apart[..., :1])
    vectors = apart[..., 1:] * np.where(
        length > ROUNDING, angle / np.maximum(length, ROUNDING), 2.0
    )
    return vectors.reshape(len(inside), -1)


def _poses(centre: _Centre, angles: HarmonicCurve) -> tuple[HarmonicCurve, HarmonicCurve | None]:
    """Return the quaternions of angles about a centre as curves, even and odd joints apart."""
    count = 4 * len(angles.frequencies) + 1
    grid = np.arange(count) / count
    turned = rot.from_rotation_vector(angles(grid).reshape(count, -1, 3))
    values = rot.multiply(centre(grid), turned).reshape(count, -1)
    odd = np.repeat(centre.frequency % 1.0 != 0.0, 4)
    even = HarmonicCurve.through(np.where(odd, 0.0, values))
    if not odd.any():
        return even, None
    return even, HarmonicCurve.through(np.where(odd, values, 0.0), odd=True)


def _velocity(travel: Fit, keep: NDArray[np.bool_]) -> HarmonicCurve:
    """Return the derivative of [C] eq. 3.27 by phase, of the axes (3,) to keep."""
    rate = 2 * np.pi * travel.curve.frequencies[:, None] * keep
    return HarmonicCurve(
        travel.curve.frequencies,
        travel.slope * keep,
        -rate * travel.curve.cosine,
        rate * travel.curve.sine,
    )
