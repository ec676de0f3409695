"""The files of a library: the log that a run goes on from, and what it is searched by.

=================  ================================================================
``clips.jsonl``    one line a clip as it was done, with signatures: the log
``library.json``   one record a clip, the groups, the sums
``cycles.csv``     one row a cycle
``signatures.npz`` the cycles' signatures, by body
``loops/``         the loops, in one folder a clip
=================  ================================================================
"""

from __future__ import annotations

import base64
import csv
import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError
from roundelay.base.files import written_beside
from roundelay.compare.spectra import Body, Spectra

__all__ = ["Entry", "Log", "Shelf", "read_shelves", "shelved", "write_shelves", "write_table"]

_ARRAYS: dict[str, Any] = {"means": np.float32, "waves": np.complex64, "reflections": np.float32}
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
class Entry:
    """What is known of a clip.

    Attributes
    ----------
    record : dict
        For people and programs; its name is under ``file``.
    stamp : dict or None
        The version of the file that was read.
    spectra : Spectra or None
        One a cycle.
    """

    record: dict[str, Any]
    stamp: dict[str, Any] | None
    spectra: Spectra | None = None


@dataclass(frozen=True, eq=False)
class Shelf:
    """The cycles of one body: their numbers among all of a library, and their signatures."""

    numbers: NDArray[np.intp]
    spectra: Spectra


class Log:
    """The entries of clips by their names, each on disk as soon as it is known."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / "clips.jsonl"
        self.entries: dict[str, Entry] = {}
        if self.path.exists():
            lines = self.path.read_text(encoding="utf-8").splitlines()
            found = [entry for entry in map(_entry, lines) if entry is not None]
            self.entries = {entry.record["file"]: entry for entry in found}

    def drop(self, names: Iterable[str]) -> None:
        """Forget entries, and write the others anew, one line each."""
        for name in names:
            self.entries.pop(name, None)
        with written_beside(self.path) as part:
            part.write_text("".join(map(_line, self.entries.values())), encoding="utf-8")

    def add(self, entry: Entry) -> None:
        """Add an entry in the place of one of the same name."""
        self.entries[entry.record["file"]] = entry
        with self.path.open("a", encoding="utf-8") as file:
            file.write(_line(entry))


def _line(entry: Entry) -> str:
    packed = None if entry.spectra is None else _packed(entry.spectra)
    line = {"record": entry.record, "stamp": entry.stamp, "signatures": packed}
    return json.dumps(line, allow_nan=False) + "\n"


def _entry(line: str) -> Entry | None:
    """Read a line; None if it was cut short when the machine stopped."""
    try:
        found = json.loads(line)
    except ValueError:
        return None
    packed = found["signatures"]
    return Entry(found["record"], found["stamp"], None if packed is None else _unpacked(packed))


def _packed(spectra: Spectra) -> dict[str, Any]:
    body = spectra.body
    arrays = {name: base64.b64encode(getattr(spectra, name).tobytes()).decode() for name in _ARRAYS}
    return {"joints": body.joints, "partners": body.partners, **arrays}


def _unpacked(packed: dict[str, Any]) -> Spectra:
    body = Body(tuple(packed["joints"]), tuple(packed["partners"]))
    array = {
        name: np.frombuffer(base64.b64decode(packed[name]), kind) for name, kind in _ARRAYS.items()
    }
    count, joints = array["reflections"].size // 3, len(body.joints)
    return Spectra(
        body,
        array["means"].reshape(count, joints, 3),
        array["waves"].reshape(count, -1, joints, 3),
        array["reflections"].reshape(count, 3),
    )


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


def write_shelves(shelves: Sequence[Shelf], written: str, path: Path) -> None:
    """Write signatures, with the time at which the library they belong to was written."""
    arrays: dict[str, Any] = {"written": np.array(written)}
    for number, shelf in enumerate(shelves):
        body = shelf.spectra.body
        named = {
            "numbers": shelf.numbers,
            "joints": np.array(body.joints),
            "partners": np.array(body.partners),
        }
        named |= {name: getattr(shelf.spectra, name) for name in _ARRAYS}
        arrays |= {f"{name}_{number}": array for name, array in named.items()}
    with written_beside(path) as part:
        np.savez(part, **arrays)


def read_shelves(path: Path, written: str) -> list[Shelf]:
    """Read signatures of the library written at that time.

    Raises
    ------
    FormatError
        If they are those of another one.
    """
    shelves = []
    with np.load(path) as file:
        if str(file["written"]) != written:
            raise FormatError("expected the signatures of the library beside them", path=path)
        for number in range(sum(name.startswith("numbers_") for name in file.files)):
            joints, partners = (file[f"{name}_{number}"] for name in ("joints", "partners"))
            body = Body(tuple(joints.tolist()), tuple(partners.tolist()))
            arrays = [file[f"{name}_{number}"] for name in _ARRAYS]
            shelves.append(Shelf(file[f"numbers_{number}"], Spectra(body, *arrays)))
    return shelves


def write_table(clips: Sequence[dict[str, Any]], path: Path) -> None:
    """Write one row a cycle as CSV with a heading; frames half-open."""
    with (
        written_beside(path) as part,
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
                writer.writerow(f"{v:.6g}" if isinstance(v, float) else v for v in row)
