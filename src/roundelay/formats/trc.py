"""Read and write TRC, the markers of Motion Analysis and OpenSim: text, separated by tabs."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roundelay.formats import decimals, text
from roundelay.formats.point_files import (
    Notes,
    checked_size,
    in_space,
    made,
    plain,
    rate_assumed,
    seen_beside_origin,
)
from roundelay.formats.points import ReadsPoints, WritesPoints
from roundelay.formats.tables import Table, fields, line_end, rate_of, read_table
from roundelay.formats.text import Source
from roundelay.motion.points import Points

__all__ = ["TrcReader", "TrcWriter", "place_rows"]

Array = NDArray[np.float64]

_KEYS = ("DataRate", "CameraRate", "NumFrames", "NumMarkers", "Units")
_ORIGINAL = ("OrigDataRate", "OrigDataStartFrame", "OrigNumFrames")
# The last decimal that is written.
_LEAST = 1e-8
# Of a count.
_DIGITS = 9


class TrcReader(ReadsPoints):
    """The reader of TRC files."""

    name = "trc"
    suffixes = (".trc",)

    def read_points(self, path: Path) -> Points:
        """Read a TRC file.

        Parameters
        ----------
        path : Path

        Returns
        -------
        Points
            In the unit that the file tells. A frame whose number is skipped is a gap.

        Raises
        ------
        FormatError
            If the file is not sound or not whole, with line and column.
        OSError
            If it cannot be read.
        """
        source = text.load(path)
        told, at = _heading(source)
        notes = Notes(path)
        names, at = _names(source, at, _count(source, told, "NumMarkers"), notes)
        markers = len(names)
        unnamed = markers < _count(source, told, "NumMarkers")
        table = read_table(source, at, 2 + 3 * markers, b"\t", cropped=unnamed)
        promised = _count(source, told, "NumFrames")
        if len(table.values) != promised:
            found = f"expected {promised} frames, found {len(table.values)}"
            raise source.error(found, source.end)
        table = table.numbered(0)
        checked_size(path, len(table.values), markers)
        places = table.without(2).reshape(-1, markers, 3)
        unit = plain(told.get("Units", ("", 0))[0]).lower()
        rate = _rate(told, table) or rate_assumed(path)
        return made(path, names, seen_beside_origin(places), rate, units=unit, notes=notes)


def _heading(source: Source) -> tuple[dict[str, tuple[str, int]], int]:
    """Return the values of the heading with the bytes of their line, and the byte after it."""
    if not source.data.lstrip().startswith(b"PathFileType"):
        first = source.data[: line_end(source, 0)].decode("utf-8", "replace").strip()
        raise source.error(f"expected PathFileType, found {text.shown(first)}", 0)
    keys = line_end(source, 0)
    values = line_end(source, keys)
    after = line_end(source, values)
    found = dict(
        zip(
            fields(source, keys, "\t"),
            ((value, values) for value in fields(source, values, "\t")),
            strict=False,
        )
    )
    for key in ("DataRate", "NumFrames", "NumMarkers"):
        if key not in found:
            raise source.error(f"expected a value of {key}, found none", min(values, source.end))
    return found, after


def _count(source: Source, told: dict[str, tuple[str, int]], key: str) -> int:
    value, at = told[key]
    if not (value.isdecimal() and value.isascii() and len(value) <= _DIGITS and int(value)):
        raise source.error(f"expected {key} as a whole number, found {text.shown(value)}", at)
    return int(value)


def _names(source: Source, at: int, promised: int, notes: Notes) -> tuple[list[str], int]:
    """Return the names of the markers, and where the frames begin.

    The line of axes bears them out where they are not as many as promised.
    """
    titles = fields(source, at, "\t")
    if [title.lower() for title in titles[:2]] != ["frame#", "time"]:
        raise source.error("expected Frame#, Time and names of markers", at)
    names = titles[2::3]
    while len(names) > 1 and not names[-1]:
        names.pop()
    axes = line_end(source, at)
    count = sum(1 for title in fields(source, axes, "\t") if title)
    if any(titles[3::3]) or any(titles[4::3]) or count != 3 * len(names):
        found = f"{len([title for title in titles[2:] if title])} and {count}"
        raise source.error(
            f"expected names of {promised} markers, three axes each, found {found}", at
        )
    if len(names) != promised:
        notes.add(f"{promised} markers promised, the {len(names)} with names read")
    return names, line_end(source, axes)


def _rate(told: dict[str, tuple[str, int]], table: Table) -> float | None:
    value = told["DataRate"][0].encode()
    rate = float(value) if decimals.is_number(value) else 0.0
    return rate if rate > 0.0 else rate_of(table.values[:, 1])


class TrcWriter(WritesPoints):
    """The writer of TRC files."""

    name = "trc"
    suffixes = (".trc",)

    def write_points(self, points: Points, path: Path) -> None:
        """Write a TRC file; a gap is an empty field.

        Parameters
        ----------
        points : Points
            A third coordinate of 0 is added to points of a plane.
        path : Path

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        text.save(path, _pieces(points, path))


def _pieces(points: Points, path: Path) -> Iterator[str]:
    frames, rate = len(points), f"{points.fps:.10g}"
    yield f"PathFileType\t4\t(X/Y/Z)\t{plain(path.name)}\n"
    yield "\t".join((*_KEYS, *_ORIGINAL)) + "\n"
    values = (rate, rate, frames, len(points.names), points.units or "", rate, 1, frames)
    yield "\t".join(map(str, values)) + "\n"
    names = "\t\t\t".join(plain(name).replace('"', "'") for name in points.names)
    yield f"Frame#\tTime\t{names}\n"
    numbers = range(1, len(points.names) + 1)
    yield "\t\t" + "\t".join(f"{axis}{number}" for number in numbers for axis in "XYZ") + "\n\n"
    yield from place_rows(points, in_space(points, _LEAST).reshape(frames, -1), "\t")


def place_rows(points: Points, values: Array, separator: str) -> Iterator[str]:
    """Yield lines of frame number, time and values (F, C); what is missing is left empty."""
    frames = np.arange(len(points))
    table = np.column_stack([frames + 1, frames / points.fps, values])
    row = separator.join(["%s"] * table.shape[1]) + "\n"
    for piece in text.rows(table, row):
        yield piece.replace("nan", "")
