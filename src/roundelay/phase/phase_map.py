"""From structure to time: phase proportional to time.

A circular coordinate tells where on the loop a pose lies, not when: it runs fast where the
distance between poses is large. The way back is not the density of the coordinate
([C] eq. 3.20, 3.21), which over-represents what an incomplete period repeats, but its speed:
the mean time one traversal takes for each piece of the circle.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.brief import brief
from roundelay.base.errors import TooShort
from roundelay.base.spans import Span
from roundelay.phase.mixture import fit_circular_mixture
from roundelay.phase.period import rising
from roundelay.phase.thresholds import PHASE_MAP

__all__ = ["PhaseMap", "mixture_remap", "phase_map", "rank_remap"]

Array = NDArray[np.float64]


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

    __repr__ = brief

    def __call__(self, turns: ArrayLike) -> Array:
        """Map unwrapped coordinates (n,) to unwrapped time phases, both in turns."""
        x = np.asarray(turns, float)
        whole = np.floor(x)
        grid = np.linspace(0.0, 1.0, len(self.phase))
        return np.asarray(whole + np.interp(x - whole, grid, self.phase))


def phase_map(turns: ArrayLike, runs: Sequence[Span]) -> PhaseMap:
    """Estimate time from structure by the speed of traversal.

    The circle is cut into equal cells; each passage of a run through a cell takes some time;
    the mean over passages, summed around the circle, is time as a function of the coordinate,
    whatever part of the circle is passed more often. (The open problem of [C] 3.5 and ch. 7.)

    Parameters
    ----------
    turns : (n,) array_like
        Unwrapped coordinate, one a frame, advancing with time.
    runs : sequence of (start, stop)

    Raises
    ------
    TooShort
        If less than 95 % of the circle is passed; cells that are not get the mean time.
    """
    cells = PHASE_MAP.cells
    total, passages = np.zeros(cells), np.zeros(cells)
    for start, stop in runs:
        risen = rising(np.asarray(turns, float)[start:stop])
        first, last = np.ceil(risen[0] * cells), np.floor(risen[-1] * cells)
        edges = np.arange(first, last + 1)
        times = np.interp(edges / cells, risen, np.arange(stop - start, dtype=float))
        cell = edges[:-1].astype(int) % cells
        np.add.at(total, cell, np.diff(times))
        np.add.at(passages, cell, 1.0)
    seen = passages > 0.0
    if np.mean(seen) < PHASE_MAP.covered:
        raise TooShort(f"the motion covers only {np.mean(seen):.0%} of one period")
    dwell = np.full(cells, float(np.mean(total[seen] / passages[seen])))
    dwell[seen] = total[seen] / passages[seen]
    phase = np.concatenate([[0.0], np.cumsum(dwell)])
    return PhaseMap(phase / phase[-1], float(phase[-1]))


def rank_remap(phase: ArrayLike) -> Array:
    """Spread phases (n,) evenly over [0, 1) by their ranks ([C] eq. 3.20)."""
    theta = np.asarray(phase, float) % 1.0
    ranks = np.empty(len(theta))
    ranks[np.argsort(theta, kind="stable")] = np.arange(len(theta))
    return ranks / len(theta)


def mixture_remap(phase: ArrayLike) -> Array:
    """Spread phases (n,) by the distribution of a Gaussian mixture ([C] eq. 3.21).

    The mixture is that of `roundelay.phase.mixture.fit_circular_mixture` ([A] 4.4).
    """
    theta = np.asarray(phase, float) % 1.0
    return fit_circular_mixture(theta).distribution(theta)
