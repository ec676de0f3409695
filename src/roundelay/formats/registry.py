"""Readers and writers: what they must be, ours and those of plug-ins, and how a file finds its own.

A reader or a writer is an object with a `name`, `suffixes` and one method; see `Reader` and
`Writer`. One module holds each of ours. The first that knows a file's suffix gets the file, ours
before those that plug-ins bring.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Protocol, TypeVar, runtime_checkable

from roundelay.base.errors import FormatError
from roundelay.base.files import STANDARD_INPUT, unpacked
from roundelay.base.registry import Registry
from roundelay.formats.acclaim_writer import AmcWriter
from roundelay.formats.amc import AmcReader
from roundelay.formats.animals import AnimalsReader
from roundelay.formats.arrays import NpyReader, NpzReader, NpzWriter
from roundelay.formats.bvh import BvhReader
from roundelay.formats.bvh_writer import BvhWriter
from roundelay.formats.c3d import C3dReader
from roundelay.formats.c3d_writer import C3dWriter
from roundelay.formats.contents import Contents
from roundelay.formats.fbx_reader import FbxReader
from roundelay.formats.fbx_writer import FbxWriter
from roundelay.formats.gltf import GltfWriter
from roundelay.formats.gltf_reader import GltfReader
from roundelay.formats.mvnx import MvnxReader
from roundelay.formats.opensim import OpenSimReader, OpenSimWriter
from roundelay.formats.options import ReadOptions
from roundelay.formats.point_csv import CsvReader, CsvWriter
from roundelay.formats.qualisys import QualisysReader, QualisysWriter
from roundelay.formats.smpl import SmplReader
from roundelay.formats.trc import TrcReader, TrcWriter
from roundelay.formats.usd import UsdReader, UsdWriter
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion
from roundelay.motion.points import Points

__all__ = [
    "ChoosingPointsReader",
    "ChoosingReader",
    "PointsReader",
    "PointsWriter",
    "Reader",
    "SkeletonReader",
    "Suffixed",
    "Writer",
    "besides_motion",
    "checked_format",
    "contents_of",
    "files_of",
    "files_written",
    "format_of_points",
    "in_words",
    "is_capture",
    "reader_of",
    "readers",
    "suffixes_of",
    "wraps_at_last_key",
    "writer_of",
    "writers",
]


class Suffixed(Protocol):
    """Whatever is found by the suffix of a file."""

    @property
    def name(self) -> str:
        """What it is called, for errors and to tell it from others."""
        ...

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of its files, in small letters with their dots, the usual one first."""
        ...


class Reader(Suffixed, Protocol):
    """Read the files of one format.

    A reader whose files may hold more than a motion has a method ``besides_motion(path)``, too; see
    `besides_motion`. One whose suffixes other things have as well, such as ``.csv``, has a method
    ``claims(path)``; see `is_capture`. One that shares its suffix with a later, more general reader
    sets ``shares_suffix = True`` and gets the files that it claims.
    """

    def read(self, path: Path) -> Motion:
        """Read a file.

        Parameters
        ----------
        path : Path
            Its suffix is one of the reader's, in any case.

        Returns
        -------
        Motion
            Lengths in the file's unit. Which axis points up is found out afterwards.

        Raises
        ------
        FormatError
            If the file is not what its format says. Nothing else may be raised because of
            what stands in a file.
        OSError
            If the file cannot be read.
        """
        ...


@runtime_checkable
class SkeletonReader(Reader, Protocol):
    """Read the files of a format that keeps the skeleton in another file."""

    def read(self, path: Path, skeleton: Skeleton | Path | None = None) -> Motion:
        """Read a file, with a skeleton or the file that holds it, found by default."""
        ...

    def find_skeleton(self, path: Path) -> Path:
        """Return the file of the skeleton that belongs to a file.

        Raises
        ------
        FormatError
            If there is none.
        """
        ...


@runtime_checkable
class PointsReader(Reader, Protocol):
    """Read the files of a format that holds points: markers or keypoints, with gaps."""

    def read_points(self, path: Path) -> Points:
        """Read the points of a file.

        Raises
        ------
        FormatError
            If the file is not what its format says.
        OSError
            If it cannot be read.
        """
        ...


