"""Tables of all options, from the dataclasses that declare them."""

from __future__ import annotations

import pkgutil
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import roundelay
from roundelay.base.options import Checked, Declared, choices, declared
from roundelay.cli import app
from roundelay.commands.listing import filled
from roundelay.commands.options import taken_by
from roundelay.library.schema import TABLES, Table

HEADING = ("option", "command line", "values", "default", "what it does", "taken by")


def option_classes() -> list[type[Checked]]:
    """Return the dataclasses of options, those of the first commands first.

    Those that others are made of are left out.
    """
    for module in pkgutil.walk_packages(roundelay.__path__, "roundelay."):
        if not module.name.rpartition(".")[2].startswith("_"):
            import_module(module.name)
    found = [one for one in _below(Checked) if one.__module__.startswith("roundelay.")]
    names = list(commands())
    return sorted(
        found, key=lambda one: (min(map(names.index, _taking(one)), default=99), str(one))
    )


def _taking(options: type[Checked]) -> list[str]:
    return [name for one in declared(options) for name in commands_with(one)]


def _below(kind: type) -> Iterator[type]:
    for one in kind.__subclasses__():
        # What others share has no title of its own.
        if "title" in vars(one):
            yield one
        yield from _below(one)


def tables() -> str:
    """Return a section a dataclass, with a row an option."""
    return "\n".join(line for one in option_classes() for line in _table(one))


def schema() -> str:
    """Return a section a table of a library's catalogue, with a row a column."""
    return "\n".join(line for table in TABLES for line in _schema(table))


def _schema(table: Table) -> list[str]:
    rows = [
        (f"`{name}`" + (" (key)" if name in table.key else ""), f"`{kind}`", words)
        for name, (kind, words) in table.columns.items()
    ]
    heading = [f"### {table.name}", "", f"A row is {table.words}.", ""]
    return [*heading, *map(_line, [("column", "type", "what it holds"), ["---"] * 3, *rows]), ""]


def _table(options: type[Checked]) -> list[str]:
    rows = [_row(one) for one in declared(options) if one.options is None]
    heading = [f"## {options.title}", "", f"`{options.__module__}.{options.__name__}`", ""]
    return [*heading, _line(HEADING), _line(["---"] * len(HEADING)), *map(_line, rows), ""]


def _row(one: Declared) -> list[str]:
    commands = commands_with(one)
    flags = [f"`--{one.flag}`"] if commands else []
    flags += [f"`--no-{one.flag}`"] if commands and bool in choices(one.kind) else []
    default = f"{one.default:.4g}" if isinstance(one.default, float) else one.default
    default = "automatic" if default is None else f"`{default}`"
    cells = [f"`{one.name}`", ", ".join(flags), str(one), default, filled(one.known.text)]
    return [*cells, ", ".join(commands)]


def commands_with(one: Declared) -> list[str]:
    """Return the names of the commands that take an option."""
    return [
        name
        for name, command in commands().items()
        if any(one.known is other.known for taken in taken_by(command) for other in taken)
    ]


def commands() -> dict[str, Any]:
    """Return the functions of all commands by name."""
    functions = [command.callback for command in app.registered_commands]
    return {function.__name__: function for function in functions if function is not None}


def _line(cells: Any) -> str:
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |"
