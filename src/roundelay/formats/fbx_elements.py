"""The elements of an FBX file as they are read: names with values and elements of their own."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError
from roundelay.formats.sane import LARGEST

__all__ = ["MOST_DEEP", "MOST_ELEMENTS", "Element", "Packed"]

MOST_DEEP = 64
"""Elements inside each other; programs write ten or so."""
MOST_ELEMENTS = 4_000_000
"""Elements of a file, each of which takes memory beyond its bytes."""
_LARGE = float(2**63)
# What zlib can make of a byte at most, rounded up.
_TIGHTEST = 1100


@dataclass(frozen=True)
class Packed:
    """An array that is unpacked when it is asked for.

    Parameters
    ----------
    count : int
    dtype : str
        As NumPy writes it.
    content : bytes-like
        Its numbers, by zlib if `is_packed`.
    is_packed : bool
    """

    count: int
    dtype: str
    content: memoryview
    is_packed: bool

    def unpacked(self) -> NDArray[Any] | str:
        """Return the array (n,), or a text that says what is wrong with it."""
        size = self.count * np.dtype(self.dtype).itemsize
        data = bytes(self.content)
        if self.is_packed:
            if size > _TIGHTEST * (len(data) + 1):
                return f"{size} bytes packed in {len(data)}"
            machine = zlib.decompressobj()
            try:
                data = machine.decompress(data, size + 1)
            except zlib.error as error:
                return str(error)
        if len(data) != size:
            return f"{len(data)} bytes for {self.count} numbers"
        return np.frombuffer(data, self.dtype)


@dataclass(frozen=True)
class Element:
    """Hold an element.

    Parameters
    ----------
    path : Path
        The file, for errors.
    at : int
        Where it stands: the byte of a binary file, the line of a text.
    is_text : bool
    name : str
    values : tuple
        Whole numbers, floats, texts, bytes, and arrays as `Packed`.
    inside : list of Element
    """

    path: Path
    at: int
    is_text: bool
    name: str
    values: tuple[Any, ...]
    inside: list[Element]

    def error(self, expected: str, found: str = "") -> FormatError:
        """Return the error of something wrong here."""
        place = f"in {self.name!r}" if self.is_text else f"in {self.name!r} at byte {self.at}"
        shown = found or f"{len(self.values)} other values"
        line = self.at if self.is_text else None
        return FormatError(f"expected {expected}, found {shown} {place}", path=self.path, line=line)

    def all(self, name: str) -> Iterator[Element]:
        """Yield the elements of a name inside."""
        return (one for one in self.inside if one.name == name)

    def first(self, name: str) -> Element | None:
        """Return the first element of a name inside, if there is one."""
        return next(self.all(name), None)

    def within(self, *names: str) -> Element | None:
        """Return the first element on a path of names, if there is one."""
        one: Element | None = self
        for name in names:
            one = None if one is None else one.first(name)
        return one

    def text(self, number: int, default: str | None = None) -> str:
        """Return a value that is a text.

        Raises
        ------
        FormatError
            If it is none, and there is no default.
        """
        value = self.values[number] if number < len(self.values) else None
        if isinstance(value, str):
            return value
        if default is None:
            raise self.error(f"a text as value {number + 1}")
        return default

    def whole(self, number: int = 0, default: int | None = None) -> int:
        """Return a value that is a whole number.

        Raises
        ------
        FormatError
            If it is none, and there is no default.
        """
        value = self.values[number] if number < len(self.values) else default
        if isinstance(value, float) and value.is_integer():
            value = int(value)
        if isinstance(value, int):
            return int(value)
        raise self.error(f"a whole number as value {number + 1}")

    def numbers(self, first: int = 0, count: int | None = None) -> NDArray[np.float64]:
        """Return finite numbers (n,): those of an array, or the values from one on.

        Raises
        ------
        FormatError
            If they are no numbers, not finite, or not so many.
        """
        values = self.array() if first == 0 else np.array(self._plain(first))
        values = values.astype(float) if count is None else values[:count].astype(float)
        if count is not None and len(values) != count:
            raise self.error(f"{count} numbers", f"{len(values)}")
        if not np.all(np.abs(values) <= LARGEST):
            raise self.error(f"finite numbers of at most {LARGEST:g}", "others")
        return values

    def array(self) -> NDArray[Any]:
        """Return the array (n,) of this element, or its values as one.

        Raises
        ------
        FormatError
            If it cannot be unpacked, or holds anything but numbers.
        """
        packed = self.values[0] if self.values else None
        if not isinstance(packed, Packed):
            return np.array(self._plain(0))
        found = packed.unpacked()
        if isinstance(found, str):
            raise self.error("an array", found)
        return found

    def _plain(self, first: int) -> list[float]:
        values = list(self.values[first:])
        if not all(isinstance(x, int | float) for x in values):
            raise self.error("numbers")
        # What no array holds is no finite number of sane size either.
        return [x if abs(x) < _LARGE else float("inf") for x in values]
