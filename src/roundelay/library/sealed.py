"""Records that tell themselves whether they are as they were written: JSON with a checksum.

A sealed record is an object whose first member is ``crc32``, the checksum of all bytes after it::

    {"crc32": "0a1b2c3d", "format": 2, ...}
"""

from __future__ import annotations

import json
import zlib
from pathlib import Path
from typing import Any

__all__ = ["FORMAT", "OLDER", "SEAL", "checksum", "checksum_of", "sealed", "unsealed"]

FORMAT = 4
"""The number of the format of a library's files.

1 had neither checksums nor lists of files, 2 neither strides nor runs, 3 no vocabulary. Of a
library of format 2 or 3 it is known which files are its own: its clips are done again.
"""
OLDER = (2, 3)
SEAL = b'{"crc32": "'
"""How every sealed record begins."""
_STOP = b'",'
_LENGTH = len(SEAL) + 8 + len(_STOP)


def checksum(data: bytes) -> str:
    """Return the CRC-32 of bytes as eight hexadecimal digits."""
    return f"{zlib.crc32(data):08x}"


def checksum_of(path: Path) -> list[int | str]:
    """Return the size of a file in bytes, and its checksum.

    Raises
    ------
    OSError
        If it cannot be read.
    """
    data = path.read_bytes()
    return [len(data), checksum(data)]


def sealed(record: dict[str, Any], indent: int | None = None) -> bytes:
    """Return a record as JSON that bears its format's number and a checksum."""
    text = json.dumps({"format": FORMAT} | record, indent=indent, allow_nan=False)
    rest = text[1:].encode() if indent is not None else b" " + text[1:].encode()
    return SEAL + checksum(rest).encode() + _STOP + rest


def unsealed(data: bytes) -> dict[str, Any] | None:
    """Return a sealed record; None if it is not as it was written.

    It may be of a later format: see its ``format``.
    """
    head, rest = data[:_LENGTH], data[_LENGTH:]
    if head != SEAL + checksum(rest).encode() + _STOP:
        return None
    record: dict[str, Any] = json.loads(data)
    return record
