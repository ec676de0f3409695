"""``roundelay info``: what a file holds, before anything is made of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from roundelay.base.files import name_of
from roundelay.base.texts import shown
from roundelay.commands.common import (
    Capture,
    Json,
    Skeleton,
    echo,
    one_line_errors,
    print_json,
    read_capture,
)
from roundelay.commands.options import takes
from roundelay.formats.options import ReadOptions


@takes(reading=ReadOptions)
def info(
    capture: Capture,
    skeleton: Skeleton = None,
    json: Json = False,
    *,
    reading: ReadOptions,
) -> None:
    """Tell what a file holds: animations, skeletons, frames, axes, unit.

    Animations and skeletons are listed by the names that --animation and --character take.

    Exit code 0: the file can be read; 2: it cannot.
    """
    with one_line_errors(capture):
        record = _record(capture, skeleton, reading)
        if json:
            print_json(record)
        else:
            _print(record)


def _record(capture: Path, skeleton: Path | None, reading: ReadOptions) -> dict[str, Any]:
    from roundelay.formats import besides_motion, contents_of
    from roundelay.loops.units import Lengths

    held = contents_of(capture, reading.suffix)
    motion = read_capture(capture, skeleton, reading)
    lengths = Lengths.of(motion.skeleton)
    return {
        "file": name_of(capture),
        "animations": list(held.animations),
        "characters": list(held.characters),
        "besides": list(besides_motion(capture)) if reading.suffix is None else [],
        "conventions": held.conventions,
        "frames": len(motion),
        "fps": motion.fps,
        "seconds": motion.duration,
        "joints": motion.skeleton.n_joints,
        "root": motion.skeleton.names[0],
        "up": "XYZ"[motion.up],
        "body_size": lengths.size,
        "metres_a_unit": lengths.metres,
    }


def _print(record: dict[str, Any]) -> None:
    echo(
        f"{shown(record['file'])}: {record['frames']} frames at {record['fps']:.4g} fps, "
        f"{record['seconds']:.1f} s, {record['joints']} joints below {shown(record['root'])!r}"
    )
    for title in ("animations", "characters", "besides"):
        if record[title]:
            echo(f"  {title}: {', '.join(map(shown, record[title]))}")
    told = [f"{key} {value}" for key, value in record["conventions"].items()]
    if told:
        echo(f"  the file says: {', '.join(map(shown, told))}")
    metres = record["metres_a_unit"]
    unit = "of no person in any unit" if metres is None else f"a unit of {metres:g} m"
    echo(f"  the poses say: up {record['up']}, a body of {record['body_size']:.4g}, {unit}")
