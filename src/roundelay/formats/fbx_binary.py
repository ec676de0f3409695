"""Read binary FBX, of versions 6.1 to 7.7, as a tree of elements.

Each element begins with the place where it ends, the number and the bytes of its values and its
name; from version 7.5 on, these are of 64 bits. A record of zeros ends a list of elements.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from roundelay.base.errors import FormatError
from roundelay.formats.fbx_elements import MOST_DEEP, MOST_ELEMENTS, Element, Packed

__all__ = ["MAGIC", "elements_of_binary"]

MAGIC = b"Kaydara FBX Binary  \x00"
_HEAD = 27
_PLAIN = {"Y": "<h", "I": "<i", "F": "<f", "D": "<d", "L": "<q"}
_ARRAYS = {"f": "<f4", "d": "<f8", "l": "<i8", "i": "<i4", "b": "u1", "c": "u1"}
_OLDEST, _WIDE, _NEWEST = 6000, 7500, 8000


def elements_of_binary(path: Path, data: bytes) -> tuple[int, Element]:
    """Return the version of a binary file, and an element that holds all others.

    Raises
    ------
    FormatError
        If it is cut short, of another version, or not sound; with the byte.
    """
    if len(data) < _HEAD:
        raise FormatError(f"expected a header of {_HEAD} bytes, found {len(data)}", path=path)
    version = struct.unpack_from("<I", data, 23)[0]
    if not _OLDEST <= version <= _NEWEST:
        known = "FBX of version 6.1 to 7.7"
        raise FormatError(f"expected {known}, found version {version / 1000:g}", path=path)
    reading = _Reading(path, memoryview(data), "<QQQB" if version >= _WIDE else "<IIIB")
    return version, Element(path, 0, False, "", (), reading.elements(_HEAD, len(data), 0)[0])


@dataclass
class _Reading:
    """Walk through a file."""

    path: Path
    data: memoryview
    head: str
    count: int = field(default=0)

    def error(self, expected: str, found: str, at: int) -> FormatError:
        return FormatError(f"expected {expected}, found {found} at byte {at}", path=self.path)

    def elements(self, at: int, stop: int, depth: int) -> tuple[list[Element], int]:
        """Return a list of elements, and where it ends."""
        if depth > MOST_DEEP:
            raise self.error(f"elements at most {MOST_DEEP} deep", "deeper ones", at)
        found: list[Element] = []
        while at < stop:
            one, at = self.element(at, stop, depth)
            if one is None:
                return found, at
            found.append(one)
        if depth == 0:
            raise self.error("the end of the elements", "the end of the file", at)
        return found, at

    def element(self, at: int, stop: int, depth: int) -> tuple[Element | None, int]:
        """Return an element, none for the record that ends a list, and where it ends."""
        size = struct.calcsize(self.head)
        if at + size > stop:
            raise self.error(f"an element of at least {size} bytes", f"{stop - at}", at)
        end, count, length, letters = struct.unpack_from(self.head, self.data, at)
        if end == 0:
            return None, at + size
        first = at + size + letters
        if not first + length <= end <= stop or count > length:
            raise self.error(f"an element that ends before byte {stop}", f"byte {end}", at)
        self.count += 1
        if self.count > MOST_ELEMENTS:
            raise self.error(f"at most {MOST_ELEMENTS} elements", "more", at)
        name = bytes(self.data[at + size : first]).decode("ascii", "replace")
        values = self.values(first, first + length, count)
        inside: list[Element] = []
        if first + length < end:
            inside, _ = self.elements(first + length, end, depth + 1)
        return Element(self.path, at, False, name, values, inside), end

    def values(self, at: int, stop: int, count: int) -> tuple[Any, ...]:
        found: list[Any] = []
        for _ in range(count):
            if at >= stop:
                raise self.error(f"{count} values", f"{len(found)}", at)
            value, at = self.value(chr(self.data[at]), at + 1, stop)
            found.append(value)
        return tuple(found)

    def value(self, kind: str, at: int, stop: int) -> tuple[Any, int]:
        """Return a value of a kind, and where it ends."""
        if kind in _PLAIN:
            return self.unpack(_PLAIN[kind], at, stop)
        if kind == "C":
            code, at = self.unpack("<B", at, stop)
            return (chr(code) if code > 1 else bool(code)), at
        if kind in "SR":
            length, at = self.unpack("<I", at, stop)
            raw = self.piece(at, length, stop)
            text = kind == "S"
            return (bytes(raw).decode("utf-8", "replace") if text else bytes(raw)), at + length
        if kind in _ARRAYS:
            count, at = self.unpack("<I", at, stop)
            packing, at = self.unpack("<I", at, stop)
            length, at = self.unpack("<I", at, stop)
            raw = self.piece(at, length, stop)
            return Packed(count, _ARRAYS[kind], raw, packing == 1), at + length
        raise self.error("a value of a known type", repr(kind), at - 1)

    def unpack(self, form: str, at: int, stop: int) -> tuple[Any, int]:
        size = struct.calcsize(form)
        self.piece(at, size, stop)
        return struct.unpack_from(form, self.data, at)[0], at + size

    def piece(self, at: int, length: int, stop: int) -> memoryview:
        if at + length > stop:
            raise self.error(f"a value of {length} bytes", f"{stop - at}", at)
        return self.data[at : at + length]
