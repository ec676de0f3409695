"""Read Acclaim motion files (AMC), each with its skeleton (ASF)."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import compress, cycle
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import RateAssumed
from roundelay.formats import decimals, text
from roundelay.formats.acclaim import AcclaimLayout
from roundelay.formats.asf import find_skeleton, read_skeleton
from roundelay.formats.euler import DEGREE, Winding, compose, winding
from roundelay.formats.text import Token
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion

__all__ = ["FRAME_TIME", "AmcReader"]

Array = NDArray[np.float64]

FRAME_TIME = 1.0 / 120.0
"""Seconds a frame where the file gives no rate: that of the CMU captures."""

_BLOCK = 1 << 16


class AmcReader:
    """The reader of AMC files, whose skeletons are ASF files."""

    name = "amc"
    suffixes = (".amc",)

    def read(self, path: Path, skeleton: Skeleton | Path | None = None) -> Motion:
        """Read an AMC file.

        Parameters
        ----------
        path : Path
        skeleton : Skeleton or Path, optional
            A skeleton read from an ASF, or its path; looked for beside the file by default.

        Returns
        -------
        Motion
            Lengths in the numbers of the ASF. The frame rate is that of the file's
            ``:SAMPLES-PER-SECOND``, 120 frames a second without it.

        Raises
        ------
        FormatError
            If a file is not whole or the two do not fit, with line and column.
        """
        source = text.without_comments(text.load(path))
        if skeleton is None:
            skeleton = find_skeleton(path)
        if isinstance(skeleton, Path):
            skeleton = read_skeleton(skeleton)
        if not isinstance(skeleton.layout, AcclaimLayout):
            raise ValueError("expected a skeleton that was read from an ASF")
        heading = _Heading.read(source, skeleton.layout)
        table = _Table(source, heading.start, skeleton)
        values = text.filled(source, heading.start, table.read())
        text.check_proportion(source, heading.start, len(values), skeleton.n_joints)
        layout = replace(
            skeleton.layout,
            frame_order=tuple(table.order),
            windings=_windings(skeleton.layout, values, heading.degree),
        )
        return _motion(replace(skeleton, layout=layout), values, heading, path.stem)

    def find_skeleton(self, path: Path) -> Path:
        """Return the ASF of an AMC; see `roundelay.formats.asf.find_skeleton`."""
        return find_skeleton(path)


@dataclass(frozen=True)
class _Heading:
    """What stands before the first frame."""

    start: int
    degree: float
    frame_time: float

    @classmethod
    def read(cls, source: text.Source, layout: AcclaimLayout) -> _Heading:
        degree, frame_time, told = layout.degree, FRAME_TIME, False
        cursor = text.Cursor(source)
        for line in text.lines(source):
            word = line[0].text.upper()
            if not word.startswith(":"):
                if not told:
                    _tell_assumed(source)
                return cls(line[0].at, degree, frame_time)
            if word in (":DEGREES", ":RADIANS"):
                degree = np.pi / 180.0 if word == ":DEGREES" else 1.0
            if word == ":SAMPLES-PER-SECOND":
                frame_time, told = 1.0 / _rate(cursor, line), True
        raise source.error("expected frames, found the end of the file", source.end)


def _tell_assumed(source: text.Source) -> None:
    warnings.warn(
        f"{source.path}: tells no frame rate, {1.0 / FRAME_TIME:g} a second assumed; give another "
        "by --capture-fps (in Python by fps)",
        RateAssumed,
        stacklevel=5,
    )


def _rate(cursor: text.Cursor, line: Sequence[Token]) -> float:
    rate = cursor.as_number(line[-1], "a frame rate")
    if not 0.0 < rate < 1e9:
        raise cursor.found("a positive frame rate", line[-1])
    return rate


class _Table:
    """Read the frames into one table, a row a frame and a column a channel of a bone."""

    def __init__(self, source: text.Source, start: int, skeleton: Skeleton) -> None:
        self.cursor = text.Cursor(source)
        self.start = start
        self.bones = {b.name: b for b in skeleton.layout.bones if b.dof}
        ends = np.cumsum([len(bone.dof) for bone in self.bones.values()]).tolist()
        self.columns = {
            name: list(range(end - len(bone.dof), end))
            for (name, bone), end in zip(self.bones.items(), ends, strict=True)
        }
        self.width = ends[-1] if ends else 0
        self.order: list[str] = []

    def read(self) -> Array:
        if not self.width:
            raise self.cursor.source.error("expected a skeleton with channels", self.start)
        table = self._read_regular()
        return self._read_lines() if table is None else table

    def _read_regular(self) -> Array | None:
        """Return the table if all frames are written like the first, else None."""
        if not self._first_frame():
            return None
        names = self.order
        pattern = [True]
        for name in names:
            pattern += [False] + [True] * len(self.columns[name])
        order = [0] + [1 + column for name in names for column in self.columns[name]]
        parts = self._blocks(names, pattern)
        if parts is None:
            return None
        values = np.concatenate(parts)
        if not np.array_equal(np.diff(values[:, 0]), np.ones(len(values) - 1)):
            return None
        return values[:, np.argsort(order)][:, 1:]

    def _first_frame(self) -> bool:
        """Find the bones' order in the first frame; tell whether that is whole."""
        for line in text.lines(self.cursor.source, self.start):
            if line[0].text not in self.bones:
                if self.order or len(line) > 1:
                    break
                continue
            if len(line) != 1 + len(self.columns[line[0].text]):
                return False
            self.order.append(line[0].text)
        return sorted(self.order) == sorted(self.bones)

    def _blocks(self, names: list[str], pattern: list[bool]) -> list[Array] | None:
        data, at = self.cursor.source.data, self.start
        rest: list[bytes] = []
        encoded = [name.encode() for name in names]
        parts = []
        while at < len(data):
            stop = data.find(b"\n", at + _BLOCK) + 1 or len(data)
            words = rest + data[at:stop].split()
            whole = len(words) - len(words) % len(pattern)
            part = _numbers(words[:whole], encoded, pattern)
            if part is None:
                return None
            parts.append(part)
            rest, at = words[whole:], stop
        return None if rest else parts

    def _read_lines(self) -> Array:
        """Read the frames line by line, bones in any order, and find what is wrong."""
        rows: list[Array] = []
        first: int | None = None
        row, missing = np.empty(0), set[str]()
        for line in text.lines(self.cursor.source, self.start):
            if line[0].text in self.bones and rows:
                self._fill(row, missing, line)
                continue
            if missing and not self._is_number(line):
                raise self.cursor.found("a bone of the skeleton with channels", line[0])
            if missing:
                raise self.cursor.found(f"bone {min(missing)} in this frame", line[0])
            first = self._number(line, first, len(rows))
            row, missing = np.empty(self.width), set(self.bones)
            rows.append(row)
        source = self.cursor.source
        if missing:
            raise source.error(
                f"expected bone {min(missing)} in the last frame, found the end of the file",
                source.end,
            )
        return np.array(rows)

    @staticmethod
    def _is_number(line: Sequence[Token]) -> bool:
        word = line[0].text
        return len(line) == 1 and len(word) < 16 and word.isascii() and word.isdecimal()

    def _number(self, line: Sequence[Token], first: int | None, count: int) -> int:
        """Check a line that starts a frame; return the number of the first frame."""
        word = line[0]
        if not self._is_number(line):
            raise self.cursor.found("the number of a frame", word)
        if first is not None and int(word.text) != first + count:
            raise self.cursor.found(f"frame {first + count}", word)
        return int(word.text) if first is None else first

    def _fill(self, row: Array, missing: set[str], line: Sequence[Token]) -> None:
        name, columns = line[0].text, self.columns[line[0].text]
        if name not in missing:
            raise self.cursor.found("each bone once in a frame", line[0])
        if len(line) != 1 + len(columns):
            raise self.cursor.source.error(
                f"expected {len(columns)} numbers for {name}, found {len(line) - 1}", line[-1].at
            )
        row[columns] = [self.cursor.value(token) for token in line[1:]]
        missing.remove(name)


