"""How alike the poses are that lie a lag apart: the plain autocorrelation, as a named test.

It needs no phase and no template, so that it is a second witness of the period.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import ROUNDING
from roundelay.timeline.thresholds import JUDGEMENT, TEMPO

__all__ = ["autocorrelation", "best_lag", "margins"]

Array = NDArray[np.float64]
Runs = Sequence[tuple[float, float]]


def _parts(values: Array, runs: Runs, lag: float) -> list[Array]:
    """Return the runs, each centred; one after the other if they are too short for the lag."""
    found = []
    for start, stop in runs:
        part = values[max(0, int(start)) : min(len(values), int(np.ceil(stop)))]
        found.append(part - part.mean(axis=0) if len(part) else part)
    if sum(max(0.0, len(part) - lag) for part in found) < JUDGEMENT.apart * lag:
        return [np.concatenate(found)] if found else []
    return found


def _shifted(part: Array, lag: float) -> Array:
    """Return values (n - lag, d) a fractional lag later."""
    whole = int(lag)
    between = lag - whole
    if between < ROUNDING:
        return part[whole:]
    return part[whole:-1] * (1.0 - between) + part[whole + 1 :] * between


def autocorrelation(parts: Sequence[Array], lag: float, reach: float | None = None) -> float:
    """Return the correlation of poses a lag apart, in [-1, 1]; -1 where nothing is so long.

    Parameters
    ----------
    parts : sequence of (n, d) ndarray
        Centred.
    lag : float
        In samples.
    reach : float, optional
        Only samples that are seen so much later count; by default the lag.
    """
    inner = first = second = 0.0
    for part in parts:
        count = len(part) - int(np.ceil(lag if reach is None else max(reach, lag)))
        if count < 3:
            continue
        later, now = _shifted(part, lag)[:count], part[:count]
        inner += float(np.sum(now * later))
        first += float(np.sum(now * now))
        second += float(np.sum(later * later))
    scale = np.sqrt(first * second)
    return inner / float(scale) if scale > 0.0 else -1.0


def margins(values: Array, runs: Runs, lag: float) -> tuple[float, float, float]:
    """Return how well poses come back after a lag, and by how much better than at others.

    Returns
    -------
    once : float
        Correlation after the lag.
    above_half : float
        What it is more than after half the lag.
    above_twice : float
        What it is more than after twice the lag, where that is seen; else 1.
    """
    around, parts = 1.0 + JUDGEMENT.around * np.array([-1.0, 0.0, 1.0]), _parts(values, runs, lag)
    once = autocorrelation(parts, lag)
    half = max(autocorrelation(parts, 0.5 * lag * f) for f in around)
    twice = max(autocorrelation(parts, 2.0 * lag * f) for f in around)
    if twice == -1.0:
        return once, once - half, 1.0
    again = autocorrelation(parts, lag, 2.0 * lag)
    return once, once - half, again - twice


def best_lag(values: Array, runs: Runs, lag: float) -> tuple[float, float]:
    """Return the lag near an estimate at which poses agree best, and their correlation."""
    tried = lag * (1.0 + TEMPO.near * np.linspace(-1.0, 1.0, TEMPO.tried))
    parts = _parts(values, runs, lag)
    found = [autocorrelation(parts, one) for one in tried]
    best = int(np.argmax(found))
    return float(tried[best]), found[best]
