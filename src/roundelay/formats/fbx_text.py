"""Read FBX as text, of versions 6.1 to 7.7, as a tree of elements.

``Name: values {`` begins an element that holds others; values stand between commas, over several
lines if they do. ``*3 { a: 1,2,3 }`` is an array.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError
from roundelay.formats import decimals
from roundelay.formats.fbx_elements import MOST_DEEP, MOST_ELEMENTS, Element, Packed

__all__ = ["elements_of_text", "is_text"]

_START = re.compile(rb"\A(?:\xef\xbb\xbf)?\s*;[^\n]*FBX", re.IGNORECASE)
_COMMENT = re.compile(r"^[ \t]*;[^\n]*", re.MULTILINE)
_NAME = re.compile(r"\s*(?:([A-Za-z_][\w|.\-]*)[ \t]*:|(\})|(\Z))")
_STRING = re.compile(r'[ \t]*"([^"]*)"')
_BARE = re.compile(r"[ \t]*([^\s,{}\"]*)")
_COMMA = re.compile(r"[ \t]*(?:\n\s*)?,[ \t]*(?:\n[ \t]*)?")
_OPEN = re.compile(r"[ \t]*\{")
_ARRAY = re.compile(r"\s*\*(\d{1,9})\s*\{\s*a:([^{}\"]*)\}")
_NUMERIC = re.compile(r"[0-9+\-.eE,\s]*")
_BROKEN = re.compile(r"[.eE]")
_VERSION = re.compile(r"FBXVersion:\s*(\d{4,5})")
_OLDEST, _NEWEST = 6000, 8000
_ENTITIES = {"&quot;": '"', "&cr;": "\r", "&lf;": "\n"}


def is_text(data: bytes) -> bool:
    """Tell whether a file begins as FBX in text does."""
    return _START.match(data[:200]) is not None or b"FBXHeaderExtension:" in data[:2000]


def elements_of_text(path: Path, data: bytes) -> tuple[int, Element]:
    """Return the version of a file, and an element that holds all others.

    Raises
    ------
    FormatError
        If it is cut short, of another version, or not sound; with the line.
    """
    text = data.removeprefix(b"\xef\xbb\xbf").decode("utf-8", "replace").replace("\r\n", "\n")
    version = _VERSION.search(text)
    if version is None or not _OLDEST <= int(version[1]) <= _NEWEST:
        told = "none" if version is None else f"version {int(version[1]) / 1000:g}"
        raise FormatError(f"expected FBX of version 6.1 to 7.7, found {told}", path=path)
    reading = _Reading(path, _COMMENT.sub("", text))
    return int(version[1]), Element(path, 1, True, "", (), reading.elements())


class _Reading:
    """Walk through a text."""

    def __init__(self, path: Path, text: str) -> None:
        self.path = path
        self.text = text
        self.at = 0
        self.line, self.counted = 1, 0

    def error(self, expected: str, found: str) -> FormatError:
        told = f"expected {expected}, found {found}"
        return FormatError(told, path=self.path, line=self.here())

    def here(self) -> int:
        """Return the line; what was counted once is not counted again."""
        self.line += self.text.count("\n", self.counted, self.at)
        self.counted = self.at
        return self.line

    def elements(self) -> list[Element]:
        """Return all elements of the file."""
        opened: list[list[Element]] = [[]]
        count = 0
        while True:
            match = _NAME.match(self.text, self.at)
            if match is None:
                raise self.error("a name, or }", repr(self.text[self.at : self.at + 20].strip()))
            self.at = match.end()
            if match[1] is None:
                if self._closed(opened, match[2] is None):
                    return opened[0]
                continue
            one = Element(self.path, self.here(), True, match[1], self._values(), [])
            opened[-1].append(one)
            count += 1
            if count > MOST_ELEMENTS:
                raise self.error(f"at most {MOST_ELEMENTS} elements", "more")
            if self._taken(_OPEN):
                opened.append(one.inside)
                if len(opened) > MOST_DEEP:
                    raise self.error(f"elements at most {MOST_DEEP} deep", "deeper ones")

    def _closed(self, opened: list[list[Element]], at_end: bool) -> bool:
        """Close an element at a brace; tell whether the file is over."""
        if at_end:
            if len(opened) > 1:
                raise self.error("}", "the end of the file")
            return True
        if len(opened) == 1:
            raise self.error("a name", "}")
        opened.pop()
        return False

    def _taken(self, what: re.Pattern[str]) -> re.Match[str] | None:
        match = what.match(self.text, self.at)
        if match is not None:
            self.at = match.end()
        return match

    def _values(self) -> tuple[Any, ...]:
        array = self._taken(_ARRAY)
        if array is not None:
            return (self._array(int(array[1]), array[2]),)
        values: list[Any] = []
        while True:
            quoted = self._taken(_STRING)
            if quoted is not None:
                values.append(_plain_text(quoted[1]))
            else:
                bare = self._taken(_BARE)
                if bare is not None and bare[1]:
                    values.append(_value(bare[1]))
            if self._taken(_COMMA) is None:
                return tuple(values)

    def _array(self, count: int, text: str) -> Packed:
        numbers = _numbers(text)
        if numbers is None:
            raise self.error("numbers", "others in an array")
        if len(numbers) != count:
            raise self.error(f"an array of {count} numbers", f"{len(numbers)}")
        return Packed(count, numbers.dtype.str, memoryview(numbers.tobytes()), False)


def _numbers(text: str) -> NDArray[Any] | None:
    """Return numbers between commas, whole ones as such: ticks take more than 53 bits."""
    if _NUMERIC.fullmatch(text) is None:
        return None
    words = text.replace(",", " ").split()
    try:
        if _BROKEN.search(text) is None:
            return np.array([int(word) for word in words], "<i8")
        return np.array([float(word) for word in words], "<f8")
    except (ValueError, OverflowError):
        return None


def _plain_text(text: str) -> str:
    if "&" in text:
        for name, letter in _ENTITIES.items():
            text = text.replace(name, letter)
    return text


def _value(word: str) -> Any:
    """Return a word as the number that it is, else as it is."""
    raw = word.encode()
    if not decimals.is_decimal(raw):
        return word
    try:
        return int(word)
    except ValueError:
        return float(word)
