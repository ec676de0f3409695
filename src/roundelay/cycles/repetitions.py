"""The repetitions behind a cycle: how each differs from the mean, and new ones drawn alike.

A repetition is its duration and, at every phase, what turns the mean's joints into its own
(rotation vectors: the tangent space of the mean), how the root's velocity and height differ, and of
points how their places do. Their covariance says how the motion varies; a new repetition is a
Gaussian draw with that covariance, which is a random mixture of those that were seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.brief import brief
from roundelay.base.checks import as_numbers, expected
from roundelay.base.errors import TooShort
from roundelay.base.numeric import TINY, smoothstep
from roundelay.base.spans import Spans
from roundelay.base.threads import one_thread
from roundelay.cycles.continuity import followed_poses
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.edit.footlock import lock_feet
from roundelay.cycles.thresholds import VARIATION
from roundelay.geometry import rotations as rot
from roundelay.motion.floating import as_motion
from roundelay.motion.motion import Motion, checked_rate
from roundelay.motion.points import Points
from roundelay.phase.harmonic import highest_harmonic

__all__ = ["Band", "Repetitions", "repetitions"]

Array = NDArray[np.float64]
_Rng = int | np.random.Generator


@dataclass(frozen=True, eq=False)
class Band:
    """How far a joint is turned along the phase, on average and from repetition to repetition.

    Attributes
    ----------
    phase : (P,) ndarray
        From 0 to below 1, in turns.
    mean, low, high : (P,) ndarray
        Degrees from the joint's mean pose about the axis about which it turns most; a new
        repetition lies between `low` and `high` at any one phase with the probability `level`.
    each : (R, P) ndarray
        The repetitions.
    level : float
    """

    phase: Array
    mean: Array
    low: Array
    high: Array
    each: Array = field(repr=False)
    level: float

    __repr__ = brief


@dataclass(frozen=True, eq=False)
class Repetitions:
    """Hold the whole repetitions that a cycle is the mean of.

    Attributes
    ----------
    cycle : Cycle
    starts : (R,) ndarray
        Frames of the capture at which each begins, with fractions.
    durations : (R,) ndarray
        Seconds.
    turns : (R, P, J, 3) ndarray
        Rotation vectors, in radians, that turn the mean's local rotations into each one's, at the
        phases from `-margin` to 1 + `margin`.
    velocity : (R, P, 3) ndarray
        Of the root, beyond that of the mean, in its heading, in lengths a period.
    height : (R, P) ndarray
        Of the root, above that of the mean.
    moved : (R, P, J, 3) ndarray or None
        Places of joints on their parents, beyond those of the mean, where bones change length.
    phase : (P,) ndarray
        In turns; before 0 and after 1 it is that of the repetitions before and after.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> kept = rl.repetitions(rl.find_cycles(walk)[0], walk)
    >>> np.round(kept.durations, 2)
    array([1.1, 1.1, 1.1, 1.1, 1.1])
    """

    cycle: Cycle
    starts: Array
    durations: Array
    turns: Array = field(repr=False)
    velocity: Array = field(repr=False)
    height: Array = field(repr=False)
    moved: Array | None = field(repr=False)
    phase: Array = field(repr=False)

    __repr__ = brief

    def __len__(self) -> int:
        return len(self.durations)

    @one_thread
    def band(self, joint: str, level: float) -> Band:
        """Return how far a joint is turned along the phase, with its spread.

        The limits are those of a new observation of a Gaussian, mean -+ t s sqrt(1 + 1 / R), at
        each phase by itself.

        Parameters
        ----------
        joint : str
        level : float
            Share of new repetitions that lie within it at any one phase, such as .95.

        Raises
        ------
        SkeletonMismatch
            If there is no such joint.
        TooShort
            If there is one repetition only: it has no spread.
        ValueError
            If the level is not between 0 and 1.
        """
        if not 0.0 < level < 1.0:
            raise ValueError(f"expected a level between 0 and 1, found {level:g}")
        number = self.cycle.skeleton.index(joint)
        count = self._several("a band")
        inside = (self.phase >= 0.0) & (self.phase < 1.0)
        mean = self.cycle.rotations(self.phase[inside])[:, number]
        own = rot.multiply(mean, rot.from_rotation_vector(self.turns[:, inside, number]))
        middle = rot.mean(mean)
        vectors = rot.vector_between(middle, own)
        axis = np.linalg.svd(vectors.reshape(-1, 3), full_matrices=False)[2][0]
        each = np.degrees(vectors @ axis)
        average = each.mean(axis=0)
        reach = _student(level, count - 1) * np.sqrt(1.0 + 1.0 / count) * each.std(axis=0, ddof=1)
        return Band(self.phase[inside], average, average - reach, average + reach, each, level)

    @one_thread
    def vary(
        self,
        periods: int = 1,
        *,
        rng: _Rng = 0,
        amount: float = 1.0,
        fps: float | None = None,
        in_place: bool = False,
        repeat_first: bool = False,
        foot_lock: bool = True,
    ) -> Motion:
        """Draw new repetitions that loop: after the last the first comes again.

        Parameters
        ----------
        periods : int
            How many different ones.
        rng : int or numpy.random.Generator
        amount : float
            1 varies as much as the capture, 0 not at all.
        fps : float, optional
            Frames a second; the capture's by default.
        in_place : bool
            Leave out the root's travel and turning.
        repeat_first : bool
            Append the frame that repeats the first.
        foot_lock : bool
            Hold standing feet still.

        Raises
        ------
        TooShort
            If there is one repetition only: it has no spread.
        ValueError
            If `periods` or `fps` is not positive, or the amount negative.
        """
        if periods < 1:
            raise ValueError(f"expected at least one period, found {periods}")
        drawn = self._drawn(periods, rng, amount)
        return self._looped(drawn, fps, in_place, repeat_first, foot_lock)

    @one_thread
    def mixed(
        self,
        shares: ArrayLike,
        *,
        fps: float | None = None,
        in_place: bool = False,
        repeat_first: bool = False,
        foot_lock: bool = True,
    ) -> Motion:
        """Mix the differences of repetitions from their mean, and return the loop of the mixtures.

        Parameters
        ----------
        shares : (n, R) array_like
            A row a period: how much of each repetition's difference is added to the mean.
        fps, in_place, repeat_first, foot_lock
            As for `vary`.

        Raises
        ------
        ValueError
            If the shares are not finite rows of R numbers, or `fps` is not positive.
        """
        rows = np.asarray(as_numbers(shares, "shares"), float)
        if rows.ndim != 2 or not len(rows) or rows.shape[1] != len(self):
            raise ValueError(f"expected rows of {len(self)} shares, found shape {rows.shape}")
        if not np.isfinite(rows).all():
            raise ValueError("expected finite shares, found others")
        return self._looped(self._mixtures(rows), fps, in_place, repeat_first, foot_lock)

    @one_thread
    def play(
        self,
        seconds: float,
        *,
        rng: _Rng = 0,
        amount: float = 1.0,
        fps: float | None = None,
        in_place: bool = False,
    ) -> Motion:
        """Go on for some seconds, never the same twice; arguments and errors as for `vary`."""
        if not 0.0 < seconds <= 3600:
            raise ValueError(f"expected up to 3600 s, found {seconds:g}")
        rate = checked_rate(self.cycle.fps if fps is None else fps)
        enough = int(np.ceil(seconds / float(self.durations.min()))) + 1
        drawn = self._drawn(enough, rng, amount)
        share = np.arange(round(seconds * rate)) / (rate * float(drawn.durations.sum()))
        return drawn.shown(share, rate, in_place)

    def _several(self, what: str) -> int:
        if len(self) < 2:
            raise TooShort(f"expected several whole repetitions for {what}, found {len(self)}")
        return len(self)

    def _drawn(self, count: int, rng: _Rng, amount: float) -> _Drawn:
        if not amount >= 0.0:
            raise ValueError(f"expected an amount of 0 or more, found {amount:g}")
        own = self._several("variation")
        draw = np.random.default_rng(rng)
        return self._mixtures(amount * draw.normal(size=(count, own)) / np.sqrt(own - 1.0))

    def _mixtures(self, shares: Array) -> _Drawn:
        logs = np.log(self.durations)
        return _Drawn(self, shares, self.cycle.period * np.exp(shares @ (logs - logs.mean())))

    def _looped(
        self, drawn: _Drawn, fps: float | None, in_place: bool, repeat_first: bool, foot_lock: bool
    ) -> Motion:
        rate = checked_rate(self.cycle.fps if fps is None else fps)
        count = max(1, round(float(drawn.durations.sum()) * rate))
        # The row before and after decide about feet that stand across the join.
        time = np.arange(-count, 2 * count) / count
        around = drawn.shown(time, rate, in_place, foot_lock=foot_lock)
        return around[count : 2 * count + int(repeat_first)]


@dataclass(frozen=True, eq=False)
class _Drawn:
    """Repetitions in a row, each a mixture of those that were seen; the last leads to the first."""

    source: Repetitions
    shares: Array
    durations: Array

    def shown(self, time: Array, fps: float, in_place: bool, *, foot_lock: bool = True) -> Motion:
        """Return the poses at times (n,), in parts of the whole row, at a frame rate."""
        phase, source = self._phase(time), self.source
        cycle = source.cycle
        turns = self._mixed(source.turns, phase)
        moved = None if source.moved is None else self._mixed(source.moved, phase)
        velocity = self._mixed(source.velocity, phase)
        if not in_place:
            up = cycle.heading(phase)[:, None] * np.eye(3)[cycle.up]
            velocity = rot.rotate(rot.from_rotation_vector(up), velocity)
        steps = 0.5 * (velocity[1:] + velocity[:-1]) * np.diff(phase)[:, None]
        along = np.zeros_like(velocity)
        if not in_place:
            along[1:] = np.cumsum(steps, axis=0)
            # It begins where the mean does.
            along -= along[np.argmin(np.abs(phase))]
        along[:, cycle.up] += self._mixed(source.height[..., None], phase)[:, 0]
        motion = cycle.at(
            phase, frame_time=1.0 / fps, in_place=in_place, change=(turns, along, moved)
        )
        if not foot_lock:
            return motion
        return _with_feet_held(motion, round(float(self.durations.min()) * fps))

    def _phase(self, time: Array) -> Array:
        """Return unwrapped phases (n,): the pace goes from that of one evenly to the next one's."""
        count = len(self.durations)
        grid = np.arange(count * VARIATION.steps + 1) / VARIATION.steps
        middles = np.arange(-1, count + 1) + 0.5
        around = np.concatenate([self.durations[-1:], self.durations, self.durations[:1]])
        slowness = np.interp(grid, middles, around)
        spent = np.concatenate([[0.0], np.cumsum(0.5 * (slowness[1:] + slowness[:-1]))])
        rows = np.floor(time)
        return rows * count + np.interp((time - rows) * spent[-1], spent, grid)

    def _mixed(self, values: Array, phase: Array) -> Array:
        """Return the differences (n, ...) from the mean at phases (n,), faded over at the joins."""
        count, source = len(self.durations), self.source
        number = np.floor(phase).astype(int)
        inside = phase - number
        own = self._one(values, number % count, inside)
        margin = -source.phase[0]
        late, early = inside > 1.0 - margin, inside < margin
        result = own.copy()
        for near, step, edge in ((late, 1, inside - 1.0), (early, -1, inside + 1.0)):
            if near.any():
                other = self._one(values, (number[near] + step) % count, edge[near])
                from_join = np.abs(edge[near] if step > 0 else inside[near])
                # An eighth of a turn at the join: squares of the weights have a sum of 1, so that
                # two draws together vary as much as each.
                share = 1.0 - smoothstep(np.clip(from_join / margin, 0.0, 1.0))
                angle = (np.pi / 4 * share).reshape(-1, *[1] * (own.ndim - 1))
                result[near] = np.cos(angle) * own[near] + np.sin(angle) * other
        return result

    def _one(self, values: Array, number: NDArray[np.intp], inside: Array) -> Array:
        """Return the differences of some of the row's repetitions at phases within them."""
        grid = self.source.phase
        place = np.clip(np.interp(inside, grid, np.arange(len(grid))), 0, len(grid) - 1)
        before = np.minimum(place.astype(int), len(grid) - 2)
        part = place - before
        flat = values.reshape(len(values), len(grid), -1)
        centred = flat - flat.mean(axis=0)
        shares = self.shares[number]
        at = [np.einsum("nr,rnd->nd", shares, centred[:, before + step]) for step in (0, 1)]
        mixed = (1.0 - part)[:, None] * at[0] + part[:, None] * at[1]
        return np.asarray(mixed.reshape(len(number), *values.shape[2:]))


