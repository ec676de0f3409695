# SPDX-License-Identifier: GPL-3.0-or-later
"""The persistence diagram, drawn in the 3D View: a click on a point chooses its class."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import bpy
import numpy as np
from numpy.typing import NDArray

from .compat import Context, State

Array = NDArray[np.float64]

# Pixels: the side of the diagram, its place in the region, and how near a click must be.
_SIDE, _CORNER, _NEAR = 240, 60, 14
# Two triangles.
_SQUARE = ((-1, -1), (1, -1), (1, 1), (-1, -1), (1, 1), (-1, 1))
_GREY, _PLAIN, _CHOSEN = (0.6, 0.6, 0.6, 1.0), (0.3, 0.6, 1.0, 1.0), (1.0, 0.5, 0.1, 1.0)


def points_of(classes: Sequence[Any]) -> Array:
    """Return where classes are in the region (n, 2): birth to the right, death up."""
    spans = np.array([(one.birth, one.death) for one in classes], float).reshape(-1, 2)
    longest = max(float(spans.max(initial=0.0)), 1e-9)
    return np.asarray(_CORNER + spans / longest * _SIDE)


def nearest(classes: Sequence[Any], x: float, y: float) -> int | None:
    """Return the class at a place of the region, if there is one near."""
    if not len(classes):
        return None
    away = np.linalg.norm(points_of(classes) - (x, y), axis=1)
    found = int(np.argmin(away))
    return found if away[found] <= _NEAR else None


class ROUNDELAY_OT_diagram(bpy.types.Operator):
    """Show the classes as a persistence diagram; click a point to choose its class, Esc ends"""

    bl_idname = "roundelay.diagram"
    bl_label = "Persistence Diagram"

    _drawn: ClassVar[Any] = None

    @classmethod
    def poll(cls, context: Context) -> bool:
        """There must be classes."""
        if not context.scene.roundelay.classes:
            cls.poll_message_set("List the classes first")
            return False
        return True

    def invoke(self, context: Context, event: bpy.types.Event) -> State:
        """Draw, and wait for clicks."""
        cls = ROUNDELAY_OT_diagram
        if cls._drawn is None and not bpy.app.background:
            cls._drawn = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: Context, event: bpy.types.Event) -> State:
        """Choose on a click; leave all else to Blender."""
        if event.type in ("ESC", "RIGHTMOUSE"):
            self._end()
            return {"FINISHED"}
        if event.type == "LEFTMOUSE" and event.value == "PRESS":
            classes = context.scene.roundelay.classes
            found = nearest(classes, event.mouse_region_x, event.mouse_region_y)
            if found is not None:
                classes[found].chosen = not classes[found].chosen
                _redraw(context)
                return {"RUNNING_MODAL"}
        return {"PASS_THROUGH"}

    def _end(self) -> None:
        cls = ROUNDELAY_OT_diagram
        if cls._drawn is not None:
            bpy.types.SpaceView3D.draw_handler_remove(cls._drawn, "WINDOW")
            cls._drawn = None


def _redraw(context: Context) -> None:
    for area in context.screen.areas if context.screen else ():
        area.tag_redraw()


def _draw() -> None:
    """Draw the diagonal, the axes and a square a class."""
    import gpu
    from gpu_extras.batch import batch_for_shader

    name = "UNIFORM_COLOR" if bpy.app.version >= (4, 0, 0) else "2D_UNIFORM_COLOR"
    shader = gpu.shader.from_builtin(name)
    low, high = _CORNER, _CORNER + _SIDE
    lines = [(low, low), (high, high), (low, low), (high, low), (low, low), (low, high)]
    settings: Any = bpy.context.scene.roundelay  # type: ignore[union-attr]
    squares = [(lines, "LINES", _GREY)]
    for one, (x, y) in zip(settings.classes, points_of(settings.classes), strict=True):
        corners = [(x + 5 * dx, y + 5 * dy) for dx, dy in _SQUARE]
        squares.append((corners, "TRIS", _CHOSEN if one.chosen else _PLAIN))
    for places, kind, colour in squares:
        batch = batch_for_shader(shader, kind, {"pos": places})
        shader.bind()
        shader.uniform_float("color", colour)
        batch.draw(shader)


CLASSES = (ROUNDELAY_OT_diagram,)
