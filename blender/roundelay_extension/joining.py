# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a loop is joined: moved by frames, or dragged with the mouse, the loop following."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from .capture import armatures_of, shows_loop
from .compat import Context, State, fcurves
from .keyed import keys_of

# Pixels of the mouse for a frame.
_PIXELS = 8


class ROUNDELAY_OT_join(bpy.types.Operator):
    """Let the loop begin some frames later; drag to the left or right"""

    bl_idname = "roundelay.join"
    bl_label = "Move Join"
    bl_options = {"REGISTER", "UNDO"}

    frames: bpy.props.IntProperty(name="Frames", description="By how many frames later it begins")
    _before: list[tuple[Any, Any]]
    _from: int

    @classmethod
    def poll(cls, context: Context) -> bool:
        """A loop must be shown."""
        return shows_loop(cls, context)

    def execute(self, context: Context) -> State:
        """Move the join."""
        self._begin(context)
        self._move(context)
        return {"FINISHED"}

    def invoke(self, context: Context, event: bpy.types.Event) -> State:
        """Follow the mouse."""
        self.frames = 0
        self._begin(context)
        self._from = event.mouse_x
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: Context, event: bpy.types.Event) -> State:
        """Move with the mouse; a click keeps, Esc and the right button take back."""
        if event.type == "MOUSEMOVE":
            self.frames = (event.mouse_x - self._from) // _PIXELS
            self._move(context)
        elif event.type in ("ESC", "RIGHTMOUSE"):
            self.frames = 0
            self._move(context)
            return {"CANCELLED"}
        elif event.type in ("LEFTMOUSE", "RET"):
            return {"FINISHED"}
        return {"RUNNING_MODAL"}

    def _begin(self, context: Context) -> None:
        curves = fcurves(armatures_of(context)[0].animation_data)
        self._before = [(curve, keys_of(curve)) for curve in curves]

    def _move(self, context: Context) -> None:
        """Give every key the value that its curve has some frames later."""
        for curve, keys in self._before:
            _fill(curve, keys[:, 1])
            later = [curve.evaluate(frame + self.frames) for frame in keys[:, 0]]
            _fill(curve, np.array(later))
        armature = armatures_of(context)[0]
        armature.animation_data.action.update_tag()
        context.scene.roundelay.message = f"Joined {self.frames} frames later"


def _fill(curve: Any, values: Any) -> None:
    keys = keys_of(curve)
    keys[:, 1] = values
    curve.keyframe_points.foreach_set("co", keys.ravel())
    curve.update()


CLASSES = (ROUNDELAY_OT_join,)
