"""Motion capture files: one module a format, found by the file's suffix."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from os import PathLike
from pathlib import Path

import numpy as np

from roundelay.base.checks import as_path, expected
from roundelay.base.errors import FormatError, RateAssumed, TooShort
from roundelay.base.files import STANDARD_INPUT, name_of, unpacked
from roundelay.base.texts import shown
from roundelay.formats.contents import Contents
from roundelay.formats.options import ReadOptions
from roundelay.formats.points import WritesPoints, motion_in_file
from roundelay.formats.registry import (
    ChoosingPointsReader,
    ChoosingReader,
    PointsReader,
    PointsWriter,
    Reader,
    SkeletonReader,
    Writer,
    besides_motion,
    checked_format,
    contents_of,
    files_of,
    files_written,
    format_of_points,
    in_words,
    is_capture,
    reader_of,
    readers,
    suffixes_of,
    wraps_at_last_key,
    writer_of,
    writers,
)
from roundelay.formats.sane import fault_of, fault_of_points
from roundelay.geometry.kinematics import vertical_axis
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.floating import motion_of_points, points_of_motion
from roundelay.motion.motion import Motion, checked_rate
from roundelay.motion.points import Points

__all__ = [
    "ChoosingReader",
    "Contents",
    "PointsReader",
    "PointsWriter",
    "Reader",
    "SkeletonReader",
    "Writer",
    "besides_motion",
    "checked_format",
    "contents_of",
    "files_of",
    "files_written",
    "format_of_points",
    "in_words",
    "is_capture",
    "read",
    "read_character",
    "read_points",
    "readers",
    "suffixes_of",
    "wraps_at_last_key",
    "write",
    "writer_of",
    "writers",
]


def read(
    path: str | PathLike[str],
    *,
    skeleton: str | PathLike[str] | Skeleton | None = None,
    fps: float | None = None,
    suffix: str | None = None,
    fill_gaps: bool = True,
    max_gap: float | None = None,
    animation: str | None = None,
    character: str | None = None,
    salvage: bool = False,
    encoding: str | None = None,
) -> Motion:
    """Read a motion capture file, in the format its suffix names.

    Parameters
    ----------
    path : path-like
        A file of a format that is known, such as ``.bvh``, ``.fbx`` or ``.glb``; ours may be
        packed, as ``.bvh.gz``, or come from standard input, ``-``.
    skeleton : path-like or Skeleton, optional
        For an AMC, its ASF or a skeleton read from one; looked for beside it by default.
    fps : float, optional
        Frames a second, where the file tells none or a wrong number.
    suffix : str, optional
        The format, such as "bvh", where the name does not tell it.
    fill_gaps : bool
        Whether gaps of points are filled as the rest of the body tells; else by straight lines.
    max_gap : float, optional
        Longest gap in seconds that is filled so; all that can be predicted by default.
    animation : str, optional
        Which of several animations; the first that moves the skeleton by default.
    character : str, optional
        Which of several skeletons, by the name of its root.
    salvage : bool
        Keep the whole frames of a recording that was cut off; fill what is no number.
    encoding : str, optional
        That of names in a text file, such as "GBK"; found out by default.

    Returns
    -------
    Motion
        Lengths in the file's unit. Of markers and keypoints its skeleton is free: see
        `roundelay.motion.floating`.

    Raises
    ------
    FormatError
        If the file is of no known format, or not what its format says, with line and column.
    ValueError
        If a skeleton is given for a file that holds its own, or something is chosen that a format
        has one of, or the rate is not positive, or beyond 10,000, or the longest gap is negative.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> rl.read("walk.bvh")
    Motion('walk', 429 frames at 60 fps, 19 joints)
    """
    path = as_path(path)
    reader = reader_of(path, suffix)
    rate = None if fps is None else checked_rate(fps)
    wanted = ReadOptions(
        animation=animation, character=character, salvage=salvage, encoding=encoding
    )
    _check_choices(reader, wanted, path)
    with _rate_known(rate is not None):
        if isinstance(reader, PointsReader) and skeleton is None:
            points = _points(reader, path, wanted)
            motion = motion_in_file(points, path, fill=fill_gaps, max_gap=max_gap)
        else:
            motion = _read(reader, path, skeleton, wanted)
    if rate is not None:
        motion = replace(motion, frame_time=1.0 / rate)
    fault = fault_of(motion)
    if fault is not None:
        raise FormatError(fault, path=path)
    if not motion.skeleton.free:
        motion = _upright(motion)
    if path == STANDARD_INPUT or unpacked(path) != path:
        motion = replace(motion, name=name_of(path))
    return motion


def read_character(path: str | PathLike[str], *, character: str | None = None) -> Motion:
    """Read a character to carry motions to: its skeleton, its pose at rest and its meshes.

    Parameters
    ----------
    path : path-like
        Of a format with characters, such as ``.fbx``, ``.glb`` or ``.vrm``, with an animation or
        without; or any capture, whose skeleton is the character's.
    character : str, optional
        Which of several skeletons, by the name of its root.

    Returns
    -------
    Motion
        Of a character one frame, at rest; of a capture all.

    Raises
    ------
    FormatError
        If the file is of no known format, or not what its format says.
    ValueError
        If a skeleton is chosen of a format that has one.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> rl.read_character("walk.bvh").skeleton.names[0]
    'Hips'
    """
    path = as_path(path)
    reader = reader_of(path, None)
    still = getattr(reader, "read_still", None)
    if still is None:
        return read(path, character=character)
    motion: Motion = still(path, ReadOptions(character=character))
    fault = fault_of(motion)
    if fault is not None:
        raise FormatError(fault, path=path)
    return _upright(motion)


def read_points(
    path: str | PathLike[str],
    *,
    suffix: str | None = None,
    character: str | None = None,
    salvage: bool = False,
) -> Points:
    """Read markers or keypoints as they are, gaps and all; of other captures, the joints.

    Parameters
    ----------
    path : path-like
    suffix : str, optional
        The format, such as "trc", where the name does not tell it.
    character : str, optional
        Which of several subjects or animals; the one with most points by default.
    salvage : bool
        Keep the whole frames of a recording that was cut off.

    Returns
    -------
    Points
        In the file's unit.

    Raises
    ------
    FormatError
        If the file is of no known format, or not what its format says, with line and column.
    ValueError
        If something is chosen that a format has one of.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> points = rl.read_points("keypoints.trc")
    >>> len(points), points.fps, points.units
    (429, 60.0, 'm')
    """
    path = as_path(path)
    reader = reader_of(path, suffix)
    wanted = ReadOptions(character=character, salvage=salvage)
    _check_choices(reader, wanted, path)
    if isinstance(reader, PointsReader):
        return _points(reader, path, wanted)
    return points_of_motion(read(path, suffix=suffix, character=character, salvage=salvage))


def _points(reader: PointsReader, path: Path, wanted: ReadOptions) -> Points:
    if isinstance(reader, ChoosingPointsReader):
        return reader.read_points(path, wanted)
    return reader.read_points(path)


@contextmanager
def _rate_known(known: bool) -> Iterator[None]:
    """Let no reader tell which frame rate it assumes where another is given."""
    if not known:
        yield
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RateAssumed)
        yield


def _check_choices(reader: Reader, wanted: ReadOptions, path: Path) -> None:
    known = reader.choices if isinstance(reader, ChoosingReader) else frozenset()
    for choice in ("animation", "character", "salvage", "encoding"):
        if getattr(wanted, choice) and choice not in known:
            told = f"{unpacked(path).name} is of a format without such a choice"
            raise ValueError(f"expected no --{choice}: {told}")


def _read(
    reader: Reader,
    path: Path,
    skeleton: str | PathLike[str] | Skeleton | None,
    wanted: ReadOptions,
) -> Motion:
    if skeleton is not None and not isinstance(reader, SkeletonReader):
        raise ValueError(f"expected no skeleton: a {path.suffix} file holds its own")
    if isinstance(reader, ChoosingReader):
        return reader.read(path, wanted)
    if skeleton is None or not isinstance(reader, SkeletonReader):
        return reader.read(path)
    return reader.read(path, skeleton if isinstance(skeleton, Skeleton) else Path(skeleton))


def _upright(motion: Motion) -> Motion:
    """Find out from some fifty poses which axis points up: Y or Z, unless the file says X."""
    if motion.up == 0:
        return motion
    spread = motion.at(np.linspace(0, len(motion) - 1, min(len(motion), 50)))
    up = vertical_axis(spread.positions(), motion.skeleton.size)
    return motion if up == motion.up else replace(motion, up=up)


def write(motion: Motion | Points, path: str | PathLike[str]) -> None:
    """Write a motion to a file, in the format its suffix names.

    A motion read from the same format is written with that file's channels. An AMC gets its
    ASF beside it, of the same name; in ``.glb`` and ``.gltf`` the vertical axis becomes Y, and
    an FBX is read back with lengths in centimetres. Points are written with their gaps to the
    formats that hold points, and with gaps filled to the others. The file appears whole or not at
    all.

    Raises
    ------
    ValueError
        If the suffix is not known, or the motion has a rate, lengths or names that no file may
        hold; see `roundelay.formats.sane`.
    TooShort
        If the motion has no frame, or in none of them enough points are seen.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> rl.write(walk[:60], "part.glb")
    >>> len(rl.read("part.glb"))
    60
    """
    path = as_path(path)
    writer = writer_of(path)
    if isinstance(motion, Points):
        if isinstance(writer, WritesPoints) and len(motion):
            _write_points(writer, motion, path)
            return
        motion = motion_of_points(motion)
    if not len(expected(Motion, motion)):
        raise TooShort("expected a motion of at least one frame, found none")
    fault = fault_of(motion)
    if fault is not None:
        raise ValueError(fault)
    name = shown(motion.name)
    motion = motion if name == motion.name else replace(motion, name=name)
    writer.write(motion, path)


def _write_points(writer: WritesPoints, points: Points, path: Path) -> None:
    fault = fault_of_points(points)
    if fault is not None:
        raise ValueError(fault)
    writer.write_points(points, path)
