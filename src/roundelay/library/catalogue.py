"""A library that was made: its clips, its cycles, and search in it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

from roundelay.base.checks import as_path, expected
from roundelay.base.errors import FormatError, SkeletonMismatch
from roundelay.base.threads import one_thread
from roundelay.compare.spectra import Spectra
from roundelay.cycles.cycle import Cycle
from roundelay.library.sealed import FORMAT, OLDER
from roundelay.library.shelves import Shelf, read_shelves
from roundelay.library.store import CATALOGUE, read_catalogue
from roundelay.motion.motion import Motion

__all__ = ["Library", "Match"]


@dataclass(frozen=True)
class Match:
    """A behaviour of a library that was found by a search.

    Attributes
    ----------
    distance : float
        RMS over points and phases: of a person in lengths of leg and trunk, else in body sizes.
    file : str
        The clip that shows it.
    cycle : dict
        Its record: that of a cycle, or of a segment that shows none.

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
            shelves = read_shelves(folder)
        except (OSError, ValueError, KeyError, TypeError) as error:
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

    @cached_property
    def behaviours(self) -> list[tuple[str, dict[str, Any]]]:
        """The file and the record of all that can be found: cycles, and segments without one."""
        return [
            (clip["file"], one)
            for clip in self.clips
            for one in (*clip["cycles"], *filter(_is_alone, clip["segments"]))
        ]

    @one_thread
    def search(self, query: Cycle | Motion, count: int | None = 10) -> tuple[list[Match], int]:
        """Find the behaviours most like one, at the best offset in phase, mirrored or not.

        Parameters
        ----------
        query : Cycle or Motion
            A motion is taken as done once, from its first frame to its last.
        count : int, optional
            How many; all if None.

        Returns
        -------
        matches : list of Match
            Nearest first.
        left_out : int
            How many behaviours were not compared, because their skeletons share less than half of
            the joints' names with the query.

        Raises
        ------
        SkeletonMismatch
            If none can be compared.
        FormatError
            If what is found is not as it was written.
        """
        wanted = _signature(query)
        total = sum(len(shelf.numbers) for shelf in self.shelves)
        found, compared = list[tuple[float, int]](), 0
        for shelf in self.shelves:
            apart, numbers = shelf.nearest(wanted, total if count is None else count)
            found += zip(apart.tolist(), numbers.tolist(), strict=True)
            compared += len(shelf.numbers) if len(numbers) else 0
        if not compared:
            raise SkeletonMismatch(
                f"none of the library's {total} behaviours has the joints of the query"
            )
        nearest = sorted(found)[:count]
        return [
            Match(apart, *self.behaviours[number]) for apart, number in nearest
        ], total - compared


def _is_alone(segment: dict[str, Any]) -> bool:
    return segment["cycle"] is None


def _signature(query: Cycle | Motion) -> Spectra:
    if isinstance(query, Motion):
        return Spectra.of_stretches(query, [(0, len(query))])
    return Spectra.of([expected(Cycle, query)])


def _intact(folder: Path) -> dict[str, Any]:
    """Read the catalogue of a folder; raise ValueError if it, or what search needs, is damaged."""
    record = read_catalogue(folder)
    if record is None:
        raise ValueError(f"a damaged {CATALOGUE}; run roundelay library again")
    if record["format"] in OLDER:
        raise ValueError(f"format {record['format']}, not {FORMAT}; run roundelay library again")
    if record["format"] != FORMAT:
        raise ValueError(f"format {record['format']}, not {FORMAT}; use the roundelay that made it")
    return record
