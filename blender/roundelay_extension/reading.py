# SPDX-License-Identifier: GPL-3.0-or-later
"""An armature's action as a motion: from its curves, or by playing it where they are not all."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, replace
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from roundelay import Motion
from roundelay.geometry import rotations as rot

from .bones import placing_curves
from .compat import Armature
from .jobs import aside
from .keyed import values_of
from .playing import play
from .rig import Channels, Rig
from .takes import curves_of

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


def read(
    rig: Rig, scene: bpy.types.Scene, frames: range, name: str = ""
) -> Generator[float, None, Reading]:
    """Read what a rig does at some frames of the scene, yielding the fraction done."""
    places = None
    if _must_play(rig):
        channels, places = yield from _played(rig, scene, frames)
    else:
        channels = yield from _from_curves(rig, frames)
        if rig.carried:
            places = yield from _places(rig.armature, frames)
    place = None if places is None or not rig.carried else places[0]
    placed = None if places is None or place is None else np.linalg.inv(place) @ places
    frame_time = scene.render.fps_base / scene.render.fps
    motion = yield from aside(lambda: rig.motion(channels, placed, frame_time, name))
    return Reading(motion, place)


def _must_play(rig: Rig) -> bool:
    """Tell whether more than an action's curves decides the pose."""
    data = rig.armature.animation_data
    layers = data.use_nla and any(not track.mute and track.strips for track in data.nla_tracks)
    drivers = any(curve.data_path.startswith("pose.bones") for curve in data.drivers)
    return layers or drivers or any(_is_special(bone) for bone in rig.bones)


def _is_special(bone: Any) -> bool:
    return not bone.bone.use_inherit_rotation or any(c.enabled for c in bone.constraints)


def _from_curves(rig: Rig, frames: range) -> Generator[float, None, Channels]:
    curves = {(one.data_path, one.array_index): one for one in curves_of(rig.armature)}
    at = np.array(frames, float)
    rotations, locations, scales = [], [], []
    for number, bone in enumerate(rig.bones):
        rotations.append(_rotations(bone, curves, at))
        locations.append(_locations(bone, curves, at))
        if rig.scaled:
            scales.append(_channel(bone, "scale", curves, at))
        yield number / len(rig.bones)
    scaled = np.stack(scales, axis=1) if rig.scaled else None
    return Channels(np.stack(rotations, axis=1), np.stack(locations, axis=1), scaled)


def _places(armature: Armature, frames: range) -> Generator[float, None, Array]:
    """Return the armature's own matrices (F, 4, 4), as its curves set them one after the other."""
    curves = [(getattr(armature, c.data_path), c) for c in placing_curves(armature)]
    before = [(values, c.array_index, values[c.array_index]) for values, c in curves]
    matrices = np.empty((len(frames), 4, 4))
    try:
        for row, frame in enumerate(frames):
            for values, curve in curves:
                values[curve.array_index] = curve.evaluate(frame)
            matrices[row] = armature.matrix_basis
            yield row / len(frames)
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
        values_of(curves[path, index], frames)
        if (path, index) in curves
        else np.full(len(frames), value)
        for index, value in enumerate(getattr(bone, name))
    ]
    return np.stack(columns, axis=1)


def _played(
    rig: Rig, scene: bpy.types.Scene, frames: range
) -> Generator[float, None, tuple[Channels, Array]]:
    """Set every frame and take the bones from where they are, parents thought at rest."""
    pose = rig.armature.pose.bones
    where = {bone.name: index for index, bone in enumerate(pose)}
    seen = yield from play(rig.armature, scene, frames, pose.keys())
    matrices, places = seen.matrices, seen.places
    rest = np.array([bone.bone.matrix_local for bone in pose])
    parents = [where[bone.parent.name] if bone.parent else -1 for bone in pose]
    own = _relative(matrices, rest, parents)[:, [where[bone.name] for bone in rig.bones]]
    turn, scales = own[..., :3, :3], np.linalg.norm(own[..., :3, :3], axis=-2)
    rotations = rot.from_matrix(turn / scales[..., None, :])
    return Channels(rotations, own[..., :3, 3], scales if rig.scaled else None), places


def _relative(matrices: Array, rest: Array, parents: list[int]) -> Array:
    """Return pose matrices (F, J, 4, 4) relative to the parents' and to rest."""
    own = np.empty_like(matrices)
    for joint, parent in enumerate(parents):
        base = rest[joint]
        if parent >= 0:
            base = matrices[:, parent] @ (np.linalg.inv(rest[parent]) @ rest[joint])
        own[:, joint] = np.linalg.inv(base) @ matrices[:, joint]
    return own
