"""Options of commands, made from the dataclasses that declare them: no default is told twice."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import reduce, wraps
from inspect import Parameter, signature
from operator import or_
from types import NoneType
from typing import Annotated, Any, Literal, get_args, get_origin

import typer

from roundelay.base.options import Checked, Declared, choices, declared, leaves
from roundelay.commands.common import one_line_errors

__all__ = ["Taken", "all_but", "help_of", "only", "taken_by", "takes"]

Command = Callable[..., None]


@dataclass(frozen=True)
class Taken:
    """Options that a command takes: those of a dataclass, or some of them.

    Parameters
    ----------
    options : type
        A `Checked` dataclass.
    names : frozenset of str
        Of the fields the command takes; the others keep their defaults.
    """

    options: type[Checked]
    names: frozenset[str]

    def __iter__(self) -> Iterator[Declared]:
        return (one for one in leaves(self.options) if one.name in self.names)

    def made(self, values: Mapping[str, Any]) -> Any:
        """Make the options of values by `_key`.

        Raises
        ------
        ValueError
            If they do not go together.
        """
        given: dict[str, Any] = {}
        for one in declared(self.options):
            if one.options is not None:
                given[one.name] = replace(self, options=one.options).made(values)
            elif one.name in self.names:
                given[one.name] = values[_key(one)]
        return self.options(**given)


def _all(options: type[Checked]) -> Taken:
    return Taken(options, frozenset(one.name for one in leaves(options)))


def only(options: type[Checked], *names: str) -> Taken:
    """Take these options of a dataclass."""
    return Taken(options, frozenset(names))


def all_but(options: type[Checked], *names: str) -> Taken:
    """Take all options of a dataclass but these."""
    taken = _all(options)
    return replace(taken, names=taken.names - set(names))


def takes(**asked: type[Checked] | Taken) -> Callable[[Command], Command]:
    """Give a command options on the command line; it gets them by the names given here.

    A command with a parameter `given` gets there which of these options, by their flags, have
    another value than when they are left out.

    Parameters
    ----------
    **asked
        A `Checked` dataclass, or what `only` or `all_but` took of one.
    """
    groups = {name: x if isinstance(x, Taken) else _all(x) for name, x in asked.items()}
    added = [_parameter(one, group) for group in groups.values() for one in group]
    taken = [one for group in groups.values() for one in group]

    def decorated(command: Command) -> Command:
        own = signature(command, eval_str=True)

        @wraps(command)
        def spread(**values: Any) -> None:
            with one_line_errors():
                made = {name: group.made(values) for name, group in groups.items()}
            set_to = {one.name: values.pop(one.name) for one in added}
            if "given" in own.parameters:
                made["given"] = frozenset(
                    one.flag for one in taken if set_to[_key(one)] != one.default
                )
            command(**values, **made)

        kept = [one for one in own.parameters.values() if one.name not in {*groups, "given"}]
        spread.__signature__ = own.replace(parameters=[*kept, *added])  # type: ignore[attr-defined]
        spread.taken = tuple(groups.values())  # type: ignore[attr-defined]
        return spread

    return decorated


def taken_by(command: Command) -> tuple[Taken, ...]:
    """Return what `takes` gave a command."""
    return getattr(command, "taken", ())


def _key(one: Declared) -> str:
    """Return the name of a command's parameter: fields of two dataclasses may share theirs."""
    return f"option_{one.flag.replace('-', '_')}"


def _parameter(one: Declared, group: Taken) -> Parameter:
    """Return a parameter as Typer reads it."""
    switch = bool in choices(one.kind)
    kind = (bool if NoneType not in choices(one.kind) else bool | None) if switch else str | None
    shown: dict[str, Any] = {
        "help": help_of(one),
        "show_default": one.default is not None,
        "rich_help_panel": group.options.title,
    }
    if switch:
        option = typer.Option(f"--{one.flag}/--no-{one.flag}", **shown)
    else:
        shown |= {"parser": _reader(one), "metavar": _form(one), "autocompletion": _offered(one)}
        option = typer.Option(f"--{one.flag}", **shown)
    annotation = Annotated[kind, option]  # type: ignore[valid-type]
    return Parameter(_key(one), Parameter.KEYWORD_ONLY, default=one.default, annotation=annotation)


def help_of(one: Declared) -> str:
    """Return what an option does, with its unit and range."""
    limits = ", ".join(filter(None, (one.known.unit, one.known.range)))
    return f"{one.known.text.rstrip('.')} ({limits})." if limits else one.known.text


def _form(one: Declared) -> str:
    """Return how a value is written."""
    if one.known.form:
        return one.known.form
    kinds = [kind for kind in choices(one.kind) if kind is not NoneType]
    if get_origin(kinds[0]) is Literal:
        return "|".join(get_args(kinds[0]))
    return "NAME" if str in kinds else "NUMBER"


def _offered(one: Declared) -> Callable[[str], list[str]]:
    """Return what tells a shell which names of an option begin with what is typed."""
    names = [name for kind in choices(one.kind) if get_origin(kind) is Literal
             for name in get_args(kind)]  # fmt: skip

    def offer(incomplete: str) -> list[str]:
        return [name for name in names if name.startswith(incomplete)]

    return offer


def _reader(one: Declared) -> Callable[[Any], Any]:
    """Return what reads and checks an option's text; defaults come as they are."""
    # Whoever names an option gives it a value: None can only be left out.
    kinds = [kind for kind in choices(one.kind) if kind is not NoneType]
    given = replace(one, name=one.flag, kind=reduce(or_, kinds))

    def read(text: Any) -> Any:
        if not isinstance(text, str):
            return text
        try:
            return given.checked(_read(text, given))
        except ValueError as error:
            raise typer.BadParameter(str(error)) from None

    return read


def _read(text: str, one: Declared) -> Any:
    """Read a text as the first kind it can be.

    Raises
    ------
    ValueError
        If it has not the form of a range.
    """
    for kind in choices(one.kind):
        if get_origin(kind) is not tuple:
            continue
        inside = get_args(kind)
        if inside[-1] is Ellipsis:
            return [_plain(part, inside[0]) for part in text.split(",")]
        start, colon, stop = text.partition(":")
        span = _plain(start or "0", inside[0]), _plain(stop, inside[1])
        if not colon or str in map(type, span):
            raise ValueError(f"expected {one.flag} as {_form(one)}, found {text!r}")
        return span
    return _plain(text, one.kind)


def _plain(text: str, kind: Any) -> Any:
    for one in choices(kind):
        if one is NoneType and not text:
            return None
        if one in (int, float):
            with suppress(ValueError):
                return one(text)
    return text
