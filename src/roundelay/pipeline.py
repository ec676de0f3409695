"""The main job, one line a stage: read this first.

::

    Motion -> Poses         what the search sees of a take               motion/features.py
           -> proposals     stretches and periods that could be          timeline/proposals/
           -> evidence      barcode, circular coordinate, turns          timeline/evidence.py
           -> verdict       is it periodic, and if not why               timeline/verdict.py
           -> selection     what the take shows                          timeline/selection.py
           -> phase         from structure to time                       phase/
           -> Cycle         a closed curve of poses with its travel      cycles/
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.checks import chosen, expected
from roundelay.base.errors import NoPeriod, TooShort
from roundelay.base.progress import Progress, report
from roundelay.base.threads import one_thread
from roundelay.cycles.captured import as_captured
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.models import cycle_models
from roundelay.motion.motion import Motion
from roundelay.motion.poses import Poses
from roundelay.phase.tempo import time_phase
from roundelay.segmentation.result import Segmentation
from roundelay.timeline.assembly import timeline_of
from roundelay.timeline.behaviours import Timeline
from roundelay.timeline.evidence import Evidence
from roundelay.timeline.options import Options
from roundelay.timeline.search import Search
from roundelay.timeline.selection import find_evidence
from roundelay.timeline.verdict import no_period

__all__ = [
    "cycles_in_segments",
    "find_cycles",
    "find_periodic",
    "make_cycle",
    "understand",
    "with_periods",
]


@one_thread
def find_cycles(
    motion: Motion, options: Options | None = None, *, progress: Progress | None = None
) -> list[Cycle]:
    """Find the periodic motions of a capture and make a cycle of each.

    Parameters
    ----------
    motion : Motion
    options : Options, optional
        Automatic by default.
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Returns
    -------
    list of Cycle
        One for each motion, the one most often and most surely repeated first.

    Raises
    ------
    NoPeriod
        If no part of the capture is periodic; the error carries the evidence.
    TooShort
        If there are fewer than 8 frames.
    SkeletonMismatch
        If a joint of the options does not exist.
    ValueError
        If an option is out of range.
    Cancelled
        If `progress` returned False.
    """
    options = chosen(Options, options)
    capture = expected(Motion, motion)
    motion, model = capture.with_root_motion(), cycle_models[options.method]
    search = Search.of_take(motion, options)
    found = find_evidence(search, progress)
    cycles, refused = [], []
    for number, evidence in enumerate(found):
        report(progress, 0.5 + 0.5 * number / len(found), "fitting cycles")
        try:
            phase = _phase(search, evidence)
            cycle = model.fit(motion, phase, evidence, options)
            cycles.append(as_captured(cycle, capture, phase, evidence.runs))
        except TooShort as error:
            refused.append(NoPeriod(str(error), evidence))
    if not cycles:
        raise no_period(refused)
    report(progress, 1.0, "done")
    return cycles


@one_thread
def make_cycle(motion: Motion, evidence: Evidence, options: Options | None = None) -> Cycle:
    """Make the cycle of what `find_periodic` or `roundelay.timeline.inspection.inspect` found.

    Parameters
    ----------
    motion : Motion
    evidence : Evidence
    options : Options, optional
        Automatic by default.

    Raises
    ------
    TooShort
        If the runs hold no whole period.
    ValueError
        If an option is out of range.
    """
    options = chosen(Options, options)
    capture = expected(Motion, motion)
    motion = capture.with_root_motion()
    phase = _phase(Search.of_take(motion, options), expected(Evidence, evidence))
    cycle = cycle_models[options.method].fit(motion, phase, evidence, options)
    return as_captured(cycle, capture, phase, evidence.runs)


@one_thread
def find_periodic(
    take: Motion | Poses, options: Options | None = None, *, progress: Progress | None = None
) -> list[Evidence]:
    """Find the periodic motions of a take without making cycles; see `find_cycles`.

    Parameters
    ----------
    take : Motion or Poses
        A motion, or whatever has the attributes of `roundelay.motion.poses.Poses`: markers,
        keypoints, features. `Options.features` and `Options.weights` are for motions alone.
    options : Options, optional
        Automatic by default.
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Returns
    -------
    list of Evidence
        The one most often and most surely repeated first.
    """
    return find_evidence(Search.of_take(take, chosen(Options, options)), progress)


@one_thread
def understand(take: Motion, *, progress: Progress | None = None) -> Timeline:
    """Tell what repeats in a take, limb by limb, and how sure that is.

    Parameters
    ----------
    take : Motion
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Returns
    -------
    Timeline
        Behaviours that repeat, each with its frames, limbs, period and probability; one closed
        pass where nothing repeats; neutral poses of an exporter.

    Raises
    ------
    TooShort
        If there are fewer than 8 frames.
    Cancelled
        If `progress` returned False.
    """
    return timeline_of(expected(Motion, take), progress)


def _phase(search: Search, evidence: Evidence) -> NDArray[np.float64]:
    """Return the phase (F,) of every frame that shows a motion, in turns, growing with time."""
    if evidence.closed:
        return evidence.turns
    own = search.of(evidence.limbs) or search
    return time_phase(own.points, evidence.turns, evidence.runs, frame_time=1.0 / search.fps)


@one_thread
def with_periods(
    found: Segmentation,
    motion: Motion,
    options: Options | None = None,
    *,
    progress: Progress | None = None,
) -> Segmentation:
    """Tell of each segment whether it is periodic, and its period.

    Parameters
    ----------
    found : Segmentation
    motion : Motion
        The capture that was cut.
    options : Options, optional
        Of the search inside each segment; `roundelay.find_cycles` takes the same.
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Returns
    -------
    Segmentation
        With `Segment.period` in seconds, of the motion that fills most of the segment.

    Raises
    ------
    ValueError
        If the motion has another number of frames.
    Cancelled
        If `progress` returned False.
    """
    segments, clips = [], expected(Segmentation, found).clips(expected(Motion, motion))
    for number, (segment, clip) in enumerate(zip(found.segments, clips, strict=True)):
        report(progress, number / len(found), "looking for periods")
        segments.append(replace(segment, period=_period(clip, options)))
    return replace(found, segments=tuple(segments))


@one_thread
def cycles_in_segments(
    found: Segmentation,
    motion: Motion,
    options: Options | None = None,
    *,
    progress: Progress | None = None,
) -> list[Cycle]:
    """Make the cycles of every segment by itself, in order.

    Parameters
    ----------
    found : Segmentation
    motion : Motion
        The capture that was cut.
    options : Options, optional
        As for `roundelay.find_cycles`, which is given each segment's frames in turn.
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Returns
    -------
    list of Cycle
        At least one.

    Raises
    ------
    NoPeriod
        If no segment is periodic; the error carries the evidence of the last.
    Cancelled
        If `progress` returned False.
    """
    cycles: list[Cycle] = []
    refused = NoPeriod("no segment is long enough to repeat anything")
    for number, segment in enumerate(found.segments):
        report(progress, number / len(found), "fitting cycles")
        inside = replace(chosen(Options, options), frames=(segment.start, segment.stop))
        try:
            cycles += find_cycles(motion, inside)
        except NoPeriod as refusal:
            refused = refusal
        except TooShort:
            continue
    if not cycles:
        raise refused
    return cycles


def _period(clip: Motion, options: Options | None) -> float | None:
    steady = replace(chosen(Options, options), gestures=False)
    try:
        return find_periodic(clip, steady)[0].period * clip.frame_time
    except (NoPeriod, TooShort):
        return None
