# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators that find loops: of all selected armatures, and the classes behind them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from math import degrees
from typing import Any

import bpy

from roundelay import (
    Loop,
    LoopOptions,
    NoPeriod,
    Options,
    RoundelayError,
    SkeletonMismatch,
    find_cycles,
    segment,
)
from roundelay.loops.recipe import made_loop
from roundelay.pipeline import cycles_in_segments
from roundelay.timeline.inspection import Inspection, inspect

from . import plots
from .bones import left_out
from .capture import Capture, armatures_of, has_armature, read_capture
from .checking import Played
from .compat import Armature, Context
from .exact import nearer
from .jobs import LongOperator, Progress, Steps, threaded
from .loops import cycles_by_hand, loop_of, moved_apart, options_of, render_of
from .making import NotKept, finish, make_action

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
    _require_possible(capture, settings)
    if context.mode != "POSE" and capture.rig is not None:
        names = [bone.name for bone in capture.rig.bones]
        settings.notes += "".join(f"{whose}{line}\n" for line in left_out(armature, names))
    options = options_of(settings)
    output = context.scene.render
    try:
        render = render_of(settings, output.fps / output.fps_base)
        if capture.rig is None:
            render = replace(render, repair=False)
        search = partial(_search, capture, options, settings.per_behaviour, render)
        found = yield from threaded(search)
    except NoPeriod as refusal:
        raise NoPeriod(capture.in_scene(str(refusal))) from refusal
    yield from _make(context, capture, found, settings)


def _require_possible(capture: Capture, settings: Any) -> None:
    """Check that what is asked for can be done with the rig, and here."""
    if settings.use_plots:
        plots.folder_of(settings)
    if not settings.mirror:
        return
    if capture.rig is None:
        raise SkeletonMismatch(
            f"{capture.armature.name} moves by controls, which are not mirrored: switch Mirror off"
        )
    capture.rig.require_both_sides()


def _make(context: Context, capture: Capture, found: list[Loop], settings: Any) -> Steps[None]:
    """Write the loops that play as was meant; the first one is shown."""
    kept, faults = [], []
    for number, made in enumerate(found, 1):
        name = f"Periodic {capture.take.action.name}" + (f" {number}" if number > 1 else "")
        steps = make_action(capture, made, name, context.scene, settings)
        try:
            while True:
                yield next(steps), f"playing {name}"
        except StopIteration as end:
            action, played = end.value
        except NotKept as fault:
            faults.append(f"{name} {fault}")
            continue
        settings.notes += moved_apart(made.parted)
        _report(settings, capture, action, made, played)
        kept.append(action)
        if settings.use_plots:
            _plot(context, capture, made, action.name)
    settings.notes += "".join(f"{fault}\n" for fault in faults)
    if not kept:
        raise NotKept(faults[0])
    for action in kept:
        finish(capture, action, settings, first=action == kept[0])


def _plot(context: Context, capture: Capture, made: Loop, name: str) -> None:
    settings, output = context.scene.roundelay, context.scene.render
    loop = loop_of(made, capture.motion, settings, output.fps / output.fps_base)
    plots.write(capture.motion, made.cycle, loop, plots.folder_of(settings), name)


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
    if options.method == "auto" and capture.rig is not None:
        cycles = [nearer(cycle, motion, render.fps or motion.fps) for cycle in cycles]
    return [made_loop(cycle, motion, render) for cycle in cycles]


def _report(
    settings: Any, capture: Capture, action: bpy.types.Action, made: Loop, played: Played
) -> None:
    item, cycle, figures = settings.loops.add(), made.cycle, made.quality
    item.armature = capture.armature
    item.by_hand, item.away, item.join = bool(capture.chosen), played.away, played.join
    item.controls = capture.rig is None
    item.verdict = str(made.verdict)
    item.action, item.period, item.turning = action, cycle.period, degrees(cycle.turning)
    evidence: Any = cycle.evidence
    item.frames = capture.in_scene(f"Frames {_listed(evidence.runs)}")
    item.repetitions, item.confidence = figures.repetitions, evidence.confidence or 0.0
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
