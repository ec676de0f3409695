"""Results as plain data: what a loop was made from, how, and how good it is."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from roundelay.base.errors import NoPeriod
from roundelay.base.files import written_beside
from roundelay.base.version import __version__
from roundelay.cycles.cycle import Cycle
from roundelay.loops.quality import Quality
from roundelay.loops.recipe import Loop
from roundelay.loops.units import Lengths
from roundelay.loops.verdict import Verdict
from roundelay.motion.floating import PointsLayout
from roundelay.motion.motion import Motion
from roundelay.timeline.evidence import Evidence
from roundelay.timeline.options import Options
from roundelay.topology.rips import Barcode

__all__ = [
    "capture_record",
    "cycle_record",
    "evidence_record",
    "loop_record",
    "refusal_record",
    "verdict_record",
    "write_json",
]

# More bars than this are noise that nobody reads.
_MOST_BARS = 100


def capture_record(motion: Motion, path: Path, options: Options | dict[str, Any]) -> dict[str, Any]:
    """Describe the capture, the options and the version that read it."""
    return {
        "roundelay": __version__,
        "capture": {
            "file": path.name,
            "frames": len(motion),
            "fps": round(motion.fps, 6),
            "seconds": round(motion.duration, 6),
            "joints": motion.skeleton.n_joints,
            "up": "XYZ"[motion.up],
            **_gaps_record(motion),
        },
        "options": options if isinstance(options, dict) else asdict(options),
    }


def _gaps_record(motion: Motion) -> dict[str, Any]:
    """Describe what was missing of points; nothing where the capture has none."""
    layout = motion.skeleton.layout
    if not isinstance(layout, PointsLayout):
        return {}
    gaps = [
        {"point": gap.point, "frames": [gap.start, gap.stop], "filled": gap.way}
        for gap in layout.gaps
    ]
    return {"points": len(layout.names), "gaps": gaps}


def cycle_record(cycle: Cycle, figures: Quality, files: Sequence[Path] = ()) -> dict[str, Any]:
    """Describe a cycle: period, parts, barcode, coordinate, travel and quality."""
    record: dict[str, Any] = {
        "period_seconds": cycle.period,
        "period_frames": cycle.period * cycle.fps,
        "method": cycle.method,
        "travel": cycle.travel.tolist(),
        "turning_degrees": float(np.degrees(cycle.turning)),
        "quality": {name: _finite(value) for name, value in asdict(figures).items()},
        "files": [path.name for path in files],
    }
    return record | ({} if cycle.evidence is None else evidence_record(cycle.evidence))


def loop_record(loop: Loop, files: Sequence[Path] = ()) -> dict[str, Any]:
    """Describe a loop: its verdict, its cycle, its frames and what players need."""
    return (
        {"verdict": verdict_record(loop.verdict, loop.cycle, loop.render.resize)}
        | cycle_record(loop.cycle, loop.quality, files)
        | {"loop_frames": len(loop.motion), "playback": loop.playback}
    )


def verdict_record(verdict: Verdict, cycle: Cycle, resized: float = 1.0) -> dict[str, Any]:
    """Describe whether a loop, whose lengths were multiplied, can be used, and how fast it goes."""
    lengths = Lengths.of(cycle.skeleton, resized)
    return {
        "word": verdict.word,
        "reasons": list(verdict.reasons),
        "speed": cycle.speed,
        "travels": cycle.travels,
        "body_size": lengths.size,
        "metres_a_unit": lengths.metres,
    }


def refusal_record(refusal: NoPeriod) -> dict[str, Any]:
    """Describe why no cycle was made, with the barcode of the best candidate."""
    found = refusal.evidence
    evidence: dict[str, Any] | None = None
    if isinstance(found, Evidence):
        evidence = evidence_record(found)
    elif isinstance(found, Barcode):
        evidence = {"barcode": _bars(found)}
    return {"cycles": [], "picture": None, "reason": str(refusal), "evidence": evidence}


def evidence_record(evidence: Evidence) -> dict[str, Any]:
    """Describe what was measured of one motion."""
    inside = [evidence.turns[start:stop] for start, stop in evidence.runs]
    behaviour = evidence.behaviour
    return {
        "parts": [list(run) for run in evidence.runs],
        "repetitions": evidence.repetitions,
        "confidence": evidence.confidence,
        "kind": "closed" if evidence.closed else "cyclic",
        "limbs": list(evidence.partial),
        "paused": [] if behaviour is None else [list(span) for span in behaviour.paused],
        "phase": "alignment" if evidence.aligned else "coordinate",
        "prominence": _finite(evidence.prominence),
        "steadiness": evidence.steadiness,
        "class": evidence.coordinate.class_index,
        "companions": list(evidence.companions),
        "scale": evidence.coordinate.scale,
        "prime": evidence.barcode.prime,
        "barcode": _bars(evidence.barcode),
        "turns": [np.round(values, 5).tolist() for values in inside],
    }


def _finite(value: float) -> float | None:
    """Return a number, or None for one that JSON does not know."""
    return value if isfinite(value) else None


def _bars(barcode: Barcode) -> list[list[float]]:
    ends = zip(barcode.births[:_MOST_BARS], barcode.deaths[:_MOST_BARS], strict=True)
    return [[round(float(birth), 6), round(float(death), 6)] for birth, death in ends]


def write_json(record: dict[str, Any], path: Path) -> None:
    """Write a record, whole or not at all."""
    with written_beside(path) as part:
        part.write_text(json.dumps(record, indent=1, allow_nan=False) + "\n", encoding="utf-8")
