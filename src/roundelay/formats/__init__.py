"""Motion capture files: one module a format, found by the file's suffix."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import TypeVar

import numpy as np

from roundelay.base.errors import FormatError, TooShort
from roundelay.formats import acclaim_writer, amc, bvh, bvh_writer, gltf
from roundelay.geometry.kinematics import vertical_axis
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion

__all__ = ["read", "write"]


@dataclass(frozen=True)
class _Reader:
    """A format's reader; that of files without a skeleton takes one."""

    read: Callable[..., Motion]
    takes_skeleton: bool = False


_READERS = {".bvh": _Reader(bvh.read), ".amc": _Reader(amc.read, takes_skeleton=True)}
_WRITERS: dict[str, Callable[[Motion, Path], None]] = {
    ".bvh": bvh_writer.write,
    ".amc": acclaim_writer.write,
    ".glb": gltf.write,
    ".gltf": gltf.write,
}
_Known = TypeVar("_Known")


def read(
    path: str | PathLike[str], *, skeleton: str | PathLike[str] | Skeleton | None = None
) -> Motion:
    """Read a motion capture file, in the format its suffix names.

    Parameters
    ----------
    path : path-like
        A ``.bvh`` or ``.amc`` file.
    skeleton : path-like or Skeleton, optional
        For an AMC, its ASF or a skeleton read from one; looked for beside it by default.

    Returns
    -------
    Motion
        Lengths in the file's unit.

    Raises
    ------
    FormatError
        If the file is of no known format, or not what its format says, with line and column.
    ValueError
        If a skeleton is given for a file that holds its own.
    OSError
        If the file cannot be read.
    """
    path = Path(path)
    try:
        known = _known(path, _READERS)
    except ValueError as error:
        raise FormatError(str(error), path=path) from None
    if not known.takes_skeleton:
        if skeleton is not None:
            raise ValueError(f"expected no skeleton: a {path.suffix} file holds its own")
        return _upright(known.read(path))
    if isinstance(skeleton, str | PathLike):
        skeleton = Path(skeleton)
    return _upright(known.read(path, skeleton))


def _upright(motion: Motion) -> Motion:
    """Find out which axis points up from some fifty poses."""
    spread = motion.at(np.linspace(0, len(motion) - 1, min(len(motion), 50)))
    up = vertical_axis(spread.positions(), motion.skeleton.size)
    return motion if up == motion.up else replace(motion, up=up)


def write(motion: Motion, path: str | PathLike[str]) -> None:
    """Write a motion to a file, in the format its suffix names.

    A motion read from the same format is written with that file's channels. An AMC gets its
    ASF beside it, of the same name; ``.glb`` and ``.gltf`` are for engines, and not read. The
    file appears whole or not at all.

    Raises
    ------
    ValueError
        If the suffix is not known.
    TooShort
        If the motion has no frame.
    OSError
        If the file cannot be written.
    """
    path = Path(path)
    write_to = _known(path, _WRITERS)
    if not len(motion):
        raise TooShort("expected a motion of at least one frame, found none")
    write_to(motion, path)


def _known(path: Path, formats: dict[str, _Known]) -> _Known:
    try:
        return formats[path.suffix.lower()]
    except KeyError:
        known = ", ".join(formats)
        raise ValueError(
            f"expected a file of type {known}, found {path.name or str(path)!r}"
        ) from None
