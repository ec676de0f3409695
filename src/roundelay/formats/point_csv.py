"""Read CSV files of points, those of Motive and DeepLabCut and a plain layout; write the plain one.

The plain layout has one row a frame and titles: ``frame`` and ``time`` (in seconds), either or
none, then ``NAME_x``, ``NAME_y``, ``NAME_z`` of each point, without the last in a plane, and where
there are any, ``NAME_residual`` and ``NAME_likelihood``. An empty field is a gap. A first line that
begins with ``#`` may tell ``fps``, ``units`` and ``image`` (whether y grows downward), as in
``# fps: 100, units: mm``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError
from roundelay.base.files import beginning
from roundelay.formats import decimals, text
from roundelay.formats.contents import Contents
from roundelay.formats.deeplabcut import deeplabcut_names, is_deeplabcut, read_deeplabcut
from roundelay.formats.motive import is_motive, motive_names, read_motive
from roundelay.formats.options import ReadOptions
from roundelay.formats.point_files import (
    Notes,
    checked_size,
    made,
    of_one_body,
    plain,
    rate_assumed,
    subjects_of,
)
from roundelay.formats.points import ChoosesPoints, WritesPoints
from roundelay.formats.tables import fields, line_end, rate_of, read_table
from roundelay.formats.text import Source
from roundelay.formats.trc import place_rows
from roundelay.motion.points import Points

__all__ = ["CsvReader", "CsvWriter"]

Array = NDArray[np.float64]

_TITLE = re.compile(r"(.+)[_.: ](x|y|z|residual|likelihood)", re.IGNORECASE)
_FRAME, _TIME = ("frame", "frame#"), ("time", "time (seconds)", "time (s)", "seconds")
_SEPARATORS = ",;\t"
# Lines in front of the titles.
_REMARKS = 20


class CsvReader(ChoosesPoints):
    """The reader of CSV files of points."""

    name = "csv"
    suffixes = (".csv",)

    def read_points(self, path: Path, wanted: ReadOptions | None = None) -> Points:
        """Read a CSV file of Motive, of DeepLabCut, or of the plain layout.

        Parameters
        ----------
        path : Path
        wanted : ReadOptions, optional
            Which skeleton of Motive or animal of DeepLabCut; by default the one with most points.

        Returns
        -------
        Points
            In the file's unit; pixels of a picture for DeepLabCut.

        Raises
        ------
        FormatError
            If the file is not sound, with line and column.
        OSError
            If it cannot be read.
        """
        source = text.load(path)
        first = fields(source, 0, ",")
        character = wanted.character if wanted else None
        if is_motive(first):
            return read_motive(source, character)
        if is_deeplabcut(first):
            return read_deeplabcut(source, character)
        return _read_plain(source, character)

    def contents(self, path: Path) -> Contents:
        """List the subjects of a file."""
        source = text.load(path)
        first = fields(source, 0, ",")
        if is_motive(first):
            return Contents(characters=subjects_of(motive_names(source)))
        if is_deeplabcut(first):
            return Contents(characters=subjects_of(deeplabcut_names(source)))
        titles, _ = _titles(source, _remarks(source)[1])
        names = [match[1] for title in titles if (match := _TITLE.fullmatch(title))]
        return Contents(characters=subjects_of(names))

    def claims(self, path: Path) -> bool:
        """Tell whether a table holds points; few do.

        Raises
        ------
        OSError
            If it cannot be read.
        """
        try:
            source = Source(path, beginning(path))
            first = fields(source, 0, ",")
            titles, _ = _titles(source, _remarks(source)[1])
        except FormatError:
            return False
        plain_layout = any(_TITLE.fullmatch(title) for title in titles)
        return is_motive(first) or is_deeplabcut(first) or plain_layout


def _read_plain(source: Source, character: str | None) -> Points:
    path, (told, at) = source.path, _remarks(source)
    titles, separator = _titles(source, at)
    columns = _Columns.of(source, at, titles)
    table = read_table(source, line_end(source, at), len(titles), separator.encode())
    if columns.frame is not None:
        table = table.numbered(columns.frame)
    checked_size(path, len(table.values), len(columns.places))
    rate = _told_rate(told)
    if not rate and columns.time is not None:
        rate = rate_of(table.values[:, columns.time]) or 0.0
    names, notes = list(columns.places), Notes(path)
    places = table.values[:, list(columns.places.values())]
    seen = np.asarray(np.isfinite(places).all(axis=2).any(axis=0)).tolist()
    kept = of_one_body(names, seen, notes, character)
    others = {kind: own for kind, own in columns.others.items() if own}
    return made(
        path,
        [names[number] for number in kept],
        places[:, kept],
        rate or rate_assumed(path),
        notes=notes,
        units=told.get("units", ""),
        image=told.get("image", "").lower() in ("yes", "true", "1"),
        **{kind: _filled(table.values, own)[:, kept] for kind, own in others.items()},
    )


def _filled(values: Array, columns: Sequence[int]) -> Array:
    return np.nan_to_num(values[:, columns])


def _remarks(source: Source) -> tuple[dict[str, str], int]:
    """Return what lines that begin with ``#`` tell, and the byte after them."""
    told: dict[str, str] = {}
    at = 0
    for _ in range(_REMARKS):
        end = line_end(source, at)
        line = source.decode(at, end).strip()
        if line and not line.startswith("#"):
            break
        for piece in line.lstrip("# ").split(","):
            key, _, value = piece.partition(":")
            told[key.strip().lower()] = plain(value)
        at = end
    return told, at


