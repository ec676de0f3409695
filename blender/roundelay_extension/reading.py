# SPDX-License-Identifier: GPL-3.0-or-later
"""An armature's action as a motion: from its curves, or by playing it where they are not all."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, replace
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from roundelay import Motion
from roundelay.geometry import rotations as rot

from . import compat
from .bones import placing_curves
from .compat import Armature
from .rig import Channels, Rig

Array = NDArray[np.float64]
Curves = dict[tuple[str, int], Any]


@dataclass(frozen=True)
class Reading:
    """What an action does.

    Attributes
    ----------
    motion : Motion
    place : (4, 4) ndarray or None
        The armature's own matrix at the first frame, where its motion is part of the root's.
    """

    motion: Motion
    place: Array | None

    def subsampled(self, step: int) -> Reading:
        """Take every step-th frame."""
        thin = self.motion.at(np.arange(0, len(self.motion), step))
        return replace(self, motion=replace(thin, frame_time=self.motion.frame_time * step))


def read(rig: Rig, scene: bpy.types.Scene, frames: range) -> Generator[float, None, Reading]:
    """Read what a rig does at some frames of the scene, yielding the fraction done."""
    if _must_play(rig):
        channels, places = yield from _played(rig, scene, frames)
    else:
        channels, places = _from_curves(rig, frames), _places(rig.armature, frames)
    frame_time = scene.render.fps_base / scene.render.fps
    if not rig.carried:
        return Reading(rig.motion(channels, None, frame_time), None)
    placed = np.linalg.inv(places[0]) @ places
    return Reading(rig.motion(channels, placed, frame_time), places[0])


def _must_play(rig: Rig) -> bool:
    """Tell whether more than an action's curves decides the pose."""
    data = rig.armature.animation_data
    layers = data.use_nla and any(not track.mute and track.strips for track in data.nla_tracks)
    drivers = any(curve.data_path.startswith("pose.bones") for curve in data.drivers)
    return layers or drivers or any(_is_special(bone) for bone in rig.bones)


def _is_special(bone: Any) -> bool:
    return not bone.bone.use_inherit_rotation or any(c.enabled for c in bone.constraints)


def _from_curves(rig: Rig, frames: range) -> Channels:
    curves = {
        (curve.data_path, curve.array_index): curve
        for curve in compat.fcurves(rig.armature.animation_data)
    }
    at = np.array(frames, float)
    return Channels(
        np.stack([_rotations(bone, curves, at) for bone in rig.bones], axis=1),
        np.stack([_locations(bone, curves, at) for bone in rig.bones], axis=1),
        np.stack([_channel(bone, "scale", curves, at) for bone in rig.bones], axis=1)
        if rig.scaled
        else None,
    )


def _places(armature: Armature, frames: range) -> Array:
    """Return the armature's own matrices (F, 4, 4), as its curves set them one after the other."""
    curves = [(getattr(armature, c.data_path), c) for c in placing_curves(armature)]
    before = [(values, c.array_index, values[c.array_index]) for values, c in curves]
    matrices = np.empty((len(frames), 4, 4))
    try:
        for row, frame in enumerate(frames):
            for values, curve in curves:
                values[curve.array_index] = curve.evaluate(frame)
            matrices[row] = armature.matrix_basis
    finally:
        for values, index, value in before:
            values[index] = value
    return matrices


def _rotations(bone: Any, curves: Curves, frames: Array) -> Array:
    """Return quaternions (F, 4) of a bone in any rotation mode."""
    if bone.rotation_mode == "QUATERNION":
        return rot.normalize(_channel(bone, "rotation_quaternion", curves, frames))
    if bone.rotation_mode == "AXIS_ANGLE":
        values = _channel(bone, "rotation_axis_angle", curves, frames)
        length = np.linalg.norm(values[:, 1:], axis=1, keepdims=True)
        return rot.from_rotation_vector(values[:, :1] * values[:, 1:] / np.maximum(length, 1e-9))
    angles = _channel(bone, "rotation_euler", curves, frames)
    # Blender's XYZ turns about X first: Rz Ry Rx.
    order = bone.rotation_mode[::-1]
    return rot.from_euler(angles[:, ["XYZ".index(axis) for axis in order]], order)


def _locations(bone: Any, curves: Curves, frames: Array) -> Array:
    if bone.bone.use_connect:
        return np.zeros((len(frames), 3))
    return _channel(bone, "location", curves, frames)


def _channel(bone: Any, name: str, curves: Curves, frames: Array) -> Array:
    """Return a property of a bone over time, (F, size); where it has no curve, as it is now."""
    path = bone.path_from_id(name)
    columns = [
        _values(curves[path, index], frames)
        if (path, index) in curves
        else np.full(len(frames), value)
        for index, value in enumerate(getattr(bone, name))
    ]
    return np.stack(columns, axis=1)


def _values(curve: Any, frames: Array) -> Array:
    """Return a curve's values; its keys as they are if there is one at every frame."""
    if len(curve.modifiers) == 0:
        keys = np.empty(2 * len(curve.keyframe_points), np.float32)
        curve.keyframe_points.foreach_get("co", keys)
        first = int(np.searchsorted(keys[::2], frames[0]))
        run = keys.reshape(-1, 2)[first : first + len(frames)]
        if np.array_equal(run[:, 0], frames):
            return run[:, 1].astype(float)
    return np.array([curve.evaluate(frame) for frame in frames])


def _played(
    rig: Rig, scene: bpy.types.Scene, frames: range
) -> Generator[float, None, tuple[Channels, Array]]:
    """Set every frame and take the bones from where they are, parents thought at rest."""
    pose, current = rig.armature.pose.bones, scene.frame_current
    where = {bone.name: index for index, bone in enumerate(pose)}
    matrices, places = np.empty((len(frames), len(pose), 4, 4)), np.empty((len(frames), 4, 4))
    buffer = np.empty(16 * len(pose), np.float32)
    try:
        for row in _visited(scene, frames):
            pose.foreach_get("matrix", buffer)
            matrices[row] = buffer.reshape(-1, 4, 4).transpose(0, 2, 1)
            places[row] = rig.armature.matrix_basis
            yield row / len(frames)
    finally:
        scene.frame_set(current)
    rest = np.array([bone.bone.matrix_local for bone in pose])
    parents = [where[bone.parent.name] if bone.parent else -1 for bone in pose]
    own = _relative(matrices, rest, parents)[:, [where[bone.name] for bone in rig.bones]]
    turn, scales = own[..., :3, :3], np.linalg.norm(own[..., :3, :3], axis=-2)
    rotations = rot.from_matrix(turn / scales[..., None, :])
    return Channels(rotations, own[..., :3, 3], scales if rig.scaled else None), places


def _visited(scene: bpy.types.Scene, frames: range) -> Iterator[int]:
    for row, frame in enumerate(frames):
        scene.frame_set(frame)
        yield row


def _relative(matrices: Array, rest: Array, parents: list[int]) -> Array:
    """Return pose matrices (F, J, 4, 4) relative to the parents' and to rest."""
    own = np.empty_like(matrices)
    for joint, parent in enumerate(parents):
        base = rest[joint]
        if parent >= 0:
            base = matrices[:, parent] @ (np.linalg.inv(rest[parent]) @ rest[joint])
        own[:, joint] = np.linalg.inv(base) @ matrices[:, joint]
    return own
