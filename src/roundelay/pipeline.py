"""The main job, one line a stage: read this first.

::

    Motion -> Body          what the search sees of a take, by limbs     timeline/limbs.py
           -> proposals     stretches and periods that could be          timeline/proposals/
           -> Timeline      what repeats, and how sure that is           timeline/assembly.py
           -> Evidence      barcode, circular coordinate, turns          timeline/finding.py
           -> phase         from structure to time                       phase/
           -> Cycle         a closed curve of poses with its travel      cycles/
           -> Loop          repaired, sampled, measured, judged          loops/recipe.py
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.checks import chosen, expected
from roundelay.base.errors import NoPeriod, TooShort
from roundelay.base.progress import Progress, report
from roundelay.base.threads import one_thread
from roundelay.cycles.captured import as_captured
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.events import begun
from roundelay.cycles.models import cycle_models
from roundelay.loops.options import LoopOptions
from roundelay.loops.recipe import Loop, made_loop, numbered
from roundelay.motion.budget import require_budget
from roundelay.motion.floating import as_motion
from roundelay.motion.motion import Motion
from roundelay.motion.points import Points
from roundelay.motion.poses import Poses
from roundelay.phase.tempo import time_phase
from roundelay.segmentation.cutting import segment as cut_by_posture
from roundelay.segmentation.result import Segment, Segmentation
from roundelay.timeline.assembly import timeline_of
from roundelay.timeline.behaviours import Behaviour, Timeline
from roundelay.timeline.evidence import Evidence
from roundelay.timeline.finding import find_evidence
from roundelay.timeline.options import Options
from roundelay.timeline.search import Search
from roundelay.timeline.thresholds import SEARCH

__all__ = [
    "cycles_in_segments",
    "find_cycles",
    "find_periodic",
    "make_cycle",
    "make_loops",
    "segment",
    "understand",
]


@one_thread
def find_cycles(
    motion: Motion | Points,
    options: Options | None = None,
    *,
    timeline: Timeline | None = None,
    progress: Progress | None = None,
) -> list[Cycle]:
    """Find the periodic motions of a capture and make a cycle of each.

    Parameters
    ----------
    motion : Motion or Points
    options : Options, optional
        Automatic by default.
    timeline : Timeline, optional
        The capture's, by `understand`, where it is known already.
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Returns
    -------
    list of Cycle
        One for each motion, the one most often and most surely repeated first. Each begins at the
        left foot's contact, or at its largest event where no foot steps.

    Raises
    ------
    NoPeriod
        If no part of the capture is periodic; the error carries the evidence.
    TooShort
        If there are fewer than 8 frames.
    TooLarge
        If less memory is free than the search would take.
    SkeletonMismatch
        If a joint of the options does not exist.
    ValueError
        If an option is out of range, or the timeline is another capture's.
    Cancelled
        If `progress` returned False.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> cycle = rl.find_cycles(walk)[0]
    >>> round(cycle.period, 2), round(cycle.evidence.repetitions)
    (1.1, 6)
    """
    options = chosen(Options, options)
    capture = as_motion(motion)
    require_budget(capture, options.span(len(capture)))
    motion = capture.with_root_motion()
    search, found = find_evidence(capture, options, progress, timeline)
    cycles, refused = [], []
    for number, evidence in enumerate(found):
        report(progress, 0.5 + 0.5 * number / len(found), "fitting cycles")
        try:
            cycles.append(_fitted(capture, motion, _phase(search, evidence), evidence, options))
        except TooShort as error:
            refused.append(NoPeriod(str(error), evidence))
    if not cycles:
        raise refused[0]
    report(progress, 1.0, "done")
    return cycles


@one_thread
def make_loops(
    motion: Motion | Points,
    search: Options | None = None,
    render: LoopOptions | None = None,
    *,
    timeline: Timeline | None = None,
    progress: Progress | None = None,
) -> list[Loop]:
    """Make the loops of a capture, as ``roundelay loop`` writes them.

    Parameters
    ----------
    motion : Motion or Points
        The capture.
    search : Options, optional
        What is looked for; automatic by default.
    render : LoopOptions, optional
        How a loop is repaired, sampled and written.
    timeline : Timeline, optional
        The capture's, by `understand`, where it is known already.
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Returns
    -------
    list of Loop
        One for each motion, the one most often and most surely repeated first. `Loop.write`
        writes it.

    Raises
    ------
    NoPeriod
        If no part of the capture is periodic; the error carries the evidence.
    TooShort
        If there are fewer than 8 frames.
    TooLarge
        If less memory is free than the search would take.
    SkeletonMismatch
        If a joint of the options does not exist, or the loops shall be mirrored and a joint of
        one side has no partner on the other.
    ValueError
        If an option is out of range, or the timeline is another capture's.
    Cancelled
        If `progress` returned False.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> for loop in rl.make_loops(walk):
    ...     print(loop.verdict, len(loop.motion))
    good 66
    """
    render, motion = chosen(LoopOptions, render), as_motion(motion)
    cycles = find_cycles(motion, search, timeline=timeline, progress=progress)
    return [made_loop(cycle, motion, render) for cycle in numbered(cycles)]


@one_thread
def make_cycle(
    motion: Motion | Points, evidence: Evidence, options: Options | None = None
) -> Cycle:
    """Make the cycle of what `find_periodic` or `roundelay.timeline.inspection.inspect` found.

    Parameters
    ----------
    motion : Motion or Points
    evidence : Evidence
    options : Options, optional
        Automatic by default.

    Raises
    ------
    TooShort
        If the runs hold no whole period.
    ValueError
        If an option is out of range.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> cycle = rl.make_cycle(walk, rl.find_periodic(walk)[0])
    >>> round(cycle.period, 2)
    1.1
    """
    options = chosen(Options, options)
    capture = as_motion(motion)
    motion = capture.with_root_motion()
    phase = _phase(Search.of_take(motion, options), expected(Evidence, evidence))
    return _fitted(capture, motion, phase, evidence, options)


@one_thread
def find_periodic(
    take: Motion | Points | Poses,
    options: Options | None = None,
    *,
    progress: Progress | None = None,
) -> list[Evidence]:
    """Find the periodic motions of a take without making cycles; see `find_cycles`.

    Parameters
    ----------
    take : Motion, Points or Poses
        A motion, points, or whatever has the attributes of `roundelay.motion.poses.Poses`: markers,
        keypoints, features. `Options.features` and `Options.weights` are for motions alone.
    options : Options, optional
        Automatic by default.
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Returns
    -------
    list of Evidence
        The one most often and most surely repeated first.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> [round(evidence.period, 2) for evidence in rl.find_periodic(walk)]
    [66.0]
    """
    options = chosen(Options, options)
    take = as_motion(take) if isinstance(take, Points) else take
    _require_budget(take, options)
    return find_evidence(take, options, progress)[1]


@one_thread
def understand(
    take: Motion | Points | Poses,
    options: Options | None = None,
    *,
    progress: Progress | None = None,
) -> Timeline:
    """Tell what repeats in a take, limb by limb, and how sure that is.

    Parameters
    ----------
    take : Motion, Points or Poses
        A motion, points, or whatever has the attributes of `roundelay.motion.poses.Poses`.
    options : Options, optional
        The frames and joints to look at, and who proposes; all by default.
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
    TooLarge
        If less memory is free than the search would take.
    SkeletonMismatch
        If a joint of the options does not exist.
    ValueError
        If the frames of the options are not all there.
    Cancelled
        If `progress` returned False.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> for each in rl.understand(walk).behaviours:
    ...     print(each.kind, round(each.period, 2), round(each.repetitions, 1))
    cyclic 1.1 6.5
    """
    options = chosen(Options, options)
    take = as_motion(take) if isinstance(take, Points) else take
    _require_budget(take, options)
    return timeline_of(take, options, progress)


def _require_budget(take: Motion | Poses, options: Options) -> None:
    """Check that there is memory for the search in a motion; poses are there already."""
    if isinstance(take, Motion):
        require_budget(take, options.span(len(take)))


def _phase(search: Search, evidence: Evidence) -> NDArray[np.float64]:
    """Return the phase (F,) of every frame that shows a motion, in turns, growing with time."""
    if evidence.closed:
        return evidence.turns
    behaviour = evidence.behaviour
    own = search if behaviour is None or behaviour.whole else search.of(behaviour.joints)
    return time_phase(own.points, evidence.turns, evidence.runs, frame_time=1.0 / search.fps)


def _fitted(
    capture: Motion,
    motion: Motion,
    phase: NDArray[np.float64],
    evidence: Evidence,
    options: Options,
) -> Cycle:
    """Fit a cycle to the motion in the root, and let it begin at an event.

    It knows its phase, the model that made it, and what the capture's own root did.
    """
    model = cycle_models[options.method]
    cycle = model.fit(motion, phase, evidence, options)
    known = phase if cycle.phase is None else cycle.phase
    cycle = replace(cycle, phase=known, method=cycle.method or model.name)
    return as_captured(begun(cycle), capture)


@one_thread
def segment(
    motion: Motion | Points,
    *,
    method: str | Any = "behaviours",
    sensitivity: float = 1.0,
    n_segments: int | None = None,
    joints: Iterable[str] | None = None,
    rng: int | np.random.Generator | None = None,
    timeline: Timeline | None = None,
    progress: Progress | None = None,
) -> Segmentation:
    """Cut a capture into behaviours, name those that come back alike, and tell which repeat.

    A cut stands where what explains the frames changes: none where one motion goes on.

    Parameters
    ----------
    motion : Motion or Points
    method : str or options
        ``behaviours`` (the default, needs nothing); ``gaussian``, what it proposes by itself;
        ``pca``, ``ppca`` or ``gmm`` of [B]; ``pca-paper``, ``ppca-paper`` and ``gmm-paper`` with
        all of the paper's own choices; one that a plug-in brings; or a method's options, such as
        ``PPCAOptions(threshold=2.5)``; or cuts that are known already, such as those of
        `roundelay.segmentation.edited_segments`.
    sensitivity : float
        2 finds finer behaviours, .5 coarser ones (``behaviours`` only).
    n_segments : int, optional
        Make exactly this many segments (``behaviours`` only).
    joints : iterable of str, optional
        Joints to look at; by default those that correspond to [B]'s fourteen.
    rng : int or numpy.random.Generator, optional
        For ``gmm``; seeded with 0 by default.
    timeline : Timeline, optional
        The capture's, by `understand`, where it is known already.
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Returns
    -------
    Segmentation
        Each segment with its period in seconds, of the behaviour that fills most of it; None
        where none fills half of it.

    Raises
    ------
    SkeletonMismatch
        If a joint is missing; the message names it.
    TooShort
        If a method of [B] gets fewer frames than it looks at. The default method takes a
        capture under two seconds for one behaviour.
    ValueError
        If an option is out of range, ``n_segments`` cannot be met, or the timeline is another
        capture's.
    Cancelled
        If `progress` returned False.

    Examples
    --------
    >>> take = rl.concatenate([rl.read("walk.bvh"), rl.read("run.bvh")])
    >>> found = rl.segment(take)
    >>> [(segment.kind, round(segment.period, 2)) for segment in found.segments]
    [('cyclic', 1.1), ('cyclic', 0.75)]
    """
    motion = as_motion(motion)
    joints = None if joints is None else tuple(joints)
    if timeline is None and len(motion) >= SEARCH.fewest:
        timeline = timeline_of(motion, Options(joints=joints), progress)
    told = () if timeline is None else timeline.checked(len(motion)).behaviours
    if isinstance(method, Segmentation):
        return _described(method.checked(len(motion)), told)
    found = cut_by_posture(
        motion,
        method=method,
        sensitivity=sensitivity,
        n_segments=n_segments,
        joints=joints,
        rng=rng,
        repeating=[each.spans for each in told if each.kind == "cyclic" and len(each.limbs) > 1],
    )
    return _described(found, told)


@one_thread
def cycles_in_segments(
    found: Segmentation,
    motion: Motion,
    options: Options | None = None,
    *,
    progress: Progress | None = None,
) -> list[Cycle]:
    """Make the cycles of every segment by itself, in order.

    Where a person named some segments, those without a name are left out.

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
    segments = [each for each in found.segments if each.name] or found.segments
    for number, segment in enumerate(segments):
        report(progress, number / len(segments), "fitting cycles")
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


def _described(found: Segmentation, told: Sequence[Behaviour]) -> Segmentation:
    """Tell of segments what the timeline does: which repeat, and in which the body is hidden."""
    cyclic = [each for each in told if each.kind == "cyclic"]
    unseen = [each for each in told if each.kind == "unseen"]
    segments = tuple(
        replace(each, period=_period(each, cyclic), unseen=_most_of(each, unseen) is not None)
        for each in found.segments
    )
    return replace(found, segments=segments)


def _period(segment: Segment, cyclic: Sequence[Behaviour]) -> float | None:
    most = _most_of(segment, cyclic)
    return None if most is None else most.period


def _most_of(segment: Segment, told: Sequence[Behaviour]) -> Behaviour | None:
    """Return the behaviour that fills most of a segment, if one fills half of it."""
    frames = range(segment.start, segment.stop)
    most = max(told, key=lambda each: each.spans.within(frames), default=None)
    return most if most and 2 * most.spans.within(frames) > len(frames) else None
