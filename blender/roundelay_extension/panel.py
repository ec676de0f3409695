# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel in the 3D View's sidebar: one button, a report, and all else folded away."""

from __future__ import annotations

import textwrap
from typing import Any

import bpy

from .compat import Context
from .preview import counterpart

# Pixels of a letter, about; letters of the narrowest line and of an icon.
_LETTER, _NARROW, _ICON = 7.0, 20, 5
# Degrees a period that are worth a line.
_TURNS = 5.0


class _Panel:
    bl_space_type: Any = "VIEW_3D"
    bl_region_type: Any = "UI"
    bl_category = "Roundelay"
    layout: Any


class _Folded(_Panel):
    bl_parent_id = "ROUNDELAY_PT_main"
    bl_options: Any = {"DEFAULT_CLOSED"}

    def column(self, context: Context) -> Any:
        """Return the place for properties, names to their left."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return self.layout.column()


def _draw_lines(layout: Any, context: Context, text: str, icon: str = "NONE") -> None:
    """Draw a text over as many lines as the sidebar's width asks for."""
    column = layout.column(align=True)
    width = context.region.width / (_LETTER * context.preferences.system.ui_scale)
    width -= _ICON if icon != "NONE" else 0
    for line in textwrap.wrap(text, max(int(width), _NARROW)):
        column.label(text=line, icon=icon)
        icon = "BLANK1" if icon != "NONE" else icon


class ROUNDELAY_PT_main(_Panel, bpy.types.Panel):
    """The button and what came of it."""

    bl_label = "Roundelay"

    def draw(self, context: Context) -> None:
        """Draw."""
        layout, settings = self.layout, context.scene.roundelay
        layout.operator("roundelay.extract", icon="FILE_REFRESH")
        if context.mode == "POSE":
            layout.label(text="Selected bones only", icon="BONE_DATA")
        if any(item.chosen for item in settings.classes):
            layout.label(text="Classes chosen by hand", icon="CHECKBOX_HLT")
        if settings.progress > 0.0:
            layout.progress(factor=settings.progress, text=settings.message)
        else:
            _draw_lines(layout, context, settings.message)
        for note in settings.notes.splitlines():
            _draw_lines(layout, context, note, icon="INFO")
        for item in settings.loops:
            if item.action is not None:
                self._draw_loop(context, item)
        layout.operator("roundelay.toggle", text=self._toggle_text(context), icon="UV_SYNC_SELECT")
        row = layout.row(align=True)
        row.operator("roundelay.join", icon="ARROW_LEFTRIGHT")
        row.operator("roundelay.export", icon="EXPORT")

    def _draw_loop(self, context: Context, item: Any) -> None:
        column = self.layout.box().column(align=True)
        column.operator("roundelay.show", text=item.action.name).action = item.action.name
        _draw_lines(
            column, context, item.verdict, icon="CHECKMARK" if item.verdict == "good" else "ERROR"
        )
        length = item.action.frame_end - item.action.frame_start
        column.label(text=f"{length:.0f} frames, {item.period:.2f} s")
        sure = "chosen by hand" if item.by_hand else f"{item.confidence:.0%} sure"
        column.label(text=f"{item.repetitions:.1f} times seen, {sure}")
        _draw_lines(column, context, item.frames)
        column.label(text=f"Seam {item.seam:.1f}\u00b0, steps up to {item.step:.1f}\u00b0")
        on = "on the controls, " if item.controls else ""
        played = f"Played back: {on}within {item.away:.1%} of the body, join {item.join:.2f}"
        _draw_lines(column, context, played)
        if abs(item.turning) >= _TURNS:
            turned = f"Turned {abs(item.turning):.0f}\u00b0 a period; heads straight on now"
            _draw_lines(column, context, turned)

    def _toggle_text(self, context: Context) -> str:
        armature = context.active_object
        other = counterpart(context.scene, armature) if armature is not None else None
        return "Capture / Loop" if other is None else f"Show {other.name}"


