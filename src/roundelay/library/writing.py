"""All that a library tells, put in order and written: groups, names, tables, what search needs."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import RoundelayWarning
from roundelay.base.version import __version__
from roundelay.library.database import database_files, has_duckdb, write_database
from roundelay.library.groups import assigned, nearest_named, typical
from roundelay.library.log import Entry, Log
from roundelay.library.names import named_by_files, resolved
from roundelay.library.schema import source_of
from roundelay.library.shelves import Shelf, shelf_files, shelved, write_shelves
from roundelay.library.store import CATALOGUE, TABLE, read_catalogue, write_catalogue, write_table

__all__ = ["beside", "write_library"]

Row = dict[str, Any]
Labels = NDArray[np.intp]


def beside(folder: Path) -> tuple[str, ...]:
    """Return the paths, below a library, of the files whose checksums ``library.json`` holds."""
    return (TABLE, *shelf_files(folder), *database_files())


def write_library(
    names: Sequence[str],
    log: Log,
    unread: Sequence[str],
    passed: dict[str, int],
    folder: Path,
) -> None:
    """Put all clips that are done in order, group their behaviours and write the library.

    Parameters
    ----------
    names : sequence of str
        Of all clips, in order.
    log : Log
        Gets the groups that are new.
    unread : sequence of str
        Folders that could not be read.
    passed : dict
        Files that are no captures, by suffix.
    folder : Path
    """
    entries = [log.entries[name] for name in names if name in log.entries]
    shelves = shelved(entries)
    found = assigned(shelves, _known(entries, log, folder), log.groups)
    log.found(found.founded)
    clips = _labelled(entries, found.labels)
    groups = _groups(clips, shelves, found.labels, log)
    _name(clips, groups)
    record: Row = {
        "roundelay": __version__,
        "written": datetime.now(UTC).isoformat(),
        "summary": {
            "clips": len(clips),
            "frames": sum(clip["frames"] for clip in clips),
            "seconds": sum(clip["seconds"] for clip in clips),
            "loops": sum(len(clip["cycles"]) for clip in clips),
            "groups": len(groups),
            "refused": sum(clip["error"] is not None for clip in clips) + len(unread),
            "waiting": len(names) - len(clips),
        },
        "unread": list(unread),
        "passed_over": passed,
        "waiting": [name for name in names if name not in log.entries],
        "groups": groups,
        "clips": clips,
    }
    write_shelves(shelves, folder)
    write_table(clips, folder / TABLE)
    if has_duckdb():
        write_database(source_of(record, entries, log.runs), folder)
    else:
        told = "DuckDB is not installed: no tables for other programs are written"
        warnings.warn(f"{told}; pip install duckdb", RoundelayWarning, stacklevel=2)
    write_catalogue(record, folder, beside(folder))


def _behaviours(clip: Row) -> list[Row]:
    """Return the records of a clip that have signatures: its cycles, then what shows none."""
    return [*clip["cycles"], *(one for one in clip["segments"] if one["cycle"] is None)]


def _known(entries: Sequence[Entry], log: Log, folder: Path) -> Labels:
    """Return the group that each behaviour had when the library was last written; -1 of new ones.

    What was done again since then is new: it finds its group by its likeness.
    """
    before = read_catalogue(folder) if (folder / CATALOGUE).exists() else None
    old = {clip["file"]: clip for clip in before["clips"]} if before else {}
    known: list[int] = []
    for entry in entries:
        told = _behaviours(entry.record)
        clip = old.get(entry.name)
        same = clip is not None and entry.name not in log.files
        groups = [one.get("group", -1) for one in _behaviours(clip)] if clip and same else []
        known += groups if len(groups) == len(told) else [-1] * len(told)
    return np.array(known, np.intp)


def _labelled(entries: Sequence[Entry], labels: Labels) -> list[Row]:
    """Return the records of clips with the group of every cycle and segment."""
    remaining, result = iter(labels.tolist()), []
    for entry in entries:
        record = {name: value for name, value in entry.record.items() if name != "strides"}
        cycles = [cycle | {"group": next(remaining)} for cycle in record["cycles"]]
        segments = []
        for one in record["segments"]:
            shown = one["cycle"]
            group = next(remaining) if shown is None else cycles[shown - 1]["group"]
            segments.append(one | {"group": group})
        result.append(record | {"segments": segments, "cycles": cycles})
    return result


def _groups(clips: Sequence[Row], shelves: Sequence[Shelf], labels: Labels, log: Log) -> list[Row]:
    """Describe each group: its name, how many show it where, their period, an example."""
    members: dict[int, list[tuple[str, Row]]] = {}
    rows = [(clip["file"], one) for clip in clips for one in _behaviours(clip)]
    for row in rows:
        members.setdefault(row[1]["group"], []).append(row)
    given = {number: name for number, name in log.names.items() if name and number in members}
    alike = nearest_named(shelves, labels, given) if given else {}
    files = named_by_files(clips)
    central = typical(shelves, labels, log.groups)
    return [
        _group(group, members[group], rows[central[group]] if group in central else None)
        | dict(zip(("name", "named_by"), resolved(given, alike, files, group), strict=True))
        for group in sorted(members)
    ]


def _group(group: int, inside: Sequence[tuple[str, Row]], example: tuple[str, Row] | None) -> Row:
    file, one = example or inside[0]
    periods = [row["period_seconds"] for _, row in inside if "period_seconds" in row]
    parts = one["parts"] if "parts" in one else [[one["start_frame"], one["end_frame"]]]
    return {
        "group": group,
        "cycles": len(periods),
        "behaviours": len(inside),
        "clips": len({file for file, _ in inside}),
        "period_seconds": float(np.median(periods)) if periods else None,
        "example": one.get("loop"),
        "example_clip": file,
        "example_frames": parts[0],
    }


def _name(clips: Sequence[Row], groups: Sequence[Row]) -> None:
    """Put the names of groups to the cycles and segments of clips."""
    names: Mapping[int, str | None] = {one["group"]: one["name"] for one in groups}
    for clip in clips:
        for one in (*clip["cycles"], *clip["segments"]):
            one["name"] = names[one["group"]]
