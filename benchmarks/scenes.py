"""FBX and glTF as they are read, beside Blender's importers; and what the fuzzer found.

Usage: python -m benchmarks.scenes --blenders PYTHONS [--real FOLDER] [--fuzz FILE ...] [--keep]

Each Blender, a Python that has bpy, makes FBX and glTF of one body in the options of its exporters
that matter (`benchmarks/inside/scenes.py`), and imports them; the first one those of ``--real``,
too. Our poses are compared with its own at up to 20 keyed frames: within .1 degree and .1 % of the
body's size they are equal. Of Blender's two importers of FBX the newer one, that of the Blender
named last, is asked where poses differ from the older one, which leaves out some movement.
``--fuzz`` names what ``python -m tests.fuzz`` printed, in one run or several.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
import warnings
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import roundelay as rl
from benchmarks._harness import Target, parser, report
from benchmarks._scenes import Compared, compared, made
from roundelay.formats import readers, suffixes_of

TARGETS = (
    Target("compared.fbx", ">=", 20, "FBX files compared with Blender's importers"),
    Target("compared.glb", ">=", 20, "glTF files compared with Blender's importers"),
    Target("poses_equal", ">=", 1, "share of files whose poses equal those of Blender"),
    Target("fuzz_runs", ">=", 1_000_000, "files of the fuzzer"),
    Target("other_exceptions", "==", 0, "files of the fuzzer that ended otherwise"),
)


def main() -> None:
    arguments = asking(parser(__doc__, data=None)).parse_args()
    warnings.simplefilter("ignore")
    result = measured(arguments)
    report("scenes", result, TARGETS, arguments, table=map(_line, result["scenes"]))


def asking(parser: argparse.ArgumentParser, *, needed: bool = True) -> argparse.ArgumentParser:
    """Add the options that say where Blenders, files and reports are."""
    parser.add_argument("--blenders", required=needed, help="Pythons with bpy, with commas between")
    parser.add_argument("--real", type=Path, help="folder of FBX and glTF files by others")
    parser.add_argument("--fuzz", type=Path, nargs="*", default=[], help="reports of tests.fuzz")
    return parser


def measured(arguments: argparse.Namespace) -> dict[str, Any]:
    """Compare poses with Blender's, and count what the fuzzer found."""
    pythons = [Path(one) for one in (arguments.blenders or "").split(",") if one]
    scenes = _scenes(pythons, arguments.real) if pythons else []
    return {"summary": _told(scenes, arguments.fuzz), "scenes": [vars(one) for one in scenes]}


def _scenes(blenders: Sequence[Path], real: Path | None) -> list[Compared]:
    """Compare files that each Blender makes, and those of others, with its importers."""
    others = [] if real is None else _animated(real)
    given = [others, *([[]] * (len(blenders) - 1))]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        last = [blenders[-1]] * len(blenders)
        return [row for rows in pool.map(_of_one, blenders, last, given) for row in rows]


def _of_one(python: Path, last: Path, others: list[Path]) -> list[Compared]:
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as work:
        return compared(python, [*made(python, Path(folder)), *others], Path(work), last)


def _animated(folder: Path) -> list[Path]:
    """List the files below a folder that hold an animation of a skeleton."""
    found = []
    for path in sorted(folder.rglob("*")):
        if path.suffix.lower() in (".fbx", ".glb", ".gltf"):
            try:
                rl.read(path)
            except rl.RoundelayError:
                continue
            found.append(path)
    return found


def _told(scenes: list[Compared], fuzz: Sequence[Path]) -> dict[str, Any]:
    """Return the figures of files of scenes and of the fuzzer; none of what was not done."""
    told: dict[str, Any] = {"formats_read": list(suffixes_of(readers))}
    if scenes:
        kinds = {kind: [one for one in scenes if one.kind == kind] for kind in ("fbx", "glb")}
        told |= {
            "compared": {kind: len(held) for kind, held in kinds.items()},
            "equal": {kind: sum(one.equal for one in held) for kind, held in kinds.items()},
            "poses_equal": sum(one.equal for one in scenes) / len(scenes),
            "degrees": max(one.degrees for one in scenes if one.equal),
            "not_equal": [one.file for one in scenes if not one.equal],
        }
    fuzzed = [json.loads(path.read_text()) for path in fuzz]
    for key in ("fuzz_runs", "other_exceptions", "hangs") if fuzzed else ():
        told[key] = sum(one[key] for one in fuzzed)
    return told


def _line(one: dict[str, Any]) -> str:
    word = "equal" if Compared(**one).equal else one["error"] or "NOT EQUAL"
    numbers = f"{one['joints']:5}{one['poses']:5}{one['degrees']:9.4f}{one['height']:10.6f}"
    return f"  {one['file']:44}{numbers}  {word}"


if __name__ == "__main__":
    main()
