"""The header and the parameters of a C3D file, of Intel, DEC and SGI processors.

Format: C3D User Guide (www.c3d.org), chapters "The header section", "The parameter section". A
file is made of blocks of 512 bytes. The first is the header; parameters follow in groups, and then
the frames. What is said of sizes is compared with the bytes that are there.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError
from roundelay.formats.point_files import Notes, plain

__all__ = ["BLOCK", "Bytes", "C3dFile", "Header", "Parameter", "decoded_reals", "open_file"]

Array = NDArray[np.float64]

BLOCK = 512
_KEY = 0x50
_INTEL, _DEC, _SGI = 84, 85, 86
_PROCESSORS = {_INTEL: "<", _DEC: "<", _SGI: ">"}
_SIZES = {-1: 1, 1: 1, 2: 2, 4: 4}


@dataclass(frozen=True)
class Bytes:
    """Hold the bytes of a file, the place they came from, and how its processor writes numbers."""

    path: Path
    data: bytes
    processor: int = _INTEL

    def error(self, message: str, at: int) -> FormatError:
        """Return the error of something wrong at a byte, counted from 0."""
        return FormatError(f"{message}, at byte {at}", path=self.path)

    def take(self, at: int, count: int, what: str) -> bytes:
        """Return some bytes.

        Raises
        ------
        FormatError
            If the file ends before.
        """
        if at < 0 or at + count > len(self.data):
            raise self.error(f"expected {what}, found the end of the file", len(self.data))
        return self.data[at : at + count]

    def word(self, at: int) -> int:
        """Return the whole number of two bytes, without sign."""
        order = _PROCESSORS[self.processor]
        return int(struct.unpack(order + "H", self.take(at, 2, "a number of two bytes"))[0])

    def real(self, at: int) -> float:
        """Return the number of four bytes."""
        return float(self.reals(self.take(at, 4, "a number of four bytes"))[0])

    def reals(self, raw: bytes) -> Array:
        """Return numbers (n,) of four bytes each."""
        return decoded_reals(np.frombuffer(raw, np.uint8), self.processor)

    def wholes(self, raw: bytes) -> NDArray[np.int16]:
        """Return whole numbers (n,) of two bytes each."""
        return np.frombuffer(raw, _PROCESSORS[self.processor] + "i2")


def decoded_reals(raw: NDArray[np.uint8], processor: int) -> Array:
    """Return the numbers (..., n) of bytes (..., 4 n); what is no number is NaN or infinite."""
    raw = np.ascontiguousarray(raw)
    with np.errstate(all="ignore"):
        if processor != _DEC:
            return raw.view(_PROCESSORS[processor] + "f4").astype(float)
        # The halves change places, and the exponent is two too large.
        halves = raw.view("<u2")
        swapped = np.ascontiguousarray(halves.reshape(*halves.shape[:-1], -1, 2)[..., ::-1])
        return swapped.reshape(halves.shape).view("<f4").astype(float) / 4.0


@dataclass(frozen=True)
class Parameter:
    """A parameter as it stands in the file.

    Parameters
    ----------
    kind : int
        -1 for text, 1, 2 for whole numbers of so many bytes, 4 for numbers.
    shape : tuple of int
        The first index runs fastest.
    raw : bytes
    source : Bytes
    """

    kind: int
    shape: tuple[int, ...]
    raw: bytes
    source: Bytes

    def texts(self) -> list[str]:
        """Return the texts of a list of texts, or the one; blanks behind them are no part."""
        width = next(iter(self.shape or (1,)))
        if self.kind != -1 or not width:
            return []
        pieces = (self.raw[at : at + width] for at in range(0, len(self.raw), width))
        return [_decoded(piece) for piece in pieces]

    def numbers(self) -> Array:
        """Return all numbers (n,) in the file's order; none of a text."""
        if self.kind == 4:
            return self.source.reals(self.raw)
        if self.kind == 2:
            return self.source.wholes(self.raw).astype(float)
        return np.frombuffer(self.raw if self.kind == 1 else b"", np.uint8).astype(float)

    def counts(self) -> list[int]:
        """Return whole numbers without sign."""
        values = self.numbers()
        wrapped = np.where((values < 0) & (self.kind == 2), values + 65536, values)
        return [int(value) if np.isfinite(value) else -1 for value in wrapped]


def _decoded(raw: bytes) -> str:
    raw = raw.split(b"\0", 1)[0].rstrip()
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


@dataclass(frozen=True)
class Header:
    """What the first block says.

    Parameters
    ----------
    points, samples : int
        Points a frame, and analog samples of all channels a frame.
    first, last : int
        Numbers of the first and the last frame.
    scale : float
        Of whole numbers; negative where frames hold numbers of four bytes.
    start : int
        Byte at which frames begin.
    per_frame : int
        Samples of each channel a frame.
    rate : float
        Frames a second.
    """

    points: int
    samples: int
    first: int
    last: int
    scale: float
    start: int
    per_frame: int
    rate: float


