"""Checks of what a caller gives: a wrong type is named before anything is computed."""

from __future__ import annotations

from typing import Any, TypeVar

__all__ = ["chosen", "expected"]

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
