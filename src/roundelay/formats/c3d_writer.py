"""Write C3D as programs of Intel processors do, with numbers of four bytes."""

from __future__ import annotations

import struct
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import RoundelayWarning
from roundelay.base.files import written_beside
from roundelay.formats.analog import Analog, Plate
from roundelay.formats.c3d import C3dLayout
from roundelay.formats.c3d_parameters import BLOCK
from roundelay.formats.point_files import in_space
from roundelay.formats.points import WritesPoints
from roundelay.motion.points import Points

__all__ = ["C3dWriter"]

# Of the texts of a parameter, whose dimensions are bytes; and of blocks, whose number is one, too.
_MOST = 255
_MOST_BLOCKS = 255
_MOST_COUNTED = 65535
# What an offset of two bytes with sign can skip, less what stands in front of it.
_LONGEST = 32000
# Residuals that are smaller are none.
_FINEST = 1e-30
# A number of four bytes that is not 0.
_LEAST = 2e-38


class C3dWriter(WritesPoints):
    """The writer of C3D files."""

    name = "c3d"
    suffixes = (".c3d",)

    def write_points(self, points: Points, path: Path) -> None:
        """Write a C3D file: places in single precision, residuals in 255 steps.

        Analog channels and plates of the file that the points came from are written, too, as
        long as they last as long.

        Parameters
        ----------
        points : Points
            A third coordinate of 0 is added to points of a plane.
        path : Path

        Raises
        ------
        ValueError
            If the names take more room than a C3D has.
        OSError
            If the file cannot be written.
        """
        layout = points.layout if isinstance(points.layout, C3dLayout) else C3dLayout()
        analog, per_frame = _fitting(points, layout.analog, path)
        scale = _scale(points)
        parameters = _parameters(points, layout, analog, scale)
        start = 2 + len(parameters) // BLOCK
        head = _header(points, layout.first, analog, per_frame, scale, start)
        with written_beside(path) as part, part.open("wb") as file:
            file.write(head + _with_start(parameters, start))
            file.write(_frames(points, analog, scale).tobytes())


def _fitting(points: Points, analog: Analog | None, path: Path) -> tuple[Analog | None, int]:
    """Return the analog channels that last as long as the points, and their samples a frame."""
    if analog is None:
        return None, 0
    per_frame = round(analog.rate / points.fps)
    if per_frame >= 1 and len(analog.values) == per_frame * len(points):
        return analog, per_frame
    text = f"{path}: analog channels last longer or shorter than the points, left out"
    warnings.warn(text, RoundelayWarning, stacklevel=4)
    return None, 0


def _scale(points: Points) -> float:
    """Return the step of residuals, of which there are 255."""
    largest = 0.0 if points.residuals is None else float(points.residuals.max(initial=0.0))
    return largest / 255.0 if largest > _FINEST else 0.1


def _header(
    points: Points, first: int, analog: Analog | None, per_frame: int, scale: float, start: int
) -> bytes:
    last = first + len(points) - 1
    if last >= _MOST_COUNTED:
        first, last = 1, min(_MOST_COUNTED, len(points))
    samples = per_frame * len(analog.names) if analog else 0
    words = (len(points.names), samples, first, last, 0)
    told = struct.pack("<BB5Hf", 2, 0x50, *words, -scale)
    told += struct.pack("<HHf", start, per_frame, points.fps)
    return told.ljust(BLOCK, b"\0")


