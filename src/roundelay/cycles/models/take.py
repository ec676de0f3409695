"""One repetition as it was played, closed with the least change.

A mean over repetitions softens what is short and strong in each of them: the snap of a punch, the
bounce of a gait. This model keeps the most typical repetition, frame by frame::

    phase -> repetitions from every frame on -> the one nearest to the mean, with the least to close
          -> what its ends lack spread over it (`roundelay.cycles.closing`) -> cycle
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import TooShort
from roundelay.base.spans import Span, Spans
from roundelay.base.threads import one_thread
from roundelay.cycles.closing import (
    about,
    closed_curve,
    closed_rotations,
    closed_steps,
    closing_squares,
    padded,
    padded_rotations,
)
from roundelay.cycles.continuity import Followed, followed_poses
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.models.regression import fit_cycle
from roundelay.cycles.thresholds import TAKE
from roundelay.geometry import rotations as rot
from roundelay.motion.features import point_cloud
from roundelay.motion.motion import Motion
from roundelay.phase.harmonic import HarmonicCurve, highest_harmonic
from roundelay.timeline.evidence import Evidence
from roundelay.timeline.options import Options

__all__ = ["Take", "take_cycle"]

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


class Take:
    """The most typical repetition as it was played."""

    name = "take"

    def fit(self, motion: Motion, phase: Array, evidence: Evidence, options: Options) -> Cycle:
        """Fit the cycle; see `roundelay.cycles.models.CycleModel`."""
        runs, count = evidence.runs, options.harmonics
        cycle = fit_cycle(motion, phase, runs, harmonics=count, evidence=evidence)
        return take_cycle(cycle, motion)


@dataclass(frozen=True)
class _Repetition:
    """Frames of a capture that are one repetition, and the run that they lie in.

    The stop may lie one frame beyond the run: where the next repetition would begin. By the frames
    within reach of its ends their velocities are told.
    """

    run: Span
    start: int
    stop: int
    reach: int

    @property
    def count(self) -> int:
        return self.stop - self.start

    @property
    def about(self) -> slice:
        """Places in what is padded of the run's frames."""
        return about(self.start - self.run[0], self.stop - self.run[0], self.reach)

    def shown(self, values: Array) -> Array:
        """Return values (n, ...) of the repetition of those of a capture, and those about it."""
        return padded(values[slice(*self.run)], self.reach)[self.about]


@one_thread
def take_cycle(cycle: Cycle, motion: Motion) -> Cycle:
    """Replace a cycle by the repetition that is nearest to it, as it was played.

    Parameters
    ----------
    cycle : Cycle
        The mean over repetitions, with its evidence and phase.
    motion : Motion
        The capture.

    Returns
    -------
    Cycle
        With the period of that repetition, in whole frames.

    Raises
    ------
    ValueError
        If the cycle carries no evidence or no phase.
    TooShort
        If no part shows most of a repetition.
    """
    if cycle.evidence is None or cycle.phase is None:
        raise ValueError("expected a cycle found in a capture, with its evidence and phase")
    motion, runs, phase = motion.with_root_motion(), cycle.evidence.runs, cycle.phase
    one = _most_typical(cycle, motion, phase, runs)
    poses = followed_poses(motion, phase, runs, highest_harmonic(cycle.period))
    left, turning = _heading(poses, one)
    even, odd = closed_rotations(_local(poses, one, left, motion), one.reach)
    climbs = cycle.velocity.constant[cycle.up] != 0.0
    keep = (np.arange(3) != cycle.up) | climbs
    height = one.shown(motion.root_path[:, motion.up, None])
    return replace(
        cycle,
        period=one.count * motion.frame_time,
        pose=even,
        odd_pose=odd,
        velocity=closed_steps(_steps(poses, one, left, motion) * keep, one.reach),
        height=cycle.height if climbs else closed_curve(height, one.reach),
        turning=turning,
        translations=None if motion.translations is None else _moved(motion.translations, one),
        phase=_even_phase(phase, one),
    )


def _most_typical(cycle: Cycle, motion: Motion, phase: Array, runs: Spans) -> _Repetition:
    """Return the repetition that is nearest to the cycle and easiest to close."""
    points, reach = point_cloud(motion), max(1, round(TAKE.reach * motion.fps))
    found = [each for run in runs for each in _judged(cycle, points, phase, run, reach)]
    if not found:
        return _whole_run(cycle, phase, runs, reach)
    return min(found, key=lambda each: each[0])[1]


