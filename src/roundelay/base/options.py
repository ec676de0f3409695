"""One model of options: frozen dataclasses whose fields say what they mean, checked when made.

From the same fields the command line, the panel in Blender and the tables of the documentation
are generated, so that an option has one name, one meaning and one unit everywhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import MISSING, Field, dataclass, field, fields
from functools import cache
from math import isfinite
from numbers import Integral, Real
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

__all__ = ["Checked", "Described", "choices", "default_of", "described", "option"]


@dataclass(frozen=True)
class Described:
    """What is known of an option besides its type.

    Parameters
    ----------
    text : str
        What it does, in one sentence for users.
    unit : str
        Of its values; empty where they have none.
    least, most : float, optional
        Values it may have, both allowed.
    above : float, optional
        Values must be larger than this.
    flag : str
        Its name on the command line; empty for the field's own.
    """

    text: str
    unit: str = ""
    least: float | None = None
    most: float | None = None
    above: float | None = None
    flag: str = ""

    @property
    def range(self) -> str:
        """The values allowed, in words; empty where all are."""
        low = "" if self.least is None else f"at least {self.least:g}"
        low = low if self.above is None else f"more than {self.above:g}"
        high = "" if self.most is None else f"at most {self.most:g}"
        return " and ".join(filter(None, (low, high)))

    def allows(self, value: float) -> bool:
        """Tell whether a number is in the range, and finite."""
        return (
            isfinite(value)
            and (self.least is None or value >= self.least)
            and (self.most is None or value <= self.most)
            and (self.above is None or value > self.above)
        )


def option(default: Any, text: str, **known: Any) -> Any:
    """Declare a field of a `Checked` dataclass; further arguments as for `Described`."""
    metadata = {"option": Described(text, **known)}
    if isinstance(default, type):
        return field(default_factory=default, metadata=metadata)
    return field(default=default, metadata=metadata)


class Checked:
    """Check the fields of a frozen dataclass when it is made.

    Raises
    ------
    ValueError
        If a value has not the type of its field, or is out of its range: what was expected,
        and what was found.
    """

    def __post_init__(self) -> None:
        """Check all fields; lists become tuples, and NumPy's numbers those of Python."""
        for one, kind, known in described(type(self)):
            value = _plain(getattr(self, one.name))
            object.__setattr__(self, one.name, value)
            if not _fits(value, kind):
                raise ValueError(f"expected {one.name} {_in_words(kind, known)}, found {value!r}")
            numbers = value if isinstance(value, tuple) else (value,)
            if not all(known.allows(x) for x in numbers if _is_number(x)):
                raise ValueError(f"expected {one.name} {_in_words(kind, known)}, found {value!r}")


def described(options: type) -> Iterator[tuple[Field[Any], Any, Described]]:
    """Iterate over the declared fields of a dataclass: field, type, and what is known of it."""
    kinds = _hints(options)
    for one in fields(options):
        if "option" in one.metadata:
            yield one, kinds[one.name], one.metadata["option"]


@cache
def _hints(options: type) -> dict[str, Any]:
    return get_type_hints(options)


def default_of(one: Field[Any]) -> Any:
    """Return the default value of a field."""
    if one.default_factory is not MISSING:
        return one.default_factory()
    return one.default


def choices(kind: Any) -> tuple[Any, ...]:
    """Return the alternatives of a type, without those of a Literal taken apart."""
    return get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)


def _plain(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return tuple(_plain(inside) for inside in value)
    if isinstance(value, bool | int | float):
        return value
    if isinstance(value, Integral):
        return int(value)
    return float(value) if isinstance(value, Real) else value


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _fits(value: Any, kind: Any) -> bool:
    return any(_fits_one(value, one) for one in choices(kind))


def _fits_one(value: Any, kind: Any) -> bool:
    if get_origin(kind) is Literal:
        return isinstance(value, str) and value in get_args(kind)
    if get_origin(kind) is tuple:
        inside = get_args(kind)
        if not isinstance(value, tuple):
            return False
        if inside[-1] is Ellipsis:
            return all(_fits(x, inside[0]) for x in value)
        return len(value) == len(inside) and all(map(_fits, value, inside))
    if kind is float:
        return _is_number(value)
    if kind is int:
        return _is_number(value) and isinstance(value, int)
    return isinstance(value, kind)


def _in_words(kind: Any, known: Described) -> str:
    """Say what values an option may have."""
    words = [_kind_in_words(one) for one in choices(kind) if one is not NoneType]
    text = " or ".join(words)
    if known.range:
        text += f", {known.range}"
    if known.unit:
        text += f", in {known.unit}"
    return text + (", or None" if NoneType in choices(kind) else "")


def _kind_in_words(kind: Any) -> str:
    if get_origin(kind) is Literal:
        return "among " + ", ".join(repr(name) for name in get_args(kind))
    if get_origin(kind) is tuple:
        return "as a tuple of " + _kind_in_words(get_args(kind)[0])
    names = {
        float: "as a number",
        int: "as a whole number",
        bool: "as True or False",
        str: "as text",
    }
    return names.get(kind, f"as {kind.__name__}")
