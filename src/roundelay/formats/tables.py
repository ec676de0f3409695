"""Tables of numbers in text files, where a field that is empty says that something is missing."""

from __future__ import annotations

import csv
import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError, RoundelayWarning
from roundelay.formats import decimals
from roundelay.formats.sane import MOST_FRAMES
from roundelay.formats.text import Source, shown

__all__ = ["Table", "fields", "line_end", "rate_of", "read_table"]

Array = NDArray[np.float64]
Places = NDArray[np.intp]

_BLOCK = 1 << 20
_NO_NUMBER = re.compile(rb"(?<![^\s,;])nan(?![^\s,;])", re.IGNORECASE)
_WITH_COMMA = re.compile(rb"[+-]?\d+,\d+")
_NEW_LINE = ord("\n")
# Frames that are not there, for a frame that is; more are a slip in numbering.
_SKIPPED = 4


@dataclass(frozen=True, eq=False)
class Table:
    """Rows of numbers.

    Parameters
    ----------
    values : (R, C) array
        NaN where a field is empty.
    places : (R,) array
        Byte at which each row begins.
    source : Source
    """

    values: Array
    places: Places
    source: Source

    def error(self, message: str, row: int) -> FormatError:
        """Return the error of something wrong in a row."""
        return self.source.error(message, int(self.places[row]))

    def without(self, columns: int) -> Array:
        """Return the values without so many columns in front."""
        return self.values[:, columns:]

    def numbered(self, column: int) -> Table:
        """Return rows for all frame numbers from the first to the last, those not there empty.

        Raises
        ------
        FormatError
            If numbers are not whole, do not grow, or skip more frames than there are.
        """
        numbers = self.values[:, column]
        odd = np.flatnonzero(~(numbers == np.round(numbers)) | ~(np.abs(numbers) < 2**53))
        if len(odd):
            raise self.error("expected a whole frame number", odd[0])
        back = np.flatnonzero(np.diff(numbers) < 1.0)
        if len(back):
            found = f"{numbers[back[0] + 1]:.0f} after {numbers[back[0]]:.0f}"
            raise self.error(f"expected frame numbers that grow, found {found}", back[0] + 1)
        count = int(numbers[-1] - numbers[0]) + 1
        if count == len(numbers):
            return self
        if count > min(MOST_FRAMES, (1 + _SKIPPED) * len(numbers)):
            row = int(np.argmax(np.diff(numbers))) + 1
            found = f"{numbers[row]:.0f} after {numbers[row - 1]:.0f}"
            raise self.error(f"expected frame numbers without large gaps, found {found}", row)
        filled = np.full((count, self.values.shape[1]), np.nan)
        filled[(numbers - numbers[0]).astype(int)] = self.values
        return replace(self, values=filled, places=np.full(count, self.places[0]))


def line_end(source: Source, at: int) -> int:
    """Return the byte after the line in which a byte lies."""
    return source.data.find(b"\n", at) + 1 or len(source.data)


def fields(source: Source, at: int, separator: str) -> list[str]:
    """Return the fields of a line, quoted or not, without blanks around them.

    Raises
    ------
    FormatError
        If the line is not UTF-8.
    """
    line = source.decode(at, line_end(source, at)).strip("\r\n")
    try:
        row = next(csv.reader([line], delimiter=separator), [])
    except csv.Error as error:
        raise source.error(f"expected fields, found {error}", at) from None
    return [field.strip() for field in row]


def rate_of(times: Array) -> float | None:
    """Return frames a second of times (F,) in seconds; None if they tell none."""
    seen = np.flatnonzero(np.isfinite(times))
    if len(seen) < 2 or not times[seen[-1]] > times[seen[0]]:
        return None
    # Rounded times tell a rate to so many digits.
    rate = float((seen[-1] - seen[0]) / (times[seen[-1]] - times[seen[0]]))
    whole = round(rate)
    return float(whole) if whole and abs(rate / whole - 1.0) < 1e-4 else rate


def read_table(
    source: Source, at: int, columns: int, separator: bytes | None, *, cropped: bool = False
) -> Table:
    """Read rows of so many fields each, from a byte to the end of the file.

    Parameters
    ----------
    source : Source
    at : int
        Where a line begins.
    columns : int
        At least two.
    separator : bytes, optional
        Of one byte; white space by default.
    cropped : bool
        Whether fields beyond the last column are left out, and not refused.

    Returns
    -------
    Table
        Lines of blanks alone are left out, and so is what is empty beyond the last column.

    Raises
    ------
    FormatError
        With line and column: at a field that is no number, or a line with too few or too many;
        if there is no row.
    """
    source = _with_points(source, at, separator)
    values, places = [np.empty((0, columns))], [np.empty(0, np.intp)]
    for start, stop in _blocks(source, at):
        rows, begins = _read_block(source, (start, stop), columns, separator, cropped)
        values.append(rows)
        places.append(begins)
    table = Table(np.concatenate(values), np.concatenate(places), source)
    if not len(table.values):
        raise source.error("expected rows of numbers, found none", source.end)
    return table


