"""Scanning text files strictly, with the line and column of whatever is wrong."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError, GapsFilled, RoundelayWarning
from roundelay.base.files import content, written_beside
from roundelay.formats import decimals
from roundelay.formats.encodings import in_utf8
from roundelay.formats.sane import LARGEST, fault_of_size, require_memory

__all__ = [
    "Cursor",
    "Source",
    "Token",
    "check_proportion",
    "filled",
    "lines",
    "load",
    "numbers",
    "parted",
    "rows",
    "save",
    "shown",
    "with_points",
    "without_comments",
]

_TOKEN = re.compile(rb"[{}]|[^\s{}]+")
_LINE_END = re.compile(rb"[\n{}]")
_WORD = re.compile(rb"\S+")
_CONTROL = bytes(set(range(32)) - set(b"\t\n\v\f\r\x1a"))
# Between a digit and the sign of the next number.
_GLUED = re.compile(rb"(?<=[0-9.])(?=[+-])")
# How programs write that there is no number, the old Windows ones as 1.#QNAN.
_GAP = re.compile(rb"[+-]?nan(\(\w*\))?|[+-]?1\.#(qnan|ind)0*", re.IGNORECASE)
_COMMA = re.compile(rb"(?<=[0-9]),(?=[0-9])")
_OFFSET = re.compile(rb"offset[^\n{}]*", re.IGNORECASE)
_SHOWN = 40
_SMALL = 1 << 16
_BLOCK = 1 << 16
_DECIMALS = 8


@dataclass(frozen=True)
class Source:
    """Hold the bytes of a text file and the place they came from."""

    path: Path
    data: bytes

    def error(self, message: str, at: int) -> FormatError:
        """Return the error of something wrong at a byte offset."""
        at = min(at, len(self.data))
        start = self.data.rfind(b"\n", 0, at) + 1
        column = len(self.data[start:at].decode("utf-8", "replace")) + 1
        line = self.data.count(b"\n", 0, at) + 1
        return FormatError(message, path=self.path, line=line, column=column)

    def decode(self, start: int, stop: int) -> str:
        """Return a piece of the file as text.

        Raises
        ------
        FormatError
            If it is not UTF-8.
        """
        try:
            return self.data[start:stop].decode("utf-8")
        except UnicodeDecodeError as error:
            at = start + error.start
            found = self.data[at]
            told = f"expected UTF-8 text, found byte 0x{found:02x}"
            raise self.error(f"{told}; name its encoding by --encoding", at) from None

    @property
    def end(self) -> int:
        """Byte offset just after the last character that is not white space."""
        return len(self.data.rstrip())


@dataclass(frozen=True)
class Token:
    """Hold a word of the file and its byte offset."""

    text: str
    at: int


def load(path: Path, encoding: str | None = None) -> Source:
    """Read a text file: UTF-8, a byte order mark allowed; LF, CRLF or CR ends a line.

    Text in UTF-16 with its mark, in GBK or in Shift-JIS is turned into UTF-8, with a note.

    Parameters
    ----------
    path : Path
    encoding : str, optional
        That of the file; found out by default.

    Raises
    ------
    FormatError
        If it is empty, binary or in another encoding.
    OSError
        If it cannot be read.
    """
    data = in_utf8(path, content(path), encoding)
    source = Source(path, data.removeprefix(b"\xef\xbb\xbf"))
    if not source.data.strip():
        raise source.error("expected a motion capture, found an empty file", 0)
    _refuse_binary(source)
    if b"\n" not in source.data:
        return Source(path, source.data.replace(b"\r", b"\n"))
    return source


def _refuse_binary(source: Source) -> None:
    if len(source.data.translate(None, _CONTROL)) == len(source.data):
        return
    at = next(i for i, byte in enumerate(source.data) if byte in _CONTROL)
    raise source.error(f"expected text, found byte 0x{source.data[at]:02x}", at)


def without_comments(source: Source) -> Source:
    """Return the file with comments (from ``#`` or ``//`` to the line's end) blanked out."""
    if b"#" not in source.data and b"//" not in source.data:
        return source
    data = bytearray(source.data)
    for mark in (b"#", b"//"):
        at = data.find(mark)
        while at >= 0:
            end = at + len(mark)
            if at == 0 or data[at - 1 : at].isspace():
                end = (data.find(b"\n", at) + 1 or len(data) + 1) - 1
                data[at:end] = b" " * (end - at)
            at = data.find(mark, end)
    return Source(source.path, bytes(data))


class Cursor:
    """Walk through the words of a file; braces are words of their own."""

    def __init__(self, source: Source, position: int = 0) -> None:
        self.source = source
        self.position = position

    def follows(self, *words: str) -> bool:
        """Tell whether the next word is one of some words in any case; it stays the next."""
        match = _TOKEN.search(self.source.data, self.position)
        found = b"" if match is None else match.group().lower()
        return found in {word.lower().encode() for word in words}

    def next(self, expected: str) -> Token:
        """Return the next word.

        Raises
        ------
        FormatError
            At the file's end, saying what was expected there.
        """
        match = _TOKEN.search(self.source.data, self.position)
        if match is None:
            raise self.source.error(
                f"expected {expected}, found the end of the file", self.source.end
            )
        self.position = match.end()
        return Token(self.source.decode(*match.span()), match.start())

    def keyword(self, *words: str) -> Token:
        """Return the next word, one of some words in any case.

        Raises
        ------
        FormatError
            If it is another.
        """
        expected = " or ".join(words)
        token = self.next(expected)
        if token.text.lower() not in {word.lower() for word in words}:
            raise self.found(expected, token)
        return token

    def number(self, expected: str) -> float:
        """Return the next word as a finite decimal number."""
        token = self.next(expected)
        return self.as_number(token, expected)

    def as_number(self, token: Token, expected: str) -> float:
        """Return a word as a finite decimal number.

        Raises
        ------
        FormatError
            If it is none: NaN, infinity, hexadecimal and underscores are not accepted.
        """
        if decimals.is_number(token.text.encode()):
            return float(token.text)
        raise self.found(expected, token)

    def value(self, token: Token) -> float:
        """Return a word as a finite decimal number, or as NaN if it says so.

        Raises
        ------
        FormatError
            If it is neither.
        """
        gap = _GAP.fullmatch(token.text.encode())
        return np.nan if gap else self.as_number(token, "a number")

    def line(self) -> Token:
        """Return the rest of the line up to a brace, without surrounding blanks."""
        start = self.position
        match = _LINE_END.search(self.source.data, start)
        self.position = match.start() if match else len(self.source.data)
        text = self.source.decode(start, self.position)
        return Token(text.strip(), start + len(text) - len(text.lstrip()))

    def found(self, expected: str, token: Token) -> FormatError:
        """Return the error of a word that is not what was expected."""
        large = decimals.is_decimal(token.text.encode()) and abs(float(token.text)) > LARGEST
        more = f", more than {LARGEST:g}" if large else ""
        return self.source.error(f"expected {expected}, found {shown(token.text)}{more}", token.at)


def shown(text: str) -> str:
    """Return a word as error messages show it."""
    return repr(text if len(text) <= _SHOWN else text[:_SHOWN] + "...")


def numbers(source: Source, start: int, *, salvage: bool = False) -> NDArray[np.float64]:
    """Return the numbers (n,) from a byte offset to the file's end.

    Numbers that stand glued together, as in ``66.8-0.01``, are parted, with a note. NaN, however
    a program writes it, is a gap: what was not seen.

    Parameters
    ----------
    source : Source
    start : int
    salvage : bool
        Give NaN for words that are no number.

    Raises
    ------
    FormatError
        At the first word that is not a finite decimal number.
    """
    values = decimals.parse(source.data, start)
    if values is None:
        values = _parted(source, start)
    if values is None:
        words = _GLUED.sub(b" ", source.data[start:]).split()
        known = [decimals.is_number(word) for word in words]
        others = (word for word, number in zip(words, known, strict=True) if not number)
        if not (salvage or all(map(_GAP.fullmatch, others))):
            raise _bad_number(source, start)
        values = np.array(
            [float(x) if number else np.nan for x, number in zip(words, known, strict=True)]
        )
    return values


def filled(source: Source, start: int, table: NDArray[np.float64]) -> NDArray[np.float64]:
    """Put straight lines where numbers (F, C) are missing, channel by channel, with a note.

    Raises
    ------
    FormatError
        If a channel has no number at all.
    """
    missing = ~np.isfinite(table)
    if not missing.any():
        return table
    result, frames = table.copy(), np.arange(len(table))
    for column in np.flatnonzero(missing.any(axis=0)).tolist():
        known = ~missing[:, column]
        if not known.any():
            raise source.error(f"expected a number in channel {column + 1}, found none", start)
        result[:, column] = np.interp(frames, frames[known], table[known, column])
    told = (
        f"{int(missing.sum())} values that are missing or no number, in {_in_words(missing)}, are "
        "filled from the frames beside them"
    )
    warnings.warn(f"{source.path}: {told}", GapsFilled, stacklevel=3)
    return result


def _in_words(missing: NDArray[np.bool_]) -> str:
    frames = np.flatnonzero(missing.any(axis=1))
    if frames[0] == frames[-1]:
        return f"frame {frames[0]}"
    return f"{len(frames)} frames from {frames[0]} to {frames[-1]}"


def _parted(source: Source, start: int) -> NDArray[np.float64] | None:
    """Return numbers some of which are glued, or None if that is not all that is wrong."""
    parted, count = _GLUED.subn(b" ", source.data[start:])
    values = decimals.parse(parted) if count else None
    if values is not None:
        at = start + _GLUED.search(source.data[start:]).start()  # type: ignore[union-attr]
        warned = source.error(f"{count} numbers that stand glued together are parted", at)
        warnings.warn(str(warned), RoundelayWarning, stacklevel=2)
    return values


def parted(line: bytes) -> list[bytes]:
    """Return the words of a line of numbers, glued ones parted."""
    return _GLUED.sub(b" ", line).split()


def with_points(source: Source) -> Source:
    """Return a BVH whose numbers have decimal points for commas, if commas are all they have.

    Those before MOTION follow OFFSET; names keep their commas.
    """
    if b"," not in source.data:
        return source
    start = max(source.data.lower().rfind(b"motion"), 0)
    body = source.data[start:]
    if b"," not in body or b"." in body:
        return source
    head = _OFFSET.sub(lambda match: match.group().replace(b",", b"."), source.data[:start])
    warnings.warn(
        f"{source.path}: decimal commas are read as points", RoundelayWarning, stacklevel=2
    )
    return Source(source.path, head + _COMMA.sub(b".", body))


def check_proportion(source: Source, at: int, frames: int, joints: int) -> None:
    """Refuse a motion too large, or out of proportion to its file: few channels, many frames.

    Raises
    ------
    FormatError
        If there are more joints or frames than any capture has, or more than two poses of a joint
        for a byte.
    TooLarge
        If there is no memory for the poses.
    """
    fault, size = fault_of_size(frames, joints), len(source.data)
    if fault is not None:
        raise source.error(fault, at)
    require_memory(frames, joints)
    if frames * joints > 2 * size + _SMALL:
        raise source.error(
            f"expected channels on most of the joints, found {frames} frames of {joints} joints "
            f"in {size} bytes",
            at,
        )


def _bad_number(source: Source, start: int) -> FormatError:
    for match in _WORD.finditer(source.data, start):
        if not decimals.is_number(match.group()):
            token = Token(source.decode(*match.span()), match.start())
            return Cursor(source).found("a number", token)
    raise AssertionError("the fast and the strict reader disagree on what is a number")


def lines(source: Source, start: int = 0) -> Iterator[list[Token]]:
    """Return the words of each line that is not blank, from a byte offset on.

    Raises
    ------
    FormatError
        At a byte that is not UTF-8.
    """
    while start < len(source.data):
        stop = source.data.find(b"\n", start) + 1 or len(source.data)
        found = _WORD.finditer(source.data, start, stop)
        line = [Token(source.decode(*match.span()), match.start()) for match in found]
        if line:
            yield line
        start = stop


def save(path: Path, pieces: Iterable[str]) -> None:
    """Write a text file beside its place and rename it, so that it appears whole or not at all.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    with written_beside(path) as part, part.open("w", encoding="utf-8", newline="\n") as file:
        file.writelines(pieces)


def rows(table: NDArray[np.float64], row: str) -> Iterator[str]:
    """Yield the text of a table (F, C), its numbers put into ``row`` with C fields ``%s``."""
    block = max(1, _BLOCK // max(1, table.shape[1]))
    for start in range(0, len(table), block):
        # Rounding first leaves no digits of the decimals' binary noise, and no -0.
        part = np.round(table[start : start + block], _DECIMALS) + 0.0
        yield row.replace("%s", "%.10g") * len(part) % tuple(part.ravel().tolist())
