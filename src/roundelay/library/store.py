"""The files of a library: what it tells of its clips, and what it is searched by.

=================  ================================================================
``clips.jsonl``    one line a clip as it was done: see `roundelay.library.log`
``library.json``   one record a clip, the groups, the sums; checksums of itself and the others
``cycles.csv``     one row a cycle
``signatures.npz`` the cycles' signatures, by body
``library.duckdb`` the tables for other programs, and ``tables/``: see `roundelay.library.database`
``loops/``         the loops, in one folder a clip
=================  ================================================================
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.cells import cell
from roundelay.base.files import written_beside
from roundelay.compare.spectra import Body, Spectra
from roundelay.library.log import ARRAYS, Entry
from roundelay.library.sealed import checksum_of, sealed, unsealed

__all__ = [
    "CATALOGUE",
    "SIGNATURES",
    "TABLE",
    "Shelf",
    "read_catalogue",
    "read_shelves",
    "shelved",
    "write_catalogue",
    "write_shelves",
    "write_table",
]

CATALOGUE, SIGNATURES, TABLE = "library.json", "signatures.npz", "cycles.csv"

_COLUMNS = (
    "group",
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


@dataclass(frozen=True, eq=False)
class Shelf:
    """The cycles of one body: their numbers among all of a library, and their signatures."""

    numbers: NDArray[np.intp]
    spectra: Spectra


def shelved(entries: Sequence[Entry]) -> list[Shelf]:
    """Put the cycles of all entries, numbered in order, on one shelf a body."""
    numbers: dict[Body, list[int]] = {}
    parts: dict[Body, list[Spectra]] = {}
    count = 0
    for entry in entries:
        if entry.spectra is not None:
            body, many = entry.spectra.body, len(entry.spectra)
            numbers.setdefault(body, []).extend(range(count, count + many))
            parts.setdefault(body, []).append(entry.spectra)
            count += many
    return [Shelf(np.array(numbers[body]), Spectra.joined(parts[body])) for body in parts]


def write_shelves(shelves: Sequence[Shelf], path: Path) -> None:
    """Write the signatures of a library."""
    arrays: dict[str, Any] = {}
    for number, shelf in enumerate(shelves):
        body = shelf.spectra.body
        named = {
            "numbers": shelf.numbers,
            "joints": np.array(body.joints),
            "partners": np.array(body.partners),
        }
        named |= {name: getattr(shelf.spectra, name) for name in ARRAYS}
        arrays |= {f"{name}_{number}": array for name, array in named.items()}
    with written_beside(path, durable=True) as part:
        np.savez(part, **arrays)


def read_shelves(path: Path) -> list[Shelf]:
    """Read the signatures of a library."""
    shelves = []
    with np.load(path) as file:
        for number in range(sum(name.startswith("numbers_") for name in file.files)):
            joints, partners = (file[f"{name}_{number}"] for name in ("joints", "partners"))
            body = Body(tuple(joints.tolist()), tuple(partners.tolist()))
            arrays = [file[f"{name}_{number}"] for name in ARRAYS]
            shelves.append(Shelf(file[f"numbers_{number}"], Spectra(body, *arrays)))
    return shelves


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
