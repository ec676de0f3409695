"""Files: packed ones and standard input read, output that appears whole or not at all."""

from __future__ import annotations

import gzip
import os
import sys
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from errno import EISDIR
from pathlib import Path

from roundelay.base.errors import FormatError, TooLarge

__all__ = ["STANDARD_INPUT", "content", "name_of", "unpacked", "written_beside"]

STANDARD_INPUT = Path("-")
# Bytes; what is packed tighter than any capture must not fill memory.
_MOST = 1 << 31


def unpacked(path: Path) -> Path:
    """Return the name of a file without the ``.gz`` of a packed one."""
    return path.with_suffix("") if path.suffix.lower() == ".gz" else path


def name_of(path: Path) -> str:
    """Return the name of a capture: that of its file without suffixes, or ``stdin``."""
    return "stdin" if path == STANDARD_INPUT else unpacked(path).stem


def content(path: Path) -> bytes:
    """Return what a file holds, unpacked if it is a ``.gz``; of ``-`` the standard input.

    Raises
    ------
    FormatError
        If a packed file is none, or not whole.
    TooLarge
        If it would unpack to more than 2 GB.
    OSError
        If it cannot be read.
    """
    if path == STANDARD_INPUT:
        return sys.stdin.buffer.read()
    if path.suffix.lower() != ".gz":
        return path.read_bytes()
    try:
        with gzip.open(path) as file:
            data = file.read(_MOST + 1)
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise FormatError(f"expected a whole gzip file, found: {error}", path=path) from None
    if len(data) > _MOST:
        raise TooLarge(f"expected at most {_MOST / 1e9:.1f} GB unpacked, found more")
    return data


@contextmanager
def written_beside(path: Path) -> Iterator[Path]:
    """Give a name beside `path` to write to, and rename it to `path` once that went well.

    Raises
    ------
    OSError
        If the file cannot be written or renamed, or `path` is a folder.
    """
    if path.is_dir():
        raise IsADirectoryError(EISDIR, "expected a file, found a folder", str(path))
    # The suffix stays last: some writers choose the format by it.
    part = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        yield part
        os.replace(part, path)
    except OSError as error:
        if error.filename is not None and Path(error.filename) == part:
            error.filename = str(path)  # the name that the caller knows
        raise
    finally:
        part.unlink(missing_ok=True)