class ROUNDELAY_PT_frames(_Folded, bpy.types.Panel):
    """Which frames."""

    bl_label = "Frames"

    def draw(self, context: Context) -> None:
        """Draw."""
        column, settings = self.column(context), context.scene.roundelay
        column.prop(settings, "subsample")
        column.prop(settings, "use_frames")
        inner = column.column()
        inner.active = settings.use_frames
        inner.prop(settings, "first_frame")
        inner.prop(settings, "frame_count")
        column.operator("roundelay.frames_from_markers")


class ROUNDELAY_PT_loop(_Folded, bpy.types.Panel):
    """What the actions shall be like."""

    bl_label = "Loop"

    def draw(self, context: Context) -> None:
        """Draw."""
        column, settings = self.column(context), context.scene.roundelay
        column.prop(settings, "travel")
        if settings.travel == "AXES":
            axes = column.column(align=True)
            for name in ("travel_x", "travel_y", "travel_z"):
                axes.prop(settings, name)
        for name in (
            "foot_lock",
            "repair",
            "mirror",
            "start_phase",
            "key_step",
            "most",
            "use_strip",
        ):
            column.prop(settings, name)
        inner = column.column()
        inner.active = settings.use_strip
        inner.prop(settings, "repeat")


class ROUNDELAY_PT_classes(_Folded, bpy.types.Panel):
    """The persistence diagram as bars to choose from."""

    bl_label = "Classes"

    def draw(self, context: Context) -> None:
        """Draw."""
        settings = context.scene.roundelay
        self.layout.operator("roundelay.inspect")
        self.layout.operator("roundelay.diagram")
        self.layout.prop(settings, "persistent")
        for item in settings.classes:
            row = self.layout.row(align=True)
            row.prop(item, "chosen", text="")
            label = f"{item.birth:.3f} - {item.death:.3f}"
            row.progress(factor=item.share, text=label)
            row.label(text=item.text)


class ROUNDELAY_PT_advanced(_Folded, bpy.types.Panel):
    """What is automatic unless given."""

    bl_label = "Advanced"

    def draw(self, context: Context) -> None:
        """Draw."""
        column, settings = self.column(context), context.scene.roundelay
        column.prop(settings, "method")
        constraints = column.column(heading="Follow", align=True)
        constraints.enabled = settings.method == "PAPER"
        for name in ("velocity", "acceleration"):
            constraints.prop(settings, name)
        for name in ("harmonics", "travel_harmonics", "max_scale", "scale", "prime", "use_delay"):
            column.prop(settings, name)
        delay = column.column()
        delay.active = settings.use_delay
        delay.prop(settings, "delay")
        column.prop(settings, "use_plots")
        folder = column.column()
        folder.active = settings.use_plots
        folder.prop(settings, "plot_folder")


class ROUNDELAY_PT_behaviours(_Folded, bpy.types.Panel):
    """Segmentation."""

    bl_label = "Behaviours"

    def draw(self, context: Context) -> None:
        """Draw."""
        column, settings = self.column(context), context.scene.roundelay
        column.prop(settings, "sensitivity")
        column.prop(settings, "cuts_to")
        column.operator("roundelay.segment")
        column.prop(settings, "per_behaviour")


class ROUNDELAY_PT_blend(_Folded, bpy.types.Panel):
    """Between two loops."""

    bl_label = "Blend"

    def draw(self, context: Context) -> None:
        """Draw."""
        column, settings = self.column(context), context.scene.roundelay
        column.prop(settings, "blend_first")
        column.prop(settings, "blend_second")
        column.operator("roundelay.blend")


CLASSES = (
    ROUNDELAY_PT_main,
    ROUNDELAY_PT_frames,
    ROUNDELAY_PT_loop,
    ROUNDELAY_PT_classes,
    ROUNDELAY_PT_advanced,
    ROUNDELAY_PT_behaviours,
    ROUNDELAY_PT_blend,
)