@dataclass(frozen=True)
class C3dFile:
    """A file whose header and parameters are read."""

    source: Bytes
    header: Header
    parameters: dict[tuple[str, str], Parameter] = field(repr=False)

    def get(self, group: str, name: str) -> Parameter | None:
        """Return a parameter, if there is one."""
        return self.parameters.get((group, name))

    def number(self, group: str, name: str, default: float) -> float:
        """Return the first number of a parameter."""
        values = self.numbers(group, name)
        return float(values[0]) if len(values) else default

    def numbers(self, group: str, name: str) -> Array:
        """Return the numbers (n,) of a parameter; none where there is none."""
        found = self.get(group, name)
        return found.numbers() if found else np.empty(0)

    def counts(self, group: str, name: str) -> list[int]:
        """Return the whole numbers of a parameter without sign; none where there is none."""
        found = self.get(group, name)
        return found.counts() if found else []

    def texts(self, group: str, name: str) -> list[str]:
        """Return the texts of a parameter and of those that continue it: LABELS, LABELS2 ..."""
        result: list[str] = []
        number = 1
        while (found := self.get(group, name if number == 1 else f"{name}{number}")) is not None:
            result += found.texts()
            number += 1
        return result


def open_file(path: Path, data: bytes, notes: Notes) -> C3dFile:
    """Read header and parameters; tell of parameters that frames overwrite.

    Raises
    ------
    FormatError
        If they are not sound.
    """
    source = Bytes(path, data)
    if not data:
        raise FormatError("expected a C3D, found an empty file", path=path)
    if len(data) < 2 or data[1] != _KEY:
        found = f"0x{data[1]:02x}" if len(data) > 1 else "the end of the file"
        raise source.error(f"expected a C3D, whose second byte is 0x50, found {found}", 1)
    source.take(0, BLOCK, f"a header of {BLOCK} bytes")
    start = (data[0] - 1) * BLOCK
    if start < BLOCK:
        raise source.error(f"expected parameters in block 2 or later, found {data[0]}", 0)
    processor = source.take(start, 4, "the parameters")[3]
    if processor not in _PROCESSORS:
        told = f"expected a processor of 84 (Intel), 85 (DEC) or 86 (SGI), found {processor}"
        raise source.error(told, start + 3)
    source = Bytes(path, data, processor)
    header = _read_header(source)
    # What the section says of its own length is often wrong: the frames end it.
    stop = header.start if start < header.start else len(data)
    return C3dFile(source, header, _read_parameters(source, start + 4, stop, notes))


def _read_header(source: Bytes) -> Header:
    points, samples, first, last = (source.word(at) for at in (2, 4, 6, 8))
    block = source.word(16)
    if block < 2:
        raise source.error(f"expected frames in block 2 or later, found {block}", 16)
    return Header(
        points=points,
        samples=samples,
        first=first,
        last=last,
        scale=source.real(12),
        start=(block - 1) * BLOCK,
        per_frame=source.word(18),
        rate=source.real(20),
    )


def _read_parameters(
    source: Bytes, at: int, stop: int, notes: Notes
) -> dict[tuple[str, str], Parameter]:
    """Return parameters by the names of group and parameter, in capitals.

    A list ends with a name of no length, an offset of 0, or the section.
    """
    groups: dict[int, str] = {}
    found: dict[tuple[int, str], Parameter] = {}
    while at + 2 <= min(stop, len(source.data)) and source.data[at]:
        # A negative length says that the parameter is locked.
        length, number = struct.unpack_from("bb", source.data, at)
        body = at + 2 + abs(length)
        name = _decoded(source.take(at + 2, abs(length), "a name")).strip().upper()
        offset = source.word(body)
        if number < 0:
            groups[-number] = name
        else:
            parameter, end = _read_parameter(source, body + 2, name)
            if end > stop:
                notes.add(f"parameters from byte {at} on run into the frames, left out")
                break
            found[number, name] = parameter
        if offset == 0:
            break
        at = body + offset
    return {
        (_known(groups.get(number, "")), name): parameter
        for (number, name), parameter in found.items()
    }


def _known(group: str) -> str:
    return "FORCE_PLATFORM" if group == "FORCE_PLATEFORM" else group


def _read_parameter(source: Bytes, at: int, name: str) -> tuple[Parameter, int]:
    """Return a parameter, and the byte after it."""
    what = f"the parameter {plain(name)!r}"
    kind = int(struct.unpack("b", source.take(at, 1, what))[0])
    if kind not in _SIZES:
        raise source.error(f"expected a type of -1, 1, 2 or 4 of {what}, found {kind}", at)
    rank = source.take(at + 1, 1, what)[0]
    shape = tuple(source.take(at + 2, rank, what))
    count = _SIZES[kind] * math.prod(shape)
    start = at + 2 + rank
    raw = source.take(start, count, f"{count} bytes of {what}")
    return Parameter(kind, shape, raw, source), start + count
