# SPDX-License-Identifier: GPL-3.0-or-later
"""What is searched: the armatures asked for, and what each does in the frames asked for."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import ceil, floor
from typing import Any

import bpy

from roundelay import Motion, SkeletonMismatch

from .compat import Armature, Context
from .jobs import Steps
from .loops import Chosen
from .reading import Reading, read
from .rig import Rig, rig_of
from .writing import captured, show

_RANGE = re.compile(r"\b(\d+)-(\d+)\b")


@dataclass
class Capture:
    """An armature's action as read for the search: every step-th frame from the first on."""

    rig: Rig
    action: bpy.types.Action
    first: int
    step: int
    reading: Reading
    chosen: Chosen

    @property
    def motion(self) -> Motion:
        """The bones' motion."""
        return self.reading.motion

    def in_scene(self, text: str) -> str:
        """Give a text's ranges of frames, 57-893, as frames of the scene."""
        return _RANGE.sub(
            lambda ends: "-".join(str(self.first + int(end) * self.step) for end in ends.groups()),
            text,
        )


def armatures_of(context: Context) -> list[Armature]:
    """Return the armatures to work on: in Pose Mode those in it, else the selected ones."""
    if context.mode == "POSE":
        return [o for o in context.objects_in_mode if o.type == "ARMATURE"]
    selected = [o for o in context.selected_objects if o.type == "ARMATURE"]
    active = context.active_object
    return selected or ([active] if active is not None and active.type == "ARMATURE" else [])


def has_armature(operator: Any, context: Context) -> bool:
    """Tell whether an operator has an armature and no other work in progress."""
    if not armatures_of(context):
        operator.poll_message_set("Select an armature")
        return False
    return not operator.busy


def read_capture(context: Context, armature: Armature, settings: Any) -> Steps[Capture]:
    """Read what an armature does in the chosen frames; a loop gives way to its capture."""
    data = armature.animation_data
    if data is None or data.action is None:
        raise SkeletonMismatch(f"{armature.name} has no action")
    action = captured(data.action)
    if action != data.action:
        show(armature, action)
    chosen = None
    if context.mode == "POSE":
        chosen = {bone.name for bone in context.selected_pose_bones if bone.id_data == armature}
    rig, frames = rig_of(armature, chosen), _frames(action, settings)
    reading = read(rig, context.scene, frames)
    while True:
        try:
            yield next(reading), f"reading {armature.name}"
        except StopIteration as end:
            thin = end.value.subsampled(settings.subsample)
            chosen_classes = _chosen(settings, armature)
            return Capture(rig, action, frames.start, settings.subsample, thin, chosen_classes)


def _frames(action: bpy.types.Action, settings: Any) -> range:
    """Return the action's frames as far as they are asked for."""
    start, last = ceil(action.frame_range[0]), floor(action.frame_range[1])
    if settings.use_frames:
        start = max(start, settings.first_frame)
        last = min(last, start + settings.frame_count - 1)
    if last <= start:
        raise SkeletonMismatch(f"{action.name} has no frames in the chosen range")
    return range(start, last + 1)


def _chosen(settings: Any, armature: Armature) -> Chosen:
    return [
        (c.motion, c.index) for c in settings.classes if c.chosen and c.armature == armature.name
    ]
