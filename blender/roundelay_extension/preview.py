# SPDX-License-Identifier: GPL-3.0-or-later
"""Look at the capture and its loop in turn."""

from __future__ import annotations

from typing import Any

import bpy

from .capture import armatures_of
from .compat import Context, State
from .writing import SOURCE, captured, show


def counterpart(scene: Any, action: bpy.types.Action | None) -> bpy.types.Action | None:
    """Return a loop's capture, or a capture's loop: of the last ones made, else of any."""
    if action is None:
        return None
    source = action.get(SOURCE)
    if source is not None:
        return source
    loops = [item.action for item in scene.roundelay.loops if item.action is not None]
    return next((o for o in (*loops, *bpy.data.actions) if o.get(SOURCE) == action), None)


class ROUNDELAY_OT_toggle(bpy.types.Operator):
    """Change between the capture and its loop"""

    bl_idname = "roundelay.toggle"
    bl_label = "Capture / Loop"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """There must be a counterpart."""
        return any(
            armature.animation_data and counterpart(context.scene, armature.animation_data.action)
            for armature in armatures_of(context)
        )

    def execute(self, context: Context) -> State:
        """Swap the actions."""
        for armature in armatures_of(context):
            data = armature.animation_data
            other = counterpart(context.scene, data.action) if data else None
            if other is not None:
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
            current = armature.animation_data and armature.animation_data.action
            if current and captured(chosen) == captured(current):
                show(armature, chosen)
        return {"FINISHED"}


CLASSES = (ROUNDELAY_OT_toggle, ROUNDELAY_OT_show)