@runtime_checkable
class ChoosingReader(Reader, Protocol):
    """Read the files of a format that may hold several motions or skeletons, or be mended.

    `choices` names the fields of `ReadOptions` that it obeys, among "animation", "character",
    "salvage" and "encoding".
    """

    @property
    def choices(self) -> frozenset[str]:
        """The fields of `ReadOptions` that it obeys."""
        ...

    def read(self, path: Path, wanted: ReadOptions | None = None) -> Motion:
        """Read a file, and of several motions or skeletons what is wanted."""
        ...

    def contents(self, path: Path) -> Contents:
        """List what a file holds.

        Raises
        ------
        FormatError
            If the file is not sound.
        """
        ...


@runtime_checkable
class ChoosingPointsReader(PointsReader, Protocol):
    """Read the points of a file that may hold several bodies, or be cut off."""

    @property
    def choices(self) -> frozenset[str]:
        """The fields of `ReadOptions` that it obeys."""
        ...

    def read_points(self, path: Path, wanted: ReadOptions | None = None) -> Points:
        """Read the points that are wanted, as `PointsReader` reads them."""
        ...


class Writer(Suffixed, Protocol):
    """Write the files of one format.

    A writer whose format holds keys at times, not frames, sets ``wraps_at_last_key = True``; see
    `wraps_at_last_key`. Without it, its files hold frames that all last equally long.
    """

    def write(self, motion: Motion, path: Path) -> None:
        """Write a file, whole or not at all; see `roundelay.base.files.written_beside`.

        Parameters
        ----------
        motion : Motion
            Of at least one frame.
        path : Path
            Its suffix is one of the writer's, in any case.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        ...


@runtime_checkable
class PointsWriter(Writer, Protocol):
    """Write the files of a format that holds points."""

    def write_points(self, points: Points, path: Path) -> None:
        """Write points to a file, whole or not at all.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        ...


readers: Registry[Reader] = Registry("reader", "roundelay.readers", Reader)
readers.add(BvhReader())
readers.add(AmcReader())
readers.add(GltfReader())
readers.add(FbxReader())
readers.add(C3dReader())
readers.add(TrcReader())
readers.add(OpenSimReader())
readers.add(CsvReader())
readers.add(QualisysReader())
readers.add(UsdReader())
readers.add(SmplReader())
readers.add(MvnxReader())
readers.add(NpzReader())
readers.add(NpyReader())
readers.add(AnimalsReader())

writers: Registry[Writer] = Registry("writer", "roundelay.writers", Writer)
writers.add(BvhWriter())
writers.add(AmcWriter())
writers.add(GltfWriter())
writers.add(FbxWriter())
writers.add(UsdWriter())
writers.add(C3dWriter())
writers.add(TrcWriter())
writers.add(OpenSimWriter())
writers.add(CsvWriter())
writers.add(QualisysWriter())
writers.add(NpzWriter())

_VIDEO = "; find keypoints in the video, by DeepLabCut, SLEAP or MediaPipe, and give those"
# What to do with files of other programs.
_WAYS = {
    **dict.fromkeys((".mp4", ".avi", ".mov", ".mkv", ".webm"), _VIDEO),
    ".tak": "; export it from Motive as C3D or CSV",
    ".qtm": "; export it from Qualisys Track Manager as C3D or TSV",
    ".x2d": "; export it from Nexus as C3D",
    ".blend": "; export it from Blender as BVH or glTF",
}
_NAMELESS = "; name its format by --as (in Python by suffix)"

_Known = TypeVar("_Known", bound=Suffixed)


def suffixes_of(registry: Iterable[Suffixed]) -> tuple[str, ...]:
    """List the suffixes that readers or writers know, each once."""
    return tuple(dict.fromkeys(suffix for one in registry for suffix in one.suffixes))


def in_words(registry: Iterable[Suffixed]) -> str:
    """Name the formats that readers or writers know by their suffixes, as in "BVH, AMC or GLB"."""
    *others, last = (suffix[1:].upper() for suffix in suffixes_of(registry))
    return f"{', '.join(others)} or {last}" if others else last


def reader_of(path: Path, suffix: str | None = None) -> Reader:
    """Return the reader of a file, packed or not.

    Parameters
    ----------
    path : Path
    suffix : str, optional
        The format, without a dot, where the name does not tell it.

    Raises
    ------
    FormatError
        If no reader knows the suffix; the message lists those that are known.
    """
    named = unpacked(path) if suffix is None else Path(f"{path.name}.{suffix}")
    try:
        return _reader_for(named, path)
    except ValueError as error:
        hint = _WAYS.get(named.suffix.lower(), "") if named.suffix else _NAMELESS
        raise FormatError(f"{error}{hint}", path=path) from None


