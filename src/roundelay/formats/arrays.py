"""Read and write NumPy's NPY and NPZ files of points.

An NPZ holds the array ``positions`` (F, J, 2 or 3), NaN where a point is missing, and whatever
there is of ``names`` (J,), ``fps``, ``missing`` (F, J), ``residuals`` (F, J), ``likelihoods``
(F, J), ``units``, ``image`` and ``links`` (n, 2), as in `roundelay.motion.points.Points`. An NPY
holds positions alone. Nothing in them is run: objects are refused.
"""

from __future__ import annotations

import io
import math
import tokenize
import warnings
import zipfile
import zlib
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from roundelay.base.errors import FormatError, TooLarge
from roundelay.base.files import beginning, content, name_of, written_beside
from roundelay.formats.point_files import Notes, checked_size, made, plain, rate_assumed
from roundelay.formats.points import ReadsPoints, WritesPoints
from roundelay.formats.text import shown
from roundelay.motion.points import Points

__all__ = ["NpyReader", "NpzReader", "NpzWriter", "arrays_of", "names_in"]

# Of any array of a file, and letters of an array's heading.
_MOST_BYTES, _LONGEST_HEADING = 1 << 31, 10_000
# What NumPy raises at a heading that is none.
_UNREADABLE = (ValueError, TypeError, SyntaxError, MemoryError, RecursionError, tokenize.TokenError)
_LAST_LETTER = 0x10FFFF
_KINDS = {"positions": "fiu", "fps": "fiu", "missing": "b", "residuals": "f", "likelihoods": "f"}
_KINDS |= {"names": "U", "units": "U", "image": "b", "links": "iu", "name": "U"}


class NpzReader(ReadsPoints):
    """The reader of NPZ files."""

    name = "npz"
    suffixes = (".npz",)

    def read_points(self, path: Path) -> Points:
        """Read an NPZ file.

        Parameters
        ----------
        path : Path

        Returns
        -------
        Points

        Raises
        ------
        FormatError
            If the file is not sound, or an array is not what it should be; the message names it.
        OSError
            If it cannot be read.
        """
        arrays = arrays_of(path, _KINDS)
        if "positions" not in arrays:
            raise FormatError("expected an array 'positions', found none", path=path)
        return _points(path, arrays)

    def claims(self, path: Path) -> bool:
        """Tell whether an NPZ holds positions.

        Raises
        ------
        OSError
            If it cannot be read.
        """
        return "positions" in names_in(path)


class NpyReader(ReadsPoints):
    """The reader of NPY files: positions (F, J, 2 or 3) without names or rate."""

    name = "npy"
    suffixes = (".npy",)

    def read_points(self, path: Path) -> Points:
        """Read an NPY file.

        Parameters
        ----------
        path : Path

        Returns
        -------
        Points
            Named "point 1" and so on.

        Raises
        ------
        FormatError
            If the file is not sound.
        OSError
            If it cannot be read.
        """
        return _points(path, {"positions": _array(path, content(path), "positions", "fiu")})

    def claims(self, path: Path) -> bool:
        """Tell whether an array can be positions.

        Raises
        ------
        OSError
            If it cannot be read.
        """
        try:
            shape, _, dtype = _heading(path, io.BytesIO(beginning(path)), "positions")
        except FormatError:
            return False
        return dtype.kind in "fiu" and len(shape) == 3 and shape[2] in (2, 3)


def names_in(path: Path) -> tuple[str, ...]:
    """List the arrays of an NPZ; none where it is no such file.

    Raises
    ------
    OSError
        If it cannot be read.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(content(path))) as archive:
            return tuple(name.removesuffix(".npy") for name in archive.namelist())
    except (zipfile.BadZipFile, FormatError, TooLarge):
        return ()


def arrays_of(path: Path, kinds: dict[str, str]) -> dict[str, NDArray[Any]]:
    """Return the arrays of an NPZ that mean something.

    Parameters
    ----------
    path : Path
    kinds : dict of str to str
        The arrays by their names, and the kinds of numbers that each may have, as NumPy's letters.

    Raises
    ------
    FormatError
        If it is no whole NPZ, or an array is of another kind; objects are.
    OSError
        If it cannot be read.
    """
    data = content(path)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = {info.filename.removesuffix(".npy"): info for info in archive.infolist()}
            known = {name: info for name, info in members.items() if name in kinds}
            return {
                name: _array(path, _unpacked(archive, info), name, kinds[name])
                for name, info in known.items()
            }
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise FormatError(f"expected a whole NPZ, found: {error}", path=path) from None
    except (ValueError, OverflowError, IndexError, UnicodeError) as error:
        raise FormatError(f"expected an NPZ, found: {error}", path=path) from None


def _unpacked(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> bytes:
    """Return the bytes of a member; what it says of its size is no promise."""
    with archive.open(info) as file:
        data = file.read(_MOST_BYTES + 1)
    if len(data) > _MOST_BYTES:
        raise zipfile.BadZipFile(f"{info.filename} of more than {_MOST_BYTES / 1e9:.1f} GB")
    return data


def _array(path: Path, data: bytes, name: str, kinds: str) -> NDArray[Any]:
    """Return the array in the bytes of an NPY; no memory is taken for what is not there."""
    file = io.BytesIO(data)
    shape, by_column, dtype = _heading(path, file, name)
    if dtype.kind not in kinds or not dtype.itemsize:
        what = {"U": "text", "b": "bool"}.get(kinds, "numbers")
        found = f"expected {name!r} of {what}, found {dtype}"
        raise FormatError(found, path=path)
    size, left = dtype.itemsize * math.prod(shape), len(data) - file.tell()
    if size != left:
        found = f"expected {size} bytes of {name!r} {shape}, found {left}"
        raise FormatError(found, path=path)
    values = np.frombuffer(data, dtype, offset=file.tell())
    return values.reshape(shape, order="F" if by_column else "C")


def _heading(
    path: Path, file: io.BytesIO, name: str
) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Return shape, order and type of an array."""
    try:
        version = npy.read_magic(file)
        read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that a heading looks old
            return read(file, max_header_size=_LONGEST_HEADING)
    except _UNREADABLE as error:
        told = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise FormatError(f"expected an array {name!r}, found: {told}", path=path) from None


