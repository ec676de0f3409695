"""Gestures: motions that recur with something else between, from excitation regions ([A] 4.6).

A punch thrown now and again has no period at which its poses come back; but the coordinate of
its class turns once each time. The regions in which it does are cut out and analysed by
themselves, as [A] does.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.cloud import TopologyOptions
from roundelay.errors import LiftError, NoPeriod
from roundelay.excitation import Excitation, excitations
from roundelay.parts import judged
from roundelay.periodicity import Evidence
from roundelay.timing import Run

__all__ = ["find_gestures", "gesture_runs"]

Array = NDArray[np.float64]

# A region shows the gesture if its coordinate makes at least so much of a turn.
_WHOLE = 0.75
# Shares of a turn's time: added at both ends of a region; a gap that is none.
_MARGIN, _GAP = 0.1, 0.25
# A class is another gesture if this share of its frames, at least, is in no earlier one.
_NEW = 0.5
# Frames a second looked at.
_RATE = 60.0


def find_gestures(
    points: Array, fps: float, span: Run, options: TopologyOptions, *, fewest: int = 1
) -> list[Evidence]:
    """Find motions that recur, with or without something else between.

    Parameters
    ----------
    points : (F, d) ndarray
        One pose a frame, as from `roundelay.poses.point_cloud`.
    fps : float
        Frames a second.
    span : (start, stop)
        The frames to look at.
    options : TopologyOptions
        For the frames of each gesture by themselves.
    fewest : int
        Leave out gestures shown in fewer stretches.

    Returns
    -------
    list of Evidence
        The most significant class first; the runs are the recurrences.

    Raises
    ------
    NoPeriod
        If there are none, with the reasons.
    TooShort
        If there are fewer than 4 frames.
    """
    step = max(1, round(fps / _RATE))
    taken = np.zeros(len(points), bool)
    found, refused = [], []
    try:
        classes = excitations(points[slice(*span)], fps, prime=options.prime).classes
    except LiftError as error:
        raise NoPeriod(f"no gesture recurs; {error}") from error
    for excited in classes:
        runs = gesture_runs(excited, span)
        frames = [frame for run in runs for frame in range(*run)]
        if len(runs) < fewest or np.mean(taken[frames]) > 1.0 - _NEW:
            continue
        try:
            found.append(judged(points, runs, _turn(excited), step, options, span[1] - span[0]))
        except NoPeriod as error:
            refused.append(str(error))
        else:
            taken[frames] = True
    if not found:
        raise NoPeriod("; ".join(["no gesture recurs", *refused[:3]]))
    return found


def gesture_runs(excited: Excitation, span: Run) -> list[Run]:
    """Return the regions in which a coordinate makes a whole turn forward, with margins.

    Parameters
    ----------
    excited : Excitation
        Of the frames of `span`.
    span : (start, stop)

    Returns
    -------
    list of (start, stop)
        Frames of the capture, without overlap; regions with hardly a gap between are one.
    """
    (first, last), turn, runs = span, _turn(excited), list[Run]()
    margin = round(_MARGIN * turn)
    for region in excited.regions:
        if region.net < _WHOLE:
            continue
        start = max(first, first + region.start - margin)
        stop = min(last, first + region.stop + margin)
        if runs and start - runs[-1][1] < _GAP * turn:
            start = runs.pop()[0]
        runs.append((start, stop))
    return runs


def _turn(excited: Excitation) -> float:
    """Mean time of a turn in the regions that make whole ones, in frames."""
    whole = [region for region in excited.regions if region.net >= _WHOLE]
    turns = sum(region.net for region in whole)
    return sum(region.stop - region.start for region in whole) / max(turns, _WHOLE)
