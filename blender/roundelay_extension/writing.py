# SPDX-License-Identifier: GPL-3.0-or-later
"""A loop as an action: keys, the flags that make it cyclic, and the modifiers that repeat it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from roundelay import Motion
from roundelay.geometry.symmetry import partners

from . import compat
from .compat import Armature
from .keyed import ROTATIONS, Keyed, Property
from .rig import Rig
from .takes import Take
from .tracks import Track, angles_of, rows_of

Array = NDArray[np.float64]

# What a loop knows of its capture: the action and its slot, whether strips of the NLA played, and
# whether they alone did; where its armature stood.
SOURCE, SLOT, STRIPS, BARE = (f"roundelay_{n}" for n in ("source", "slot", "strips", "bare"))
PLACE = "roundelay_place"
_CONSTANT, _LINEAR, _BEZIER, _AUTO_CLAMPED = 0, 1, 2, 4


def write_tracks(
    armature: Armature, tracks: Iterable[Track], name: str, *, start: int, key_step: int = 1
) -> bpy.types.Action:
    """Make an action of a loop.

    Parameters
    ----------
    armature : bpy.types.Object
    tracks : iterable of Track
        A row a frame of the scene, the last the first again.
    name : str
    start : int
        Frame of the first key.
    key_step : int
        Put a key at every key_step-th frame only.
    """
    new, last = compat.NewAction(name, armature), 0
    for track in tracks:
        last = len(track.rows) - 1
        step = 1 if track.stepped else key_step
        taken = [*range(0, last, step), last]
        for index in track.indices:
            user = None if track.target.owner == armature else track.target.owner
            curve = new.curve(track.target.path, index, track.group, user)
            values = track.rows[taken, index]
            _fill(curve, start + np.array(taken, float), values, _LINEAR if step == 1 else _BEZIER)
            if track.stepped:
                _step(curve)
            modifier: Any = curve.modifiers.new("CYCLES")
            onward = track.goes_on(index)
            modifier.mode_before = modifier.mode_after = "REPEAT_OFFSET" if onward else "REPEAT"
            curve.update()
    action = new.action
    action.use_frame_range, action.use_cyclic, action.use_fake_user = True, True, True
    action.frame_start, action.frame_end = start, start + last
    return action


def _fill(curve: Any, frames: Array, values: Array, interpolation: int) -> None:
    points, count = curve.keyframe_points, len(frames)
    points.add(count)
    points.foreach_set("co", np.column_stack([frames, values]).ravel())
    points.foreach_set("interpolation", [interpolation] * count)
    for side in ("handle_left_type", "handle_right_type"):
        points.foreach_set(side, [_AUTO_CLAMPED] * count)


def _step(curve: Any) -> None:
    curve.keyframe_points.foreach_set("interpolation", [_CONSTANT] * len(curve.keyframe_points))


def bone_tracks(rig: Rig, loop: Motion, keyed: Keyed, *, mirror: bool = False) -> Iterator[Track]:
    """Yield the tracks of what is keyed of bones, for a loop on their skeleton.

    Parameters
    ----------
    rig : Rig
    loop : Motion
    keyed : Keyed
        The root's place is keyed, too, where it takes the motion of the armature as a whole.
    mirror : bool
        The loop is a mirror image: what is keyed changes sides with it.
    """
    rotations, locations, scales = rig.channels(loop)
    others = partners(rig.skeleton) if mirror else np.arange(rig.skeleton.n_joints)
    for joint in np.flatnonzero(rig.keyed):
        bone, other = rig.bones[joint], rig.bones[others[joint]].name
        rows = {"location": locations[:, joint]}
        if scales is not None:
            rows["scale"] = scales[:, joint]
        rows |= dict(_turned(bone, rotations[:, joint]))
        taken = rig.carried and joint == 0
        for name, values in rows.items():
            one = Property(rig.armature, bone.path_from_id(name), bone.name, name)
            onward = name == "location" and joint == 0
            if (taken and name != "scale") or (mirror and keyed.has(other, name)):
                yield Track(one, one.bone, tuple(range(values.shape[1])), values, onward=onward)
            elif one in keyed.curves:
                track = Track.of(one, keyed, values)
                yield Track(one, track.group, track.indices, values, onward=onward)


def _turned(bone: Any, rotations: Array) -> Iterator[tuple[str, Array]]:
    """Write rotations (n, 4), the last the first again, in the bone's own mode."""
    mode = bone.rotation_mode
    name = next((name for name, one in ROTATIONS.items() if one == mode), "rotation_euler")
    yield name, angles_of(rotations, mode) if name == "rotation_euler" else rows_of(rotations, name)


def steady_track(one: Property, keyed: Keyed, count: int) -> Track:
    """Return the track of a property that does not change, over so many frames."""
    return Track.of(one, keyed, np.tile(one.now(), (count, 1)))


def mark(action: bpy.types.Action, take: Take, armature: Armature, place: Array | None) -> None:
    """Let a loop know its capture."""
    action[SOURCE], action[BARE] = take.action, take.bare
    action[STRIPS] = bool(take.strips)
    slot = None if take.bare else compat.slot_of(armature.animation_data)
    action[SLOT] = slot.identifier if slot else ""
    if place is not None:
        action[PLACE] = place.ravel().tolist()
    if take.action.library is None:
        take.action.use_fake_user = True


def add_strip(armature: Armature, action: bpy.types.Action, repeat: float) -> None:
    """Put a loop on an NLA track of its own, repeated."""
    track = armature.animation_data.nla_tracks.new()
    track.name, track.mute = action.name, True
    strip = track.strips.new(action.name, int(action.frame_start), action)
    compat.assign(strip, action)
    strip.action_frame_start, strip.action_frame_end = action.frame_start, action.frame_end
    strip.repeat = repeat


def is_loop(action: bpy.types.Action | None) -> bool:
    """Tell whether an action is a loop made here."""
    return action is not None and action.get(SOURCE) is not None


def show(armature: Armature, loop: bpy.types.Action) -> None:
    """Let a loop drive an armature, and shape keys that its capture drives, alone.

    A loop may have the armature's own motion in its root: the armature stands where it began.
    """
    data = armature.animation_data
    if loop.get(STRIPS):
        data.use_nla = False
    _pass_on(data.action or loop.get(SOURCE), loop)
    compat.assign(data, loop)
    place: Any = loop.get(PLACE)
    if place is not None:
        armature.matrix_basis = Matrix(np.reshape(place, (4, 4)).tolist())


def show_capture(armature: Armature, loop: bpy.types.Action) -> None:
    """Let the capture of a loop drive an armature again."""
    data = armature.animation_data
    while is_loop(loop[SOURCE]):
        loop = loop[SOURCE]
    _pass_on(data.action, loop[SOURCE])
    if loop.get(BARE):
        data.action = None
    else:
        compat.assign(data, loop[SOURCE], loop.get(SLOT, ""))
    if loop.get(STRIPS):
        data.use_nla = True


def _pass_on(before: bpy.types.Action | None, action: bpy.types.Action) -> None:
    """Let an action drive the shape keys that the one before drives."""
    for keys in bpy.data.shape_keys:
        data = keys.animation_data
        if data is not None and before is not None and data.action == before:
            name = getattr(compat.slot_of(data), "identifier", "")
            compat.assign(data, action, name)


def captured(action: bpy.types.Action) -> bpy.types.Action:
    """Return the capture a loop was made of; an action that is no loop is its own."""
    while (source := action.get(SOURCE)) is not None:
        action = source
    return action
