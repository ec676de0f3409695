"""The files of a library: what it tells of its clips, and what it is searched by.

=================  ================================================================
``clips.jsonl``    one line a clip as it was done: see `roundelay.library.log`
``library.json``   one record a clip, the groups, the sums; checksums of itself and the others
``cycles.csv``     one row a cycle
``signatures/``    what behaviours are compared by: see `roundelay.library.shelves`
``library.duckdb`` the tables for other programs, and ``tables/``: see `roundelay.library.database`
``loops/``         the loops, in one folder a clip
=================  ================================================================
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from roundelay.base.cells import cell
from roundelay.base.files import written_beside
from roundelay.library.sealed import checksum_of, sealed, unsealed

__all__ = ["CATALOGUE", "TABLE", "read_catalogue", "write_catalogue", "write_table"]

CATALOGUE, TABLE = "library.json", "cycles.csv"

_COLUMNS = (
    "group",
    "name",
    "period_seconds",
    "period_frames",
    "repetitions",
    "confidence",
    "speed",
    "speed_in_sizes",
    "turning_degrees",
    "loop",
)
_FIGURES = ("template_error", "seam_rotation")


def write_catalogue(record: dict[str, Any], folder: Path, names: Sequence[str]) -> None:
    """Write what a library tells of its clips, with checksums of the files beside it."""
    beside = {name: checksum_of(folder / name) for name in names}
    with written_beside(folder / CATALOGUE, durable=True) as part:
        part.write_bytes(sealed(record | {"checksums": beside}, indent=1))


def read_catalogue(folder: Path) -> dict[str, Any] | None:
    """Read what a library tells of its clips; None if that is not as it was written.

    Raises
    ------
    OSError
        If it cannot be read.
    """
    record = unsealed((folder / CATALOGUE).read_bytes())
    if record is not None:
        del record["crc32"]
    return record


def write_table(clips: Sequence[dict[str, Any]], path: Path) -> None:
    """Write one row a cycle as CSV with a heading; frames half-open."""
    with (
        written_beside(path, durable=True) as part,
        # Names of files may hold bytes that are no text.
        part.open("w", encoding="utf-8", errors="surrogateescape", newline="") as file,
    ):
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["file", "frames", *_COLUMNS, *_FIGURES, "verdict"])
        for clip in clips:
            for cycle in clip["cycles"]:
                frames = " ".join(f"{start}-{stop}" for start, stop in cycle["parts"])
                values = [cycle[column] for column in _COLUMNS]
                figures = [cycle["quality"][name] for name in _FIGURES]
                row = [clip["file"], frames, *values, *figures, cycle["verdict"]["word"]]
                writer.writerow(map(_cell, row))


def _cell(value: Any) -> Any:
    if isinstance(value, str):
        return cell(value)
    return f"{value:.6g}" if isinstance(value, float) else value
