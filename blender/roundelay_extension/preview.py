# SPDX-License-Identifier: GPL-3.0-or-later
"""Look at the capture and its loop in turn."""

from __future__ import annotations

from typing import Any

import bpy

from .capture import armatures_of
from .compat import Armature, Context, State
from .writing import BARE, SOURCE, captured, is_loop, show, show_capture


def counterpart(scene: Any, armature: Armature) -> bpy.types.Action | None:
    """Return the capture of the loop that an armature plays, or a loop of its capture.

    Of loops, the last ones made come first.
    """
    data = armature.animation_data
    if data is None:
        return None
    action = data.action
    if is_loop(action):
        return action[SOURCE]
    own = [item.action for item in scene.roundelay.loops if item.armature == armature]
    loops = [one for one in own if is_loop(one) and (action is None or one[SOURCE] == action)]
    if loops or action is None:
        return loops[0] if loops else None
    return next((one for one in bpy.data.actions if one.get(SOURCE) == action), None)


def swap(armature: Armature) -> None:
    """Show the capture instead of its loop."""
    loop = armature.animation_data.action
    if is_loop(loop[SOURCE]):
        show(armature, loop[SOURCE])
    else:
        show_capture(armature, loop)


class ROUNDELAY_OT_toggle(bpy.types.Operator):
    """Change between the capture and its loop"""

    bl_idname = "roundelay.toggle"
    bl_label = "Capture / Loop"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """There must be a counterpart."""
        return any(
            counterpart(context.scene, armature) is not None for armature in armatures_of(context)
        )

    def execute(self, context: Context) -> State:
        """Swap the actions."""
        for armature in armatures_of(context):
            other = counterpart(context.scene, armature)
            if other is not None and is_loop(armature.animation_data.action):
                swap(armature)
            elif other is not None:
                show(armature, other)
        return {"FINISHED"}


class ROUNDELAY_OT_show(bpy.types.Operator):
    """Play this loop"""

    bl_idname = "roundelay.show"
    bl_label = "Show Loop"
    bl_options = {"REGISTER", "UNDO"}

    action: bpy.props.StringProperty()

    def execute(self, context: Context) -> State:
        """Assign the action to the armatures that have its capture or one of its loops."""
        chosen = bpy.data.actions[self.action]
        for armature in armatures_of(context):
            data = armature.animation_data
            if data is None:
                continue
            own = any(one.action == chosen for one in context.scene.roundelay.loops)
            if data.action is None:
                same = bool(chosen.get(BARE)) and own
            else:
                same = captured(chosen) == captured(data.action)
            if same:
                show(armature, chosen)
        return {"FINISHED"}


CLASSES = (ROUNDELAY_OT_toggle, ROUNDELAY_OT_show)
