"""Read and write STO and MOT, the tables of OpenSim, where they hold places of points.

Of the many things that such a table can hold these are points: three columns a point, NAME_tx,
NAME_ty, NAME_tz or NAME_x, NAME_y, NAME_z; and one column of three numbers a point (Vec3). What
else they hold is named and refused.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from roundelay.base.errors import FormatError
from roundelay.formats import decimals, text
from roundelay.formats.point_files import Notes, checked_size, in_space, made, plain, rate_assumed
from roundelay.formats.points import ReadsPoints, WritesPoints
from roundelay.formats.tables import fields, line_end, rate_of, read_table
from roundelay.formats.text import Source
from roundelay.motion.points import Points

__all__ = ["OpenSimReader", "OpenSimWriter", "triples"]

_AXIS = re.compile(r"(.+?)[_.](t?)([xyz])", re.IGNORECASE)
# Orientations of bodies stand beside their places.
_TURN = re.compile(r".+_O[xyz]", re.IGNORECASE)
_FORCE = re.compile(r".*(_v[xyz]|_p[xyz]|force|torque|moment)", re.IGNORECASE)
_NAMED = 4
# Lines of a heading.
_LONGEST = 1000


class OpenSimReader(ReadsPoints):
    """The reader of STO and MOT files."""

    name = "opensim"
    suffixes = (".sto", ".mot")

    def read_points(self, path: Path) -> Points:
        """Read an STO or MOT file.

        Parameters
        ----------
        path : Path

        Returns
        -------
        Points
            In metres, unless the file tells another unit.

        Raises
        ------
        FormatError
            If the file is not sound or holds something else than points, such as joint angles.
        OSError
            If it cannot be read.
        """
        source = text.load(path)
        told, at = _heading(source)
        titles, at = _titles(source, at)
        vectors = told.get("datatype", "").lower() == "vec3"
        notes = Notes(path)
        columns, width, source = _columns(source, at, titles, vectors, notes)
        table = read_table(source, line_end(source, at), width, None)
        promised = told.get("nrows", told.get("datarows", ""))
        if promised and promised != str(len(table.values)):
            found = f"expected {promised} rows, found {len(table.values)}"
            raise source.error(found, source.end)
        checked_size(path, len(table.values), len(columns))
        places = np.stack([table.values[:, three] for three in columns.values()], axis=1)
        rate = _told_rate(told) or rate_of(table.values[:, 0]) or rate_assumed(path)
        return made(path, list(columns), places, rate, units=told.get("units", "m"), notes=notes)


def _titles(source: Source, at: int) -> tuple[list[str], int]:
    """Return the names of columns, and the byte where their line begins."""
    first = next(text.lines(source, at), [])
    at = first[0].at if first else at
    # Names with blanks are told apart where tabs part them.
    parted = b"\t" in source.data[at : line_end(source, at)]
    titles = fields(source, at, "\t") if parted else [token.text for token in first]
    if not titles or titles[0].lower() != "time":
        raise source.error("expected the names of columns, time first", at)
    return titles, at


def _told_rate(told: dict[str, str]) -> float:
    word = told.get("datarate", "").encode()
    return max(0.0, float(word)) if decimals.is_number(word) else 0.0


def _heading(source: Source) -> tuple[dict[str, str], int]:
    """Return what the heading tells, keys in small letters, and the byte after it."""
    told: dict[str, str] = {}
    at = 0
    for _ in range(_LONGEST):
        if at >= len(source.data):
            break
        end = line_end(source, at)
        line = source.decode(at, end).strip()
        at = end
        if line.lower().startswith("endheader"):
            return told, at
        key, equals, value = line.partition("=")
        if not equals:
            key, _, value = line.partition(" ")
        told[key.strip().lower()] = value.strip()
    raise source.error("expected endheader, found the end of the heading", min(at, source.end))


def _columns(
    source: Source, at: int, titles: Sequence[str], vectors: bool, notes: Notes
) -> tuple[dict[str, list[int]], int, Source]:
    """Return the columns of each point, how many there are, and the table as it is to be read."""
    if vectors:
        body = line_end(source, at)
        data = source.data[:body] + source.data[body:].replace(b",", b"\t")
        found = {name: [3 * n + 1, 3 * n + 2, 3 * n + 3] for n, name in enumerate(titles[1:])}
        return found, 3 * len(titles) - 2, Source(source.path, data)
    found = triples(titles)
    used = {0, *(column for three in found.values() for column in three)}
    left = [title for column, title in enumerate(titles) if column not in used]
    turns = [title for title in left if _TURN.fullmatch(title)]
    if not found or len(turns) < len(left):
        raise _unsuited(source, at, [title for title in left if title not in turns])
    notes.add_named(turns, "orientations, left out")
    return found, len(titles), source


def triples(titles: Sequence[str]) -> dict[str, list[int]]:
    """Return the columns of x, y and z of each point that has all three."""
    found: dict[str, dict[str, int]] = {}
    for column, title in enumerate(titles):
        match = _AXIS.fullmatch(title)
        if match and not _TURN.fullmatch(title):
            found.setdefault(match[1], {})[match[3].lower()] = column
    return {name: [axes[axis] for axis in "xyz"] for name, axes in found.items() if len(axes) == 3}


def _unsuited(source: Source, at: int, titles: Sequence[str]) -> FormatError:
    """Return the error of a table of something else, named by its columns."""
    what = "forces" if any(map(_FORCE.fullmatch, titles)) else "coordinates of a model"
    more = ", ..." if len(titles) > _NAMED else ""
    named = f" ({', '.join(map(plain, titles[:_NAMED]))}{more})" if titles else ""
    advice = "export markers, or positions of bodies"
    return source.error(f"expected points, found {what}{named}; {advice}", at)


class OpenSimWriter(WritesPoints):
    """The writer of STO and MOT files."""

    name = "opensim"
    suffixes = (".sto", ".mot")

    def write_points(self, points: Points, path: Path) -> None:
        """Write an STO or MOT file: three columns a point, ``nan`` where it is missing.

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
        text.save(path, _pieces(points))


def _pieces(points: Points) -> Iterator[str]:
    frames, columns = len(points), 3 * len(points.names) + 1
    yield f"{plain(points.name) or 'points'}\nversion=1\nnRows={frames}\nnColumns={columns}\n"
    yield f"DataRate={points.fps:.10g}\ninDegrees=no\n"
    yield f"units={points.units}\n" if points.units else ""
    titles = (f"{plain(name)}_t{axis}" for name in points.names for axis in "xyz")
    yield "endheader\n" + "\t".join(["time", *titles]) + "\n"
    places = in_space(points, 0.0).reshape(frames, -1)
    table = np.column_stack([np.arange(frames) / points.fps, places])
    yield from text.rows(table, "\t".join(["%s"] * columns) + "\n")
