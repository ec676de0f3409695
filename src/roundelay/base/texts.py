"""Text from outside, such as the name of a file, as it may be shown anywhere."""

from __future__ import annotations

import os
import unicodedata

__all__ = ["printable", "shown"]

# Control characters, bytes that are no text, and what turns the order of letters around.
_HIDDEN = {"Cc", "Cs", "Zl", "Zp"}
_TURNING = frozenset("\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")


def shown(text: str | os.PathLike[str]) -> str:
    r"""Return a name on one line that changes nothing where it is shown.

    What would command a terminal, break a line or be no text is written as in Python: ``\x1b``.
    """
    return "".join(map(_visible, os.fspath(text)))


def printable(text: str) -> str:
    """Return lines of text as `shown` would show each; line breaks and tabs stay."""
    return "".join(letter if letter in "\n\t" else _visible(letter) for letter in text)


def _visible(letter: str) -> str:
    if letter.isprintable() or not (letter in _TURNING or unicodedata.category(letter) in _HIDDEN):
        return letter
    code = ord(letter)
    if 0xDC80 <= code <= 0xDCFF:  # a byte of a file name that is no text
        code -= 0xDC00
    return f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}"
