"""Repair motions whose limbs pass through each other ([A] section 7).

What meets in the captures that a loop is made from is contact, or limbs thinner than their
capsules; what regression, blending and foot lock add to it is repaired where small turns of
shoulders and hips do it (`roundelay.geometry.separation`). In a cycle the turns are functions of
phase: what is repaired is a cycle as any other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import smoothstep
from roundelay.base.spans import Span, Spans, closed_spans
from roundelay.base.threads import one_thread
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.thresholds import REPAIR
from roundelay.geometry import rotations as rot
from roundelay.geometry.contacts import contacts, find_feet, foot_points, shoulders
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.geometry.separation import Body, Pair, deepest, separate, turned
from roundelay.geometry.thresholds import SEPARATION
from roundelay.motion.motion import Motion
from roundelay.phase.harmonic import HarmonicCurve, highest_harmonic

__all__ = ["Mended", "repaired", "repaired_motion", "source_parts"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Mended:
    """Describe two bones that no longer meet more than in what the motion is made from.

    Attributes
    ----------
    bones : (str, str)
        Names of the joints at their lower ends.
    seconds : tuple of (float, float)
        When they did; in a cycle from phase 0, and beyond the period where across the seam.
    angle : float
        The largest angle in radians by which a joint was turned for it.
    """

    bones: Pair
    seconds: tuple[tuple[float, float], ...]
    angle: float


def source_parts(cycle: Cycle, motion: Motion, *, mirror: bool = False) -> list[Motion]:
    """Return the parts of a capture that show a cycle, and if asked those mirrored."""
    whole, runs = motion.with_root_motion(), cycle.evidence.runs if cycle.evidence else ()
    parts = [whole[start:stop] for start, stop in runs]
    return parts + [part.mirror() for part in parts if mirror]


@one_thread
def repaired(cycle: Cycle, sources: Sequence[Motion] = ()) -> tuple[Cycle, tuple[Mended, ...]]:
    """Part limbs of a cycle that pass through each other, by small smooth turns.

    Shoulders and hips turn by 15 degrees at most, no standing leg is moved, and no other bones
    come to meet; what cannot be mended so stays as it was.

    Parameters
    ----------
    cycle : Cycle
    sources : sequence of Motion
        What the cycle is made from: two bones may be as deep in each other as they are there.

    Returns
    -------
    cycle : Cycle
        The one given, if nothing was mended.
    mended : tuple of Mended
    """
    count = int(np.clip(round(REPAIR.rate * cycle.period), REPAIR.fewest, REPAIR.most))
    fps = count / cycle.period
    # The periods before and after decide about feet that stand across the seam.
    around = cycle.sample(fps, start=-1.0, periods=3).with_root_motion()
    before = _deepest([around[count : 2 * count]])
    if not before:
        return cycle, ()
    body = _body(around, slice(count, 2 * count), closed=True)
    limits = _deepest(sources)
    parted = separate(body, limits)
    if not parted.met:
        return cycle, ()
    changed = _turned(cycle, body.joints, parted.turns)
    # The feet are locked anew, which may undo it.
    allowed = {pair: depth + SEPARATION.clearance for pair, depth in before.items()}
    allowed |= dict.fromkeys(parted.met, 0.0)
    after = _deepest([changed.sample(fps).with_root_motion()])
    if any(d > max(allowed.get(p, 0.0), limits.get(p, 0.0)) for p, d in after.items()):
        return cycle, ()
    return changed, tuple(
        Mended(pair, _seconds(closed_spans(met), fps), parted.angles[pair])
        for pair, met in parted.met.items()
    )


@one_thread
def repaired_motion(
    motion: Motion, sources: Sequence[Motion] = ()
) -> tuple[Motion, tuple[Mended, ...]]:
    """Part limbs of a motion, such as a transition, as `repaired` does those of a cycle."""
    whole = motion.with_root_motion()
    if not _deepest([whole]):
        return motion, ()
    body = _body(whole, slice(None), closed=False)
    parted = separate(body, _deepest(sources))
    if not parted.met:
        return motion, ()
    rotations = motion.rotations.copy()
    rotations[:, body.joints] = rot.normalize(turned(rotations[:, body.joints], parted.turns))
    return replace(motion, rotations=rotations), tuple(
        Mended(pair, _seconds(Spans.of_mask(met), motion.fps), parted.angles[pair])
        for pair, met in parted.met.items()
    )


def _deepest(motions: Sequence[Motion]) -> dict[Pair, float]:
    """Return how deep pairs of bones are in each other in any of the motions."""
    found: dict[Pair, float] = {}
    for motion in motions:
        met = deepest(motion.skeleton, motion.rotations, motion.translations)
        found |= {pair: max(depth, found.get(pair, 0.0)) for pair, depth in met.items()}
    return found


def _body(motion: Motion, frames: slice, *, closed: bool) -> Body:
    """Describe some frames of a motion, with how free its shoulders and hips are in them."""
    places, turns = forward_kinematics(
        motion.skeleton, motion.rotations, motion.root_path, translations=motion.translations
    )
    arms = shoulders(motion.skeleton, places, motion.up)
    feet = find_feet(motion.skeleton, places, motion.up)
    freedom = np.ones((len(motion), len(arms) + len(feet)))
    if feet:
        points = foot_points(feet, places, turns)
        standing = contacts(points, fps=motion.fps, size=motion.skeleton.size, up=motion.up)
        freedom[:, len(arms) :] = _eased(standing, REPAIR.ease * motion.fps)
    part = motion[frames]
    joints = np.array([*arms, *(foot.hip for foot in feet)], np.intp)
    return Body(
        part.skeleton,
        part.rotations,
        part.translations,
        joints,
        freedom[frames],
        part.fps,
        closed=closed,
    )


def _eased(standing: Mask, frames: float) -> Array:
    """Return 0 where feet stand (F, n) and 1 some frames away from there, smooth between."""
    free = np.ones(standing.shape)
    at = np.arange(len(standing))
    for column, stands in zip(free.T, standing.T, strict=True):
        for start, stop in Spans.of_mask(stands):
            away = np.maximum(np.maximum(start - at, at - stop + 1), 0)
            x = np.minimum(away / frames, 1.0)
            column *= smoothstep(x)
    return free


def _turned(cycle: Cycle, joints: NDArray[np.intp], turns: Array) -> Cycle:
    """Turn joints (k,) of a cycle by vectors (n, k, 3) at even phases."""
    smooth = HarmonicCurve.through(turns.reshape(len(turns), -1))

    def after(curve: HarmonicCurve, *, odd: bool) -> HarmonicCurve:
        # A product of trigonometric polynomials has the harmonics of both together.
        harmonics = len(curve.frequencies) + highest_harmonic(cycle.period)
        x = np.arange(2 * harmonics + 1) / (2 * harmonics + 1)
        values = curve(x).reshape(len(x), -1, 4)
        half = smooth(x).reshape(len(x), -1, 3)
        values[:, joints] = turned(values[:, joints], half)
        return HarmonicCurve.through(values.reshape(len(x), -1), odd=odd)

    odd_pose = cycle.odd_pose and after(cycle.odd_pose, odd=True)
    return replace(cycle, pose=after(cycle.pose, odd=False), odd_pose=odd_pose)


def _seconds(spans: Sequence[Span], fps: float) -> tuple[tuple[float, float], ...]:
    return tuple((start / fps, stop / fps) for start, stop in spans)