def _parameters(points: Points, layout: C3dLayout, analog: Analog | None, scale: float) -> bytes:
    """Return the parameter section, filled up to whole blocks.

    Raises
    ------
    ValueError
        If it has more blocks than can be counted.
    """
    groups = [_Group("POINT"), _Group("TRIAL"), _Group("ANALOG"), _Group("FORCE_PLATFORM")]
    _tell_points(groups[0], points, layout, scale)
    _tell_trial(groups[1], len(points))
    _tell_analog(groups[2], analog)
    _tell_plates(groups[3], layout.plates if analog else ())
    body = b"".join(group.packed(number) for number, group in enumerate(groups, 1))
    blocks = -(-(4 + len(body) + 2) // BLOCK)
    if blocks > _MOST_BLOCKS:
        told = f"{len(points.names)} points whose names take {len(body)} bytes"
        raise ValueError(f"expected names that take at most {_MOST_BLOCKS * BLOCK}, found {told}")
    return (struct.pack("<4B", 1, 0x50, blocks, 84) + body).ljust(blocks * BLOCK, b"\0")


class _Group:
    """A group of parameters that is being written."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.told: list[tuple[str, bytes]] = []

    def number(self, name: str, value: float) -> None:
        self.told.append((name, struct.pack("<bBf", 4, 0, value)))

    def words(self, name: str, values: Sequence[int], shape: Sequence[int]) -> None:
        wrapped = [value - 65536 if value > 32767 else value for value in values]
        head = struct.pack("<bB", 2, len(shape)) + bytes(shape)
        self.told.append((name, head + struct.pack(f"<{len(wrapped)}h", *wrapped)))

    def numbers(self, name: str, values: NDArray[np.float64], shape: Sequence[int]) -> None:
        head = struct.pack("<bB", 4, len(shape)) + bytes(shape)
        self.told.append((name, head + np.asarray(values).astype("<f4").tobytes()))

    def text(self, name: str, value: str) -> None:
        raw = value.encode()[:_MOST]
        self.told.append((name, struct.pack("<bBB", -1, 1, len(raw)) + raw))

    def texts(self, name: str, values: Sequence[str]) -> None:
        """Tell texts, in as many parameters as they need: LABELS, LABELS2 ..."""
        raw = [_cut(value) for value in values]
        width = max(map(len, raw), default=0)
        many = max(1, min(_MOST, _LONGEST // max(1, width)))
        for number, start in enumerate(range(0, max(1, len(raw)), many), 1):
            part = raw[start : start + many]
            head = struct.pack("<bBBB", -1, 2, width, len(part))
            piece = head + b"".join(one.ljust(width) for one in part)
            self.told.append((name if number == 1 else f"{name}{number}", piece))

    def packed(self, number: int) -> bytes:
        """Return the group and its parameters as they stand in the file."""
        result = _entry(-number, self.name, b"")
        return result + b"".join(_entry(number, name, told) for name, told in self.told)


def _cut(text: str) -> bytes:
    """Return a text of at most 255 bytes, not cut within a character."""
    return text.encode()[:_MOST].decode(errors="ignore").encode()


def _entry(number: int, name: str, told: bytes) -> bytes:
    """Return a group or a parameter, without a description; the offset leads to the next."""
    raw = name.encode()
    head = struct.pack("<bb", len(raw), number) + raw
    return head + struct.pack("<H", 2 + len(told) + 1) + told + b"\0"


def _tell_points(group: _Group, points: Points, layout: C3dLayout, scale: float) -> None:
    group.words("USED", [len(points.names)], ())
    group.number("SCALE", -scale)
    group.number("RATE", points.fps)
    group.words("DATA_START", [0], ())
    group.words("FRAMES", [min(_MOST_COUNTED, len(points))], ())
    if len(points) >= _MOST_COUNTED:
        group.number("LONG_FRAMES", len(points))
    group.texts("LABELS", points.names)
    group.text("UNITS", points.units or "")
    for axis, told in zip("XY", layout.screen or (), strict=False):
        group.text(f"{axis}_SCREEN", told)


def _tell_trial(group: _Group, frames: int) -> None:
    if frames >= _MOST_COUNTED:
        group.words("ACTUAL_START_FIELD", [1, 0], (2,))
        group.words("ACTUAL_END_FIELD", [frames % 65536, frames // 65536], (2,))


def _tell_analog(group: _Group, analog: Analog | None) -> None:
    count = len(analog.names) if analog else 0
    group.words("USED", [count], ())
    if analog is None:
        return
    group.texts("LABELS", analog.names)
    group.texts("UNITS", analog.units)
    group.number("RATE", analog.rate)
    group.number("GEN_SCALE", 1.0)
    if count <= _MOST:
        group.numbers("SCALE", np.ones(count), (count,))
        group.words("OFFSET", [0] * count, (count,))


def _tell_plates(group: _Group, plates: Sequence[Plate]) -> None:
    group.words("USED", [len(plates)], ())
    if not plates:
        return
    count = len(plates)
    group.words("TYPE", [plate.kind for plate in plates], (count,))
    group.words("ZERO", [0, 0], (2,))
    group.numbers("CORNERS", np.array([plate.corners for plate in plates]), (3, 4, count))
    group.numbers("ORIGIN", np.array([plate.origin for plate in plates]), (3, count))
    most = max(len(plate.channels) for plate in plates)
    rows = [[*(c + 1 for c in p.channels), *[0] * (most - len(p.channels))] for p in plates]
    group.words("CHANNEL", [channel for row in rows for channel in row], (most, count))
    matrices = [plate.matrix for plate in plates]
    sizes = {None if matrix is None else matrix.shape for matrix in matrices}
    if len(sizes) == 1 and None not in sizes:
        columns = np.array([matrix.T for matrix in matrices if matrix is not None])
        group.numbers("CAL_MATRIX", columns, (columns.shape[2], columns.shape[1], count))


def _with_start(parameters: bytes, start: int) -> bytes:
    """Return the parameters with the block where frames begin."""
    mark = b"DATA_START" + struct.pack("<HbB", 2 + 4 + 1, 2, 0)
    head, _, tail = parameters.partition(mark)
    return head + mark + struct.pack("<H", start) + tail[2:]


def _frames(points: Points, analog: Analog | None, scale: float) -> NDArray[np.float32]:
    """Return the frames (F, n): places and residual of each point, then all samples."""
    frames, count = len(points), len(points.names)
    table = np.zeros((frames, count, 4), "<f4")
    table[..., :3] = in_space(points, _LEAST)
    if points.residuals is not None:
        table[..., 3] = np.clip(np.round(points.residuals / scale), 0, 255)
    table[points.missing] = (0.0, 0.0, 0.0, -1.0)
    rows = table.reshape(frames, 4 * count)
    if analog is None:
        return rows
    return np.hstack([rows, analog.values.reshape(frames, -1).astype("<f4")])
