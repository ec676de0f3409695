"""Blend cycles and go from one to another ([A] 4.5).

A cycle is linear in its coefficients up to the normalisation of quaternions, so that a convex
combination of cycles in phase with each other is the same combination of their coefficients: the
blend of cycles is again a cycle. Averaging unit quaternions of one hemisphere and normalising
minimises the weighted sum of squared chordal distances: an average on the sphere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.checks import all_expected, as_numbers, expected
from roundelay.base.numeric import ROUNDING, SIX_DIGITS, smoothstep
from roundelay.base.threads import one_thread
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.edit.align import Criterion, align, mapped
from roundelay.cycles.edit.points import of_common_points
from roundelay.cycles.thresholds import ALIGNMENT
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion, checked_rate
from roundelay.phase.harmonic import HarmonicCurve

__all__ = ["CycleSpace", "blend", "transition"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CycleSpace:
    """Cycles in phase with each other, ready to be blended at any weights and phase.

    Parameters
    ----------
    cycles : tuple of Cycle
        Aligned to the first; use `CycleSpace.of` to make them so.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> run = rl.read("run.bvh")
    >>> gaits = rl.CycleSpace.of([rl.find_cycles(take)[0] for take in (walk, run)])
    >>> [round(gaits.cycle([1.0 - share, share]).period, 2) for share in (0.0, 0.5, 1.0)]
    [1.1, 0.91, 0.75]
    """

    cycles: tuple[Cycle, ...]

    @classmethod
    def of(
        cls, cycles: Sequence[Cycle], *, by: Criterion = "poses", mirror: bool = False
    ) -> CycleSpace:
        """Align cycles to the first of them; `by` and `mirror` as for `align`.

        Raises
        ------
        ValueError
            If there are none, a joint makes whole turns in some of them only, or not the same
            axis points up in all.
        SkeletonMismatch
            If their skeletons differ, naming the joints; of markers and keypoints those in common
            count.
        """
        cycles = all_expected(Cycle, cycles)
        if not cycles:
            raise ValueError("expected at least one cycle, found none")
        first, *others = of_common_points(cycles)
        others = [align(first, other, by=by, mirror=mirror).cycle for other in others]
        return cls((first, *[_same_signs(first, other) for other in others]))

    @one_thread
    def cycle(self, weights: ArrayLike) -> Cycle:
        """Return the blend (k,) of the cycles as a cycle.

        Rotations, travel, turning and bone lengths are averaged, the period geometrically; the
        joints above the one that carries the body are the first cycle's.

        Raises
        ------
        ValueError
            If the weights are not one a cycle, not negative, with a sum of 1.
        """
        w = _checked(weights, len(self.cycles))
        first = self.cycles[0]
        offsets = np.einsum("k,kjc->jc", w, [c.skeleton.offsets for c in self.cycles])
        periods = [cycle.period for cycle in self.cycles]
        turns = [cycle.odd_pose for cycle in self.cycles]
        return replace(
            first,
            skeleton=replace(first.skeleton, offsets=offsets),
            period=float(np.exp(w @ np.log(periods))),
            pose=_combined([cycle.pose for cycle in self.cycles], w),
            odd_pose=_combined([c for c in turns if c is not None], w) if all(turns) else None,
            velocity=_combined([cycle.velocity for cycle in self.cycles], w),
            height=_combined([cycle.height for cycle in self.cycles], w),
            turning=float(w @ [cycle.turning for cycle in self.cycles]),
            translations=_combined(self._translations, w) if self._translations else None,
            evidence=None,
            phase=None,
            method="",
        )

    @one_thread
    def rotations(self, weights: ArrayLike, phase: ArrayLike) -> Array:
        """Return rotations (n, J, 4) at phases (n,) with weights (k,) or one row a phase (n, k).

        The root's rotation is without its steady turning, as in `Cycle.rotations`.
        """
        x = np.asarray(phase, float)
        w = np.broadcast_to(np.asarray(weights, float), (len(x), len(self.cycles)))
        frequencies, table = self._table
        angle = 2 * np.pi * x[:, None] * frequencies
        waves = np.hstack([np.sin(angle), np.cos(angle), np.ones((len(x), 1))])
        total = np.reshape(w[:, :, None] * waves[:, None], (len(x), -1)) @ table
        return rot.normalize(total.reshape(len(x), -1, 4))

    @cached_property
    def _translations(self) -> list[HarmonicCurve]:
        """Local positions of the cycles' joints; empty if no bone of any changes its length."""
        if all(cycle.translations is None for cycle in self.cycles):
            return []
        return [cycle.translations or _resting(cycle.skeleton) for cycle in self.cycles]

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        """Frequencies (m,) of all cycles, and (k (2 m + 1), 4 J): sines, cosines, constant each."""
        own = [[c.pose, *([c.odd_pose] if c.odd_pose else [])] for c in self.cycles]
        frequencies = np.unique(np.concatenate([c.frequencies for curves in own for c in curves]))
        m, columns = len(frequencies), 4 * self.cycles[0].skeleton.n_joints
        table = np.zeros((len(own), 2 * m + 1, columns))
        for rows, curves in zip(table, own, strict=True):
            for curve in curves:
                at = np.searchsorted(frequencies, curve.frequencies)
                rows[at] += curve.sine
                rows[m + at] += curve.cosine
                rows[-1] += curve.constant
        return frequencies, table.reshape(-1, columns)

    def weights_at(self, value: float, by: str = "speed") -> Array:
        """Return the weights (k,) that lie at a value of a parameter between two cycles.

        Parameters
        ----------
        value : float
            Speed in lengths a second, or turning in radians a second.
        by : {"speed", "turning", "period"}

        Raises
        ------
        ValueError
            If the value lies outside what the cycles span, or the parameter is unknown.
        """
        values = np.array([_parameter(cycle, by) for cycle in self.cycles])
        order = np.argsort(values)
        low, high = values[order[0]], values[order[-1]]
        slack = ROUNDING * (abs(low) + abs(high))
        if not low - slack <= value <= high + slack:
            raise ValueError(f"expected a {by} from {low:g} to {high:g}, found {value:g}")
        place = np.interp(value, values[order], np.arange(len(values)))
        before = int(min(place, len(values) - 2)) if len(values) > 1 else 0
        weights = np.zeros(len(values))
        weights[order[before]] = 1.0 - (place - before)
        if len(values) > 1:
            weights[order[before + 1]] = place - before
        return weights


