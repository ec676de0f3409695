"""Text of programs that write no UTF-8: UTF-16, GBK and Shift-JIS, told by their bytes."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

from roundelay.base.errors import FormatError, RoundelayWarning

__all__ = ["in_utf8"]

_HIGH = re.compile(rb"[\x80-\xff]+")
_KANA = re.compile("[\u3041-\u30fe]")
_HALF_WIDTH = re.compile("[\uff61-\uff9f]")


def in_utf8(path: Path, data: bytes, encoding: str | None = None) -> bytes:
    """Return a text in UTF-8; what cannot be told is left as it is.

    Parameters
    ----------
    path : Path
        The file, for errors and notes.
    data : bytes
    encoding : str, optional
        That of the text; found out by default.

    Raises
    ------
    FormatError
        If the text is not in the encoding that it is said to have, or that its mark names.
    """
    known = encoding or _named(data)
    if known is None:
        return data
    try:
        text = data.decode(known)
    except (UnicodeDecodeError, LookupError) as error:
        told = str(error).replace(chr(10), " ")
        raise FormatError(f"expected text in {known}, found: {told}", path=path) from None
    if encoding is None:
        told = f"read as {known}; name another encoding by --encoding"
        warnings.warn(f"{path}: {told}", RoundelayWarning, stacklevel=3)
    return text.removeprefix("\ufeff").encode("utf-8", "replace")


def _named(data: bytes) -> str | None:
    """Return the encoding of a text, or None where it is UTF-8 or cannot be told."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "UTF-16"
    if data.isascii() or _decoded(data, "utf-8") is not None:
        return None
    japanese, chinese = _decoded(data, "cp932"), _decoded(data, "gb18030")
    if japanese is not None and _KANA.search(japanese) and not _HALF_WIDTH.search(japanese):
        return "Shift-JIS"
    # In GBK most letters are of two bytes that are no ASCII; those of Latin stand alone.
    paired = all(len(run) % 2 == 0 for run in _HIGH.findall(data))
    return "GBK" if chinese is not None and paired else None


def _decoded(data: bytes, encoding: str) -> str | None:
    try:
        return data.decode(encoding)
    except UnicodeDecodeError:
        return None
