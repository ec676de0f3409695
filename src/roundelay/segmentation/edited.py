"""Cuts and names that a person edited: tables of behaviours in and out.

Read are our own bout tables after an edit, and tables of other programs for annotation: with a
heading (ELAN, BORIS, any spreadsheet) or without one (Audacity: start, end, name).
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from roundelay.base.cells import cell
from roundelay.base.errors import FormatError
from roundelay.segmentation.result import Curve, Segment, Segmentation

__all__ = ["Edited", "edited_segments", "tab_separated"]

_START = ("start", "begin", "begin time", "start (s)", "begin time - ss.msec", "onset")
_STOP = ("end", "stop", "end time", "stop (s)", "end time - ss.msec", "offset")
_FRAMES = ("start_frame", "end_frame")
_NAME = ("name", "behavior", "behaviour", "annotation", "value", "label")


@dataclass(frozen=True)
class Edited:
    """Where cuts are from.

    Parameters
    ----------
    file : str
    """

    file: str


@dataclass(frozen=True)
class _Row:
    line: int
    start: int
    stop: int
    name: str


def edited_segments(path: Path, n_frames: int, fps: float) -> Segmentation:
    """Read cuts and names from a table that a person edited.

    Parameters
    ----------
    path : path-like
        Separated by commas, semicolons or tabs. Its heading names the columns of starts and ends
        in seconds ("start", "end"; as ELAN and BORIS call them, too) and of names ("name",
        "behavior", "annotation", "label"); without a heading they are the first three.
    n_frames : int
        Of the take.
    fps : float
        Its frames a second.

    Returns
    -------
    Segmentation
        What the table leaves out is a segment without a name. Equal names are one label.

    Raises
    ------
    FormatError
        If the table has no such columns, a time is no number or outside the take, a behaviour
        ends before it starts, or two overlap; with the line.
    """
    path = Path(path)
    rows = sorted(_rows(path, n_frames, fps), key=lambda row: row.start)
    if not rows:
        raise FormatError("expected a row for each behaviour, found none", path=path)
    for one, other in pairwise(rows):
        if other.start < one.stop:
            raise FormatError(
                f"expected behaviours that do not overlap, found one that starts at "
                f"{other.start / fps:g} s before that of line {one.line} ends, at "
                f"{one.stop / fps:g} s",
                path=path,
                line=other.line,
            )
    places = np.zeros(1)
    curve = Curve(places, places, "cuts of a person")
    segments = tuple(_filled(rows, n_frames))
    return Segmentation(segments, "edited", Edited(path.name), 1.0 / fps, curve)


def tab_separated(found: Segmentation) -> str:
    """Return start, end and name of each segment, which ELAN, BORIS and Audacity read.

    Parameters
    ----------
    found : Segmentation
    """
    text = io.StringIO()
    writer = csv.writer(text, delimiter="\t", lineterminator="\n")
    writer.writerow(["start", "end", "name"])
    for segment in found.segments:
        times = (segment.start * found.frame_time, segment.stop * found.frame_time)
        writer.writerow([*(f"{time:.6f}" for time in times), cell(segment.title)])
    return text.getvalue()


def _rows(path: Path, n_frames: int, fps: float) -> Iterator[_Row]:
    """Read and check the rows of a table, each by itself."""
    table = _table(path)
    columns = _columns(table[0], path) if table else (0, 1, 2)
    headed = bool(table) and not _number(table[0][0])
    for line, cells in enumerate(table, 1):
        if (headed and line == 1) or not any(cells):
            continue
        cells = [*cells, *[""] * (max(columns) + 1 - len(cells))]
        start, stop = (_time(cells[column], path, line) for column in columns[:2])
        first, last = round(start * fps), round(stop * fps)
        if not 0 <= first < last <= n_frames:
            raise FormatError(
                f"expected a behaviour within 0 and {n_frames / fps:g} s that ends after it "
                f"starts, found {start:g} to {stop:g} s",
                path=path,
                line=line,
            )
        _check_frames(table[0], cells, (first, last), path, line)
        yield _Row(line, first, last, cells[columns[2]])


def _check_frames(
    heading: Sequence[str], cells: Sequence[str], found: tuple[int, int], path: Path, line: int
) -> None:
    """Refuse frames that were edited where the seconds beside them were not, or the reverse."""
    for name, frame in zip(_FRAMES, found, strict=True):
        told = cells[heading.index(name)] if name in heading[: len(cells)] else ""
        if told and not (_number(told) and abs(float(told) - frame) <= 1.0):
            raise FormatError(
                f"expected {name} as the seconds beside it, {frame}, found {told}; change both, or "
                "leave the columns of frames out",
                path=path,
                line=line,
            )


def _table(path: Path) -> list[list[str]]:
    """Split a table into cells, by what separates its first line."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise FormatError(
            f"expected a table as UTF-8 text, found {error.reason}", path=path
        ) from None
    first = text.partition("\n")[0]
    separator = max("\t;,", key=first.count)
    return [
        [cell.strip() for cell in row] for row in csv.reader(io.StringIO(text), delimiter=separator)
    ]


def _columns(heading: Sequence[str], path: Path) -> tuple[int, int, int]:
    """Return which columns hold starts, ends and names."""
    if heading and _number(heading[0]):
        return 0, 1, 2
    names = [text.lower() for text in heading]
    found = [
        next((names.index(word) for word in words if word in names), None)
        for words in (_START, _STOP, _NAME)
    ]
    start, stop, name = found
    if start is None or stop is None or name is None:
        raise FormatError(
            'expected a heading with the columns "start", "end" and "name" (or those of ELAN or '
            f"BORIS), found {', '.join(heading) or 'an empty line'}",
            path=path,
            line=1,
        )
    return start, stop, name


def _number(text: str) -> bool:
    try:
        return bool(np.isfinite(float(text)))
    except ValueError:
        return False


def _time(text: str, path: Path, line: int) -> float:
    if not _number(text):
        raise FormatError(f"expected a time in seconds, found {text!r}", path=path, line=line)
    return float(text)


def _filled(rows: Sequence[_Row], n_frames: int) -> Iterator[Segment]:
    """Make segments of rows in order, and of what lies between them."""
    number: dict[str, int] = {}
    place = 0
    for row in [*rows, _Row(0, n_frames, n_frames, "")]:
        if row.start > place:
            yield Segment(place, row.start, number.setdefault("", len(number)))
        if row.stop > row.start:
            yield Segment(
                row.start, row.stop, number.setdefault(row.name, len(number)), name=row.name
            )
        place = row.stop
