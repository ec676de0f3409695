"""Checks of what a caller gives: a wrong type is named before anything is computed."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Real
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "all_expected",
    "as_number",
    "as_numbers",
    "as_path",
    "as_sequence",
    "chosen",
    "expected",
]

Kind = TypeVar("Kind")


def expected(kind: type[Kind], value: Any) -> Kind:
    """Return a value that is of a type.

    Raises
    ------
    TypeError
        If it is not: which type was expected, and which was found.
    """
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        raise TypeError(f"expected {article} {kind.__name__}, found {type(value).__name__}")
    return value


def chosen(kind: type[Kind], value: Kind | None) -> Kind:
    """Return a value that is of a type, or one with all defaults if none is given.

    Raises
    ------
    TypeError
        If it is neither.
    """
    return kind() if value is None else expected(kind, value)


def all_expected(kind: type[Kind], values: Any) -> list[Kind]:
    """Return several values that are all of a type.

    Raises
    ------
    TypeError
        If they are not several, or one is of another type.
    """
    try:
        several = list(values)
    except TypeError:
        raise TypeError(
            f"expected several {kind.__name__}s, found {type(values).__name__}"
        ) from None
    return [expected(kind, value) for value in several]


def as_sequence(value: Any, what: str) -> Sequence[Any]:
    """Return what has a length and an order.

    Raises
    ------
    TypeError
        If it has not: what was expected, and what was found.
    """
    is_one = isinstance(value, str | bytes) or (isinstance(value, np.ndarray) and not value.ndim)
    if is_one or not isinstance(value, Sequence | np.ndarray):
        raise TypeError(f"expected a sequence of {what}, found {type(value).__name__}")
    return value  # type: ignore[return-value]


def as_number(value: Any, what: str) -> float:
    """Return a real number as it is.

    Raises
    ------
    TypeError
        If it is none: what was expected, and what was found.
    """
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(f"expected a {what} as a number, found {type(value).__name__}")
    return value  # type: ignore[return-value]


def as_path(value: Any) -> Path:
    """Return the path of a file or folder that was given as text or as a path.

    Raises
    ------
    TypeError
        If it is neither.
    """
    if isinstance(value, bytes) or not isinstance(value, str | PathLike):
        raise TypeError(f"expected a path, found {type(value).__name__}")
    return Path(value)


def as_numbers(data: Any, what: str) -> NDArray[Any]:
    """Return data as an array of real numbers.

    Parameters
    ----------
    data : array_like
    what : str
        What they are, for the error: "points (n, d)".

    Raises
    ------
    ValueError
        If they are none: what was expected, and what was found.
    """
    if hasattr(data, "tocoo"):
        raise ValueError(f"expected {what}, found a sparse matrix")
    try:
        array = np.asarray(data)
        if array.dtype.kind == "c":
            raise TypeError
        return array if array.dtype.kind in "buif" else array.astype(np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"expected {what} as numbers, found {_in_short(data)}") from None


def _in_short(data: Any) -> str:
    dtype = getattr(data, "dtype", "")
    return f"{type(data).__name__} of {dtype}" if dtype else type(data).__name__
