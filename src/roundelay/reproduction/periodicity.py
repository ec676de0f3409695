"""Periodic or a mere loop, by the coordinate alone: the first test, before there was a verdict."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from roundelay.topology.distances import Runs
from roundelay.topology.kernel.reduction import F64
from roundelay.topology.significance import turns

__all__ = ["Periodicity", "periodicity"]

# These bring false positives on noise from 35-82 % to 0-2 %: measured on an Ornstein-Uhlenbeck
# process. The jitter of dense samples must not count.
FEWEST_TURNS = 1.5
LEAST_FORWARD = 0.8
STEPS_A_TURN = 12


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
    if abs(net) >= FEWEST_TURNS:
        frames = sum(stop - start for start, stop in runs)
        total = _coarse_variation(phase, runs, max(1, int(frames / (STEPS_A_TURN * abs(net)))))
    forward = abs(net) >= LEAST_FORWARD * total
    return Periodicity(net, total, bool(forward and abs(net) >= FEWEST_TURNS))


def _coarse_variation(phase: F64, runs: Runs, lag: int) -> float:
    """Sum of turns to and fro between every lag-th frame, following each frame in between."""
    total = 0.0
    for start, stop in runs:
        unwrapped = np.unwrap(phase[start:stop], period=1.0)
        total += float(abs(np.diff(np.append(unwrapped[:-1:lag], unwrapped[-1:]))).sum())
    return total
