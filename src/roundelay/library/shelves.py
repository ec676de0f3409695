"""What the behaviours of a library are compared by: signatures, in files read as they are needed.

=============================  ======================================================
``signatures/shelves.json``    the bodies, and checksums of the other files
``signatures/N.values.npy``    a row a behaviour of one body
``signatures/N.numbers.npy``   the behaviours' numbers among all
``signatures/N.crc32.npy``     a checksum a row
``signatures/N.usearch``       a graph of near ones, of many behaviours
=============================  ======================================================
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError
from roundelay.base.files import written_beside
from roundelay.compare.neighbours import Finder, graph_of, has_usearch
from roundelay.compare.packed import Packed, unpacked
from roundelay.compare.spectra import Body, Spectra, least_distances
from roundelay.compare.thresholds import NEAR
from roundelay.library.log import Entry
from roundelay.library.sealed import checksum_of, sealed, unsealed

__all__ = ["FOLDER", "SHELVES", "Shelf", "read_shelves", "shelf_files", "shelved", "write_shelves"]

FOLDER = "signatures"
SHELVES = f"{FOLDER}/shelves.json"
_KINDS = ("values", "numbers", "crc32")
# Bytes of a file whose checksum is looked at before it is used; rows have checksums of their own.
_SMALL = 1 << 26


@dataclass(frozen=True, eq=False)
class Shelf:
    """The behaviours of one body.

    Attributes
    ----------
    numbers : (n,) ndarray of int
        Their numbers among all of a library.
    packed : Packed
        Their signatures.
    checks : (n,) ndarray of uint32 or None
        Checksums of the rows, where they come from a file.
    graph : Path or None
        The file of a graph of near ones.
    """

    numbers: NDArray[np.intp]
    packed: Packed
    checks: NDArray[np.uint32] | None = None
    graph: Path | None = None

    @cached_property
    def finder(self) -> Finder:
        """What finds the nearest of them."""
        return Finder.opened(self.packed, self.graph)

    def nearest(self, query: Spectra, count: int) -> tuple[NDArray[np.float32], NDArray[np.intp]]:
        """Return distances and numbers of the behaviours nearest to one; none if not comparable.

        Raises
        ------
        FormatError
            If one of them is not as it was written.
        """
        if query.body != self.packed.body:
            return self._nearest_of_others(query, count)
        apart, rows = self.finder.nearest(Packed.of(query), count)
        self._check(rows[0])
        return apart[0], self.numbers[rows[0]]

    def _nearest_of_others(
        self, query: Spectra, count: int
    ) -> tuple[NDArray[np.float32], NDArray[np.intp]]:
        """Compare by the joints that both bodies have."""
        across = query.reflections[0]
        apart = least_distances(query, unpacked(self.packed, across))[0]
        rows = np.argsort(apart, kind="stable")[: count if np.isfinite(apart).any() else 0]
        self._check(rows)
        return apart[rows], self.numbers[rows]

    def _check(self, rows: NDArray[np.intp]) -> None:
        if self.checks is None:
            return
        found = [zlib.crc32(row.tobytes()) for row in self.packed.values[rows]]
        if found != self.checks[rows].tolist():
            told = "expected signatures as they were written, found damaged ones"
            raise FormatError(f"{told}; run roundelay library again")


def shelved(entries: Sequence[Entry]) -> list[Shelf]:
    """Put the behaviours of all entries, numbered in order, on one shelf a body."""
    numbers: dict[Body, list[int]] = {}
    parts: dict[Body, list[NDArray[np.float32]]] = {}
    count = 0
    for entry in entries:
        if entry.spectra is not None:
            body, many = entry.spectra.body, len(entry.spectra)
            numbers.setdefault(body, []).extend(range(count, count + many))
            parts.setdefault(body, []).append(Packed.of(entry.spectra).values)
            count += many
    return [
        Shelf(np.array(numbers[body]), Packed(body, np.concatenate(parts[body]))) for body in parts
    ]


def shelf_files(folder: Path) -> tuple[str, ...]:
    """Return the paths, below a library, of the files that its shelves are in."""
    told = _told(folder)
    return (SHELVES, *(name for one in told["shelves"] for name in one["files"]))


def write_shelves(shelves: Sequence[Shelf], folder: Path) -> None:
    """Write the signatures of a library, and remove those of earlier bodies."""
    (folder / FOLDER).mkdir(exist_ok=True)
    told = [
        {
            "joints": shelf.packed.body.joints,
            "partners": shelf.packed.body.partners,
            "files": {name: checksum_of(folder / name) for name in _written(shelf, number, folder)},
        }
        for number, shelf in enumerate(shelves)
    ]
    with written_beside(folder / SHELVES, durable=True) as part:
        part.write_bytes(sealed({"shelves": told}))
    known = {Path(name).name for name in shelf_files(folder)}
    for name in os.listdir(folder / FOLDER):
        if name not in known and name.endswith((".npy", ".usearch")):
            (folder / FOLDER / name).unlink()


def _written(shelf: Shelf, number: int, folder: Path) -> Iterator[str]:
    """Write the files of a shelf and yield their names."""
    checks = np.array([zlib.crc32(row.tobytes()) for row in shelf.packed.values], np.uint32)
    arrays: dict[str, NDArray[Any]] = {
        "values": shelf.packed.values,
        "numbers": shelf.numbers,
        "crc32": checks,
    }
    for kind, array in arrays.items():
        name = f"{FOLDER}/{number}.{kind}.npy"
        with written_beside(folder / name, durable=True) as part:
            np.save(part, array)
        yield name
    if len(shelf.packed) >= NEAR.many and has_usearch():
        name = f"{FOLDER}/{number}.usearch"
        with written_beside(folder / name, durable=True) as part:
            graph_of(shelf.packed.vectors()).save(str(part))
        yield name


def _told(folder: Path) -> dict[str, Any]:
    told = unsealed((folder / SHELVES).read_bytes())
    if told is None:
        raise ValueError(f"a damaged {SHELVES}; run roundelay library again")
    return told


def read_shelves(folder: Path) -> list[Shelf]:
    """Open the signatures of a library; they are read from disk as they are needed.

    Raises
    ------
    ValueError
        If a file is not as it was written.
    OSError
        If one cannot be read.
    """
    return [_read(one, number, folder) for number, one in enumerate(_told(folder)["shelves"])]


def _read(told: dict[str, Any], number: int, folder: Path) -> Shelf:
    for name, known in told["files"].items():
        size = (folder / name).stat().st_size
        if size != known[0] or (size <= _SMALL and checksum_of(folder / name) != known):
            raise ValueError(f"a damaged {name}; run roundelay library again")
    body = Body(tuple(told["joints"]), tuple(told["partners"]))
    values, numbers, checks = (
        np.load(folder / f"{FOLDER}/{number}.{kind}.npy", mmap_mode="r") for kind in _KINDS
    )
    graph = f"{FOLDER}/{number}.usearch"
    return Shelf(
        numbers, Packed(body, values), checks, folder / graph if graph in told["files"] else None
    )
