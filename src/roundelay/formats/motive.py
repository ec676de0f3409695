"""Read the CSV export of Motive (OptiTrack): its markers, or else its bones or rigid bodies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from roundelay.formats import decimals
from roundelay.formats.point_files import (
    Notes,
    checked_size,
    made,
    of_one_body,
    rate_assumed,
    seen_beside_origin,
)
from roundelay.formats.tables import fields, line_end, rate_of, read_table
from roundelay.formats.text import Source
from roundelay.motion.points import Points

__all__ = ["is_motive", "motive_names", "read_motive"]

Array = NDArray[np.float64]

# What the first row of titles may say of a column that holds a place; the first found are read.
_KINDS = (
    ("marker",),
    ("rigid body marker", "bone marker"),
    ("bone",),
    ("rigid body",),
)
_UNITS = {"meters": "m", "centimeters": "cm", "millimeters": "mm", "inches": "in", "feet": "ft"}
_AXES = ("x", "y", "z")
# Rows of titles above "Frame".
_ROWS = 8


def is_motive(first: Sequence[str]) -> bool:
    """Tell whether the first row of a CSV is that of Motive."""
    return next(iter(first), "").lower() == "format version"


def motive_names(source: Source) -> list[str]:
    """Return the names of the points in a CSV of Motive.

    Raises
    ------
    FormatError
        If the file is not sound.
    """
    return [name for name, _ in _columns(_titles(source)[0])]


def read_motive(source: Source, character: str | None = None) -> Points:
    """Read a CSV of Motive.

    Parameters
    ----------
    source : Source
    character : str, optional
        Which skeleton; the one with most points by default.

    Raises
    ------
    FormatError
        If the file is not sound, with line and column, or holds no place.
    """
    path = source.path
    heading = fields(source, 0, ",")
    told = dict(zip(heading[::2], heading[1::2], strict=False))
    rows, at = _titles(source)
    columns = _columns(rows)
    if not columns:
        raise source.error("expected positions of markers, found none", line_end(source, 0))
    table = read_table(source, at, len(rows[-1]), b",")
    _check_frames(source, told, len(table.values))
    table = table.numbered(0)
    checked_size(path, len(table.values), len(columns))
    notes = Notes(path)
    names = [name for name, _ in columns]
    places = np.stack([table.values[:, three] for three in columns.values()], axis=1)
    places = seen_beside_origin(places)
    kept = _kept(names, places, notes, character)
    rate = _number(told, "Export Frame Rate") or rate_of(table.values[:, 1]) or rate_assumed(path)
    unit = told.get("Length Units", "").lower()
    unit = _UNITS.get(unit, unit)
    return made(path, [names[n] for n in kept], places[:, kept], rate, units=unit, notes=notes)


def _number(told: dict[str, str], key: str) -> float:
    """Return a positive number of the heading; 0 where it tells none."""
    word = told.get(key, "").encode()
    return max(0.0, float(word)) if decimals.is_number(word) else 0.0


def _check_frames(source: Source, told: dict[str, str], found: int) -> None:
    promised = _number(told, "Total Exported Frames")
    if promised and promised != found:
        raise source.error(f"expected {promised:g} frames, found {found}", source.end)


def _kept(names: list[str], places: Array, notes: Notes, character: str | None) -> list[int]:
    """Return the markers of one body; those without a name are left out where others have one."""
    named = [n for n, name in enumerate(names) if not name.lower().startswith("unlabeled")]
    if not named:
        return list(range(len(names)))
    if len(named) < len(names):
        notes.add(f"{len(names) - len(named)} unlabeled markers, left out")
    seen = np.asarray(np.isfinite(places[:, named]).all(axis=2).any(axis=0)).tolist()
    body = of_one_body([names[n] for n in named], seen, notes, character)
    return [named[number] for number in body]


def _titles(source: Source) -> tuple[list[list[str]], int]:
    """Return the rows of titles, the last of which begins with Frame, and the byte after them."""
    at, rows = line_end(source, 0), list[list[str]]()
    while at < len(source.data) and len(rows) < _ROWS:
        row = fields(source, at, ",")
        at = line_end(source, at)
        if any(row):
            rows.append(row)
        if row and row[0].lower() == "frame":
            return rows, at
    raise source.error("expected a row of titles that begins with Frame, found none", at)


def _columns(rows: list[list[str]]) -> dict[tuple[str, str], list[int]]:
    """Return the columns of x, y and z of each point by its name and what else tells it."""
    axes = rows[-1]
    above = [row + [""] * (len(axes) - len(row)) for row in rows[:-1]]
    kinds = next((row for row in above if any(map(_is_kind, row))), [""] * len(axes))
    names = above[above.index(kinds) + 1] if kinds in above[:-1] else kinds
    for wanted in _KINDS:
        found: dict[tuple[str, str], dict[str, int]] = {}
        for column, axis in enumerate(axes):
            titles = [row[column].lower() for row in above]
            if kinds[column].lower() in wanted and "position" in titles and axis.lower() in _AXES:
                key = (names[column], " ".join(titles))
                while axis.lower() in found.get(key, {}):
                    key = (key[0], f"{key[1]} again")
                found.setdefault(key, {})[axis.lower()] = column
        whole = {key: axes for key, axes in found.items() if len(axes) == 3}
        if whole:
            return {key: [three[axis] for axis in _AXES] for key, three in whole.items()}
    return {}


def _is_kind(title: str) -> bool:
    return any(title.lower() in kinds for kinds in _KINDS)
