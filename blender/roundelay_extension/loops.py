# SPDX-License-Identifier: GPL-3.0-or-later
"""From the settings to roundelay and back: which cycles to look for, how their loops shall be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from roundelay import Cycle, LoopOptions, Motion, NoPeriod, Options, TopologyOptions
from roundelay.cycles.captured import as_shown
from roundelay.cycles.edit.separate import Mended
from roundelay.cycles.models.regression import fit_cycle
from roundelay.geometry import rotations as rot
from roundelay.loops.recipe import Rendered
from roundelay.phase.harmonic import HarmonicCurve
from roundelay.pipeline import make_cycle
from roundelay.timeline.inspection import inspect

from .exact import held

Chosen = Sequence[tuple[int, int]]


def options_of(settings: Any) -> Options:
    """Return the library's options for what the panel holds."""
    topology = TopologyOptions(
        prime=settings.prime,
        classes=settings.persistent or None,
        max_scale=settings.max_scale or None,
        scale=settings.scale or None,
        delay=settings.delay if settings.use_delay else None,
    )
    constrained = settings.method == "PAPER"
    return Options(
        topology=topology,
        harmonics=settings.harmonics or None,
        method=settings.method.lower(),
        velocity=settings.velocity or not constrained,
        acceleration=settings.acceleration or not constrained,
        most=settings.most or None,
    )


def cycles_by_hand(motion: Motion, options: Options, chosen: Chosen) -> list[Cycle]:
    """Make the cycles of classes chosen by hand, as (motion, class)."""
    found = inspect(motion, options, most=1 + max(index for _, index in chosen))
    return [_chosen_cycle(motion, found, options, *which) for which in chosen]


def cycle_of_loop(loop: Motion, period: int) -> Cycle:
    """Return the cycle whose repeated loop this is, `period` frames a turn."""
    phase = np.arange(len(loop)) / period
    runs = [(0, len(loop))]
    return as_shown(fit_cycle(loop.with_root_motion(), phase, runs), loop, phase)


def _chosen_cycle(motion: Motion, found: Any, options: Options, number: int, index: int) -> Cycle:
    classes = found[number].classes if number < len(found) else []
    if index >= len(classes):
        raise NoPeriod("the classes have changed; list them again")
    if classes[index].evidence is None:
        raise NoPeriod(f"class {index}: {classes[index].fault}")
    return make_cycle(motion, classes[index].evidence, options)


def render_of(settings: Any, fps: float) -> LoopOptions:
    """Return how the library shall make loops; what the armature needs besides, `loop_of` does."""
    return LoopOptions(
        fps=fps,
        in_place=settings.travel != "TRAVEL",
        repeat_first=True,
        foot_lock=settings.foot_lock,
        repair=settings.repair,
    )


def moved_apart(parted: Sequence[Mended]) -> str:
    """Say which limbs were moved apart, a line a pair."""
    lines = [
        f"{' and '.join(one.bones)} moved apart by up to {np.degrees(one.angle):.0f}\u00b0\n"
        for one in parted
    ]
    return "".join(lines)


def loop_of(made: Rendered, capture: Motion, settings: Any, fps: float) -> Motion:
    """Sample a loop as frames of the scene, the last one the first again, heading straight on."""
    cycle, lock = replace(made.cycle, turning=0.0), made.render.foot_lock
    if settings.travel_harmonics:
        cycle = replace(cycle, velocity=_first(cycle.velocity, settings.travel_harmonics))
    sampling = {"fps": fps, "start": settings.start_phase}
    light = lock and settings.method == "AUTO"
    sampling["foot_lock"] = lock and not light
    loop = cycle.sample(**sampling, repeat_first=True)
    if light:
        loop = held(cycle, loop, fps, settings.start_phase)
    loop = loop.with_root_motion()
    still = cycle.sample(**sampling, repeat_first=True, in_place=True).with_root_motion()
    none = np.zeros_like(loop.root_path)
    path = by_axis(settings, loop.root_path, still.root_path, none)
    begin = _beginning(cycle, capture, path)
    loop = replace(loop, root_path=path + begin)
    if cycle.above is not None:
        steady = cycle.steady_path(settings.start_phase + np.linspace(0.0, 1.0, len(loop)))
        flat = np.where(np.arange(3) == cycle.up, 0.0, begin)
        above = replace(cycle.above, places=cycle.above.places + flat)
        steady = by_axis(settings, steady, none, none)
        loop = above.given(loop, rot.identity(len(loop)), steady)
    return loop.mirror() if settings.mirror else loop


def by_axis(settings: Any, travel: np.ndarray, sway: np.ndarray, none: np.ndarray) -> np.ndarray:
    """Return the path (F, 3) of which every axis is what the panel says."""
    paths = {"TRAVEL": travel, "SWAY": sway, "NONE": none}
    models = [settings.travel] * 3
    if settings.travel == "AXES":
        models = [settings.travel_x, settings.travel_y, settings.travel_z]
    return np.column_stack([paths[model][:, axis] for axis, model in enumerate(models)])


def _beginning(cycle: Cycle, capture: Motion, path: np.ndarray) -> np.ndarray:
    """Return what puts a path where its capture was; its height stays as it is."""
    start, stop = cycle.evidence.runs[0] if cycle.evidence else (0, len(capture))
    seen = capture.with_root_motion().root_path[start:stop]
    travels = np.abs(path[-1] - path[0]) > 1e-9
    moved = np.where(travels, seen[0] - path[0], seen.mean(axis=0) - path.mean(axis=0))
    if np.ptp(path[:, cycle.up]) > 0.0:
        moved[cycle.up] = 0.0
    return moved


def _first(curve: HarmonicCurve, count: int) -> HarmonicCurve:
    return HarmonicCurve(
        curve.frequencies[:count], curve.constant, curve.sine[:count], curve.cosine[:count]
    )
