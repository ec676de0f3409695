# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators that find loops: of all selected armatures, and the classes behind them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from math import degrees
from typing import Any

import bpy

from roundelay import (
    Loop,
    LoopOptions,
    Motion,
    NoPeriod,
    Options,
    RoundelayError,
    find_cycles,
    segment,
)
from roundelay.loops.recipe import made_loop
from roundelay.pipeline import cycles_in_segments
from roundelay.timeline.inspection import Inspection, inspect

from . import plots
from .bones import left_out
from .capture import Capture, armatures_of, has_armature, read_capture
from .compat import Armature, Context
from .jobs import LongOperator, Progress, Steps, threaded
from .loops import cycles_by_hand, loop_of, moved_apart, options_of, render_of
from .writing import PLACE, SOURCE, add_strip, show, write_loop

# How many ranges of frames are listed.
_SHOWN = 3


class ROUNDELAY_OT_extract(LongOperator, bpy.types.Operator):
    """Find what repeats in the actions of the selected armatures, and make seamless loops of it"""

    bl_idname = "roundelay.extract"
    bl_label = "Extract Periodic Motion"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Work needs an armature."""
        return has_armature(cls, context)

    def steps(self, context: Context) -> Steps[str]:
        """Read, search and write, one armature after the other."""
        settings, armatures = context.scene.roundelay, armatures_of(context)
        settings.loops.clear()
        settings.notes = ""
        faults: list[str] = []
        for armature in armatures:
            whose = f"{armature.name}: " if len(armatures) > 1 else ""
            try:
                yield from _extract(context, armature, settings, whose)
            except (RoundelayError, ValueError) as fault:
                faults.append(f"{whose}{fault}")
        made = len(settings.loops)
        if not made:
            raise RoundelayError(faults[0])
        return "; ".join([f"Made {made} loop{'s' if made > 1 else ''}", *faults])


def _extract(context: Context, armature: Armature, settings: Any, whose: str) -> Steps[None]:
    capture = yield from read_capture(context, armature, settings)
    if settings.mirror:
        capture.rig.require_both_sides()
    if context.mode != "POSE":
        names = [bone.name for bone in capture.rig.bones]
        settings.notes += "".join(f"{whose}{line}\n" for line in left_out(armature, names))
    options = options_of(settings)
    output = context.scene.render
    fps = output.fps / output.fps_base
    try:
        render = render_of(settings, fps)
        search = partial(_search, capture, options, settings.per_behaviour, render)
        found = yield from threaded(search)
    except NoPeriod as refusal:
        raise NoPeriod(capture.in_scene(str(refusal))) from refusal
    for number, made in enumerate(found, 1):
        settings.notes += moved_apart(made.parted)
        loop = loop_of(made.cycle, capture.motion, settings, fps)
        action = _write(capture, loop, number, settings)
        _report(settings, capture, action, made)
        if settings.use_plots:
            folder = bpy.path.abspath(settings.plot_folder)
            plots.write(capture.motion, made.cycle, loop, folder, action.name)


def _search(
    capture: Capture, options: Options, per_behaviour: bool, render: LoopOptions, progress: Progress
) -> list[Loop]:
    """Find cycles and make their loops; touches no Blender data."""
    motion = capture.motion
    if capture.chosen:
        cycles = cycles_by_hand(motion, options, capture.chosen)
    elif per_behaviour:
        cycles = cycles_in_segments(segment(motion), motion, options, progress=progress)
    else:
        cycles = find_cycles(motion, options, progress=progress)
    progress(1.0, "measuring loops")
    return [made_loop(cycle, motion, render) for cycle in cycles]


def _write(capture: Capture, loop: Motion, number: int, settings: Any) -> bpy.types.Action:
    """Make the action of a loop; the first one is shown."""
    name = f"Periodic {capture.action.name}" + (f" {number}" if number > 1 else "")
    armature = capture.rig.armature
    action = write_loop(capture.rig, loop, name, start=capture.first, key_step=settings.key_step)
    action[SOURCE] = capture.action
    if capture.reading.place is not None:
        action[PLACE] = capture.reading.place.ravel().tolist()
    capture.action.use_fake_user = True
    if settings.use_strip:
        add_strip(armature, action, settings.repeat)
    if number == 1:
        show(armature, action)
    return action


def _report(settings: Any, capture: Capture, action: bpy.types.Action, made: Loop) -> None:
    item, cycle, figures = settings.loops.add(), made.cycle, made.quality
    item.verdict = str(made.verdict)
    item.action, item.period, item.turning = action, cycle.period, degrees(cycle.turning)
    item.frames = capture.in_scene(f"Frames {_listed(cycle.evidence.runs)}")
    item.repetitions, item.confidence = figures.repetitions, cycle.evidence.confidence or 0.0
    item.seam, item.step = figures.seam_rotation, figures.step_rotation


def _listed(runs: Sequence[tuple[int, int]]) -> str:
    shown = ", ".join(f"{start}-{stop}" for start, stop in runs[:_SHOWN])
    return shown if len(runs) <= _SHOWN else f"{shown} and {len(runs) - _SHOWN} more"


class ROUNDELAY_OT_inspect(LongOperator, bpy.types.Operator):
    """List the classes of the poses, to choose by hand which ones become loops"""

    bl_idname = "roundelay.inspect"
    bl_label = "List Classes"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Work needs an armature."""
        return has_armature(cls, context)

    def steps(self, context: Context) -> Steps[str]:
        """Read and inspect, one armature after the other."""
        settings = context.scene.roundelay
        settings.classes.clear()
        for armature in armatures_of(context):
            capture = yield from read_capture(context, armature, settings)
            found = yield from threaded(partial(_inspected, capture, options_of(settings)))
            for item, values in zip(_added(settings, found), _rows(found), strict=True):
                item.armature = armature.name
                for name, value in values.items():
                    setattr(item, name, value)
        return f"Found {len(settings.classes)} classes"


def _inspected(capture: Capture, options: Options, progress: Progress) -> list[Inspection]:
    return inspect(capture.motion, options)


def _added(settings: Any, found: Any) -> Iterator[Any]:
    for inspection in found:
        for _ in inspection.classes:
            yield settings.classes.add()


def _rows(found: Any) -> Iterator[dict[str, Any]]:
    """Describe every class; its bar's share of the longest is drawn."""
    longest = max(one.death - one.birth for item in found for one in item.classes)
    for number, inspection in enumerate(found):
        for one in inspection.classes:
            text = one.fault
            if one.evidence is not None:
                text = f"{one.evidence.net:.1f} turns of {one.evidence.period:.0f} frames"
            yield {
                "motion": number,
                "index": one.index,
                "birth": one.birth,
                "death": one.death,
                "share": (one.death - one.birth) / longest,
                "text": text,
            }


CLASSES = (ROUNDELAY_OT_extract, ROUNDELAY_OT_inspect)