def _numbers(words: list[bytes], names: list[bytes], pattern: list[bool]) -> Array | None:
    """Return the numbers of some whole frames, or None unless their names are as given."""
    width, frames = len(pattern), len(words) // len(pattern)
    places = [column for column, is_number in enumerate(pattern) if not is_number]
    for column, name in zip(places, names, strict=True):
        if words[column::width].count(name) != frames:
            return None
    if not all(map(bytes.isdigit, words[::width])):
        return None
    values = decimals.parse(b" ".join(compress(words, cycle(pattern))))
    return None if values is None else values.reshape(frames, sum(pattern))


def _motion(skeleton: Skeleton, table: Array, heading: _Heading, name: str) -> Motion:
    layout: AcclaimLayout = skeleton.layout
    axes = layout.local_axes()
    turns = _turns(layout)
    orders = [bone.turns for bone in layout.bones]
    rotations = compose(table, orders, turns, unit=heading.degree)
    # C M C^-1 turns about C times the axis of M.
    axis = np.matmul(rotations[..., 1:].swapaxes(0, 1), rot.to_matrix(axes).swapaxes(1, 2))
    rotations[..., 1:] = axis.swapaxes(0, 1)
    path = np.array(layout.position) + _moves(layout, table, 0)
    translations = _translations(skeleton, table, axes)
    return Motion(skeleton, rotations, path, heading.frame_time, translations, name)


def _windings(layout: AcclaimLayout, table: Array, degree: float) -> tuple[Winding, ...]:
    return tuple(
        winding(table[:, own] * (degree / DEGREE)) if len(own) == 3 else "continuous"
        for own in _turns(layout)
    )


def _turns(layout: AcclaimLayout) -> list[list[int]]:
    """Return the columns of each bone's rotation channels, as `Bone.turns` orders them."""
    return [own[::-1] for own in _columns(layout, "r")]


def _columns(layout: AcclaimLayout, kind: str) -> list[list[int]]:
    """Return the columns of the table that hold each bone's channels of a kind."""
    firsts = np.cumsum([0] + [len(bone.dof) for bone in layout.bones]).tolist()
    bones = zip(layout.bones, firsts[:-1], strict=True)
    return [[first + column for column in bone.columns(kind)] for bone, first in bones]


def _moves(layout: AcclaimLayout, table: Array, joint: int) -> Array:
    """Return the translation (F, 3) of a bone along its local axes."""
    bone, columns = layout.bones[joint], _columns(layout, "t")[joint]
    result = np.zeros((len(table), 3))
    result[:, ["xyz".index(bone.dof[c][1]) for c in bone.columns("t")]] = table[:, columns]
    return result


def _translations(skeleton: Skeleton, table: Array, axes: Array) -> Array | None:
    layout: AcclaimLayout = skeleton.layout
    moving = [joint for joint, own in enumerate(_columns(layout, "t")) if own and joint]
    stretching = {joint: own[0] for joint, own in enumerate(_columns(layout, "l")) if own}
    if not moving and not stretching:
        return None
    result = np.tile(skeleton.offsets, (len(table), 1, 1))
    for joint in moving:
        result[:, joint] += rot.rotate(axes[joint], _moves(layout, table, joint))
    for joint, parent in enumerate(skeleton.parents):
        if parent in stretching:
            stretch = table[:, stretching[parent], None]
            result[:, joint] += stretch * np.array(layout.bones[parent].direction)
    return result
