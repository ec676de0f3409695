"""``roundelay report``: one page of a library."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from roundelay.commands.common import echo, one_line_errors

Folder = Annotated[
    Path,
    typer.Argument(
        metavar="LIBRARY", help="A folder made by roundelay library.", show_default=False
    ),
]
Page = Annotated[
    Path | None,
    typer.Option(
        "-o",
        "--output",
        help="The page; report.html in the library by default.",
        show_default=False,
    ),
]


def report(folder: Folder, output: Page = None) -> None:
    """Write one page of a library: groups with moving figures, names, counts, what was refused.

    It needs nothing else: no server, no network.

    Exit code 0: it is written; 2: bad input.
    """
    from roundelay.library import Library
    from roundelay.library.report import write_report

    with one_line_errors():
        path = folder / "report.html" if output is None else output
        write_report(Library.open(folder), path)
        echo(f"-> {path}")
