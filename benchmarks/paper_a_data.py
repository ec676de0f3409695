"""Captures and published figures of [A]: table 1 and figures 7, 9, 10, 11; captures to join."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import roundelay as rl
from benchmarks.raunio import find_capture

__all__ = ["FRAMES_A_SECOND", "KINDS", "ROWS", "Row", "excerpt"]

Frames = tuple[int, int]
FRAMES_A_SECOND = 11.8
"""What [A] says of its speed, from poses to cycle."""
SLASHES = (0, 280, 515, 750, 1020, 1235, 1445, 1500, 1680, 1815, 1945, 2025, 2247)


@dataclass(frozen=True)
class Row:
    """A row of table 1: frames, birth of the class, largest scale, seconds of cohomology.

    Behaviours are those of the figures' captions, with their frames.
    """

    frames: Frames
    born: float
    end: float
    seconds: float
    behaviours: dict[str, tuple[Frames, ...]] = field(default_factory=dict)

    def figures(self) -> dict[str, Any]:
        return asdict(self)


ROWS = {
    "01_09": Row(
        (0, 4238), 8.98, 50.0, 64.21,
        {
            "walking": ((0, 293), (1961, 2136)),
            "climbing": ((294, 617), (2137, 2745)),
            "dangling feet": ((618, 1483), (2745, 3880)),
            "jumping down": ((1484, 1960),),
        },
    ),
    "02_07": Row(
        (0, 2247), 23.04, 50.0, 108.86,
        {f"slash {a}": ((a, b),) for a, b in pairwise(SLASHES)},
    ),
    "05_13": Row(
        (0, 1091), 40.92, 50.0, 7.04,
        {
            "balance": ((0, 275),),
            "skip": ((276, 495),),
            "first pirouette": ((495, 700),),
            "second pirouette": ((701, 840),),
            "final pose": ((841, 1095),),
        },
    ),
    "13_29": Row((0, 1200), 19.36, 30.0, 11.04),
    "143_23": Row((100, 500), 5.66, 30.0, 12.72),
}  # fmt: skip

# Captures, or frames of one, that show one motion.
KINDS: dict[str, list[tuple[str, Frames | None]]] = {
    "walk": [(n, None) for n in ("02_01", "07_01", "07_05", "08_02", "08_11", "05_01", "08_07")],
    "run": [(n, None) for n in ("02_03", "09_01", "09_09", "16_35", "16_45", "09_05")],
    "jacks": [("13_29", (0, 488))],
    "jump": [("86_01", (560, 1060))],
    "arms": [("13_29", (1195, 1460))],
    "punch": [("86_01", (2160, 2480))],
}


def excerpt(data: Path, name: str, frames: Frames | None) -> rl.Motion:
    """Read a capture, or some frames of it."""
    motion = find_capture(data, name)
    return motion if frames is None else motion[slice(*frames)]
