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
from typing import Any, ClassVar, Literal, Union, get_args, get_origin, get_type_hints

__all__ = ["Checked", "Declared", "Described", "choices", "declared", "leaves", "option"]


@dataclass(frozen=True)
class Described:
    """What is known of an option besides its name, type and default.

    Parameters
    ----------
    text : str
        What it does, in one sentence for users.
    unit : str
        Of its values; empty where they have none.
    least, most : float, optional
        Values it may have, both allowed.
    above, below : float, optional
        Values must be larger, or smaller, than this.
    flag : str
        Its name on the command line; empty for the field's own.
    label : str
        Its name in a panel; empty for the field's own.
    form : str
        How it is written on the command line, where its type does not tell.
    """

    text: str
    unit: str = ""
    least: float | None = None
    most: float | None = None
    above: float | None = None
    below: float | None = None
    flag: str = ""
    label: str = ""
    form: str = ""

    @property
    def range(self) -> str:
        """The values allowed, in words; empty where all are."""
        bounds = {
            "at least": self.least,
            "more than": self.above,
            "at most": self.most,
            "less than": self.below,
        }
        return " and ".join(f"{word} {x:g}" for word, x in bounds.items() if x is not None)

    def allows(self, value: float) -> bool:
        """Tell whether a number is in the range, and finite."""
        return (
            isfinite(value)
            and (self.least is None or value >= self.least)
            and (self.most is None or value <= self.most)
            and (self.above is None or value > self.above)
            and (self.below is None or value < self.below)
        )


@dataclass(frozen=True)
class Declared:
    """An option as it is declared.

    Parameters
    ----------
    name : str
        Of the field.
    kind : type
        What its values are.
    default : object
    known : Described
        The same object for all that share a declaration.
    """

    name: str
    kind: Any
    default: Any
    known: Described

    @property
    def flag(self) -> str:
        """The name on the command line, without its dashes in front."""
        return self.known.flag or self.name.replace("_", "-")

    @property
    def label(self) -> str:
        """The name in a panel."""
        return self.known.label or self.name.replace("_", " ").title()

    @property
    def options(self) -> type[Checked] | None:
        """The dataclass that its values are of; None if it is an option by itself."""
        is_class = isinstance(self.kind, type) and issubclass(self.kind, Checked)
        return self.kind if is_class else None

    def __str__(self) -> str:
        """Say what values it may have: type, range, unit."""
        words = " or ".join(_in_words(one) for one in choices(self.kind) if one is not NoneType)
        unit = f"in {self.known.unit}" if self.known.unit else ""
        none = "or None" if NoneType in choices(self.kind) else ""
        return ", ".join(filter(None, (words, self.known.range, unit, none)))

    def checked(self, value: Any) -> Any:
        """Return a value in plain Python: lists as tuples, NumPy's numbers as those of Python.

        Raises
        ------
        ValueError
            If it has not the type, or is out of range: what was expected, and what was found.
        """
        plain = _plain(value)
        numbers = plain if isinstance(plain, tuple) else (plain,)
        inside = all(self.known.allows(x) for x in numbers if _is_number(x))
        if not (inside and _fits(plain, self.kind)):
            raise ValueError(f"expected {self.name} as {self}, found {plain!r}")
        return plain


def option(default: Any, text: str, **known: Any) -> Any:
    """Declare a field of a `Checked` dataclass.

    Parameters
    ----------
    default : object
        A class is called without arguments for the default.
    text : str
        What it does, in one sentence for users.
    **known
        Further arguments of `Described`.
    """
    metadata = {"option": Described(text, **known)}
    if isinstance(default, type):
        return field(default_factory=default, metadata=metadata)
    return field(default=default, metadata=metadata)


class Checked:
    """Check the fields of a frozen dataclass when it is made.

    Attributes
    ----------
    title : str
        What the options are about, as a heading.

    Raises
    ------
    ValueError
        If a value has not the type of its field, or is out of its range: what was expected,
        and what was found.
    """

    title: ClassVar[str]

    def __post_init__(self) -> None:
        """Check all fields; lists become tuples, and NumPy's numbers those of Python."""
        for one in declared(type(self)):
            object.__setattr__(self, one.name, one.checked(getattr(self, one.name)))


def declared(options: type) -> tuple[Declared, ...]:
    """Return the options that a dataclass declares."""
    return _declared(options)


@cache
def _declared(options: type) -> tuple[Declared, ...]:
    kinds = get_type_hints(options)
    return tuple(
        Declared(one.name, kinds[one.name], _default_of(one), one.metadata["option"])
        for one in fields(options)
        if "option" in one.metadata
    )


def leaves(options: type) -> Iterator[Declared]:
    """Iterate over the options of a dataclass and of those that it holds."""
    for one in declared(options):
        if one.options is None:
            yield one
        else:
            yield from leaves(one.options)


def _default_of(one: Field[Any]) -> Any:
    return one.default if one.default_factory is MISSING else one.default_factory()


def choices(kind: Any) -> tuple[Any, ...]:
    """Return the alternatives of a union; another type, also a Literal, is its only one."""
    return get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)


def _plain(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return tuple(_plain(inside) for inside in value)
    if hasattr(value, "tolist"):  # an array of NumPy, or one of its numbers
        return _plain(value.tolist())
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
        return isinstance(value, tuple) and _fits_inside(value, get_args(kind))
    if kind is float:
        return _is_number(value)
    if kind is int:
        return _is_number(value) and isinstance(value, int)
    return isinstance(value, kind)


def _fits_inside(values: tuple[Any, ...], kinds: tuple[Any, ...]) -> bool:
    if kinds[-1] is Ellipsis:
        return all(_fits(x, kinds[0]) for x in values)
    return len(values) == len(kinds) and all(map(_fits, values, kinds))


def _in_words(kind: Any) -> str:
    if get_origin(kind) is Literal:
        return "one of " + ", ".join(repr(name) for name in get_args(kind))
    if get_origin(kind) is tuple:
        inside = get_args(kind)
        words = [" or ".join(map(_in_words, choices(x))) for x in inside if x is not Ellipsis]
        if inside[-1] is Ellipsis:
            return f"a tuple, each {words[0]}"
        return f"a pair of {' and '.join(words)}"
    names = {float: "a number", int: "a whole number", bool: "True or False", str: "text"}
    return "None" if kind is NoneType else names.get(kind, f"a {kind.__name__}")
