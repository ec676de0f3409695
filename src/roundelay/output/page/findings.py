"""What was found in the capture, as the page shows it: one record a motion."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import NoPeriod
from roundelay.cycles.cycle import Cycle
from roundelay.loops.recipe import Loop
from roundelay.motion.features import point_cloud
from roundelay.motion.motion import Motion
from roundelay.output.figures.space import Space
from roundelay.output.page.capture import sampling_step
from roundelay.output.page.feet import loop_feet
from roundelay.output.page.packing import Packer
from roundelay.output.page.table import quality_rows
from roundelay.timeline.evidence import Evidence, class_coordinate, turns_of
from roundelay.topology.rips import Barcode

__all__ = ["loop_data", "loop_track", "refusal_data"]

Array = NDArray[np.float64]

# Bars drawn, and among them those with a coordinate to look at.
_BARS, _CLASSES = 16, 5
_LOOP_FPS, _LOOP_FRAMES = 40.0, 240


def loop_data(
    motion: Motion, loop: Loop, space: Space, packer: Packer, *, file: str
) -> dict[str, Any]:
    """Describe one periodic motion and its loop.

    Parameters
    ----------
    motion : Motion
        The capture.
    loop : Loop
        Made of it.
    space : Space
    packer : Packer
    file : str
        Name for the loop when it is saved.
    """
    cycle = loop.cycle
    # A loop is made of what was found, by the phase of its frames.
    evidence, phase = cast("Evidence", cycle.evidence), cast("Array", cycle.phase)
    record = _evidence(motion, evidence, packer, cycle)
    return record | {
        "verdict": str(loop.verdict),
        "period": cycle.period,
        "repetitions": evidence.repetitions,
        "confidence": evidence.confidence,
        "limbs": list(evidence.partial),
        "travel": float(np.linalg.norm(cycle.travel)) / space.size,
        "turning": float(np.degrees(cycle.turning)),
        "loop": loop_track(motion, cycle, phase, space, packer),
        "quality": quality_rows(loop.quality),
        "file": file,
        "bvh": _bvh(loop, packer),
    }


def refusal_data(motion: Motion, refusal: NoPeriod, packer: Packer) -> list[dict[str, Any]]:
    """Describe the best candidate of a capture with no period, if there was one."""
    found = refusal.evidence
    if isinstance(found, Evidence):
        return [_evidence(motion, found, packer, None)]
    if isinstance(found, Barcode):
        return [{"parts": [], "bars": _bars(found), "hidden": max(0, len(found) - _BARS)}]
    return []


def _evidence(
    motion: Motion, evidence: Evidence, packer: Packer, cycle: Cycle | None
) -> dict[str, Any]:
    points = point_cloud(motion.with_root_motion())
    return {
        "parts": [list(run) for run in evidence.runs],
        "lead": min(evidence.prominence, 1e6),
        "bars": _bars(evidence.barcode),
        "hidden": max(0, len(evidence.barcode) - _BARS),
        "chosen": evidence.coordinate.class_index,
        "classes": _classes(evidence, sampling_step(motion), packer),
        "plane": _plane(points, evidence, sampling_step(motion), packer, cycle),
    }


def _bars(barcode: Barcode) -> list[list[float]]:
    deaths = np.minimum(barcode.deaths, barcode.max_scale)
    ends = zip(barcode.births[:_BARS], deaths[:_BARS], strict=True)
    return [[round(float(birth), 5), round(float(death), 5)] for birth, death in ends]


def _classes(evidence: Evidence, step: int, packer: Packer) -> list[dict[str, Any]]:
    """Compute the coordinate over time of the longest bars, and of the chosen one."""
    wanted = {*range(min(_CLASSES, len(evidence.barcode))), evidence.coordinate.class_index}
    classes = []
    for number in sorted(wanted):
        turns = _turns(evidence, number)
        if turns is not None:
            moved = [np.diff(turns[start:stop]) for start, stop in evidence.runs]
            classes.append({
                "bar": number,
                "net": sum(float(part.sum()) for part in moved),
                "total": sum(float(abs(part).sum()) for part in moved),
                "turns": packer.add(np.nan_to_num(turns[::step])),
            })  # fmt: skip
    return classes


def _turns(evidence: Evidence, number: int) -> Array | None:
    """Return the unwrapped coordinate (F,) of a class; None where there is none."""
    cloud = evidence.cloud
    if number == evidence.coordinate.class_index:
        return evidence.turns
    if cloud is None:
        return None
    try:
        coordinate = class_coordinate(cloud, number)
    except NoPeriod:
        return None
    return turns_of(cloud, coordinate, len(evidence.turns))[0]


def _plane(
    points: Array, evidence: Evidence, step: int, packer: Packer, cycle: Cycle | None
) -> dict[str, Any]:
    """Project capture and cycle on the motion's first two principal components."""
    inside = evidence.runs.frames
    centre = points[inside].mean(axis=0)
    _, spread, axes = np.linalg.svd(points[inside] - centre, full_matrices=False)
    plane = axes[:2].T
    shares = spread[:2] ** 2 / max(float(np.sum(spread**2)), 1e-12)
    record: dict[str, Any] = {"shares": shares.tolist()}
    record["capture"] = packer.add((points[::step] - centre) @ plane, common_step=True)
    if cycle is not None:
        around = cycle.at(np.linspace(0.0, 1.0, 181), frame_time=0.01).with_root_motion()
        record["loop"] = packer.add((point_cloud(around) - centre) @ plane, common_step=True)
    return record


def loop_track(
    motion: Motion,
    cycle: Cycle,
    phase: Array,
    space: Space,
    packer: Packer,
    *,
    foot_lock: bool = False,
) -> dict[str, Any]:
    """Sample one period, its end included, and the phase of the capture's frames in it.

    Parameters
    ----------
    motion : Motion
        The capture.
    cycle : Cycle
    phase : (F,) ndarray
        Of the capture's frames, in turns.
    space : Space
    packer : Packer
    foot_lock : bool
        Hold standing feet, as in a file.
    """
    count = int(np.clip(round(cycle.period * _LOOP_FPS), 8, _LOOP_FRAMES))
    if foot_lock:
        period = cycle.sample(count / cycle.period, repeat_first=True)
    else:
        period = cycle.at(np.arange(count + 1) / count, frame_time=1.0 / _LOOP_FPS)
    return {
        "points": packer.add(space.points(period).reshape(len(period), -1), common_step=True),
        "turning": cycle.turning,
        "feet": loop_feet(cycle),
        "phase": packer.add(np.nan_to_num(phase[:: sampling_step(motion)])),
    }


def _bvh(loop: Loop, packer: Packer) -> dict[str, Any]:
    """Return the loop as the head of a BVH file and its rows of numbers."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "loop.bvh"
        loop.write(path)
        lines = path.read_text(encoding="utf-8").splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("Frame Time")) + 1
    values = np.array([line.split() for line in lines[first:]], float)
    # A thousandth of a degree, and of a hundredth of a body.
    decimals = max(3, 5 - int(np.floor(np.log10(loop.cycle.skeleton.size))))
    return {
        "head": "\n".join(lines[:first]),
        "decimals": decimals,
        "rows": packer.add_decimals(values, decimals),
    }
