"""Unwrapped coordinates: whole turns counted over time, and smoothed.

Coordinates are in turns; no motion is counted across the border of two spans of frames.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.spans import Span
from roundelay.phase.thresholds import TEMPO

__all__ = ["smooth_turns", "unwrap"]

Array = NDArray[np.float64]


def unwrap(phase: ArrayLike, runs: Sequence[Span]) -> Array:
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


def smooth_turns(turns: ArrayLike, runs: Sequence[Span], width: float) -> Array:
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
    reach = min(int(np.ceil(TEMPO.kernel * width)), len(values) - 1)
    offset = np.arange(-reach, reach + 1, dtype=float)
    weight = np.exp(-0.5 * (offset / width) ** 2)
    ones = np.ones(len(values))
    s0, s1, s2 = (_correlate(ones, weight * offset**k) for k in range(3))
    y0, y1 = (_correlate(values, weight * offset**k) for k in range(2))
    return (s2 * y0 - s1 * y1) / (s0 * s2 - s1 * s1)


def _correlate(values: Array, kernel: Array) -> Array:
    reach = len(kernel) // 2
    return np.convolve(values, kernel[::-1])[reach : reach + len(values)]
