"""From structure to time: unwrapped coordinate, period, and phase proportional to time.

A circular coordinate tells where on the loop a pose lies, not when: it runs fast where the
distance between poses is large. The way back is not the density of the coordinate
([C] eq. 3.20, 3.21), which over-represents what an incomplete period repeats, but its speed:
the mean time one traversal takes for each piece of the circle.

Coordinates are in turns; a *run* is a half-open range of consecutive frames, and no motion is
counted across the border of two runs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.errors import TooShort
from roundelay.mixture import fit_circular_mixture

__all__ = [
    "PhaseMap",
    "Run",
    "line_period",
    "mixture_remap",
    "phase_map",
    "rank_remap",
    "return_period",
    "smooth_turns",
    "unwrap",
]

Array = NDArray[np.float64]
Run = tuple[int, int]

# The share of the circle that must be passed for its timing to be known.
_COVERED = 0.95


def unwrap(phase: ArrayLike, runs: Sequence[Run]) -> Array:
    """Count whole turns of a circular coordinate over time ([C] fig. 3.8).

    Parameters
    ----------
    phase : (n,) array_like
        In turns; only its value mod 1 matters.
    runs : sequence of (start, stop)
        Ranges of consecutive frames; each begins in [0, 1).

    Returns
    -------
    (n,) ndarray
        Turns; entries outside all runs are NaN.
    """
    theta = np.asarray(phase, float)
    turns = np.full(theta.shape, np.nan)
    for start, stop in runs:
        steps = np.diff(theta[start:stop], prepend=theta[start])
        turns[start:stop] = theta[start] % 1.0 + np.cumsum(steps - np.round(steps))
    return turns


def line_period(turns: ArrayLike, runs: Sequence[Run]) -> float:
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
        slope = float(time @ np.asarray(turns, float)[start:stop]) / max(float(time @ time), 1e-12)
        made, frames = made + slope * (stop - start), frames + (stop - start)
    if made <= 0.0:
        raise TooShort("the circular coordinate does not advance with time")
    return frames / made


def return_period(turns: ArrayLike, runs: Sequence[Run]) -> float:
    """Return the median time, in frames, in which the coordinate gains one turn.

    Needs no uniformity of the coordinate, unlike `line_period`.

    Raises
    ------
    TooShort
        If no run makes a whole turn.
    """
    times = []
    for start, stop in runs:
        rising = _rising(np.asarray(turns, float)[start:stop])
        frames = np.arange(stop - start, dtype=float)
        back = np.interp(rising + 1.0, rising, frames, right=np.nan)
        times.append(back - frames)
    gained = np.concatenate(times)
    gained = gained[np.isfinite(gained)]
    if len(gained) == 0:
        raise TooShort("the motion does not complete one period")
    return float(np.median(gained))


def _rising(turns: Array) -> Array:
    """Return the smallest strictly rising curve above `turns`, so that it can be inverted."""
    highest = np.maximum.accumulate(turns)
    return highest + 1e-9 * np.arange(len(highest))


@dataclass(frozen=True)
class PhaseMap:
    """Map the circle to itself so that phase becomes proportional to time.

    Parameters
    ----------
    phase : (m + 1,) ndarray
        Time phase at m equal steps of the coordinate: rising, from 0 to 1.
    period : float
        Frames of one traversal.
    """

    phase: Array
    period: float

    def __call__(self, turns: ArrayLike) -> Array:
        """Map unwrapped coordinates (n,) to unwrapped time phases, both in turns."""
        x = np.asarray(turns, float)
        whole = np.floor(x)
        grid = np.linspace(0.0, 1.0, len(self.phase))
        return np.asarray(whole + np.interp(x - whole, grid, self.phase))


def phase_map(turns: ArrayLike, runs: Sequence[Run], *, cells: int = 128) -> PhaseMap:
    """Estimate time from structure by the speed of traversal.

    The circle is cut into equal cells; each passage of a run through a cell takes some time;
    the mean over passages, summed around the circle, is time as a function of the coordinate,
    whatever part of the circle is passed more often. (The open problem of [C] 3.5 and ch. 7.)

    Parameters
    ----------
    turns : (n,) array_like
        Unwrapped coordinate, one a frame, advancing with time.
    runs : sequence of (start, stop)
    cells : int
        Number of cells.

    Raises
    ------
    TooShort
        If less than 95 % of the circle is passed; cells that are not get the mean time.
    """
    total, passages = np.zeros(cells), np.zeros(cells)
    for start, stop in runs:
        rising = _rising(np.asarray(turns, float)[start:stop])
        first, last = np.ceil(rising[0] * cells), np.floor(rising[-1] * cells)
        edges = np.arange(first, last + 1)
        times = np.interp(edges / cells, rising, np.arange(stop - start, dtype=float))
        cell = edges[:-1].astype(int) % cells
        np.add.at(total, cell, np.diff(times))
        np.add.at(passages, cell, 1.0)
    seen = passages > 0.0
    if np.mean(seen) < _COVERED:
        raise TooShort(f"the motion covers only {np.mean(seen):.0%} of one period")
    dwell = np.full(cells, float(np.mean(total[seen] / passages[seen])))
    dwell[seen] = total[seen] / passages[seen]
    phase = np.concatenate([[0.0], np.cumsum(dwell)])
    return PhaseMap(phase / phase[-1], float(phase[-1]))


def smooth_turns(turns: ArrayLike, runs: Sequence[Run], width: float) -> Array:
    """Smooth an advancing coordinate over time, keeping a steady advance exactly.

    A local line is fitted around each frame with Gaussian weights, so that ends are not
    biased; an infinite width gives one line a run.

    Parameters
    ----------
    turns : (n,) array_like
    runs : sequence of (start, stop)
    width : float
        Standard deviation of the weights, in frames.
    """
    values = np.asarray(turns, float)
    result = values.copy()
    for start, stop in runs:
        result[start:stop] = _local_lines(values[start:stop], width)
    return result


def _local_lines(values: Array, width: float) -> Array:
    time = np.arange(len(values), dtype=float)
    if not np.isfinite(width):
        return np.asarray(np.polyval(np.polyfit(time, values, 1), time))
    reach = min(int(np.ceil(4.0 * width)), len(values) - 1)
    offset = np.arange(-reach, reach + 1, dtype=float)
    weight = np.exp(-0.5 * (offset / width) ** 2)
    ones = np.ones(len(values))
    s0, s1, s2 = (_correlate(ones, weight * offset**k) for k in range(3))
    y0, y1 = (_correlate(values, weight * offset**k) for k in range(2))
    return (s2 * y0 - s1 * y1) / (s0 * s2 - s1 * s1)


def _correlate(values: Array, kernel: Array) -> Array:
    reach = len(kernel) // 2
    return np.convolve(values, kernel[::-1])[reach : reach + len(values)]


def rank_remap(phase: ArrayLike) -> Array:
    """Spread phases (n,) evenly over [0, 1) by their ranks ([C] eq. 3.20)."""
    theta = np.asarray(phase, float) % 1.0
    ranks = np.empty(len(theta))
    ranks[np.argsort(theta, kind="stable")] = np.arange(len(theta))
    return ranks / len(theta)


def mixture_remap(phase: ArrayLike) -> Array:
    """Spread phases (n,) by the distribution of a Gaussian mixture ([C] eq. 3.21).

    The mixture is that of `roundelay.mixture.fit_circular_mixture` ([A] 4.4).
    """
    theta = np.asarray(phase, float) % 1.0
    return fit_circular_mixture(theta).distribution(theta)
