"""``roundelay query``: a question in SQL to a library's tables."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from roundelay.commands.common import Json, echo, one_line_errors, print_json

Folder = Annotated[
    Path,
    typer.Argument(
        metavar="LIBRARY", help="A folder made by roundelay library.", show_default=False
    ),
]
Sql = Annotated[
    str,
    typer.Argument(
        metavar="SQL",
        help="A question to the tables, in DuckDB's SQL; without one, the tables are listed.",
        show_default=False,
    ),
]
Target = Annotated[
    Path | None,
    typer.Option(
        "-o", "--output", help="A .csv, .json or .parquet for the answer.", show_default=False
    ),
]


def query(folder: Folder, sql: Sql = "", output: Target = None, json: Json = False) -> None:
    """Ask the tables of a library: clips, behaviours, cycles, loops, strides, signatures, runs.

    The tables are those of library.duckdb and tables/*.parquet, which DuckDB, pandas and Polars
    open by themselves. They are made anew where they are damaged or of an older version.

    Exit code 0: the question was answered; 2: bad input.
    """
    from roundelay.library.query import LISTING, answer, written_answer

    with one_line_errors():
        if output is not None:
            written_answer(folder, sql or LISTING, output)
            return
        found = answer(folder, sql or LISTING)
        if json:
            print_json(found.records())
        else:
            for line in found.lines():
                echo(line)
