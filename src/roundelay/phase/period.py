"""Periods of an unwrapped coordinate, in frames."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.errors import TooShort
from roundelay.base.numeric import ROUNDING, TINY
from roundelay.base.spans import Span

__all__ = ["line_period", "return_period", "rising"]

Array = NDArray[np.float64]


def line_period(turns: ArrayLike, runs: Sequence[Span]) -> float:
    """Return the period in frames as the inverse slope of a line ([C] 3.6, fig. 3.7).

    Slopes of several runs are averaged by length. On a structural coordinate it is
    biased for captures under two periods, as that is not uniform in time (see
    `return_period`); on a phase proportional to time (`phase_map`) it is the mean tempo.

    Raises
    ------
    TooShort
        If the coordinate does not advance.
    """
    made = frames = 0.0
    for start, stop in runs:
        time = np.arange(stop - start) - 0.5 * (stop - start - 1)
        slope = float(time @ np.asarray(turns, float)[start:stop]) / max(float(time @ time), TINY)
        made, frames = made + slope * (stop - start), frames + (stop - start)
    if made <= 0.0:
        raise TooShort("the circular coordinate does not advance with time")
    return frames / made


def return_period(turns: ArrayLike, runs: Sequence[Span]) -> float:
    """Return the median time, in frames, in which the coordinate gains one turn.

    Needs no uniformity of the coordinate, unlike `line_period`.

    Raises
    ------
    TooShort
        If no run makes a whole turn.
    """
    times = []
    for start, stop in runs:
        risen = rising(np.asarray(turns, float)[start:stop])
        frames = np.arange(stop - start, dtype=float)
        back = np.interp(risen + 1.0, risen, frames, right=np.nan)
        times.append(back - frames)
    gained = np.concatenate(times)
    gained = gained[np.isfinite(gained)]
    if len(gained) == 0:
        raise TooShort("the motion does not complete one period")
    return float(np.median(gained))


def rising(turns: Array) -> Array:
    """Return the smallest strictly rising curve above `turns`, so that it can be inverted."""
    highest = np.maximum.accumulate(turns)
    return highest + ROUNDING * np.arange(len(highest))
