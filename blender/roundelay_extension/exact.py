# SPDX-License-Identifier: GPL-3.0-or-later
"""The plain mean of the repetitions, where the library's smooth one is too far from it.

Few frames a stride, as animators key them, leave corners that a smooth regression rounds off.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay import Cycle, Motion, TooShort
from roundelay.base.spans import Spans
from roundelay.cycles.continuity import Followed, followed_poses
from roundelay.cycles.edit.footlock import lock_offsets, move_foot
from roundelay.geometry import rotations as rot
from roundelay.geometry.contacts import contacts, find_feet, foot_points
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.phase.harmonic import HarmonicCurve

from .averaging import Values, Windows, windows_of

Array = NDArray[np.float64]

# Body sizes between the two means from which on the plain one is taken: .3 cm of a person.
_APART = 0.0016
# Body sizes a second: what moves less stands.
_STANDS = 0.06
# Body sizes by which a foot is moved at most to stand: .5 cm of a person.
_MOST = 0.0027


def nearer(cycle: Cycle, motion: Motion, fps: float) -> Cycle:
    """Return the cycle, or the plain mean of its repetitions if it is too far from that.

    Parameters
    ----------
    cycle : Cycle
        Of a smooth mean, with its evidence and phase; others are returned as they are.
    motion : Motion
        The capture.
    fps : float
        Frames a second at which the loop will be keyed.
    """
    if cycle.method != "harmonic" or cycle.above is not None:
        return cycle
    body, evidence, phase = motion.with_root_motion(), cycle.evidence, cycle.phase
    count = max(1, round(cycle.period * fps))
    runs: Any = evidence.runs if evidence is not None else ()
    try:
        windows = windows_of(phase, np.arange(len(body), dtype=float), runs, count, 0.0)  # type: ignore[arg-type]
    except TooShort:
        return cycle
    poses = followed_poses(body, phase, runs, 1)  # type: ignore[arg-type]
    if poses.odd.any() or poses.jumps.any():
        return cycle
    mean = _mean(cycle, body, poses, windows)
    x = np.arange(count) / count
    shown = [one.at(x, frame_time=1.0, in_place=True).positions() for one in (cycle, mean)]
    apart = np.linalg.norm(shown[0] - shown[1], axis=-1).max() / motion.skeleton.size
    return mean if apart > _APART else cycle


def held(cycle: Cycle, loop: Motion, fps: float, start: float) -> Motion:
    """Hold the feet of a loop, the last frame the first again, where they really stand.

    The library's lock holds them from heel to toe, by which the poses of a stride change by some
    centimetres; what is keyed is changed as little as can be.
    """
    count = len(loop) - 1
    around = cycle.sample(fps, periods=3, start=start - 1.0, foot_lock=False)
    places, turns = forward_kinematics(
        around.skeleton, around.rotations, around.root_path, translations=around.translations
    )
    feet = () if around.skeleton.free else find_feet(around.skeleton, places, around.up)
    if not feet:
        return loop
    points, size = foot_points(feet, places, turns), around.skeleton.size
    down = contacts(points, fps=around.fps, size=size, up=around.up)
    steps = np.delete(np.diff(points, axis=0), around.up, axis=-1)
    slow = np.linalg.norm(steps, axis=-1) * around.fps / size < _STANDS
    down[1:] &= slow
    down[:-1] &= slow
    for stands in down.T:
        for first, stop in Spans.of_mask(stands):
            stands[first:stop] = stop - first < count
    rotations = around.rotations.copy()
    offsets = lock_offsets(points, down, around.up)
    far = np.linalg.norm(offsets, axis=-1, keepdims=True) / size
    offsets *= _MOST / np.maximum(far, _MOST)
    for foot, offset in zip(feet, np.moveaxis(offsets, 1, 0), strict=True):
        move_foot(around.skeleton, rotations, foot, offset, places, turns)
    legs = [joint for foot in feet for joint in (foot.hip, foot.knee, foot.ankle)]
    taken = loop.rotations.copy()
    taken[:-1, legs] = rotations[count : 2 * count, legs]
    taken[-1, legs] = taken[0, legs]
    return replace(loop, rotations=taken)


def _mean(cycle: Cycle, motion: Motion, poses: Followed, windows: Windows) -> Cycle:
    count, climbs = windows.count, cycle.velocity.constant[cycle.up] != 0.0
    local = poses.local.reshape(len(poses.local), -1)
    places = np.concatenate([np.zeros((1, 3)), np.cumsum(poses.steps(motion), axis=0)])
    values = _sampled(places)
    gain = windows.gain(values)
    path = windows.mean(values, gain)
    keep = (np.arange(3) != cycle.up) | climbs
    # A step is the velocity in its middle.
    velocity = HarmonicCurve.through(np.diff(path, axis=0) * count * keep).shifted(-0.5 / count)
    height = windows.mean(_sampled(motion.root_path[:, [motion.up]]))[:-1]
    moved = motion.translations
    if moved is not None:
        moved = windows.mean(_sampled(moved.reshape(len(moved), -1)))[:-1]
    return replace(
        cycle,
        pose=HarmonicCurve.through(_turned(windows, local)),
        odd_pose=None,
        velocity=velocity,
        height=cycle.height if climbs else HarmonicCurve.through(height),
        translations=None if moved is None else HarmonicCurve.through(moved),
    )


def _turned(windows: Windows, local: Array) -> Array:
    """Return the mean of quaternions (F, 4 J), which keep their signs, over the windows."""
    rows = windows.mean(_sampled(local))[:-1]
    return rot.normalize(rows.reshape(len(rows), -1, 4)).reshape(len(rows), -1)


def _sampled(samples: Array) -> Values:
    """Return values at fractional frames: cubic between those around."""

    def values(frames: Array) -> Array:
        last = len(samples) - 1
        before = np.clip(np.floor(frames).astype(int), 0, max(last - 1, 0))
        t = (frames - before)[..., None]
        a, b, c, d = (samples[np.clip(before + k, 0, last)] for k in (-1, 0, 1, 2))
        bend = 2 * a - 5 * b + 4 * c - d
        return b + 0.5 * t * ((c - a) + t * (bend + t * (3 * (b - c) + d - a)))

    return values
