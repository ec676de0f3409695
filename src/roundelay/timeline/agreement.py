"""How alike the poses are that lie a lag apart: the plain autocorrelation, as a named test.

It needs no phase and no template, so that it is a second witness of the period.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import ROUNDING
from roundelay.timeline.thresholds import JUDGEMENT, TEMPO

__all__ = ["best_lag", "margins"]

Array = NDArray[np.float64]


class _Part:
    """Consecutive poses (n, d), centred, with what their correlations share."""

    def __init__(self, poses: Array) -> None:
        centred = poses - poses.mean(axis=0) if len(poses) else poses
        self._count, self._width = centred.shape
        self._flat = centred.ravel()
        self._squares = np.einsum("ij,ij->i", centred, centred)
        self._next = np.einsum("ij,ij->i", centred[:-1], centred[1:])
        self._known: dict[tuple[int, int], float] = {}

    def __len__(self) -> int:
        return self._count

    def products(self, lag: float, count: int) -> tuple[float, float, float]:
        """Return the sums of now times later, now squared and later squared, of so many poses.

        Later is between two poses: of a straight line, its square is that of both ends and of
        their product.
        """
        whole = int(lag)
        after = lag - whole if lag - whole >= ROUNDING else 0.0
        before, now = 1.0 - after, float(self._squares[:count].sum())
        inner = before * self._inner(whole, count)
        later = before**2 * float(self._squares[whole : whole + count].sum())
        if after:
            inner += after * self._inner(whole + 1, count)
            later += after**2 * float(self._squares[whole + 1 : whole + 1 + count].sum())
            later += 2.0 * before * after * float(self._next[whole : whole + count].sum())
        return inner, now, later

    def _inner(self, lag: int, count: int) -> float:
        if (lag, count) not in self._known:
            now, later = (slice(at * self._width, (at + count) * self._width) for at in (0, lag))
            self._known[lag, count] = float(self._flat[now] @ self._flat[later])
        return self._known[lag, count]


def _parts(runs: Sequence[Array], lag: float) -> list[_Part]:
    """Return the poses of runs; one after the other if they are too short for the lag."""
    found = [_Part(run) for run in runs]
    if sum(max(0.0, len(part) - lag) for part in found) < JUDGEMENT.apart * lag:
        centred = [run - run.mean(axis=0) if len(run) else run for run in runs]
        return [_Part(np.concatenate(centred))] if runs else []
    return found


def _autocorrelation(parts: Sequence[_Part], lag: float, reach: float = 0.0) -> float:
    """Return the correlation of poses a lag apart, in [-1, 1]; -1 where nothing is so long.

    Only poses that are seen for a longer reach, if there is one, count.
    """
    inner = first = second = 0.0
    for part in parts:
        count = len(part) - int(np.ceil(max(reach, lag)))
        if count >= 3:
            products = part.products(lag, count)
            inner, first, second = inner + products[0], first + products[1], second + products[2]
    scale = np.sqrt(first * second)
    return float(inner / scale) if scale > 0.0 else -1.0


def margins(runs: Sequence[Array], lag: float) -> tuple[float, float, float]:
    """Return how well poses come back after a lag, and by how much better than at others.

    Parameters
    ----------
    runs : sequence of (n, d) ndarray
        Poses of each run.
    lag : float
        In samples.

    Returns
    -------
    once : float
        Correlation after the lag.
    above_half : float
        What it is more than after half the lag.
    above_twice : float
        What it is more than after twice the lag, where that is seen; else 1.
    """
    around, parts = 1.0 + JUDGEMENT.around * np.array([-1.0, 0.0, 1.0]), _parts(runs, lag)
    once = _autocorrelation(parts, lag)
    half = max(_autocorrelation(parts, 0.5 * lag * f) for f in around)
    twice = max(_autocorrelation(parts, 2.0 * lag * f) for f in around)
    if twice == -1.0:
        return once, once - half, 1.0
    again = _autocorrelation(parts, lag, 2.0 * lag)
    return once, once - half, again - twice


def best_lag(runs: Sequence[Array], lag: float) -> tuple[float, float]:
    """Return the lag near an estimate at which poses agree best, and their correlation."""
    tried = lag * (1.0 + TEMPO.near * np.linspace(-1.0, 1.0, TEMPO.tried))
    parts = _parts(runs, lag)
    found = [_autocorrelation(parts, one) for one in tried]
    best = int(np.argmax(found))
    return float(tried[best]), found[best]
