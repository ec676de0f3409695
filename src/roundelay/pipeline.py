"""The main job, one line a stage: read this first.

::

    Motion -> points        poses as a point cloud                      poses.py
           -> parts         stretches in which poses come back          detection.py
           -> evidence      barcode, circular coordinate, turns         periodicity.py, topology/
           -> phase         from structure to time                      timing.py
           -> cycle         a closed curve of poses with its travel     cycles/
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from roundelay.closed import closed_capture
from roundelay.cloud import TopologyOptions
from roundelay.cycles.centroid import centroid_cycle
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.fitting import fit_cycle
from roundelay.cycles.tempo import time_phase
from roundelay.detection import Part, candidate_parts, leading_rest_pose, recurring_groups
from roundelay.errors import LiftError, NoPeriod, TooShort
from roundelay.geometry.contacts import free_limbs
from roundelay.motion import Motion
from roundelay.periodicity import Evidence, measure, without_pauses
from roundelay.poses import Features, point_cloud
from roundelay.progress import Progress, report
from roundelay.timing import Run

__all__ = ["Options", "find_cycles", "find_periodic"]

Array = NDArray[np.float64]
Method = Literal["harmonic", "centroid"]
Weights = Literal["none", "length", "mass"]

# A longer capture that ends as it began is a take, not a loop, in seconds.
_LONGEST_CLOSED = 10.0
# Where arms alone decide, their loop must stand out this much from the next.
_PROMINENT_ARMS = 4.0


@dataclass(frozen=True)
class Options:
    """Choices of the main job; all automatic unless given.

    Parameters
    ----------
    frames : (int, int), optional
        Half-open range of frames to look at; by default all but a rest pose put before them.
    joints : sequence of str, optional
        Joints that decide what is a repetition; all by default. Every joint is in the cycle.
    features : str
        What a pose is to the search, see `roundelay.poses.point_cloud`.
    weights : {"none", "length", "mass"}
        Weigh every joint by the length of its bones ([C] ch. 4) or by that of all bones it
        moves, which stands for their mass ([A] 7). Positions weigh by length of themselves.
    topology : TopologyOptions
        Prime, class, scale, velocity or delays, metric, dimensions.
    harmonics : int, optional
        Number of harmonics of the cycle; by default what the period can need.
    method : {"harmonic", "centroid"}
        How poses become a cycle: harmonic regression ([C]) or centroids ([A] 4.4).
    most : int, optional
        Return this many cycles at most, best first.
    """

    frames: tuple[int, int] | None = None
    joints: Sequence[str] | None = None
    features: Features = "positions"
    weights: Weights = "none"
    topology: TopologyOptions = field(default_factory=TopologyOptions)
    harmonics: int | None = None
    method: Method = "harmonic"
    most: int | None = None


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
    options, motion = options or Options(), motion.with_root_motion()
    if options.method not in get_args(Method):
        raise ValueError(f"expected a method among {get_args(Method)}, found {options.method!r}")
    points = _points(motion, options)
    try:
        found = find_periodic(motion, options, points=points, progress=progress)
    except NoPeriod as refusal:
        found, points = _by_arms(motion, options, refusal, progress)
    cycles, refused = [], []
    for number, evidence in enumerate(found):
        report(progress, 0.5 + 0.5 * number / len(found), "fitting cycles")
        try:
            cycles.append(_cycle(motion, points, evidence, options))
        except TooShort as error:
            refused.append(NoPeriod(f"frames {_listed(evidence.runs)}: {error}", evidence))
    if not cycles:
        raise _no_period(refused)
    report(progress, 1.0, "done")
    return cycles


def _cycle(motion: Motion, points: Array, evidence: Evidence, options: Options) -> Cycle:
    phase = evidence.turns
    if not evidence.closed:
        phase = time_phase(points, phase, evidence.runs, frame_time=motion.frame_time)
    cycle = fit_cycle(motion, phase, evidence.runs, harmonics=options.harmonics, evidence=evidence)
    return centroid_cycle(cycle, motion) if options.method == "centroid" else cycle


def _by_arms(
    motion: Motion, options: Options, refusal: NoPeriod, progress: Progress | None
) -> tuple[list[Evidence], Array]:
    """Look at the arms alone where all joints together show no period.

    A few bones that do not repeat can hide those that do, as in boxing ([C] ch. 7).
    """
    limbs = free_limbs(motion.skeleton, motion.positions(), motion.up)
    if options.joints is not None or not limbs:
        raise refusal
    points = point_cloud(motion, options.features, joints=limbs)
    report(progress, 0.5, "looking at the arms alone")
    try:
        found = find_periodic(motion, options, points=points)
    except NoPeriod:
        raise refusal from None
    sure = [e for e in found if not e.closed and e.prominence >= _PROMINENT_ARMS]
    if not sure:
        raise refusal
    return sure, points


def find_periodic(
    motion: Motion,
    options: Options | None = None,
    *,
    points: Array | None = None,
    progress: Progress | None = None,
) -> list[Evidence]:
    """Find the periodic motions of a capture without making cycles; see `find_cycles`."""
    options = options or Options()
    points = _points(motion.with_root_motion(), options) if points is None else points
    first, last = _frames(motion, points, options.frames)
    step = _step(motion.fps, last - first)
    report(progress, 0.0, "looking for recurring poses")
    parts = candidate_parts(points[first:last:step], motion.fps / step)
    groups = recurring_groups(points, [part.spread(step, first, last) for part in parts])
    found: list[Evidence] = []
    refused: list[NoPeriod] = []
    for number, group in enumerate(groups):
        report(progress, 0.1 + 0.4 * number / len(groups), "computing barcodes")
        accepted, reasons = _judge(points, group, step, options.topology, last - first)
        found += accepted
        refused += reasons
    if not found and last - first > _LONGEST_CLOSED * motion.fps:
        raise _no_period(refused)
    if not found:
        found = [_closed(points, (first, last), step, options, refused)]
    found.sort(key=_weight, reverse=True)
    return found[: options.most]


def _points(motion: Motion, options: Options) -> Array:
    if len(motion) < 8:
        raise TooShort(f"a period needs at least 8 frames, found {len(motion)}")
    skeleton = motion.skeleton
    joints = None if options.joints is None else skeleton.indices(options.joints)
    weights = {"none": None, "length": skeleton.bone_lengths, "mass": skeleton.moved_lengths}
    if options.weights not in weights:
        raise ValueError(f"expected weights among {list(weights)}, found {options.weights!r}")
    chosen = weights[options.weights]
    scaled = None if chosen is None else chosen / max(float(chosen.max()), 1e-12)
    return point_cloud(motion, options.features, joints=joints, weights=scaled)


def _frames(motion: Motion, points: Array, frames: Run | None) -> Run:
    if frames is None:
        return (1 if leading_rest_pose(points) else 0), len(motion)
    start, stop = frames
    if not 0 <= start < stop <= len(motion):
        raise ValueError(f"expected frames within 0 and {len(motion)}, found {start} to {stop}")
    return start, stop


def _step(fps: float, frames: int) -> int:
    """Thin to some 60 frames a second, long captures to 30."""
    target = 60.0 if frames / fps < 15.0 else 30.0
    return max(1, round(fps / target))


def _weight(evidence: Evidence) -> float:
    return evidence.repetitions * evidence.confidence


def _judge(
    points: Array, group: list[Part], step: int, options: TopologyOptions, searched: int
) -> tuple[list[Evidence], list[NoPeriod]]:
    """Ask topology about parts that look alike: all together, else each by itself."""
    try:
        return [_accepted(points, group, step, options, searched)], []
    except NoPeriod as refusal:
        if len(group) == 1:
            return [], [refusal]
    accepted, refused = [], []
    for part in group:
        evidence, reasons = _judge(points, [part], step, options, searched)
        accepted += evidence
        refused += reasons
    return accepted, refused


def _accepted(
    points: Array, group: list[Part], step: int, options: TopologyOptions, searched: int
) -> Evidence:
    """Measure parts of one motion, cut its pauses out, and check the result."""
    by_hand = options.class_index is not None
    runs, period = _union(group), float(np.median([part.period for part in group]))
    try:
        evidence = measure(points, runs, period, step, options)
        cut = without_pauses(evidence)
        if cut and tuple(cut) != evidence.runs:
            again = measure(points, cut, evidence.period, step, options)
            evidence = again if again.objection(searched, chosen=by_hand) is None else evidence
    except (LiftError, TooShort) as error:
        raise NoPeriod(str(error)) from error
    objection = evidence.objection(searched, chosen=by_hand)
    if objection is not None:
        raise NoPeriod(f"frames {_listed(evidence.runs)}: {objection}", evidence)
    return evidence


def _union(parts: list[Part]) -> list[Run]:
    """Join ranges that overlap."""
    joined: list[Run] = []
    for part in parts:
        if joined and part.start <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(part.stop, joined[-1][1]))
        else:
            joined.append((part.start, part.stop))
    return joined


def _listed(runs: Sequence[Run]) -> str:
    return ", ".join(f"{start}-{stop}" for start, stop in runs)


def _closed(
    points: Array, run: Run, step: int, options: Options, refused: list[NoPeriod]
) -> Evidence:
    """Try whether all frames are one closed period, where nothing comes back."""
    try:
        chosen = options.frames is not None
        return closed_capture(points, run, step, options.topology, chosen=chosen)
    except NoPeriod as refusal:
        raise _no_period([*refused, refusal]) from None


def _no_period(refused: list[NoPeriod]) -> NoPeriod:
    if not refused:
        return NoPeriod("no periodic motion found: no pose comes back after a while")
    shown = "; ".join(str(reason) for reason in refused[:3])
    more = f"; and {len(refused) - 3} more" if len(refused) > 3 else ""
    return NoPeriod(f"no periodic motion found: {shown}{more}", refused[0].evidence)
