"""``roundelay name``: what the behaviours of a library are called."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from roundelay.base.texts import shown
from roundelay.commands.common import Json, echo, one_line_errors, print_json

if TYPE_CHECKING:
    from roundelay.library import Library

Folder = Annotated[
    Path,
    typer.Argument(
        metavar="LIBRARY", help="A folder made by roundelay library.", show_default=False
    ),
]
Group = Annotated[
    int | None,
    typer.Argument(
        metavar="GROUP", help="The number of a group; without one, all are listed.", min=0
    ),
]
Name = Annotated[
    str | None,
    typer.Argument(
        metavar="NAME",
        help='What it is called, such as "walk"; several groups may share a name.',
        show_default=False,
    ),
]
Forget = Annotated[bool, typer.Option("--forget", help="Take a name back.")]


def name(
    folder: Folder,
    group: Group = None,
    word: Name = None,
    forget: Forget = False,
    json: Json = False,
) -> None:
    """Name a group of alike behaviours; list groups, their names and who gave them.

    A name is kept when clips are added or done again. Groups that nobody named are called as the
    nearest that somebody named, if one is near, else as the files are called that show them.

    Exit code 0: it is named, or groups were listed; 2: bad input.
    """
    from roundelay.library import Library
    from roundelay.library.naming import name_group

    with one_line_errors():
        if group is None:
            library = Library.open(folder)
        elif (word is None) is not forget:
            raise ValueError("expected a name for the group, or --forget")
        else:
            library = name_group(folder, group, word)
        if json:
            print_json(library.record["groups"])
        else:
            _print_groups(library, group)


def _print_groups(library: Library, only: int | None) -> None:
    echo("group  behaviours  clips  period  name")
    for one in sorted(library.record["groups"], key=lambda group: -group["behaviours"]):
        if only in (None, one["group"]):
            period = one["period_seconds"]
            told = "      -" if period is None else f"{period:5.2f} s"
            by = "" if one["named_by"] in (None, "person") else f" (by {one['named_by']})"
            echo(
                f"{one['group']:5d}{one['behaviours']:12d}{one['clips']:7d} {told}  "
                f"{shown(one['name'] or '-')}{by}; for example {shown(one['example_clip'])}"
            )
