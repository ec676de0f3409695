# SPDX-License-Identifier: GPL-3.0-or-later
"""A loop between two loops, by a slider: in phase with each other, bone by bone."""

from __future__ import annotations

from typing import Any

import bpy

from roundelay import Cycle, Motion, RoundelayError, blend
from roundelay.loops.recipe import rendered

from .capture import armatures_of
from .compat import Armature, Context, State, assign
from .keyed import keyed_of
from .loops import cycle_of_loop, loop_of, moved_apart, render_of
from .reading import read
from .rig import Rig, rig_of
from .takes import take_of
from .writing import SOURCE, bone_tracks, is_loop, show, write_tracks


class ROUNDELAY_OT_blend(bpy.types.Operator):
    """Blend two loops of the active armature; the slider is in the last operation's panel"""

    bl_idname = "roundelay.blend"
    bl_label = "Blend Loops"
    bl_options = {"REGISTER", "UNDO"}

    weight: bpy.props.FloatProperty(
        name="Weight", description="0 for the first, 1 for the second", default=0.5, min=0, max=1
    )

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Work needs an armature and two loops."""
        settings = context.scene.roundelay
        if not (settings.blend_first and settings.blend_second):
            cls.poll_message_set("Choose two loops")
            return False
        return bool(armatures_of(context))

    def execute(self, context: Context) -> State:
        """Read both, blend and write."""
        settings = context.scene.roundelay
        try:
            action = _blended(context, armatures_of(context)[0], self.weight)
        except (RoundelayError, ValueError) as error:
            settings.message = str(error)
            self.report({"ERROR"}, settings.message)
            return {"CANCELLED"}
        settings.message = f"Made {action.name}"
        return {"FINISHED"}


def _blended(context: Context, armature: Armature, weight: float) -> bpy.types.Action:
    settings, scene = context.scene.roundelay, context.scene
    before = take_of(armature).action
    loops = settings.blend_first, settings.blend_second
    try:
        (rig, first, capture), (_, second, other) = [_read(scene, armature, a) for a in loops]
    finally:
        show(armature, before) if is_loop(before) else assign(armature.animation_data, before)
    fps = scene.render.fps / scene.render.fps_base
    mixed, sources = blend([first, second], [1.0 - weight, weight]), (capture, other)
    made = rendered(mixed, [m.with_root_motion() for m in sources], render_of(settings, fps))
    settings.notes = moved_apart(made.parted)
    loop = loop_of(made, capture, settings, fps)
    name = f"Blend {loops[0].name} {loops[1].name}"
    tracks = bone_tracks(rig, loop, keyed_of(armature, take_of(armature)))
    action = write_tracks(armature, tracks, name, start=int(loops[0].frame_start))
    action[SOURCE] = loops[0]
    show(armature, action)
    return action


def _read(scene: Any, armature: Any, action: bpy.types.Action) -> tuple[Rig, Cycle, Motion]:
    """Read two periods of a loop; its modifiers go on after its last key."""
    show(armature, action)
    rig, period = rig_of(armature), int(action.frame_end - action.frame_start)
    start = int(action.frame_start)
    reading = read(rig, scene, range(start, start + 2 * period + 1))
    while True:
        try:
            next(reading)
        except StopIteration as end:
            return rig, cycle_of_loop(end.value.motion, period), end.value.motion


CLASSES = (ROUNDELAY_OT_blend,)