def _with_feet_held(motion: Motion, longest: int) -> Motion:
    legs, turned = lock_feet(motion, longest)
    if not legs:
        return motion
    rotations = motion.rotations.copy()
    rotations[:, legs] = turned
    return replace(motion, rotations=rotations)


@one_thread
def repetitions(cycle: Cycle, motion: Motion | Points) -> Repetitions:
    """Return the whole repetitions of a capture behind a cycle that was found in it.

    Parameters
    ----------
    cycle : Cycle
        As from `roundelay.find_cycles`.
    motion : Motion or Points
        The capture given to it.

    Raises
    ------
    TooShort
        If the capture shows no whole repetition.
    ValueError
        If the cycle carries no evidence of where it was found.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> kept = rl.repetitions(rl.find_cycles(walk)[0], walk)
    >>> another = kept.vary(rng=0)
    >>> len(kept.durations), len(another)
    (5, 66)
    """
    cycle, motion = expected(Cycle, cycle), as_motion(motion)
    if cycle.evidence is None or cycle.phase is None:
        raise ValueError("expected a cycle found in a capture, with its evidence and phase")
    body, runs = motion.with_root_motion(), cycle.evidence.runs
    grid = np.arange(-VARIATION.margin, VARIATION.phases + VARIATION.margin + 1)
    phase = grid / VARIATION.phases
    places = [one for run in runs for one in _whole(cycle.phase, run, phase)]
    if not places:
        raise TooShort("expected a whole repetition in the capture, found none")
    frames = np.array(places)
    starts = np.array([np.interp(0.0, phase, one) for one in frames])
    stops = np.array([np.interp(1.0, phase, one) for one in frames])
    turns, velocity = _differences(cycle, body, runs, frames, phase)
    height = _at(body.root_path[:, cycle.up, None], frames)[..., 0] - cycle.height(phase)[:, 0]
    moved = None
    if body.translations is not None and cycle.translations is not None:
        mean = cycle.translations(phase).reshape(len(phase), -1, 3)
        moved = _at(body.translations, frames) - mean
    if cycle.velocity.constant[cycle.up] == 0.0:
        # On the level the height tells it, where it climbs the velocity.
        velocity[..., cycle.up] = 0.0
    else:
        height = np.zeros_like(height)
    return Repetitions(
        cycle, starts, (stops - starts) / motion.fps, turns, velocity, height, moved, phase
    )


