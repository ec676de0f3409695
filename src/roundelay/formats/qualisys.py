"""Read and write TSV, the text of Qualisys Track Manager: three columns a marker."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from roundelay.base.errors import FormatError
from roundelay.base.files import beginning
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
from roundelay.formats.tables import fields, line_end, rate_of, read_table
from roundelay.formats.text import Source
from roundelay.motion.points import METRES, Points

__all__ = ["QualisysReader", "QualisysWriter"]

# The last decimal that is written.
_LEAST = 1e-8
# Lines of a heading; events stand in it, too.
_LONGEST = 10_000


class QualisysReader(ReadsPoints):
    """The reader of Qualisys' TSV files."""

    name = "qualisys"
    suffixes = (".tsv",)

    def read_points(self, path: Path) -> Points:
        """Read a TSV file.

        Parameters
        ----------
        path : Path

        Returns
        -------
        Points
            In millimetres. What lies exactly at the origin is a gap.

        Raises
        ------
        FormatError
            If the file is not sound or not whole, with line and column, or holds bodies instead
            of markers.
        OSError
            If it cannot be read.
        """
        source = text.load(path)
        told, at = _heading(source)
        names = told["MARKER_NAMES"]
        while len(names) > 1 and not names[-1]:
            names.pop()
        _check_count(source, told, "NO_OF_MARKERS", len(names), at)
        before, at = _before(source, at, len(names))
        table = read_table(source, at, before + 3 * len(names), b"\t")
        _check_count(source, told, "NO_OF_FRAMES", len(table.values), source.end)
        if before:
            table = table.numbered(0)
        checked_size(path, len(table.values), len(names))
        places = table.without(before).reshape(len(table.values), -1, 3)
        rate = _number(told, "FREQUENCY")
        if not rate and before == 2:
            rate = rate_of(table.values[:, 1]) or 0.0
        rate = rate or rate_assumed(path)
        return made(path, names, seen_beside_origin(places), rate, units="mm", notes=Notes(path))

    def claims(self, path: Path) -> bool:
        """Tell whether a table is one of Qualisys.

        Raises
        ------
        OSError
            If it cannot be read.
        """
        try:
            return b"MARKER_NAMES" in beginning(path)
        except FormatError:
            return False


def _heading(source: Source) -> tuple[dict[str, list[str]], int]:
    """Return what the heading tells, and the byte after the names of the markers."""
    told: dict[str, list[str]] = {}
    at = 0
    for _ in range(_LONGEST):
        if at >= len(source.data):
            break
        key, *values = fields(source, at, "\t") or [""]
        kind = " ".join(values).upper()
        if key == "DATA_INCLUDED" and kind and kind != "3D":
            raise source.error(f"expected markers (3D), found {text.shown(kind)}", at)
        told[key] = values
        at = line_end(source, at)
        if key == "MARKER_NAMES" and values:
            return told, at
    raise source.error("expected MARKER_NAMES, found none", source.end)


def _number(told: dict[str, list[str]], key: str) -> float:
    """Return a number of the heading; 0 where it tells none."""
    word = next(iter(told.get(key, [])), "").replace(",", ".").encode()
    return float(word) if decimals.is_number(word) else 0.0


def _check_count(source: Source, told: dict[str, list[str]], key: str, found: int, at: int) -> None:
    if key in told and _number(told, key) != found:
        promised = text.shown(" ".join(told[key]))
        raise source.error(f"expected {key} {promised}, found {found}", at)


def _before(source: Source, at: int, markers: int) -> tuple[int, int]:
    """Return how many columns stand before the markers, and where the rows begin."""
    row = fields(source, at, "\t")
    while row and (row[0] == "TRAJECTORY_TYPES" or row[0].lower() == "frame"):
        at = line_end(source, at)
        row = fields(source, at, "\t") if at < len(source.data) else []
    # Frame and time; older programs write neither.
    count = len(row) - (not row[-1] if row else 0)
    return (2 if count > 3 * markers else 0), at


class QualisysWriter(WritesPoints):
    """The writer of Qualisys' TSV files."""

    name = "qualisys"
    suffixes = (".tsv",)

    def write_points(self, points: Points, path: Path) -> None:
        """Write a TSV file, in millimetres where the unit of the points is known.

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
    frames, scale = len(points), METRES.get(points.units, METRES["mm"]) / METRES["mm"]
    told = {
        "NO_OF_FRAMES": frames,
        "NO_OF_CAMERAS": 0,
        "NO_OF_MARKERS": len(points.names),
        "FREQUENCY": f"{points.fps:.10g}",
        "NO_OF_ANALOG": 0,
        "ANALOG_FREQUENCY": 0,
        "DESCRIPTION": "--",
        "TIME_STAMP": "--",
        "DATA_INCLUDED": "3D",
    }
    yield "".join(f"{key}\t{value}\n" for key, value in told.items())
    yield "\t".join(["MARKER_NAMES", *(plain(name).replace('"', "'") for name in points.names)])
    places = in_space(points, _LEAST / scale).reshape(frames, -1) * scale
    yield "\n"
    for piece in text.rows(places, "\t".join(["%s"] * places.shape[1]) + "\n"):
        yield piece.replace("nan", "")
