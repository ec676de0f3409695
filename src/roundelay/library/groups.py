"""Alike cycles of a whole library: the same motion bears the same label in every clip."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.compare.distances import cluster
from roundelay.compare.spectra import least_distances
from roundelay.compare.thresholds import GROUPS
from roundelay.library.store import Shelf

__all__ = ["group_records", "grouped", "labelled"]

# Cycles compared with all others at once.
_ROWS = 256


def grouped(shelves: Sequence[Shelf]) -> tuple[list[int], list[int]]:
    """Put alike cycles into groups, by average linkage.

    Returns
    -------
    labels : list of int
        The group of each cycle of the library, numbered in the order in which they first occur.
    examples : list of int
        The number of the most typical cycle of each group: the least far from the others.
    """
    distances = _distances(shelves)
    labels = cluster(distances, within=GROUPS.alike)
    examples = []
    for label in range(len(set(labels))):
        rows = np.flatnonzero(labels == label)
        central = np.argmin(distances[np.ix_(rows, rows)].sum(axis=1))
        examples.append(int(rows[central]))
    return labels.tolist(), examples


def _distances(shelves: Sequence[Shelf]) -> NDArray[np.float32]:
    """Distances (n, n) of all cycles of a library, each pair compared once."""
    count = sum(len(shelf.numbers) for shelf in shelves)
    result = np.empty((count, count), np.float32)
    for number, one in enumerate(shelves):
        for start in range(0, len(one.numbers), _ROWS):
            rows = slice(start, start + _ROWS)
            for other, first in [(one, start), *((shelf, 0) for shelf in shelves[:number])]:
                block = least_distances(one.spectra[rows], other.spectra[first:])
                place = np.ix_(one.numbers[rows], other.numbers[first:])
                result[place] = np.minimum(block, GROUPS.far)
                result.T[place] = result[place]
    return result


def labelled(records: Sequence[dict[str, Any]], labels: Sequence[int]) -> list[dict[str, Any]]:
    """Return the records of clips with the group of every cycle, and of segments that show one."""
    remaining, result = iter(labels), []
    for record in records:
        cycles = [cycle | {"group": next(remaining)} for cycle in record["cycles"]]
        segments = [segment | {"group": _shown(segment, cycles)} for segment in record["segments"]]
        result.append(record | {"segments": segments, "cycles": cycles})
    return result


def _shown(segment: dict[str, Any], cycles: Sequence[dict[str, Any]]) -> int | None:
    """Return the group of the cycle that fills at least half of a segment."""
    start, stop = segment["start_frame"], segment["end_frame"]
    filled = [
        (sum(max(0, min(b, stop) - max(a, start)) for a, b in cycle["parts"]), cycle["group"])
        for cycle in cycles
    ]
    most, group = max(filled, default=(0, None))
    return group if 2 * most >= stop - start else None


def group_records(clips: Sequence[dict[str, Any]], examples: Sequence[int]) -> list[dict[str, Any]]:
    """Describe each group: how many cycles in how many clips, their median period, an example."""
    rows = [(clip["file"], cycle) for clip in clips for cycle in clip["cycles"]]
    members: list[list[tuple[str, dict[str, Any]]]] = [[] for _ in examples]
    for row in rows:
        members[row[1]["group"]].append(row)
    return [
        {
            "group": group,
            "cycles": len(inside),
            "clips": len({file for file, _ in inside}),
            "period_seconds": float(np.median([cycle["period_seconds"] for _, cycle in inside])),
            "example": rows[example][1]["loop"],
        }
        for group, (inside, example) in enumerate(zip(members, examples, strict=True))
    ]