def _with_points(source: Source, at: int, separator: bytes | None) -> Source:
    """Return a table whose decimal commas, if it has any, are decimal points."""
    if separator == b"," or b"," not in source.data[at:] or b"." in source.data[at:]:
        return source
    text = f"{source.path}: decimal commas read as decimal points"
    warnings.warn(text, RoundelayWarning, stacklevel=6)
    return Source(source.path, source.data[:at] + source.data[at:].replace(b",", b"."))


def _blocks(source: Source, at: int) -> Iterator[tuple[int, int]]:
    while at < len(source.data):
        stop = line_end(source, min(at + _BLOCK, len(source.data) - 1))
        yield at, stop
        at = stop


def _read_block(
    source: Source,
    span: tuple[int, int],
    columns: int,
    separator: bytes | None,
    cropped: bool,
) -> tuple[Array, Places]:
    """Return rows (R, C) of whole lines, and the byte at which each begins."""
    start, stop = span
    block = source.data[start:stop].replace(b'"', b" ").rstrip(b"\n") + b"\n"
    begins = start + _line_begins(block)
    if separator is None:
        block = b"\n".join(b"\t".join(line.split()) for line in block.split(b"\n"))
    if b"n" in block or b"N" in block:
        block = _NO_NUMBER.sub(b"   ", block)
    layout = _Layout.of(block, separator or b"\t")
    fault = layout.fault(columns, cropped)
    if fault is not None:
        message, line = fault
        end = line_end(source, int(begins[line]))
        raise source.error(message, len(source.data[:end].rstrip()))
    numbers = decimals.parse(block.replace(separator or b"\t", b" "))
    if numbers is None or len(numbers) != layout.filled.sum():
        raise _bad_field(source, start, stop, separator)
    result = np.full((len(begins), columns), np.nan)
    lines, places = layout.line[layout.filled], layout.field[layout.filled]
    inside = places < columns
    result[lines[inside], places[inside]] = numbers[inside]
    kept = np.logical_not(layout.blank)
    return result[kept], begins[kept]


def _line_begins(block: bytes) -> Places:
    """Return where each line begins; all end."""
    ends = np.flatnonzero(np.frombuffer(block, np.uint8) == _NEW_LINE)
    return np.concatenate([[0], ends[:-1] + 1])


@dataclass(frozen=True, eq=False)
class _Layout:
    """Where fields are: the line of each, its place in it, whether it is filled.

    `blank` is of lines: which hold nothing at all.
    """

    line: Places
    field: Places
    filled: NDArray[np.bool_]
    blank: NDArray[np.bool_]

    @classmethod
    def of(cls, block: bytes, separator: bytes) -> _Layout:
        """Return the layout of lines that all end."""
        chars = np.frombuffer(block, np.uint8)
        line_ends = chars == _NEW_LINE
        separates = line_ends | (chars == ord(separator))
        ends = np.flatnonzero(separates)
        inked = np.cumsum((chars > ord(" ")) & ~separates)
        filled = np.diff(inked[ends], prepend=0) > 0
        last = np.flatnonzero(line_ends[ends])
        first = np.concatenate([[0], last[:-1] + 1])
        counts = last - first + 1
        line = np.repeat(np.arange(len(last)), counts)
        field = np.arange(len(ends)) - first[line]
        blank = (counts == 1) & np.logical_not(filled[first])
        return cls(line, field, filled, blank)

    def fault(self, columns: int, cropped: bool) -> tuple[str, int] | None:
        """Tell what is wrong with the first line that has too few or too many fields."""
        counts = np.bincount(self.line, minlength=len(self.blank))
        short = (counts < columns) & np.logical_not(self.blank)
        beyond = self.filled & (self.field >= columns) & (not cropped)
        odd = np.flatnonzero(short | np.isin(np.arange(len(counts)), self.line[beyond]))
        if not len(odd):
            return None
        line = int(odd[0])
        return f"expected {columns} fields, found {counts[line]}", line


def _bad_field(source: Source, start: int, stop: int, separator: bytes | None) -> FormatError:
    """Return the error of the first field that is no number."""
    between = rb"\s" if separator is None else separator
    at = start
    for line in source.data[start:stop].split(b"\n"):
        place = at
        for field in re.split(between, line):
            word = field.replace(b'"', b" ").strip()
            if word and word.lower() != b"nan" and not decimals.is_number(word):
                found = shown(word.decode("utf-8", "replace"))
                hint = "; write decimal points" if _WITH_COMMA.fullmatch(word) else ""
                return source.error(f"expected a number, found {found}{hint}", place)
            place += len(field) + 1
        at += len(line) + 1
    raise AssertionError("the fast and the strict reader disagree on what is a number")