def _told_rate(told: dict[str, str]) -> float:
    word = told.get("fps", "").encode()
    return max(0.0, float(word)) if decimals.is_number(word) else 0.0


def _titles(source: Source, at: int) -> tuple[list[str], str]:
    """Return the titles, and what separates them: that of which there is most."""
    line = source.decode(at, line_end(source, at))
    separator = max(_SEPARATORS, key=line.count)
    return fields(source, at, separator), separator


@dataclass(frozen=True)
class _Columns:
    """Where the numbers of each point stand; `others` by their name in `Points`."""

    frame: int | None
    time: int | None
    places: dict[str, list[int]]
    others: dict[str, list[int]]

    @classmethod
    def of(cls, source: Source, at: int, titles: Sequence[str]) -> _Columns:
        """Find the columns.

        Raises
        ------
        FormatError
            If a column is none of these, or a point lacks one that others have.
        """
        first: dict[str, int] = {}
        found: dict[str, dict[str, int]] = {}
        for column, title in enumerate(titles):
            kind = "frame" if title.lower() in _FRAME else "time"
            match = _TITLE.fullmatch(title)
            if match and match[2].lower() not in found.get(match[1], {}):
                found.setdefault(match[1], {})[match[2].lower()] = column
            elif match:
                raise source.error(
                    f"expected titles that differ, found {text.shown(title)} twice", at
                )
            elif title.lower() in _FRAME + _TIME and kind not in first:
                first[kind] = column
            elif title or column:
                raise _no_title(source, at, title)
        axes = _axes(source, at, found)
        places = {name: [own[axis] for axis in axes] for name, own in found.items()}
        others = {
            f"{kind}s": [own[kind] for own in found.values() if kind in own]
            for kind in ("residual", "likelihood")
        }
        if any(len(own) not in (0, len(found)) for own in others.values()):
            raise source.error("expected a residual or likelihood of all points or of none", at)
        return cls(first.get("frame"), first.get("time"), places, others)


def _no_title(source: Source, at: int, title: str) -> FormatError:
    return source.error(
        f"expected titles frame, time, NAME_x, NAME_y and NAME_z, found {text.shown(title)}", at
    )


def _axes(source: Source, at: int, found: dict[str, dict[str, int]]) -> str:
    """Return the axes that all points have: xy or xyz."""
    axes = "xyz" if any("z" in own for own in found.values()) else "xy"
    if not found:
        raise _no_title(source, at, "")
    for name, own in found.items():
        if not set(axes) <= own.keys():
            raise source.error(f"expected columns {', '.join(axes)} of {text.shown(name)}", at)
    return axes


class CsvWriter(WritesPoints):
    """The writer of CSV files of points."""

    name = "csv"
    suffixes = (".csv",)

    def write_points(self, points: Points, path: Path) -> None:
        """Write a CSV file in the plain layout.

        Parameters
        ----------
        points : Points
        path : Path

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        text.save(path, _pieces(points))


def _pieces(points: Points) -> Iterator[str]:
    told = {"fps": f"{points.fps:.10g}", "units": points.units, "image": "yes" * points.image}
    yield f"# {', '.join(f'{key}: {value}' for key, value in told.items() if value)}\n"
    columns = [
        (axis, points.to_array()[..., n]) for n, axis in enumerate("xyz"[: points.dimensions])
    ]
    others: dict[str, Any] = {"residual": points.residuals, "likelihood": points.likelihoods}
    columns += [(kind, values) for kind, values in others.items() if values is not None]
    titles = (f"{_title(name)}_{kind}" for name in points.names for kind, _ in columns)
    yield ",".join(["frame", "time", *titles]) + "\n"
    values = np.stack([values for _, values in columns], axis=2)
    yield from place_rows(points, values.reshape(len(points), -1), ",")


def _title(name: str) -> str:
    """Return a name without what separates fields."""
    return re.sub(r'[,;\t"]', " ", plain(name))
