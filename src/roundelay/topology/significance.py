"""Which bars are more than noise, and which loops are periodic in time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from roundelay.topology.distances import Runs
from roundelay.topology.kernel.reduction import F64
from roundelay.topology.rips import Barcode
from roundelay.topology.thresholds import SIGNIFICANCE

__all__ = ["Periodicity", "count_classes", "p_values", "periodicity", "turns", "two_bar_ratio"]


@dataclass(frozen=True)
class Periodicity:
    """How a coordinate moves along time.

    Attributes
    ----------
    net : float
        Turns forward minus backward, in cycles; the sign tells the direction.
    total : float
        Turns forward plus backward, in cycles, in steps of a twelfth of a turn's mean time, so
        that the jitter of a densely sampled motion does not count.
    is_periodic : bool
        At least 1.5 net turns, and at least .8 of the motion forward: a loop that is run
        through again and again, not a shape that noise happened to close.
    """

    net: float
    total: float
    is_periodic: bool


def p_values(barcode: Barcode) -> F64:
    """Test each bar against the universal law of noise, corrected for the number of bars.

    Bobrowski and Skraba 2023 (Sci. Rep. 13:12274): with l = log log(death / birth) minus its
    mean over all bars and Euler's constant, noise has p = exp(-exp(l)); times the number of bars
    (Bonferroni). A small value says "there is a loop", not "it is periodic": see `periodicity`.

    Parameters
    ----------
    barcode : Barcode
        All bars, not only the longest.

    Returns
    -------
    (B,) array
        Values in [0, 1]; 0 for a class born at scale 0 or alive at the end.

    Raises
    ------
    ValueError
        If the barcode holds only the longest bars.
    """
    if not barcode.is_complete:
        raise ValueError("expected a barcode of all bars, found one of the longest only")
    if not len(barcode):
        return np.zeros(0)
    with np.errstate(divide="ignore", over="ignore"):
        scores = np.log(np.log(barcode.deaths / barcode.births))
        finite = scores[np.isfinite(scores)]
        centre = finite.mean() if len(finite) else 0.0
        single = np.exp(-np.exp(scores - np.euler_gamma - centre))
    return np.asarray(np.minimum(single * len(barcode), 1.0), np.float64)


def count_classes(barcode: Barcode, *, level: float | None = None) -> int:
    """Count the longest bars that are significant: the number of classes to look at.

    [A] 4.2 leaves this number to the eye.

    Parameters
    ----------
    barcode : Barcode
        All bars.
    level : float, optional
        Largest corrected p-value of a significant bar; .05 by default.

    Returns
    -------
    int
        How many bars, longest first, before the first that is not significant.
    """
    passed = p_values(barcode) <= (SIGNIFICANCE.level if level is None else level)
    return int(np.logical_and.accumulate(passed).sum())


def two_bar_ratio(barcode: Barcode) -> float:
    """Length of the longest bar over that of the second; inf without a second, 0 without any.

    Near 1 the two may swap under small changes, and the coordinate with them.
    """
    lengths = barcode.persistence
    if len(lengths) < 2 or np.isinf(lengths[0]):
        return float("inf") if len(lengths) else 0.0
    return float(lengths[0] / lengths[1])


def turns(phase: F64, runs: Runs) -> tuple[float, float]:
    """Count turns along time, taking the short way between consecutive frames.

    Parameters
    ----------
    phase : (n,) array
        In cycles.
    runs : sequence of (start, stop)
        Runs of consecutive frames; nothing is counted between two.

    Returns
    -------
    net, total : float
        Turns forward minus backward, in cycles (the sign tells the direction), and their sum.
    """
    steps = [np.diff(phase[start:stop]) for start, stop in runs]
    moved = np.concatenate([np.zeros(0), *steps])
    moved -= np.round(moved)
    return float(moved.sum()), float(abs(moved).sum())


def periodicity(phase: F64, runs: Runs) -> Periodicity:
    """Tell a periodic motion from a mere loop by the way it is run through.

    Parameters
    ----------
    phase : (n,) array
        A circular coordinate in time order, in cycles.
    runs : sequence of (start, stop)
        Runs of consecutive frames.

    Returns
    -------
    Periodicity
        Net and total turns and the verdict.
    """
    net, total = turns(phase, runs)
    if abs(net) >= SIGNIFICANCE.turns:
        frames = sum(stop - start for start, stop in runs)
        lag = max(1, int(frames / (SIGNIFICANCE.steps * abs(net))))
        total = _coarse_variation(phase, runs, lag)
    forward = abs(net) >= SIGNIFICANCE.forward * total
    return Periodicity(net, total, bool(forward and abs(net) >= SIGNIFICANCE.turns))


def _coarse_variation(phase: F64, runs: Runs, lag: int) -> float:
    """Sum of turns to and fro between every lag-th frame, following each frame in between."""
    total = 0.0
    for start, stop in runs:
        unwrapped = np.unwrap(phase[start:stop], period=1.0)
        total += float(abs(np.diff(np.append(unwrapped[:-1:lag], unwrapped[-1:]))).sum())
    return total