def _points(path: Path, arrays: dict[str, NDArray[Any]]) -> Points:
    positions = arrays["positions"]
    if positions.ndim != 3 or positions.shape[2] not in (2, 3):
        found = f"expected 'positions' of shape (F, J, 2 or 3), found {positions.shape}"
        raise FormatError(found, path=path)
    frames, count = positions.shape[:2]
    checked_size(path, frames, count)
    _check_shapes(path, arrays, frames, count)
    with np.errstate(all="ignore"):
        places = positions.astype(float)
    names = _texts(path, arrays, "names") or [""] * count
    units, name = (" ".join(_texts(path, arrays, key)) for key in ("units", "name"))
    rate = float(arrays["fps"]) if "fps" in arrays else rate_assumed(path)
    return made(
        path,
        names,
        places,
        rate,
        notes=Notes(path),
        missing=arrays.get("missing"),
        residuals=arrays.get("residuals"),
        likelihoods=arrays.get("likelihoods"),
        units=units,
        image=bool(arrays.get("image", False)),
        links=[(int(a), int(b)) for a, b in arrays.get("links", ())],
        name=name or name_of(path),
    )


def _texts(path: Path, arrays: dict[str, NDArray[Any]], name: str) -> list[str]:
    """Return the texts of an array; none where there is no such array."""
    if name not in arrays:
        return []
    values = arrays[name]
    letters = np.frombuffer(values.tobytes(), f"{values.dtype.byteorder}u4")
    if np.any(letters > _LAST_LETTER):
        _refuse(path, name, "of letters", "what is none")
    return [plain(str(value)) for value in values.reshape(-1)]


def _check_shapes(path: Path, arrays: dict[str, NDArray[Any]], frames: int, count: int) -> None:
    shapes: dict[str, tuple[int, ...]] = dict.fromkeys(("fps", "units", "image", "name"), ())
    shapes |= dict.fromkeys(("missing", "residuals", "likelihoods"), (frames, count))
    shapes["names"] = (count,)
    for name, shape in shapes.items():
        if name in arrays and arrays[name].shape != shape:
            _refuse(path, name, f"of shape {shape}", f"{arrays[name].shape}")
    links = arrays.get("links", np.empty((0, 2), int))
    if links.ndim != 2 or links.shape[1] != 2:
        _refuse(path, "links", "of shape (n, 2)", f"{links.shape}")
    if len(links) and not 0 <= links.min() <= links.max() < count:
        _refuse(
            path, "links", f"between points 0 to {count - 1}", f"{links.min()} to {links.max()}"
        )


def _refuse(path: Path, name: str, expected: str, found: str) -> NoReturn:
    raise FormatError(f"expected {name!r} {expected}, found {shown(found)}", path=path)


class NpzWriter(WritesPoints):
    """The writer of NPZ files."""

    name = "npz"
    suffixes = (".npz",)

    def write_points(self, points: Points, path: Path) -> None:
        """Write an NPZ file that holds all of the points, exactly.

        Parameters
        ----------
        points : Points
        path : Path

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        told: dict[str, Any] = {
            "positions": points.to_array(),
            "names": np.array(points.names),
            "fps": np.array(points.fps),
            "units": np.array(points.units),
            "image": np.array(points.image),
            "links": np.array(points.links, int).reshape(-1, 2),
            "name": np.array(points.name),
            "residuals": points.residuals,
            "likelihoods": points.likelihoods,
        }
        given = {name: value for name, value in told.items() if value is not None}
        with written_beside(path) as part, part.open("wb") as file:
            np.savez(file, **given)