def _whole(phase: Array, run: tuple[int, int], grid: Array) -> list[Array]:
    """Return the frames (P,) at which each whole repetition of a run passes the phases of a grid.

    At the ends of a run, where the repetition before or after is not seen, the frames stay.
    """
    own = np.maximum.accumulate(phase[slice(*run)])
    numbers = np.arange(np.ceil(own[0] - TINY), np.floor(own[-1] + TINY))
    frames = np.arange(run[0], run[1], dtype=float)
    return [np.interp(number + grid, own, frames) for number in numbers]


def _differences(
    cycle: Cycle, body: Motion, runs: Spans, frames: Array, phase: Array
) -> tuple[Array, Array]:
    """Return rotations (R, P, J, 3) and velocities (R, P, 3) of the root beyond the mean's."""
    assert cycle.phase is not None
    poses = followed_poses(body, cycle.phase, runs, highest_harmonic(cycle.period))
    before = np.clip(frames.astype(int), 0, len(body) - 2)
    part = frames - before
    own = rot.slerp(poses.local[before], poses.local[before + 1], part[..., None])
    turns = rot.vector_between(cycle.rotations(phase)[None], own)
    # A step lies between two frames; a period has as many as it lasts.
    steps = poses.steps(body) * (cycle.period * body.fps)
    velocity = _at(steps, np.clip(frames - 0.5, 0, len(steps) - 1)) - cycle.velocity(phase)
    return turns, velocity - velocity.mean(axis=0)


def _at(values: Array, frames: Array) -> Array:
    """Return values (R, P, ...) of a table (F, ...) at frames (R, P), interpolated."""
    before = np.clip(frames.astype(int), 0, max(len(values) - 2, 0))
    after = np.minimum(before + 1, len(values) - 1)
    part = (frames - before).reshape(*frames.shape, *[1] * (values.ndim - 1))
    return np.asarray((1.0 - part) * values[before] + part * values[after])


def _student(level: float, freedom: int) -> float:
    """Return the quantile of Student's t that holds a share in the middle (Abramowitz 26.7.5)."""
    z = NormalDist().inv_cdf(0.5 + 0.5 * level)
    terms: Sequence[float] = (
        z,
        (z**3 + z) / 4,
        (5 * z**5 + 16 * z**3 + 3 * z) / 96,
        (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384,
    )
    return float(sum(term / freedom**power for power, term in enumerate(terms)))
