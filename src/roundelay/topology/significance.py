"""Which bars are more than noise, and how a coordinate turns along time."""

from __future__ import annotations

import numpy as np

from roundelay.base.checks import as_numbers, expected
from roundelay.topology.distances import Runs
from roundelay.topology.kernel.reduction import F64
from roundelay.topology.rips import Barcode
from roundelay.topology.thresholds import SIGNIFICANCE

__all__ = ["count_classes", "p_values", "turns", "two_bar_ratio"]


def p_values(barcode: Barcode) -> F64:
    """Test each bar against the universal law of noise, corrected for the number of bars.

    Bobrowski and Skraba 2023 (Sci. Rep. 13:12274): with l = log log(death / birth) minus its
    mean over all bars and Euler's constant, noise has p = exp(-exp(l)); times the number of bars
    (Bonferroni). A small value says "there is a loop", not "it is periodic": that shows in the
    turns of its coordinate along time, see `turns`.

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
    if not expected(Barcode, barcode).is_complete:
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
    lengths = expected(Barcode, barcode).persistence
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
    values = np.asarray(as_numbers(phase, "a phase (n,)"), np.float64)
    bounds = np.asarray(as_numbers(runs, "runs (start, stop)"))
    if values.ndim != 1 or (bounds.size and (bounds.ndim != 2 or bounds.shape[1] != 2)):
        found = f"{values.shape} and {bounds.shape}"
        raise ValueError(f"expected a phase (n,) and runs (start, stop), found {found}")
    steps = [np.diff(values[start:stop]) for start, stop in runs]
    moved = np.concatenate([np.zeros(0), *steps])
    moved -= np.round(moved)
    return float(moved.sum()), float(abs(moved).sum())
