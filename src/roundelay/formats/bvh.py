"""Read Biovision hierarchy files (BVH).

Rotations of a joint are composed in the order of its channels, R = R1 R2 R3. Position
channels give a joint's position on its parent in place of its OFFSET. Accepted beyond the
plain format: any channel order and count, any case, comments from ``#`` or ``//``, frames
over several lines or all on one. With a note: more frames than promised, joints of one name,
numbers glued together, decimal commas, channels of end sites, scale channels, other encodings.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError
from roundelay.formats import text
from roundelay.formats.bvh_hierarchy import BvhLayout, Hierarchy, read_hierarchies
from roundelay.formats.contents import Contents
from roundelay.formats.euler import DEGREE, Winding, compose, winding
from roundelay.formats.moving import leave
from roundelay.formats.nodes import called, different, listed, note
from roundelay.formats.options import ReadOptions
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion

__all__ = ["BvhReader"]

Array = NDArray[np.float64]

_SALVAGE = "; --salvage keeps the whole frames"
_COUNT = re.compile(r"frames\s*:?\s*(\d+)", re.IGNORECASE)
_TIME = re.compile(r"frame\s*time\s*:?\s*(\S+)", re.IGNORECASE)


class BvhReader:
    """The reader of BVH files."""

    name = "bvh"
    suffixes = (".bvh",)
    choices = frozenset({"character", "salvage", "encoding"})

    def read(self, path: Path, wanted: ReadOptions | None = None) -> Motion:
        """Read a BVH file.

        Parameters
        ----------
        path : Path
        wanted : ReadOptions, optional
            Which of several skeletons, the encoding of names, and whether a recording that was
            cut off is read as far as it goes.

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
        wanted = wanted or ReadOptions()
        skeleton, values, frame_time = _parse(path, wanted)
        skeleton = replace(skeleton, layout=_with_windings(skeleton.layout, values))
        return _motion(skeleton, values, frame_time, path.stem)

    def contents(self, path: Path) -> Contents:
        """List the skeletons of a file."""
        source = text.without_comments(text.load(path))
        found = read_hierarchies(text.Cursor(source))
        return Contents(characters=different([one.skeleton.names[0] for one in found]))


def _parse(path: Path, wanted: ReadOptions) -> tuple[Skeleton, Array, float]:
    """Return the skeleton, the channels (F, C) and the seconds a frame."""
    source = text.without_comments(text.load(path, wanted.encoding))
    cursor = text.Cursor(text.with_points(source))
    found = read_hierarchies(cursor)
    number = _character(cursor.source, found, wanted.character)
    frames, frame_time = _heading(cursor, sum(one.width for one in found))
    table = _body(cursor, frames, found, salvage=wanted.salvage)
    for told in found[number].notes:
        note(path, told)
    first = sum(one.width for one in found[:number])
    columns = [first + column for column in found[number].columns]
    everything = len(columns) == table.shape[1]
    return found[number].skeleton, table if everything else table[:, columns], frame_time


def _character(source: text.Source, found: list[Hierarchy], wanted: str | None) -> int:
    """Return the number of the skeleton that is wanted, or of the only one."""
    names = different([one.skeleton.names[0] for one in found])
    if wanted is not None:
        return called("a skeleton (--character)", names, wanted, source.path)
    if len(found) > 1:
        told = f"expected one skeleton, found {listed(list(map(repr, names)))}"
        raise source.error(f"{told}; choose one by --character", found[1].at)
    return 0


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


def _body(cursor: text.Cursor, frames: int, found: list[Hierarchy], *, salvage: bool) -> Array:
    """Return the table (F, C) of all channels; those of end sites are NaN if none are there."""
    source, start = cursor.source, cursor.position
    width, bare = (sum(one.width - cut * len(one.at_ends) for one in found) for cut in (0, 1))
    values = _numbers(source, start, salvage)
    if bare < width and len(values) % width and len(values) % bare == 0:
        width = bare
    frames = _frames(source, start, frames, width, len(values), salvage)
    text.check_proportion(source, start, frames, sum(one.skeleton.n_joints for one in found))
    table = values[: frames * width].reshape(frames, width)
    table = text.filled(source, start, table)
    return table if width != bare or not any(x.at_ends for x in found) else _widened(table, found)


def _numbers(source: text.Source, start: int, salvage: bool) -> Array:
    try:
        return text.numbers(source, start, salvage=salvage)
    except FormatError as error:
        hint = "; --salvage fills what is no number from the frames beside it"
        raise FormatError(
            f"{error.message}{hint}", path=error.path, line=error.line, column=error.column
        ) from None


def _frames(
    source: text.Source, start: int, promised: int, width: int, count: int, salvage: bool
) -> int:
    """Return how many frames are read of so many numbers; say so if it is not what is promised."""
    whole, rest = divmod(count, width)
    if rest == 0 and whole == promised:
        return promised
    if rest == 0 and whole > promised and not salvage:
        told = f"more than the {promised} promised, left out"
        note(source.path, f"{_counted(whole - promised)} {told} (--salvage keeps all)")
        return promised
    odd = _odd_line(source, start, width)
    cut = odd is None or not source.data[odd[0] :].strip()
    if not (salvage and whole and cut):
        raise _wrong_count(source, start, promised, width, count)
    told = f"of {promised} frames promised {whole} are there and read"
    note(source.path, told + (f", {rest} numbers at the end left out" if rest else ""))
    return whole


def _counted(frames: int) -> str:
    return f"{frames} frame{'s' if frames > 1 else ''}"


def _widened(table: Array, found: list[Hierarchy]) -> Array:
    """Return a table with channels of nothing where end sites name some that are not there."""
    result = np.zeros((len(table), sum(one.width for one in found)))
    first, there = 0, list[int]()
    for one in found:
        there += [first + n for n in range(one.width) if n not in one.at_ends]
        first += one.width
    result[:, there] = table
    return result


def _wrong_count(
    source: text.Source, start: int, frames: int, width: int, count: int
) -> FormatError:
    odd = _odd_line(source, start, width)
    if odd is not None:
        at, found = odd
        last = "" if source.data[at:].strip() else _SALVAGE
        return source.error(f"expected {width} numbers in a frame, found {found}{last}", at)
    return source.error(
        f"expected {frames} frames of {width} numbers, found {count / width:.10g} frames{_SALVAGE}",
        source.end,
    )


def _odd_line(source: text.Source, start: int, width: int) -> tuple[int, int] | None:
    """Return place and numbers of the first line unlike the others, if lines are frames."""
    at, odd, lines = start, None, 0
    for line in source.data[start:].split(b"\n"):
        found = len(text.parted(line))
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
