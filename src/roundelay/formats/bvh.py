"""Read Biovision hierarchy files (BVH).

Rotations of a joint are composed in the order of its channels, R = R1 R2 R3. Position
channels give a joint's position on its parent in place of its OFFSET. Accepted beyond the
plain format: any channel order and count, any case, comments from ``#`` or ``//``, frames
over several lines or all on one, and one frame more than promised (left out, with a warning).
"""

from __future__ import annotations

import re
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError, RoundelayWarning
from roundelay.formats import text
from roundelay.formats.bvh_hierarchy import BvhLayout, read_hierarchy
from roundelay.formats.euler import DEGREE, Winding, compose, winding
from roundelay.formats.moving import leave
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion

__all__ = ["BvhReader"]

Array = NDArray[np.float64]

_COUNT = re.compile(r"frames\s*:?\s*(\d+)", re.IGNORECASE)
_TIME = re.compile(r"frame\s*time\s*:?\s*(\S+)", re.IGNORECASE)


class BvhReader:
    """The reader of BVH files."""

    name = "bvh"
    suffixes = (".bvh",)

    def read(self, path: Path) -> Motion:
        """Read a BVH file.

        Parameters
        ----------
        path : Path

        Returns
        -------
        Motion
            Lengths in the file's unit. `Motion.translations` is set if a joint other than the
            root has position channels that leave its OFFSET.

        Raises
        ------
        FormatError
            If the file is not a whole BVH, with line and column.
        """
        skeleton, values, frame_time = _parse(path)
        skeleton = replace(skeleton, layout=_with_windings(skeleton.layout, values))
        return _motion(skeleton, values, frame_time, path.stem)


def _parse(path: Path) -> tuple[Skeleton, Array, float]:
    """Return the skeleton, the channels (F, C) and the seconds a frame."""
    cursor = text.Cursor(text.without_comments(text.load(path)))
    skeleton = read_hierarchy(cursor)
    frames, frame_time = _heading(cursor, skeleton.layout.width)
    return skeleton, _body(cursor, frames, skeleton), frame_time


def _with_windings(layout: BvhLayout, values: Array) -> BvhLayout:
    windings: list[Winding] = [
        winding(values[:, columns]) if len(columns) == 3 else "continuous"
        for columns in layout.columns("rotation")
    ]
    return replace(layout, windings=tuple(windings))


def _heading(cursor: text.Cursor, width: int) -> tuple[int, float]:
    cursor.keyword("MOTION")
    token = _filled_line(cursor, "Frames: and a number")
    match = _COUNT.fullmatch(token.text)
    if match is None:
        raise cursor.found("Frames: and a whole number", token)
    frames = int(match[1]) if len(match[1]) < 19 else 10**18
    if frames == 0 or width == 0:
        raise cursor.found("at least one frame and one channel", token)
    return frames, _frame_time(cursor)


def _frame_time(cursor: text.Cursor) -> float:
    expected = "Frame Time: and a positive number"
    token = _filled_line(cursor, expected)
    match = _TIME.fullmatch(token.text)
    if match is None:
        raise cursor.found(expected, token)
    value = text.Token(match[1], token.at + match.start(1))
    seconds = cursor.as_number(value, "a positive frame time")
    if seconds <= 0.0:
        raise cursor.found("a positive frame time", value)
    return seconds


def _filled_line(cursor: text.Cursor, expected: str) -> text.Token:
    cursor.position = cursor.next(expected).at
    return cursor.line()


def _body(cursor: text.Cursor, frames: int, skeleton: Skeleton) -> Array:
    width = skeleton.layout.width
    start = cursor.position
    values = text.numbers(cursor.source, start)
    if len(values) == (frames + 1) * width:
        warnings.warn(
            f"{cursor.source.path}: one frame more than the {frames} promised, left out",
            RoundelayWarning,
            stacklevel=5,
        )
    elif len(values) != frames * width:
        raise _wrong_count(cursor.source, start, frames, width, len(values))
    text.check_proportion(cursor.source, start, frames, skeleton.n_joints)
    return values[: frames * width].reshape(frames, width)


def _wrong_count(
    source: text.Source, start: int, frames: int, width: int, count: int
) -> FormatError:
    odd = _odd_line(source, start, width)
    if odd is not None:
        at, found = odd
        return source.error(f"expected {width} numbers in a frame, found {found}", at)
    return source.error(
        f"expected {frames} frames of {width} numbers, found {count / width:.10g} frames",
        source.end,
    )


def _odd_line(source: text.Source, start: int, width: int) -> tuple[int, int] | None:
    """Return place and numbers of the first line unlike the others, if lines are frames."""
    at, odd, lines = start, None, 0
    for line in source.data[start:].split(b"\n"):
        found = len(line.split())
        lines += found == width
        if odd is None and found not in (0, width):
            odd = at + len(line.rstrip()), found
        at += len(line) + 1
    return odd if lines else None


def _motion(skeleton: Skeleton, values: Array, frame_time: float, name: str) -> Motion:
    layout: BvhLayout = skeleton.layout
    rotations = compose(values, layout.orders, layout.columns("rotation"), unit=DEGREE)
    rotations.flags.writeable = False  # a motion need not copy them
    places = _placements(skeleton, values)
    path = places.get(0, np.broadcast_to(skeleton.offsets[0], (len(values), 3)))
    moved = {joint: place for joint, place in places.items() if joint}
    translations = None
    if any(leave(place, skeleton.offsets[j], skeleton.size) for j, place in moved.items()):
        shape = (len(values), skeleton.n_joints, 3)
        translations = np.broadcast_to(skeleton.offsets, shape).copy()
        for joint, place in moved.items():
            translations[:, joint] = place
    return Motion(skeleton, rotations, path, frame_time, translations, name)


def _placements(skeleton: Skeleton, values: Array) -> dict[int, Array]:
    """Return positions (F, 3) of the joints that have position channels."""
    layout: BvhLayout = skeleton.layout
    places = {}
    for joint, columns in enumerate(layout.columns("position")):
        if columns:
            place = np.tile(skeleton.offsets[joint], (len(values), 1))
            place[:, ["XYZ".index(axis) for axis in layout.placed[joint]]] = values[:, columns]
            places[joint] = place
    return places
