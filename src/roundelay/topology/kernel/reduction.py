"""What a run of the filtration leaves behind, whichever kernel ran it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.brief import brief
from roundelay.base.numeric import GOLDEN

__all__ = [
    "F32",
    "F64",
    "I32",
    "I64",
    "LARGEST_VALUE",
    "NO_VERTEX",
    "U16",
    "U64",
    "Columns",
    "Reduction",
    "bit_labels",
    "count_shorter",
    "count_up_to",
    "ends",
    "lengths_of",
    "narrow_ends",
]

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]
U16 = NDArray[np.uint16]
U64 = NDArray[np.uint64]

LARGEST_VALUE = 32767
"""No value of an integer cocycle is larger: a table holds them in 16 bits."""
NO_VERTEX = 0xFFFF
"""Fill of an edge whose lune was empty."""


@dataclass(frozen=True)
class Columns:
    """Relations between births as compressed columns.

    Attributes
    ----------
    start : (count + 1,) array of int
        Where each column's entries begin.
    index, value : (entries,) arrays of int
        Birth numbers and their coefficients.
    time : (count,) array
        Length of the edge that brought each relation; ascending.
    """

    start: I64
    index: I32
    value: I64
    time: F32

    __repr__ = brief


@dataclass(frozen=True)
class Reduction:
    """A filtration run.

    Attributes
    ----------
    keys : (edges,) array of uint64
        The edges in order, until the last death (all if a class outlives the run): bits of the
        length << 32 | i << 16 | j with i < j.
    fill : (n, n) array of uint16, upper triangle
        The vertex through which each of these edges is filled, or `NO_VERTEX`.
    merges : (n - 1,) array
        Lengths at which components merge, ascending.
    births : (born,) array of uint64
        Keys of the edges that gave birth to a class, ascending.
    deaths : (born,) array
        Lengths at which the classes die, inf where alive at the end.
    killer : (born,) array of int
        The reduced column that killed each class, or -1.
    relations : Columns
        The relations found while a class lives, over the integers; the others hold then.
    reduced : Columns
        Relations mod p in echelon form: each column's last entry is its youngest birth, with
        value 1.
    """

    keys: U64
    fill: U16
    merges: F32
    births: U64
    deaths: F32
    killer: I64
    relations: Columns
    reduced: Columns

    __repr__ = brief


def lengths_of(keys: U64) -> F32:
    """Return the lengths that edge keys carry."""
    return (keys >> np.uint64(32)).astype(np.uint32).view(np.float32)


def ends(keys: U64) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the vertices i < j of edge keys."""
    i, j = narrow_ends(keys)
    return i.astype(np.intp), j.astype(np.intp)


def narrow_ends(keys: U64) -> tuple[U16, U16]:
    """Return the vertices i < j of edge keys without copying them."""
    parts = keys.astype("<u8", copy=False).view("<u2")
    return parts[1::4], parts[0::4]


def count_shorter(keys: U64, length: float) -> int:
    """Count the edges strictly shorter than a length; keys ascending."""
    # The bits of floats are in the order of the floats from 0 on only, and -0.0 is none of them.
    floor = int(np.float32(max(0.0, length)).view(np.uint32)) << 32
    return int(np.searchsorted(keys, np.uint64(floor)))


def count_up_to(keys: U64, length: float) -> int:
    """Count the edges at most as long as a length; keys ascending."""
    return count_shorter(keys, float(np.nextafter(np.float32(length), np.float32(np.inf))))


def bit_labels(n: int) -> U16:
    """Number n vertices so that neighbours in time get far-apart numbers.

    Steps of the golden section; the first vertices by number are spread evenly over time.
    """
    turns = np.arange(n) * GOLDEN % 1.0
    label = np.empty(n, np.uint16)
    label[np.argsort(turns, kind="stable")] = np.arange(n, dtype=np.uint16)
    return label