def _resting(skeleton: Skeleton) -> HarmonicCurve:
    """Return the offsets of joints as a curve that does not move."""
    offsets = skeleton.offsets.reshape(-1)
    none = np.zeros((0, len(offsets)))
    return HarmonicCurve(np.zeros(0), offsets, none, none)


def _parameter(cycle: Cycle, by: str) -> float:
    if by == "speed":
        return cycle.speed
    if by == "turning":
        return cycle.turning / cycle.period
    if by == "period":
        return cycle.period
    raise ValueError(f"expected speed, turning or period, found {by!r}")


def _checked(weights: ArrayLike, count: int) -> Array:
    w = np.asarray(as_numbers(weights, "weights"), float)
    if w.shape != (count,):
        raise ValueError(f"expected {count} weights, found an array of shape {w.shape}")
    if not np.all(np.isfinite(w)) or np.any(w < 0.0):
        raise ValueError(f"expected weights that are not negative, found {w.tolist()}")
    if abs(w.sum() - 1.0) > SIX_DIGITS:
        raise ValueError(f"expected weights with a sum of 1, found {w.sum():g}")
    return w


def _same_signs(first: Cycle, other: Cycle) -> Cycle:
    """Give the quaternions of a cycle the signs of the first one's; the rotations stay."""
    ours, theirs = (_turning_joints(cycle) for cycle in (first, other))
    if np.any(ours != theirs):
        names = [first.skeleton.names[joint] for joint in np.flatnonzero(ours != theirs)]
        raise ValueError(f"joints that make whole turns in one cycle only: {', '.join(names)}")
    grid = np.arange(ALIGNMENT.phases) / ALIGNMENT.phases
    products = np.einsum("pjq,pjq->j", first.rotations(grid), other.rotations(grid))
    signs = np.repeat(np.where(products < 0.0, -1.0, 1.0), 4)
    odd = None if other.odd_pose is None else mapped(other.odd_pose, lambda v: v * signs)
    return replace(other, pose=mapped(other.pose, lambda v: v * signs), odd_pose=odd)


def _turning_joints(cycle: Cycle) -> NDArray[np.bool_]:
    if cycle.odd_pose is None:
        return np.zeros(cycle.skeleton.n_joints, bool)
    strength = np.abs(cycle.odd_pose.sine).sum(axis=0) + np.abs(cycle.odd_pose.cosine).sum(axis=0)
    return np.asarray(strength.reshape(-1, 4).sum(axis=1) > 0.0)


def _combined(curves: Sequence[HarmonicCurve], weights: Array) -> HarmonicCurve:
    longest = max(curves, key=lambda curve: len(curve.frequencies))
    rows, columns = longest.sine.shape
    sine, cosine = np.zeros((rows, columns)), np.zeros((rows, columns))
    for curve, weight in zip(curves, weights, strict=True):
        sine[: len(curve.sine)] += weight * curve.sine
        cosine[: len(curve.cosine)] += weight * curve.cosine
    constant = np.einsum("k,kd->d", weights, [curve.constant for curve in curves])
    return HarmonicCurve(longest.frequencies, constant, sine, cosine)


