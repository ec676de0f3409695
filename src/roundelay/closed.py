"""Captures that are one period already: closed loops, as people cut them by hand."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.cloud import TopologyOptions, make_cloud
from roundelay.errors import NoPeriod
from roundelay.periodicity import Evidence, class_coordinate
from roundelay.timing import Run

__all__ = ["closed_capture"]

Array = NDArray[np.float64]

# The loop must be this much wider than the gap between its ends.
_WIDER = 8.0
# Steps between the ends that are closed where frames were chosen by hand.
_CHOSEN_STEPS = 4.0
# A closed period is one loop: its bar is so much longer than the next.
_PROMINENT = 1.5


def closed_capture(
    points: Array, run: Run, step: int, options: TopologyOptions, *, chosen: bool
) -> Evidence:
    """Take frames for one closed period if their ends meet.

    They meet if the last pose comes as near to the first as neighbouring poses are. Nothing
    comes back in one period, so time itself is its phase.

    Parameters
    ----------
    points : (F, d) ndarray
        One pose a frame.
    run : (start, stop)
        The frames to look at.
    step : int
        Take every step-th frame only, for the barcode.
    options : TopologyOptions
    chosen : bool
        The frames were chosen by hand: their ends may lie a few steps apart.

    Returns
    -------
    Evidence
        With `closed` set, and one repetition.

    Raises
    ------
    NoPeriod
        If the ends do not meet, with how far they are apart, or the poses form no loop.
    """
    poses = points[slice(*run)]
    steps = np.linalg.norm(np.diff(poses, axis=0), axis=1)
    gap = float(np.linalg.norm(poses[-1] - poses[0]))
    usual = max(1.5 * float(np.median(steps)), float(np.percentile(steps, 95)))
    if gap > usual * (_CHOSEN_STEPS if chosen else 1.0):
        apart = f"{gap / usual:.1f} steps" if usual > 0.0 else "far"
        raise NoPeriod(f"its last pose is {apart} from its first: no closed period")
    width = float(np.linalg.norm(poses - poses[0], axis=1).max())
    if width < _WIDER * gap:
        wide = f"{width / gap:.1f} times as wide as the gap between its ends"
        raise NoPeriod(f"its loop is {wide}, not {_WIDER:g}")
    cloud = make_cloud(points, [run], float(len(poses)), step, options)
    coordinate = class_coordinate(cloud, options.class_index or 0, options.scale)
    # The way from the last frame to the first takes its share of a frame: none if it repeats it.
    period = len(poses) - 1 + min(1.0, gap / max(0.5 * float(steps[0] + steps[-1]), 1e-12))
    turns = np.full(len(points), np.nan)
    turns[slice(*run)] = np.arange(len(poses)) / period
    evidence = Evidence(
        (run,), turns, period, cloud.barcode, coordinate, 1.0, 1.0, cloud=cloud, closed=True
    )
    if evidence.prominence < _PROMINENT and not chosen:
        raise NoPeriod(
            f"its ends meet, but its longest bar is {evidence.prominence:.2f} times the next, "
            f"not {_PROMINENT:g}",
            evidence,
        )
    return evidence
