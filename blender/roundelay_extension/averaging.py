# SPDX-License-Identifier: GPL-3.0-or-later
"""Means of anything that is keyed over the repetitions of a motion, at equal phase, that close.

A repetition is a window of one period. What its ends lack to meet is spread over it, as the
library does for poses (`roundelay.cycles.closing`), and the mean is over the windows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from roundelay import TooShort
from roundelay.cycles.closing import closing_curve
from roundelay.geometry import rotations as rot

Array = NDArray[np.float64]
# Values (..., n) at frames (...).
Values = Callable[[Array], Array]

# Frames by which a phase may be off that of an even tempo and still be one.
_EVEN = 1.0
# Frames on either side by which speeds at the ends of a window are told.
_REACH = 1.0
# The share of what it changes within a repetition that a value gains by it if it runs on.
_RUNS_ON = 0.5


@dataclass(frozen=True, eq=False)
class Windows:
    """The repetitions of a motion.

    Attributes
    ----------
    phase : (W, N) ndarray
        Unwrapped, of the frames of a loop, which is that of the first window's as it plays.
    frames : (W, N) ndarray
        When each repetition shows it.
    inner : (W, N) ndarray
        In turns, from the window's begin.
    ends : (W, 2) ndarray
        Frames at which windows begin and end.
    runs : (W, 2) ndarray
        The first and last frame of the run each lies in.
    turns : (N + 1,) ndarray
        Phase as the loop plays, its last frame a turn after its first.
    """

    phase: Array = field(repr=False)
    frames: Array = field(repr=False)
    inner: Array = field(repr=False)
    ends: Array = field(repr=False)
    runs: Array = field(repr=False)
    turns: Array = field(repr=False)

    def __len__(self) -> int:
        return len(self.frames)

    @property
    def count(self) -> int:
        """Frames of a period of the loop."""
        return self.frames.shape[1]

    def only(self, window: int) -> Windows:
        """Keep one repetition."""
        one = slice(window, window + 1)
        kept = {n: getattr(self, n)[one] for n in ("phase", "frames", "inner", "ends", "runs")}
        return replace(self, **kept)

    def sampled(self, values: Values, frames: Array) -> Array:
        """Return values (W, k, n) at frames (W, k); beyond a run they go on at their speed."""
        first, last = self.runs[:, :1], self.runs[:, 1:]
        found = values(np.clip(frames, first, last))
        for end, inward in ((first, 1.0), (last, -1.0)):
            beyond = np.maximum((end - frames) * inward, 0.0)
            if beyond.max() > 0.0:
                edge = values(np.concatenate([end, end + inward], axis=1))
                found = found + (edge[:, :1] - edge[:, 1:]) * beyond[..., None]
        return found

    def lacks(self, values: Values) -> tuple[Array, Array]:
        """Return what the values and the speeds (W, n), a period, of windows' ends lack."""
        offsets = np.array([-_REACH, 0.0, _REACH])
        first = self.sampled(values, self.ends[:, :1] + offsets)
        last = self.sampled(values, self.ends[:, 1:] + offsets)
        long = np.diff(self.ends, axis=1) / (2.0 * _REACH)
        slower = (first[:, 2] - first[:, 0] - last[:, 2] + last[:, 0]) * long
        return first[:, 1] - last[:, 1], slower

    def gain(self, values: Values) -> Array:
        """Return what values (n,) gain in a period on average."""
        ends = self.sampled(values, self.ends)
        return np.asarray((ends[:, 1] - ends[:, 0]).mean(axis=0))

    def runs_on(self, values: Values) -> Array:
        """Return what values (n,) gain in a period; 0 where they come back but for some drift."""
        gain = self.gain(values)
        within = np.ptp(self.sampled(values, self.frames), axis=1).mean(axis=0)
        return np.where(np.abs(gain) > _RUNS_ON * within, gain, 0.0)

    def each(self, values: Values, gain: Array | float = 0.0, turn: float = 0.0) -> Array:
        """Return every repetition closed (W, N, n), less what is gained with the phase.

        Values that differ by whole turns, if a turn is given, are brought together.
        """
        found = self.sampled(values, self.frames)
        found = found - self.phase[..., None] * gain
        if turn:
            apart = found.mean(axis=1) - found[0].mean(axis=0)
            found -= (turn * np.round(apart / turn))[:, None]
        lack, slower = self.lacks(values)
        lack = lack + gain
        for window, inner in enumerate(self.inner):
            found[window] += closing_curve(lack[window], slower[window], inner)
        return found

    def mean(self, values: Values, gain: Array | float = 0.0, turn: float = 0.0) -> Array:
        """Return the mean repetition (N + 1, n), which goes on by the gain where it ends."""
        closed = self.each(values, gain, turn).mean(axis=0)
        return np.concatenate([closed, closed[:1]]) + self.turns[:, None] * gain

    def middle(self, values: Values) -> Array:
        """Return the median repetition (N + 1, n), of what jumps from value to value."""
        found = self.sampled(values, self.frames)
        nearest = np.sort(found, axis=0)[(len(found) - 1) // 2]
        return np.concatenate([nearest, nearest[:1]])

    def mean_turn(self, values: Values) -> Array:
        """Return the mean repetition (N + 1, 4) of rotations, the last the first again."""
        found = rot.normalize(self.sampled(values, self.frames))
        offsets = np.array([-_REACH, 0.0, _REACH])
        first = rot.normalize(self.sampled(values, self.ends[:, :1] + offsets))
        last = rot.normalize(self.sampled(values, self.ends[:, 1:] + offsets))
        lack = rot.vector_between(last[:, 1], first[:, 1])
        slower = rot.vector_between(first[:, 0], first[:, 2])
        slower -= rot.vector_between(last[:, 0], last[:, 2])
        slower *= np.diff(self.ends, axis=1) / (2.0 * _REACH)
        for window, inner in enumerate(self.inner):
            closing = closing_curve(lack[window], slower[window], inner)
            found[window] = rot.multiply(found[window], rot.from_rotation_vector(closing))
        closed = rot.mean(found)
        return rot.continuous(np.concatenate([closed, closed[:1]]))


def windows_of(
    phase: Array, frames: Array, runs: Sequence[tuple[int, int]], count: int, start: float
) -> Windows:
    """Find the whole repetitions in the runs of a motion; one that is nearly whole where none is.

    Parameters
    ----------
    phase : (V,) ndarray
        Unwrapped, in turns, of what was looked at.
    frames : (V,) ndarray
        When that was.
    runs : sequence of (start, stop)
        Of places in them.
    count : int
        Frames of a period of the loop.
    start : float
        The phase at which the loop starts.

    Raises
    ------
    TooShort
        If no run shows most of a repetition.
    """
    parts = [(_even(phase[a:b], frames[a:b]), frames[a:b]) for a, b in runs]
    whole = [part for part in parts if part[0][-1] - part[0][0] >= 1.0]
    if not whole:
        whole = [max(parts, key=lambda part: part[0][-1] - part[0][0])]
        if whole[0][0][-1] - whole[0][0][0] < _MOST:
            raise TooShort("no part shows most of a repetition")
    found = [_in_run(*part, count, start) for part in whole]
    joined = {n: np.concatenate([getattr(w, n) for w in found]) for n in _ARRAYS}
    return Windows(**joined, turns=found[0].turns)


_ARRAYS = ("phase", "frames", "inner", "ends", "runs")
# The share of a period that stands for all of it where nothing is seen twice.
_MOST = 0.9


def _even(phase: Array, frames: Array) -> Array:
    """Return phases that grow evenly if they nearly do, else rising ones."""
    slope, offset = np.polyfit(frames, phase, 1)
    line = offset + slope * frames
    if slope > 0.0 and np.abs(phase - line).max() < _EVEN * slope:
        return np.asarray(line)
    rising = np.maximum.accumulate(phase)
    return np.asarray(rising + np.arange(len(rising)) * 1e-9)


def _in_run(phase: Array, frames: Array, count: int, start: float) -> Windows:
    """Find the repetitions of one run, as many as fit in; they begin where that leaves room."""
    number = max(1, int(np.floor(phase[-1] - phase[0])))
    left = max(0.0, phase[-1] - phase[0] - number)
    begin = phase[0] + 0.5 * left
    first = start + np.ceil(begin - start - 1e-9)
    grid = first + np.arange(count) / count
    inner = (grid - begin) % 1.0
    turns = begin + inner + np.arange(number)[:, None]
    edges = begin + np.arange(number + 1)
    # Beyond the frames of a closed period, time goes on as it did.
    step = (frames[-1] - frames[0]) / (phase[-1] - phase[0])
    at = np.interp(turns, phase, frames) + np.maximum(turns - phase[-1], 0.0) * step
    cuts = np.interp(edges, phase, frames) + np.maximum(edges - phase[-1], 0.0) * step
    return Windows(
        phase=turns,
        frames=at,
        inner=np.tile(inner, (number, 1)),
        ends=np.stack([cuts[:-1], cuts[1:]], axis=1),
        runs=np.tile([frames[0], frames[-1]], (number, 1)),
        turns=np.append(grid, first + 1.0),
    )
