"""Questions in SQL to the tables of a library."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roundelay.base.checks import as_path
from roundelay.base.errors import FormatError, RoundelayError
from roundelay.base.files import written_beside
from roundelay.base.locks import locked
from roundelay.base.texts import shown
from roundelay.library.catalogue import Library
from roundelay.library.database import (
    DATABASE,
    Outdated,
    connected,
    has_duckdb,
    in_a_line,
    write_database,
)
from roundelay.library.log import Log
from roundelay.library.schema import source_of
from roundelay.library.store import write_catalogue
from roundelay.library.writing import beside

if TYPE_CHECKING:
    from duckdb import DuckDBPyConnection

__all__ = ["LISTING", "Answer", "answer", "opened_tables", "written_answer"]

LISTING = (
    'SELECT table_name AS "table", estimated_size AS "rows", comment AS "a row is" '
    "FROM duckdb_tables() ORDER BY table_name"
)
"""The question which tables there are."""
_SUFFIXES = {".csv": "csv, HEADER", ".json": "json, ARRAY true", ".parquet": "parquet"}


@dataclass(frozen=True)
class Answer:
    """What a question was answered.

    Attributes
    ----------
    columns : tuple of str
    rows : list of tuple
        Plain values.
    """

    columns: tuple[str, ...]
    rows: list[tuple[Any, ...]]

    def records(self) -> list[dict[str, Any]]:
        """Return a dict a row."""
        return [dict(zip(self.columns, row, strict=True)) for row in self.rows]

    def lines(self) -> Iterator[str]:
        """Yield a heading, and a line a row: columns side by side, numbers to the right."""
        table = [self.columns, *(tuple(map(_cell, row)) for row in self.rows)]
        widths = [max(map(len, column)) for column in zip(*table, strict=True)]
        kinds = list(zip(*self.rows, strict=True)) or [()] * len(widths)
        right = [bool(kind) and all(map(_is_number, kind)) for kind in kinds]
        for row in table:
            cells = [
                cell.rjust(width) if numbers else cell.ljust(width)
                for cell, width, numbers in zip(row, widths, right, strict=True)
            ]
            yield "  ".join(cells).rstrip()


def _is_number(value: Any) -> bool:
    return value is None or (isinstance(value, int | float) and not isinstance(value, bool))


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.6g}"
    return shown(value) if isinstance(value, str) else shown(json.dumps(value))


def answer(folder: str | PathLike[str], sql: str) -> Answer:
    """Ask the tables of a library.

    Parameters
    ----------
    folder : path-like
        Of the library.
    sql : str
        In DuckDB's SQL; it can read only.

    Returns
    -------
    Answer

    Raises
    ------
    FormatError
        If the folder is no library, or one of a newer version.
    ValueError
        If the question cannot be answered.
    RoundelayError
        If DuckDB is not installed.
    """
    with _asked(as_path(folder)) as database:
        found = database.execute(sql)
        columns = tuple(column[0] for column in found.description or ())
        rows = [tuple(map(_plain, row)) for row in found.fetchall()]
    return Answer(columns, rows)


def written_answer(folder: str | PathLike[str], sql: str, path: Path) -> None:
    """Write what the tables of a library answer, whole or not at all.

    Parameters
    ----------
    folder : path-like
    sql : str
    path : Path
        Of type .csv, .json or .parquet.

    Raises
    ------
    ValueError
        If the file is of another type, or the question cannot be answered.
    OSError
        If the file cannot be written.
    """
    kind = _SUFFIXES.get(path.suffix.lower())
    if kind is None:
        told = ", ".join(_SUFFIXES)
        raise ValueError(f"expected a file of type {told}, found {path.name!r}")
    with _asked(as_path(folder)) as database, written_beside(path) as part:
        name = str(part).replace("'", "''")
        database.execute(f"COPY ({sql.strip().rstrip(';')}\n) TO '{name}' (FORMAT {kind})")


def _plain(value: Any) -> Any:
    """Return a value that JSON knows."""
    if isinstance(value, bool | int | float | str | None):
        return value
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, dict):
        return {str(name): _plain(one) for name, one in value.items()}
    return value.isoformat() if isinstance(value, datetime) else str(value)


@contextmanager
def _asked(folder: Path) -> Iterator[DuckDBPyConnection]:
    """Open the tables; tell what is wrong with a question in one line."""
    if not has_duckdb():
        raise RoundelayError("expected DuckDB, found none; pip install duckdb")
    import duckdb

    with opened_tables(folder) as database:
        try:
            yield database
        except duckdb.Error as error:
            raise ValueError(in_a_line(error)) from None


@contextmanager
def opened_tables(folder: Path) -> Iterator[DuckDBPyConnection]:
    """Open the tables of a library, made anew if they are damaged, gone or older.

    Parameters
    ----------
    folder : Path

    Raises
    ------
    FormatError
        If the folder is no library, or one of a newer version.
    """
    try:
        opened = connected(folder)
        database = opened.__enter__()
    except Outdated:
        _remake(folder)
        opened = connected(folder)
        database = opened.__enter__()
    try:
        yield database
    finally:
        opened.__exit__(None, None, None)


def _remake(folder: Path) -> None:
    """Make the tables anew from the log and ``library.json``."""
    record = Library.open(folder).record
    with locked(folder / "library.lock"):
        log = Log(folder)
        missing = [clip["file"] for clip in record["clips"] if clip["file"] not in log.entries]
        if missing:
            told = f"the records of {len(missing)} of {len(record['clips'])} clips are damaged"
            raise FormatError(f"{told}; run roundelay library again", path=folder / DATABASE)
        entries = [log.entries[clip["file"]] for clip in record["clips"]]
        write_database(source_of(record, entries, log.runs), folder)
        kept = {
            name: value for name, value in record.items() if name not in ("format", "checksums")
        }
        write_catalogue(kept, folder, beside(folder))
