"""Files: packed ones and standard input read, output that appears whole or not at all."""

from __future__ import annotations

import gzip
import os
import re
import secrets
import stat
import sys
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from errno import EISDIR
from hashlib import sha256
from pathlib import Path

from roundelay.base.errors import FormatError, TooLarge

__all__ = [
    "STANDARD_INPUT",
    "beginning",
    "content",
    "fitting",
    "flushed",
    "is_part",
    "name_of",
    "unpacked",
    "written_beside",
]

STANDARD_INPUT = Path("-")
# Bytes; what is packed tighter than any capture must not fill memory.
_MOST = 1 << 31
# Bytes of a generated name: file systems take 255, some with encryption 143; a temporary name, a
# number and a suffix must fit, too.
_LONGEST_NAME = 120
_PART = re.compile(r"\.[0-9a-f]{16}\.part(\.\w+){0,2}")
_KINDS = {
    stat.S_IFIFO: "a named pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}


def unpacked(path: Path) -> Path:
    """Return the name of a file without the ``.gz`` of a packed one."""
    return path.with_suffix("") if path.suffix.lower() == ".gz" else path


def name_of(path: Path) -> str:
    """Return the name of a capture: that of its file without suffixes, or ``stdin``."""
    return "stdin" if path == STANDARD_INPUT else unpacked(path).stem


def fitting(stem: str, ending: str, longest: int = _LONGEST_NAME) -> str:
    """Return a file name of a stem and an ending that every file system takes.

    Parameters
    ----------
    stem : str
        Cut if it is too long; then a checksum of the whole tells it from others.
    ending : str
    longest : int
        Bytes that the name may have.
    """
    whole = os.fsencode(stem)
    room = longest - len(os.fsencode(ending))
    if len(whole) <= room:
        return stem + ending
    mark = f"~{sha256(whole).hexdigest()[:12]}"
    # What is cut within a character is no text: it is left out.
    kept = whole[: max(0, room - len(mark))].decode(sys.getfilesystemencoding(), "ignore")
    return kept + mark + ending


def content(path: Path) -> bytes:
    """Return what a file holds, unpacked if it is a ``.gz``; of ``-`` the standard input.

    Raises
    ------
    FormatError
        If it is a pipe or a device, changes while it is read, or is packed and not whole.
    TooLarge
        If it holds, or would unpack to, more than 2 GB.
    OSError
        If it cannot be read.
    """
    if path == STANDARD_INPUT:
        return _bounded(sys.stdin.buffer.read(_MOST + 1))
    _refuse_special(path)
    if path.suffix.lower() != ".gz":
        return _whole(path)
    try:
        with gzip.open(path) as file:
            return _bounded(file.read(_MOST + 1))
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise FormatError(f"expected a whole gzip file, found: {error}", path=path) from None


def beginning(path: Path, most: int = 1 << 16) -> bytes:
    """Return the first bytes of a file, unpacked if it is a ``.gz``.

    Raises
    ------
    FormatError
        If it is a pipe or a device, or is packed and not whole.
    OSError
        If it cannot be read.
    """
    _refuse_special(path)
    try:
        with gzip.open(path) if path.suffix.lower() == ".gz" else path.open("rb") as file:
            return file.read(most)
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise FormatError(f"expected a whole gzip file, found: {error}", path=path) from None


def _refuse_special(path: Path) -> None:
    """Refuse what has no end, before it is opened: opening a pipe may wait for ever."""
    kind = _KINDS.get(stat.S_IFMT(path.stat().st_mode))
    if kind is not None:
        told = f"expected a file, found {kind}; pipe it into standard input and give - for it"
        raise FormatError(told, path=path)


def _whole(path: Path) -> bytes:
    """Read a file that nobody is writing to."""
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size
        if size > _MOST:
            raise TooLarge(f"expected a file of at most {_MOST / 1e9:.1f} GB, found {path} larger")
        data = file.read(size + 1)
    if len(data) != size:
        told = "expected a file that stays as it is, found one that changed while it was read"
        raise FormatError(f"{told}; read it when it is whole", path=path)
    return data


def _bounded(data: bytes) -> bytes:
    if len(data) > _MOST:
        raise TooLarge(f"expected at most {_MOST / 1e9:.1f} GB unpacked, found more")
    return data


@contextmanager
def written_beside(path: Path, *, durable: bool = False) -> Iterator[Path]:
    """Give a name beside `path` to write to, and rename it to `path` once that went well.

    No other process, on this machine or another that shares the folder, is given the same name.

    Parameters
    ----------
    path : Path
    durable : bool
        Wait until the file would outlast a loss of power.

    Raises
    ------
    OSError
        If the file cannot be written or renamed, or `path` is a folder; it names `path`.
    """
    if path.is_dir():
        raise IsADirectoryError(EISDIR, "expected a file, found a folder", str(path))
    # The suffix stays last: some writers choose the format by it.
    part = path.with_name(f".{secrets.token_hex(8)}.part{path.suffix}")
    try:
        yield part
        if durable:
            flushed(part)
        os.replace(part, path)
        if durable:
            _flushed_folder(path.parent)
    except OSError as error:
        # A full disk is told of without a name, and the name in between is of no use.
        unnamed = error.filename is None and error.errno is not None
        if unnamed or (error.filename is not None and Path(error.filename) == part):
            error.filename, error.filename2 = str(path), None
        raise
    finally:
        part.unlink(missing_ok=True)


def is_part(name: str) -> bool:
    """Tell whether a file is what `written_beside` was writing when its process was killed."""
    return _PART.fullmatch(name) is not None


def flushed(path: Path) -> None:
    """Wait until what a file holds is on the disk."""
    with path.open("rb+") as file:
        os.fsync(file.fileno())


def _flushed_folder(folder: Path) -> None:
    """Wait until the names in a folder are on the disk, where the system can be asked to."""
    if os.name == "nt":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
