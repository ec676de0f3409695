"""Read the CSV of DeepLabCut: x, y and likelihood of each body part, in pixels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from roundelay.formats.point_files import Notes, checked_size, made, of_one_body, rate_assumed
from roundelay.formats.tables import fields, line_end, read_table
from roundelay.formats.text import Source
from roundelay.motion.points import Points

__all__ = ["deeplabcut_names", "is_deeplabcut", "read_deeplabcut"]

_TITLES = ("scorer", "individuals", "bodyparts", "coords")
_COORDINATES = ("x", "y", "likelihood")


def is_deeplabcut(first: Sequence[str]) -> bool:
    """Tell whether the first row of a CSV is that of DeepLabCut."""
    return next(iter(first), "").lower() == "scorer"


def deeplabcut_names(source: Source) -> list[str]:
    """Return the names of the points in a CSV of DeepLabCut.

    Raises
    ------
    FormatError
        If the file is not sound.
    """
    return _columns(source, _titles(source)[0])[0]


def read_deeplabcut(source: Source, character: str | None = None) -> Points:
    """Read a CSV of DeepLabCut.

    Parameters
    ----------
    source : Source
    character : str, optional
        Which individual; the one with most body parts by default.

    Raises
    ------
    FormatError
        If the file is not sound, with line and column.
    """
    path = source.path
    titles, at = _titles(source)
    names, columns = _columns(source, titles)
    table = read_table(source, at, len(titles["coords"]), b",").numbered(0)
    checked_size(path, len(table.values), len(names))
    places = table.values[:, columns]
    notes = Notes(path)
    seen = np.asarray(np.isfinite(places[..., :2]).all(axis=2).any(axis=0)).tolist()
    kept = of_one_body(names, seen, notes, character, least=1)
    likelihoods = np.nan_to_num(places[:, kept, 2]) if places.shape[2] == 3 else None
    return made(
        path,
        [names[number] for number in kept],
        places[:, kept, :2],
        rate_assumed(path),
        likelihoods=likelihoods,
        units="px",
        image=True,
        notes=notes,
    )


def _titles(source: Source) -> tuple[dict[str, list[str]], int]:
    """Return the rows of titles by what each begins with, and the byte after them."""
    rows, at = dict[str, list[str]](), 0
    while at < len(source.data) and "coords" not in rows:
        row = fields(source, at, ",")
        key = row[0].lower() if row else ""
        if key not in _TITLES:
            told = "a row of titles that begins with bodyparts or coords"
            raise source.error(f"expected {told}, found {key!r}", at)
        rows[key] = row
        at = line_end(source, at)
    if not {"bodyparts", "coords"} <= rows.keys():
        raise source.error("expected rows of bodyparts and coords, found none", at)
    return rows, at


def _columns(source: Source, titles: dict[str, list[str]]) -> tuple[list[str], list[list[int]]]:
    """Return the names of the points and the columns of each."""
    coordinates = titles["coords"]
    parts, individuals = titles["bodyparts"], titles.get("individuals")
    if any(len(row) != len(coordinates) for row in titles.values()):
        raise source.error("expected rows of titles that are equally long", 0)
    found: dict[str, dict[str, int]] = {}
    for column, kind in enumerate(coordinates[1:], 1):
        subject = f"{individuals[column]}:" if individuals else ""
        own = found.setdefault(subject + parts[column], {})
        if kind.lower() in own:
            raise source.error(f"expected {kind} of {parts[column]!r} once, found it twice", 0)
        own[kind.lower()] = column
    kinds = _COORDINATES[: 2 + any("likelihood" in columns for columns in found.values())]
    for name, columns in found.items():
        if not set(kinds) <= columns.keys():
            raise source.error(f"expected {', '.join(kinds)} of {name!r}, found fewer", 0)
    if not found:
        raise source.error("expected body parts, found none", 0)
    return list(found), [[columns[kind] for kind in kinds] for columns in found.values()]