@one_thread
def blend(
    cycles: Sequence[Cycle],
    weights: ArrayLike,
    *,
    by: Criterion = "poses",
    mirror: bool = False,
) -> Cycle:
    """Align cycles and blend them with convex weights ([A] 4.5); see `CycleSpace`.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> run = rl.read("run.bvh")
    >>> first, second = (rl.find_cycles(take)[0] for take in (walk, run))
    >>> jog = rl.blend([first, second], [0.5, 0.5])
    >>> first.period > jog.period > second.period
    True
    """
    return CycleSpace.of(cycles, by=by, mirror=mirror).cycle(weights)


@one_thread
def transition(
    first: Cycle,
    second: Cycle,
    seconds: float = 0.5,
    *,
    before: float = 1.0,
    after: float = 1.0,
    fps: float | None = None,
    by: Criterion = "poses",
    mirror: bool = False,
) -> Motion:
    """Go from one cycle to another while the phase runs on ([A] 4.5).

    The weight eases from 0 to 1; period, turning and velocity are those of the blend at each
    moment, and the root's path is their integral, so that nothing jumps. The skeleton is the
    first cycle's, as is what the joints above the one that carries the body do.

    Parameters
    ----------
    first, second : Cycle
    seconds : float
        How long the transition lasts.
    before, after : float
        Seconds of the first cycle before it and of the second after it.
    fps : float, optional
        Frames a second; the first cycle's by default.
    by : {"poses", "contacts"}
        What shall agree at equal phases; see `roundelay.cycles.edit.align.align`.
    mirror : bool
        Let the second cycle be mirrored where that fits better.

    Returns
    -------
    Motion

    Raises
    ------
    ValueError
        If a duration is negative, the transition takes longer than a minute or what is around it
        longer than an hour, or the frame rate is not positive, or beyond 10,000.
    SkeletonMismatch
        If the skeletons differ.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> run = rl.read("run.bvh")
    >>> first, second = (rl.find_cycles(take)[0] for take in (walk, run))
    >>> motion = rl.transition(first, second, seconds=0.5, before=1.0, after=1.0, fps=30.0)
    >>> len(motion)
    76
    """
    first, second = expected(Cycle, first), expected(Cycle, second)
    if not (0.0 < seconds <= 60 and 0.0 <= before <= 3600 and 0.0 <= after <= 3600):
        raise ValueError(
            "expected no negative durations, a transition of up to 60 s and up to 3600 s before "
            f"and after it, found {seconds:g}, {before:g} and {after:g}"
        )
    rate = checked_rate(first.fps if fps is None else fps)
    space = CycleSpace.of([first, second], by=by, mirror=mirror)
    time = np.arange(round((before + seconds + after) * rate) + 1) / rate
    share = smoothstep(np.clip((time - before) / seconds, 0.0, 1.0))
    weights = np.stack([1.0 - share, share], axis=1)
    one, two = space.cycles
    pace = np.exp(-weights @ np.log([one.period, two.period]))
    phase = _running(pace) / rate
    turn = _running(pace * (weights @ [one.turning, two.turning])) / rate
    axis = np.eye(3)[one.up]
    heading_turn = rot.from_rotation_vector(turn[:, None] * axis)

    def walked(velocities: Sequence[Array]) -> Array:
        velocity = np.einsum("fk,kfd->fd", weights, velocities)
        return _running(rot.rotate(heading_turn, pace[:, None] * velocity)) / rate

    path = walked([c.velocity(phase) for c in space.cycles])
    height = sum(w * c.height(phase)[:, 0] for w, c in zip(weights.T, space.cycles, strict=True))
    path[:, one.up] += height
    rotations = space.rotations(weights, phase)
    rotations[:, 0] = rot.multiply(heading_turn, rotations[:, 0])
    curves = [curve(phase) for curve in space._translations]
    moved = np.einsum("fk,kfd->fd", weights, curves).reshape(len(phase), -1, 3) if curves else None
    name = f"{one.name} to {two.name}"
    motion = Motion(one.skeleton, rotations, path, 1.0 / rate, moved, name=name, up=one.up)
    if one.above is None:
        return motion
    steady = walked([np.tile(c.velocity.constant, (len(phase), 1)) for c in space.cycles])
    return one.above.given(motion, heading_turn, steady + one.steady_path([0.0]))


def _running(rates: Array) -> Array:
    """Integrate rates a frame by the trapezoid rule, from 0."""
    steps = 0.5 * (rates[1:] + rates[:-1])
    return np.concatenate([np.zeros_like(rates[:1]), np.cumsum(steps, axis=0)])
