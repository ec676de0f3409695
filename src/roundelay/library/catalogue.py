"""A library that was made: its clips, its cycles, and search in it."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from roundelay.base.checks import as_path
from roundelay.base.errors import FormatError, SkeletonMismatch
from roundelay.base.threads import one_thread
from roundelay.compare.spectra import Spectra, least_distances
from roundelay.cycles.cycle import Cycle
from roundelay.library.sealed import FORMAT, OLDER, checksum_of
from roundelay.library.store import CATALOGUE, SIGNATURES, Shelf, read_catalogue, read_shelves

__all__ = ["Library", "Match"]


@dataclass(frozen=True)
class Match:
    """A cycle of a library that was found by a search.

    Attributes
    ----------
    distance : float
        RMS over joints and phases in body sizes, as `roundelay.cycle_distance`.
    file : str
        The clip that shows it.
    cycle : dict
        Its record.

    Examples
    --------
    >>> library = rl.build_library("captures", "library")
    >>> matches, left_out = library.search(rl.find_cycles(rl.read("walk.bvh"))[0])
    >>> matches[0].file, round(matches[0].distance, 3)
    ('walk.bvh', 0.0)
    """

    distance: float
    file: str
    cycle: dict[str, Any]


@dataclass(frozen=True, eq=False)
class Library:
    """Clips with their segments, cycles and groups, as `roundelay.build_library` made them.

    Attributes
    ----------
    folder : Path
    record : dict
        All that ``library.json`` tells.

    Examples
    --------
    >>> library = rl.build_library("captures", "library")
    >>> library.summary["clips"], len(library.cycles)
    (2, 2)
    """

    folder: Path
    record: dict[str, Any] = field(repr=False)
    shelves: tuple[Shelf, ...] = field(repr=False)

    @classmethod
    def open(cls, folder: str | PathLike[str]) -> Library:
        """Read a library.

        Raises
        ------
        FormatError
            If the folder holds none, or not all of it.
        """
        folder = as_path(folder)
        try:
            record = _intact(folder)
            shelves = read_shelves(folder / SIGNATURES)
        except (OSError, ValueError, KeyError, TypeError, BadZipFile) as error:
            fault = error if (folder / CATALOGUE).exists() else f"no {CATALOGUE} in it"
            message = f"expected a folder made by roundelay library, found {fault}"
            raise FormatError(message, path=folder) from None
        return cls(folder, record, tuple(shelves))

    @property
    def clips(self) -> list[dict[str, Any]]:
        """The records of all clips."""
        return self.record["clips"]

    @property
    def summary(self) -> dict[str, Any]:
        """Numbers of clips, frames, seconds, loops, groups; of clips refused and waiting."""
        return self.record["summary"]

    @property
    def cycles(self) -> list[tuple[str, dict[str, Any]]]:
        """The file and the record of every cycle."""
        return [(clip["file"], cycle) for clip in self.clips for cycle in clip["cycles"]]

    @one_thread
    def search(self, query: Cycle, count: int | None = 10) -> tuple[list[Match], int]:
        """Find the cycles most like one, at the best offset in phase, mirrored or not.

        Parameters
        ----------
        query : Cycle
        count : int, optional
            How many; all if None.

        Returns
        -------
        matches : list of Match
            Nearest first.
        left_out : int
            How many cycles were not compared, because their skeletons share less than half of
            the joints' names with the query.

        Raises
        ------
        SkeletonMismatch
            If none can be compared.
        """
        wanted, cycles = Spectra.of([query]), self.cycles
        distances = np.full(len(cycles), np.inf)
        for shelf in self.shelves:
            distances[shelf.numbers] = least_distances(wanted, shelf.spectra)[0]
        compared = int(np.isfinite(distances).sum())
        if not compared:
            raise SkeletonMismatch(
                f"none of the library's {len(cycles)} cycles has the joints of the query"
            )
        nearest = np.argsort(distances, kind="stable")[:compared][:count]
        found = [Match(float(distances[number]), *cycles[number]) for number in nearest]
        return found, len(cycles) - compared


def _intact(folder: Path) -> dict[str, Any]:
    """Read the catalogue of a folder; raise ValueError if it, or what search needs, is damaged."""
    record = read_catalogue(folder)
    if record is None:
        raise ValueError(f"a damaged {CATALOGUE}; run roundelay library again")
    if record["format"] in OLDER:
        raise ValueError(f"format {record['format']}, not {FORMAT}; run roundelay library again")
    if record["format"] != FORMAT:
        raise ValueError(f"format {record['format']}, not {FORMAT}; use the roundelay that made it")
    if record["checksums"][SIGNATURES] != checksum_of(folder / SIGNATURES):
        raise ValueError(f"a damaged {SIGNATURES}; run roundelay library again")
    return record