def is_capture(path: Path) -> bool:
    """Tell whether a file found in a folder is a capture, by its suffix.

    Where other things have that suffix, too, the reader is asked. What cannot be looked at counts
    as one, so that whoever reads it says why.
    """
    try:
        reader = _reader_for(unpacked(path), path)
        return bool(getattr(reader, "claims", lambda path: True)(path))
    except ValueError:
        return False
    except OSError:
        return True


def besides_motion(path: Path) -> tuple[str, ...]:
    """Name what a file holds that is lost where its motion is written over it, such as "meshes".

    Raises
    ------
    FormatError
        If no reader knows the suffix, or the file is not sound.
    OSError
        If it cannot be read.
    """
    named = getattr(reader_of(path), "besides_motion", None)
    return () if named is None else tuple(named(path))


def contents_of(path: Path, suffix: str | None = None) -> Contents:
    """List what a file holds to choose from; nothing where its format has one motion a file.

    Raises
    ------
    FormatError
        If no reader knows the suffix, or the file is not sound.
    OSError
        If it cannot be read.
    """
    reader = reader_of(path, suffix)
    return reader.contents(path) if isinstance(reader, ChoosingReader) else Contents()


def writer_of(path: Path) -> Writer:
    """Return the writer of a file.

    Raises
    ------
    ValueError
        If no writer knows the suffix; the message lists those that are known.
    """
    return _known(path, writers)


def _reader_for(named: Path, path: Path) -> Reader:
    """Return the reader of a name; one that shares its suffix must claim the file, too."""

    def refuses(one: Reader) -> bool:
        shares = getattr(one, "shares_suffix", False)
        return shares and (path == STANDARD_INPUT or not one.claims(path))  # type: ignore[attr-defined]

    return _known(named, readers, refuses)


def _nothing(one: object) -> bool:
    return False


def _known(
    path: Path, registry: Iterable[_Known], refuses: Callable[[_Known], bool] = _nothing
) -> _Known:
    suffix = path.suffix.lower()
    # Plug-ins are not looked for where one of ours knows the suffix.
    for one in registry:
        if suffix in one.suffixes and not refuses(one):
            return one
    known = ", ".join(suffixes_of(registry))
    raise ValueError(f"expected a file of type {known}, found {path.name or str(path)!r}")


def checked_format(name: str) -> str:
    """Return the name of a format to write, a suffix without its dot, if there is a writer of it.

    Raises
    ------
    ValueError
        If there is none; the message lists those that are known.
    """
    if not any(f".{name}" in writer.suffixes for writer in writers):
        known = tuple(suffix[1:] for suffix in suffixes_of(writers))
        raise ValueError(f"expected a format among {known}, found {name!r}")
    return name


def format_of_points(path: Path, suffix: str | None = None) -> str | None:
    """Return the format, a suffix without its dot, that loops of a file of points are written in.

    The file's own if it can be written, else TRC; None for other files.

    Parameters
    ----------
    path : Path
    suffix : str, optional
        The format, without a dot, where the name does not tell it.

    Raises
    ------
    FormatError
        If no reader knows the suffix.
    """
    if not isinstance(reader_of(path, suffix), PointsReader):
        return None
    own = suffix or unpacked(path).suffix[1:].lower()
    return own if f".{own}" in suffixes_of(writers) else "trc"


def wraps_at_last_key(name: str) -> bool:
    """Tell whether players of a format go from the last key to the first without any time between.

    A loop in such a format lasts a whole period only if its last key repeats its first.

    Parameters
    ----------
    name : str
        The format, a suffix without its dot.

    Raises
    ------
    ValueError
        If no writer knows it.
    """
    return getattr(_known(Path(f"loop.{name}"), writers), "wraps_at_last_key", False)


def files_written(path: Path) -> tuple[Path, ...]:
    """List the files that writing one left: itself, and that of its skeleton if it has one."""
    skeleton = path.with_suffix(".asf")
    return (path, skeleton) if path.suffix.lower() == ".amc" else (path,)


def files_of(path: Path) -> list[Path]:
    """List the files that a capture is made of: its own, and that of its skeleton.

    Raises
    ------
    FormatError
        If no reader knows the suffix, or the skeleton is not found.
    OSError
        If the folder cannot be read.
    """
    reader = reader_of(path)
    return [path, *([reader.find_skeleton(path)] if isinstance(reader, SkeletonReader) else [])]
