# SPDX-License-Identifier: GPL-3.0-or-later
"""Distinct behaviours as markers or NLA strips, and the frames of one for the search."""

from __future__ import annotations

from functools import partial
from typing import Any

import bpy

from roundelay import Motion, Segmentation, segment
from roundelay.segmentation import Segment

from . import compat
from .capture import Capture, armatures_of, has_armature, read_capture
from .compat import Context, State
from .jobs import LongOperator, Progress, Steps, threaded


class ROUNDELAY_OT_segment(LongOperator, bpy.types.Operator):
    """Cut the action into distinct behaviours; those that come back have the same letter"""

    bl_idname = "roundelay.segment"
    bl_label = "Cut into Behaviours"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Work needs an armature."""
        return has_armature(cls, context)

    def steps(self, context: Context) -> Steps[str]:
        """Read, cut and mark."""
        settings, count = context.scene.roundelay, 0
        for armature in armatures_of(context):
            capture = yield from read_capture(context, armature, settings)
            found = yield from threaded(partial(_cut, capture.motion, settings.sensitivity))
            place = _strips if settings.cuts_to == "STRIPS" else _markers
            place(context.scene, capture, found.segments, settings.subsample)
            count += len(found)
        return f"Found {count} behaviours"


def _cut(motion: Motion, sensitivity: float, progress: Progress) -> Segmentation:
    return segment(motion, sensitivity=sensitivity, progress=progress)


def _frames(capture: Capture, part: Segment, step: int) -> tuple[int, int]:
    return capture.first + part.start * step, capture.first + part.stop * step


def _name(part: Segment) -> str:
    """Name a behaviour by letter, and by period where it repeats itself."""
    return part.title if part.period is None else f"{part.title} ({part.period:.2f} s)"


def _markers(scene: Any, capture: Capture, parts: tuple[Segment, ...], step: int) -> None:
    for part in parts:
        scene.timeline_markers.new(_name(part), frame=_frames(capture, part, step)[0])


def _strips(scene: Any, capture: Capture, parts: tuple[Segment, ...], step: int) -> None:
    """Put a strip for each behaviour on a muted track: the action itself goes on playing."""
    track = capture.armature.animation_data.nla_tracks.new()
    track.name, track.mute = f"Behaviours {capture.take.action.name}", True
    for part in parts:
        start, stop = _frames(capture, part, step)
        strip = track.strips.new(_name(part), start, capture.take.action)
        compat.assign(strip, capture.take.action)
        strip.action_frame_start, strip.action_frame_end = start, stop
        strip.frame_start, strip.frame_end = start, stop


class ROUNDELAY_OT_frames_from_markers(bpy.types.Operator):
    """Search only between the markers around the current frame"""

    bl_idname = "roundelay.frames_from_markers"
    bl_label = "Range from Markers"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: Context) -> State:
        """Set the frame range."""
        scene, settings = context.scene, context.scene.roundelay
        frames = sorted(marker.frame for marker in scene.timeline_markers)
        before = [frame for frame in frames if frame <= scene.frame_current]
        after = [frame for frame in frames if frame > scene.frame_current]
        if not before:
            self.report({"ERROR"}, "there is no marker before the current frame")
            return {"CANCELLED"}
        settings.use_frames, settings.first_frame = True, before[-1]
        settings.frame_count = after[0] - before[-1] if after else 1_000_000
        return {"FINISHED"}


CLASSES = (ROUNDELAY_OT_segment, ROUNDELAY_OT_frames_from_markers)
