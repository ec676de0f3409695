"""Loops as the browser shows them: what plays, and what is to be known of it."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from roundelay.cycles.cycle import Cycle
from roundelay.loops.options import LoopOptions
from roundelay.loops.recipe import Loop
from roundelay.loops.units import Lengths
from roundelay.motion.motion import Motion
from roundelay.output.figures.space import Space
from roundelay.output.page.capture import sampling_step
from roundelay.output.page.findings import loop_track
from roundelay.output.page.packing import Packer
from roundelay.timeline.evidence import Evidence

__all__ = ["loop_event", "verdict_event"]

Array = NDArray[np.float64]


def loop_event(
    motion: Motion, cycle: Cycle, space: Space, place: int, render: LoopOptions | None = None
) -> dict[str, Any]:
    """Describe a loop so that it can play, beside the take.

    Parameters
    ----------
    motion : Motion
        The take.
    cycle : Cycle
    space : Space
        Of the take.
    place : int
        Of the part, 0 being the first.
    render : LoopOptions, optional
        How it is written; the plain cycle by default.

    Returns
    -------
    dict
        ``loop``, packed, and the part's ``place``.
    """
    evidence, phase = cast("Evidence", cycle.evidence), cast("Array", cycle.phase)
    packer = Packer()
    held = render is not None and render.foot_lock
    record = {
        "parts": [list(run) for run in evidence.runs],
        "period": cycle.period,
        "repetitions": evidence.repetitions,
        "confidence": evidence.confidence,
        "limbs": list(evidence.partial),
        "chosen": evidence.coordinate.class_index,
        "classes": [_followed(evidence, sampling_step(motion), packer)],
        "loop": loop_track(motion, cycle, phase, space, packer, foot_lock=held),
    }
    return {"loop": packer.text(record), "place": place}


def _followed(evidence: Evidence, step: int, packer: Packer) -> dict[str, Any]:
    return {
        "bar": evidence.coordinate.class_index,
        "net": evidence.net,
        "total": evidence.total,
        "turns": packer.add(np.nan_to_num(evidence.turns[::step])),
    }


def verdict_event(loop: Loop, place: int) -> dict[str, Any]:
    """Describe whether a loop can be used, and its figures.

    Parameters
    ----------
    loop : Loop
    place : int
        Of the part, 0 being the first.

    Returns
    -------
    dict
        ``verdict``: its word, its reasons, and rows of name, value, and what the capture has; and
        the part's ``place``.
    """
    cycle, figures = loop.cycle, loop.quality
    lengths = Lengths.of(cycle.skeleton, loop.render.resize)
    size = cycle.skeleton.size
    speed = lengths.told_speed(cycle.speed).partition(" (")[0] if cycle.travels else "in place"
    rows = [
        ("Period", f"{cycle.period:.2f} s", f"{len(loop.motion)} frames"),
        ("Speed", speed, ""),
        (
            "Largest step at the join",
            f"{figures.seam_rotation:.1f}°",
            f"{figures.step_rotation:.1f}° elsewhere",
        ),
        (
            "Feet slide in a period",
            lengths.told(figures.loop_skate * size),
            f"{lengths.told(figures.capture_skate * size)} in the take",
        ),
        ("Made by", cycle.method, "changed at hand" if loop.parted else ""),
    ]
    if abs(cycle.turning) >= np.radians(1.0):
        rows.insert(2, ("Turns", f"{np.degrees(cycle.turning):.0f}°", "a period"))
    return {
        "verdict": {
            "word": loop.verdict.word,
            "reasons": list(loop.verdict.reasons),
            "rows": rows,
        },
        "place": place,
    }
