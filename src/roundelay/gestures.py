"""Gestures: motions that recur with something else between, from excitation regions ([A] 4.6).

`roundelay.find_cycles` looks for poses that come back after a period. A punch thrown now and
again has none; but the coordinate of its class turns once each time. The regions in which it
does are cut out and analysed by themselves, as [A] does.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.cloud import TopologyOptions
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.fitting import fit_cycle
from roundelay.cycles.tempo import time_phase
from roundelay.errors import LiftError, NoPeriod, TooShort
from roundelay.excitation import Excitation, excitations
from roundelay.motion import Motion
from roundelay.periodicity import Evidence, measure
from roundelay.poses import point_cloud
from roundelay.timing import Run

__all__ = ["find_gestures", "gesture_runs"]

Array = NDArray[np.float64]

# A region shows the gesture if its coordinate makes at least so much of a turn.
_WHOLE = 0.75
# Shares of a turn's time: added at both ends of a region; a gap that is none.
_MARGIN, _GAP = 0.1, 0.25
# A class is another gesture if this share of its frames, at least, is in no earlier one.
_NEW = 0.5


def find_gestures(motion: Motion) -> list[Cycle]:
    """Find motions that recur, with or without something else between, as cycles.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    list of Cycle
        The most significant class first; the runs of their evidence are the recurrences.

    Raises
    ------
    NoPeriod
        If there are none, with the reasons.
    TooShort
        If there are fewer than 4 frames.
    """
    motion = motion.with_root_motion()
    points = point_cloud(motion)
    taken = np.zeros(len(motion), bool)
    found, refused = [], []
    for excited in excitations(points, motion.fps).classes:
        runs = gesture_runs(excited, len(motion))
        frames = [frame for run in runs for frame in range(*run)]
        if not frames or np.mean(taken[frames]) > 1.0 - _NEW:
            continue
        try:
            found.append(_measured(points, runs, _turn(excited), motion.fps))
        except NoPeriod as error:
            refused.append(str(error))
        else:
            taken[frames] = True
    if not found:
        raise NoPeriod("; ".join(["no gesture recurs", *refused[:3]]))
    return [_cycle(motion, points, evidence) for evidence in found]


def gesture_runs(excited: Excitation, frames: int) -> list[Run]:
    """Return the regions in which a coordinate makes a whole turn forward, with margins.

    Parameters
    ----------
    excited : Excitation
    frames : int
        Length of the capture.

    Returns
    -------
    list of (start, stop)
        Without overlap; regions with hardly a gap between are one.
    """
    turn, runs = _turn(excited), list[Run]()
    margin = round(_MARGIN * turn)
    for region in excited.regions:
        if region.net < _WHOLE:
            continue
        start, stop = max(0, region.start - margin), min(frames, region.stop + margin)
        if runs and start - runs[-1][1] < _GAP * turn:
            start = runs.pop()[0]
        runs.append((start, stop))
    return runs


def _turn(excited: Excitation) -> float:
    """Mean time of a turn in the regions that make whole ones, in frames."""
    whole = [region for region in excited.regions if region.net >= _WHOLE]
    turns = sum(region.net for region in whole)
    return sum(region.stop - region.start for region in whole) / max(turns, _WHOLE)


def _measured(points: Array, runs: list[Run], turn: float, fps: float) -> Evidence:
    step = max(1, round(fps / 60.0))
    try:
        evidence = measure(points, runs, turn, step, TopologyOptions())
    except (LiftError, TooShort) as error:
        raise NoPeriod(str(error)) from error
    objection = evidence.objection(len(points))
    if objection is not None:
        raise NoPeriod(f"frames {runs[0][0]}-{runs[-1][1]}: {objection}", evidence)
    return evidence


def _cycle(motion: Motion, points: Array, evidence: Evidence) -> Cycle:
    phase = time_phase(points, evidence.turns, evidence.runs, frame_time=motion.frame_time)
    return fit_cycle(motion, phase, evidence.runs, evidence=evidence)