def _judged(
    cycle: Cycle, points: Array, phase: Array, run: Span, reach: int
) -> Iterator[tuple[float, _Repetition]]:
    """Give every repetition of a run with its cost."""
    starts, stops = _repetitions(phase, run)
    if len(starts) == 0:
        return
    costs = _apart(cycle, points, phase, run, starts, stops)
    costs += closing_squares(points[slice(*run)], starts - run[0], stops - run[0], reach)
    for cost, start, stop in zip(costs.tolist(), starts.tolist(), stops.tolist(), strict=True):
        yield cost, _Repetition(run, start, stop, reach)


def _repetitions(phase: Array, run: Span) -> tuple[Indices, Indices]:
    """Return the frames from which on a turn is made within a run, and where it ends."""
    rising = np.maximum.accumulate(phase[slice(*run)])
    later = np.searchsorted(rising, rising + 1.0)
    first = np.flatnonzero(later < len(rising))
    later = later[first]
    # The nearer of the two frames about the end of the turn.
    over, under = rising[later] - rising[first] - 1.0, rising[first] + 1.0 - rising[later - 1]
    return run[0] + first, run[0] + later - (under < over)


def _whole_run(cycle: Cycle, phase: Array, runs: Spans, reach: int) -> _Repetition:
    """Take the run that shows most of a turn for the repetition.

    Raises
    ------
    TooShort
        If it shows too little of one.
    """
    start, stop = max(runs, key=lambda run: phase[run[1] - 1] - phase[run[0]])
    if phase[stop - 1] - phase[start] < TAKE.least:
        raise TooShort("no part shows most of a repetition")
    end = min(stop, start + round(cycle.period * cycle.fps))
    return _Repetition((start, stop), start, end, reach)


def _apart(
    cycle: Cycle, points: Array, phase: Array, run: Span, starts: Indices, stops: Indices
) -> Array:
    """Return how far repetitions are from the cycle: mean squares, summed over the joints."""
    own, first, last = points[slice(*run)], starts - run[0], stops - run[0]
    mean = point_cloud(cycle.at(phase[slice(*run)], frame_time=1.0))
    apart = np.concatenate([[0.0], np.cumsum(np.sum((own - mean) ** 2, axis=1))])
    return np.asarray((apart[last] - apart[first]) / (last - first))


def _heading(poses: Followed, one: _Repetition) -> tuple[Array, float]:
    """Return what is left of the heading beside its steady turning, and that turning."""
    drift, reach = one.shown(poses.drift), one.reach
    turning = float(drift[-1 - reach] - drift[reach])
    share = np.arange(-reach, one.count + reach + 1) / one.count
    return drift - drift[reach] - turning * share, turning


def _local(poses: Followed, one: _Repetition, left: Array, motion: Motion) -> Array:
    """Return rotations (n, J, 4) about the repetition, the root's without its steady turning."""
    local = padded_rotations(poses.local[slice(*one.run)], one.reach)[one.about]
    local[:, 0] = rot.multiply(_turned(left, motion), local[:, 0])
    return local


def _steps(poses: Followed, one: _Repetition, left: Array, motion: Motion) -> Array:
    """Return the root's steps (n - 1, 3) to the next frame, in the heading that turns steadily."""
    start, stop = one.run
    own = poses.steps(motion)[start : stop - 1]
    before, behind = np.repeat(own[:1], one.reach, 0), np.repeat(own[-1:], one.reach + 1, 0)
    whole = np.concatenate([before, own, behind])[one.about][: one.count + 2 * one.reach]
    return rot.rotate(_turned(0.5 * (left[1:] + left[:-1]), motion), whole)


def _turned(angles: Array, motion: Motion) -> Array:
    return rot.from_rotation_vector(angles[:, None] * motion.up_vector)


def _moved(translations: Array, one: _Repetition) -> HarmonicCurve:
    values = one.shown(translations)
    return closed_curve(values.reshape(len(values), -1), one.reach)


def _even_phase(phase: Array, one: _Repetition) -> Array:
    """Return the phase (F,) from the repetition's begin on, by which it advances evenly."""
    since = phase - phase[one.start]
    own = np.append(since[one.start : one.start + one.count], 1.0)
    even = np.arange(one.count + 1) / one.count
    return np.asarray(np.floor(since) + np.interp(since % 1.0, own, even))
