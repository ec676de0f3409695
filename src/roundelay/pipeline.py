"""The main job, one line a stage: read this first.

::

    Motion -> points        poses as a point cloud                      poses.py
           -> parts         stretches in which poses come back          detection.py, gestures.py
           -> evidence      barcode, circular coordinate, turns         parts.py, topology/
           -> phase         from structure to time                      timing.py
           -> cycle         a closed curve of poses with its travel     cycles/
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from roundelay.closed import closed_capture
from roundelay.cloud import TopologyOptions
from roundelay.cycles.centroid import centroid_cycle
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.fitting import fit_cycle
from roundelay.cycles.paper_cycle import paper_cycle
from roundelay.cycles.tempo import time_phase
from roundelay.detection import leading_rest_pose
from roundelay.errors import NoPeriod, TooShort
from roundelay.geometry.contacts import free_limbs
from roundelay.gestures import find_gestures
from roundelay.motion import Motion
from roundelay.parts import no_period, periodic_parts
from roundelay.periodicity import Evidence
from roundelay.poses import Features, point_cloud
from roundelay.progress import Progress, report
from roundelay.timing import Run

__all__ = ["Options", "find_cycles", "find_periodic", "make_cycle"]

Array = NDArray[np.float64]
Method = Literal["harmonic", "centroid", "paper"]
Weights = Literal["none", "length", "mass"]

_FEWEST = 8  # frames
# A longer capture that ends as it began is a take, not a loop, in seconds.
_LONGEST_CLOSED = 10.0
# Body sizes below which nothing moves, but for rounding.
_STILL = 1e-9
# What recurs with something else between, unasked for, is no chance from so many times on.
_OFTEN = 3
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
        Number of harmonics of the cycle; by default what the period can need, and [C]'s 20
        with the method "paper".
    method : {"harmonic", "centroid", "paper"}
        How poses become a cycle: harmonic regression of quaternions, centroids ([A] 4.4), or
        [C]'s weighted regression of angles (eq. 3.14).
    velocity, acceleration : bool
        Constrain the method "paper" by the velocities and accelerations of the frames
        ([C] 5.3 items 20, 21): both are [C]'s model M1, neither is M2. Other methods have
        no such constraints.
    gestures : bool, optional
        Look for gestures, which recur with something else between (True), never (False), or
        where no part is periodic (the default; they must then recur three times).
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
    velocity: bool = True
    acceleration: bool = True
    gestures: bool | None = None
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
    found, points = _searched(motion, options, progress)
    cycles, refused = [], []
    for number, evidence in enumerate(found):
        report(progress, 0.5 + 0.5 * number / len(found), "fitting cycles")
        try:
            cycles.append(make_cycle(motion, evidence, options, points=points))
        except TooShort as error:
            refused.append(NoPeriod(str(error), evidence))
    if not cycles:
        raise no_period(refused)
    report(progress, 1.0, "done")
    return cycles


def make_cycle(
    motion: Motion,
    evidence: Evidence,
    options: Options | None = None,
    *,
    points: Array | None = None,
) -> Cycle:
    """Make the cycle of what was found, by `find_periodic` or `roundelay.inspection.inspect`.

    Parameters
    ----------
    motion : Motion
    evidence : Evidence
    options : Options, optional
        Automatic by default.
    points : (F, d) ndarray, optional
        The poses that tell time; by default those of the options.

    Raises
    ------
    TooShort
        If the runs hold no whole period.
    ValueError
        If an option is out of range.
    """
    options, motion = options or Options(), motion.with_root_motion()
    _check(options)
    points, phase = _points(motion, options) if points is None else points, evidence.turns
    if not evidence.closed:
        phase = time_phase(points, phase, evidence.runs, frame_time=motion.frame_time)
    cycle = fit_cycle(motion, phase, evidence.runs, harmonics=options.harmonics, evidence=evidence)
    if options.method == "centroid":
        return centroid_cycle(cycle, motion)
    if options.method == "paper":
        return paper_cycle(
            cycle,
            motion,
            harmonics=options.harmonics,
            velocity=options.velocity,
            acceleration=options.acceleration,
        )
    return cycle


def _check(options: Options) -> None:
    for what, count in (("harmonic", options.harmonics), ("cycle", options.most)):
        if count is not None and count < 1:
            raise ValueError(f"expected at least one {what}, found {count}")
    if options.method not in get_args(Method):
        raise ValueError(f"expected a method among {get_args(Method)}, found {options.method!r}")
    if options.method != "paper" and not (options.velocity and options.acceleration):
        raise ValueError(
            'only the method "paper" has velocities and accelerations to leave out, '
            f"found {options.method!r}"
        )


def find_periodic(
    motion: Motion, options: Options | None = None, *, progress: Progress | None = None
) -> list[Evidence]:
    """Find the periodic motions of a capture without making cycles; see `find_cycles`."""
    return _searched(motion.with_root_motion(), options or Options(), progress)[0]


def _searched(
    motion: Motion, options: Options, progress: Progress | None
) -> tuple[list[Evidence], Array]:
    """Return what is found, best first, and the points in which it was.

    Where all joints together show no period, the arms alone may; else what recurs now and then.
    """
    _check(options)
    points = _points(motion, options)
    span = _frames(motion, points, options.frames)
    if np.ptp(points[slice(*span)], axis=0).max() < _STILL:
        raise NoPeriod("no periodic motion found: no joint moves against the root")
    if options.gestures:
        return _gestures(points, motion.fps, span, options, fewest=1), points
    try:
        return _periods(points, motion.fps, span, options, progress), points
    except NoPeriod as error:
        refusal = error
    with suppress(NoPeriod):
        return _in_arms(motion, span, options, progress)
    if options.gestures is None and options.topology.class_index is None:
        report(progress, 0.5, "looking for gestures")
        with suppress(NoPeriod):
            return _gestures(points, motion.fps, span, options, fewest=_OFTEN), points
    raise refusal


def _periods(
    points: Array, fps: float, span: Run, options: Options, progress: Progress | None
) -> list[Evidence]:
    """Find motions whose poses come back after a period, or all frames as one closed period."""
    frames = span[1] - span[0]
    step = _step(fps, frames)
    found, refused = periodic_parts(points, fps, span, step, options.topology, progress)
    if not found and frames <= _LONGEST_CLOSED * fps:
        chosen = options.frames is not None
        try:
            found = [closed_capture(points, span, step, options.topology, chosen=chosen)]
        except NoPeriod as refusal:
            refused.append(refusal)
    if not found:
        raise no_period(refused)
    found.sort(key=_weight, reverse=True)
    return found[: options.most]


def _in_arms(
    motion: Motion, span: Run, options: Options, progress: Progress | None
) -> tuple[list[Evidence], Array]:
    """Look at the arms alone: a few bones that do not repeat can hide those that do.

    As in boxing ([C] ch. 7).
    """
    limbs = free_limbs(motion.skeleton, motion.positions(), motion.up)
    if options.joints is not None or not limbs:
        raise NoPeriod("there are no arms to look at alone")
    report(progress, 0.5, "looking at the arms alone")
    arms = [motion.skeleton.names[joint] for joint in limbs]
    points = _points(motion, replace(options, joints=arms))
    stay = progress and (lambda _, stage: progress(0.5, stage))
    found = _periods(points, motion.fps, span, options, stay)
    sure = [e for e in found if not e.closed and e.prominence >= _PROMINENT_ARMS]
    if not sure:
        raise NoPeriod("no loop of the arms stands out")
    return sure, points


def _gestures(
    points: Array, fps: float, span: Run, options: Options, *, fewest: int
) -> list[Evidence]:
    found = find_gestures(points, fps, span, options.topology, fewest=fewest)
    return found[: options.most]


def _weight(evidence: Evidence) -> float:
    return evidence.repetitions * evidence.confidence


def _points(motion: Motion, options: Options) -> Array:
    if len(motion) < _FEWEST:
        raise TooShort(f"a period needs at least {_FEWEST} frames, found {len(motion)}")
    skeleton = motion.skeleton
    joints = None if options.joints is None else skeleton.indices(options.joints)
    weights = {"none": None, "length": skeleton.bone_lengths, "mass": skeleton.moved_lengths}
    if options.weights not in weights:
        raise ValueError(f"expected weights among {tuple(weights)}, found {options.weights!r}")
    chosen = weights[options.weights]
    scaled = None if chosen is None else chosen / max(float(chosen.max()), 1e-12)
    return point_cloud(motion, options.features, joints=joints, weights=scaled)


def _frames(motion: Motion, points: Array, frames: Run | None) -> Run:
    if frames is None:
        return (1 if leading_rest_pose(points) else 0), len(motion)
    start, stop = frames
    if not 0 <= start < stop <= len(motion):
        raise ValueError(f"expected frames within 0 and {len(motion)}, found {start} to {stop}")
    if stop - start < _FEWEST:
        raise TooShort(f"a period needs at least {_FEWEST} frames, found {stop - start}")
    return start, stop


def _step(fps: float, frames: int) -> int:
    """Thin to some 60 frames a second, long captures to 30."""
    target = 60.0 if frames / fps < 15.0 else 30.0
    return max(1, round(fps / target))
