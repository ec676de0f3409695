"""Parse tables of decimal numbers, exactly and many at a time.

A number like -12.3456 is two runs of digits. Eight characters are read as one integer and
turned into a number in three multiplications (D. Lemire, "Number parsing at a gigabyte per
second", 2021, section 3), here for all numbers of a block at once. Up to 15 digits the result
is a quotient of two exact doubles, and so the nearest double to what is written. Exponents and
longer runs, rare in captures, are left to ``float``.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from roundelay.formats.sane import LARGEST

__all__ = ["is_decimal", "is_number", "parse"]

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Places = NDArray[np.intp]

_NUMBER = re.compile(rb"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")

_BLANK = re.compile(rb"\s")
_NUMERIC = b"0123456789+-.eE \t\r\n\v\f"
_BLOCK = 1 << 16
_POWERS = 10.0 ** np.arange(9)
# Masks of the digits in the last 0 to 8 characters of eight, in a little-endian word.
_LAST = np.array([0x0F0F0F0F0F0F0F0F >> (64 - 8 * n) << (64 - 8 * n) for n in range(9)], np.uint64)
_PAIRS = np.uint64(0x000000FF000000FF)
_UPPER = np.uint64(0x000F424000000064)
_LOWER = np.uint64(0x0000271000000001)


def is_decimal(word: bytes) -> bool:
    """Tell whether a word is a decimal number: no NaN, infinity, hexadecimal, _."""
    return _NUMBER.fullmatch(word) is not None


def is_number(word: bytes) -> bool:
    """Tell whether a word is a decimal number of sane size; see `roundelay.formats.sane`."""
    return is_decimal(word) and abs(float(word)) <= LARGEST


def parse(text: bytes, start: int = 0) -> Array | None:
    """Return the numbers (n,) in text of nothing else, or None if a word is not one.

    Parameters
    ----------
    text : bytes
    start : int
        Where the numbers begin; what stands before is not looked at.
    """
    parts = [np.empty(0)]
    while start < len(text):
        stop = _block_end(text, start)
        part = _parse_block(text[start:stop])
        if part is None:
            return None
        parts.append(part)
        start = stop
    return np.concatenate(parts)


def _block_end(text: bytes, start: int) -> int:
    """Return the end of a block, at a blank unless the text is one long word."""
    found = _BLANK.search(text, start + _BLOCK)
    return found.start() if found else len(text)


def _parse_block(block: bytes) -> Array | None:
    if block.translate(None, _NUMERIC):
        return None
    # Eight blanks in front let every number be read as a whole word of memory.
    padded = b" " * 8 + block + b" "
    chars = np.frombuffer(padded, np.uint8)
    blank = chars <= ord(" ")
    edges = np.flatnonzero(blank[1:] != blank[:-1]) + 1
    starts, stops = edges[::2], edges[1::2]
    dots, odd = _dots(chars, starts, stops)
    signed = chars[starts] < ord(".")
    odd |= _has_other_marks(chars, blank, starts, int(signed.sum()))
    whole, part = dots - starts - signed, np.maximum(stops - dots - 1, 0)
    odd |= (whole > 8) | (part > 8) | (whole + part > 15) | (whole + part == 0)
    if 2 * np.count_nonzero(odd) > len(odd):
        return _one_by_one(block)
    whole[odd] = part[odd] = 0
    words = np.ndarray(len(chars) - 7, "<u8", padded, strides=(1,))
    scale = _POWERS[part]
    values = _digits(words[dots - 8], whole) * scale + _digits(words[stops - 8], part)
    values /= scale
    np.negative(values, out=values, where=chars[starts] == ord("-"))
    rest = np.flatnonzero(odd)
    places = zip(starts[rest].tolist(), stops[rest].tolist(), strict=True)
    try:
        # Of the characters that are left, float takes decimal numbers only.
        values[rest] = [float(padded[start:stop]) for start, stop in places]
    except ValueError:
        return None
    return values if np.all(np.abs(values[rest]) <= LARGEST) else None


def _one_by_one(block: bytes) -> Array | None:
    """Return the numbers of a block most of which have too many digits or exponents."""
    try:
        values = np.array([float(word) for word in block.split()])
    except ValueError:
        return None
    return values if np.all(np.abs(values) <= LARGEST) else None


def _dots(chars: NDArray[np.uint8], starts: Places, stops: Places) -> tuple[Places, Flags]:
    """Return where each number's point is, or its end, and which numbers have several."""
    dots = np.flatnonzero(chars == ord("."))
    several = np.zeros(len(starts), bool)
    if len(dots) == len(starts) and np.all((starts <= dots) & (dots < stops)):
        return dots, several
    owners = np.searchsorted(starts, dots, "right") - 1
    several[owners[1:][owners[1:] == owners[:-1]]] = True
    places = stops.copy()
    places[owners] = dots
    return places, several


def _has_other_marks(chars: NDArray[np.uint8], blank: Flags, starts: Places, signed: int) -> Flags:
    """Return which numbers hold a sign or an exponent after their first character."""
    odd = np.zeros(len(starts), bool)
    marks = np.flatnonzero(((chars < ord(".")) & ~blank) | (chars > ord("9")))
    if len(marks) > signed:
        owners = np.searchsorted(starts, marks, "right") - 1
        odd[owners[(starts[owners] != marks) | (chars[marks] > ord("9"))]] = True
    return odd


def _digits(words: NDArray[np.uint64], count: Places) -> Array:
    """Return the numbers that the last `count` characters of words of eight digits write."""
    digits = words & _LAST[count]
    digits = digits * np.uint64(10) + (digits >> np.uint64(8))
    high = (digits & _PAIRS) * _UPPER
    low = ((digits >> np.uint64(16)) & _PAIRS) * _LOWER
    return ((high + low) >> np.uint64(32)).astype(float)
