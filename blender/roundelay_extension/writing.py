# SPDX-License-Identifier: GPL-3.0-or-later
"""A loop as an action: keys, the flags that make it cyclic, and the modifiers that repeat it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix, Quaternion
from numpy.typing import NDArray

from roundelay import Motion
from roundelay.geometry import rotations as rot

from . import compat
from .compat import Armature
from .rig import Rig

Array = NDArray[np.float64]

SOURCE, PLACE = "roundelay_source", "roundelay_place"
_LINEAR, _BEZIER, _AUTO_CLAMPED = 1, 2, 4


def write_loop(
    rig: Rig, loop: Motion, name: str, *, start: int, key_step: int = 1
) -> bpy.types.Action:
    """Make an action of a loop whose last frame is the first again, moved on by its travel.

    Parameters
    ----------
    rig : Rig
    loop : Motion
        On the rig's skeleton, a frame of the scene each.
    name : str
    start : int
        Frame of the first key.
    key_step : int
        Put a key at every key_step-th frame only.
    """
    action, place = compat.new_action(name, rig.armature)
    taken = [*range(0, len(loop) - 1, key_step), len(loop) - 1]
    frames = start + np.array(taken, float)
    rotations, locations, scales = rig.channels(loop)
    for joint in np.flatnonzero(rig.keyed):
        bone = rig.bones[joint]
        channels = [*_curves(bone, rotations[taken, joint])]
        if np.abs(locations[taken, joint]).max() > 1e-6 * rig.skeleton.size:
            channels.append(("location", locations[taken, joint]))
        if scales is not None:
            channels.append(("scale", scales[taken, joint]))
        for path, values in channels:
            away = np.abs(values[-1] - values[0]).max() > 1e-6 * rig.skeleton.size
            travels = path == "location" and (joint == 0 or away)
            _add(place, bone, path, frames, values, travels=travels, smooth=key_step > 1)
    action.use_frame_range, action.use_cyclic, action.use_fake_user = True, True, True
    action.frame_start, action.frame_end = start, start + len(loop) - 1
    return action


def _curves(bone: Any, rotations: Array) -> Iterator[tuple[str, Array]]:
    """Write rotations (n, 4), the last the first again, in the bone's own mode."""
    if bone.rotation_mode == "QUATERNION":
        rows = rot.continuous(rotations)
        rows[-1] = rows[0] * np.sign(rows[0] @ rows[-1])
        yield "rotation_quaternion", rows
    elif bone.rotation_mode == "AXIS_ANGLE":
        vectors = rot.to_rotation_vector(rot.normalize(rotations))
        angles = np.linalg.norm(vectors, axis=1, keepdims=True)
        rows = np.hstack([angles, np.where(angles > 1e-9, vectors, (0.0, 1.0, 0.0))])
        rows[:, 1:] /= np.linalg.norm(rows[:, 1:], axis=1, keepdims=True)
        rows[-1] = rows[0]
        yield "rotation_axis_angle", rows
    else:
        yield "rotation_euler", _euler(rotations, bone.rotation_mode)


def _euler(rotations: Array, order: str) -> Array:
    """Return Euler angles (n, 3), each nearest to the one before; the last whole turns on."""
    angles = [Quaternion(rotations[0]).to_euler(order)]
    for rotation in rotations[1:]:
        angles.append(Quaternion(rotation).to_euler(order, angles[-1]))
    rows = np.array(angles)
    turns = (rows[-1] - rows[0]) / (2.0 * np.pi)
    if np.allclose(turns, np.round(turns), atol=1e-4):
        rows[-1] = rows[0] + 2.0 * np.pi * np.round(turns)
    return rows


def _add(
    place: Any, bone: Any, name: str, frames: Array, values: Array, *, travels: bool, smooth: bool
) -> None:
    """Add one curve a column of values (n, size), repeated before and after."""
    path = bone.path_from_id(name)
    for index, column in enumerate(values.T):
        curve = compat.new_fcurve(place, path, index, bone.name)
        points, count = curve.keyframe_points, len(frames)
        points.add(count)
        points.foreach_set("co", np.column_stack([frames, column]).ravel())
        points.foreach_set("interpolation", [_BEZIER if smooth else _LINEAR] * count)
        for side in ("handle_left_type", "handle_right_type"):
            points.foreach_set(side, [_AUTO_CLAMPED] * count)
        modifier: Any = curve.modifiers.new("CYCLES")
        onward = travels or (name == "rotation_euler" and column[0] != column[-1])
        modifier.mode_before = modifier.mode_after = "REPEAT_OFFSET" if onward else "REPEAT"
        curve.update()


def add_strip(armature: Armature, action: bpy.types.Action, repeat: float) -> None:
    """Put a loop on an NLA track of its own, repeated."""
    track = armature.animation_data.nla_tracks.new()
    track.name, track.mute = action.name, True
    strip = track.strips.new(action.name, int(action.frame_start), action)
    compat.assign(strip, action)
    strip.action_frame_start, strip.action_frame_end = action.frame_start, action.frame_end
    strip.repeat = repeat


def show(armature: Armature, action: bpy.types.Action) -> None:
    """Let an action drive an armature.

    A loop has the armature's own motion in its root: the armature stands where it began.
    """
    compat.assign(armature.animation_data, action)
    place: Any = action.get(PLACE)
    if place is not None:
        armature.matrix_basis = Matrix(np.reshape(place, (4, 4)).tolist())


def captured(action: bpy.types.Action) -> bpy.types.Action:
    """Return the capture a loop was made of; an action that is no loop is its own."""
    while (source := action.get(SOURCE)) is not None:
        action = source
    return action
