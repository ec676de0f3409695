"""The catalogue of a library for other programs: a file of DuckDB, and Parquet beside it.

=====================  ===========================================================
``library.duckdb``     all tables of `roundelay.library.schema`, with their words
``tables/*.parquet``   the same, a file a table
=====================  ===========================================================

Both are derived, so that a damaged or older one is made anew. Equal libraries give equal Parquet
files, to the byte, but for that of runs.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roundelay.base.errors import FormatError
from roundelay.base.files import written_beside
from roundelay.base.version import __version__
from roundelay.library.schema import SCHEMA, TABLES, Source, Table, as_text

if TYPE_CHECKING:
    from duckdb import DuckDBPyConnection

__all__ = [
    "DATABASE",
    "PARQUET",
    "Outdated",
    "connected",
    "database_files",
    "has_duckdb",
    "in_a_line",
    "write_database",
]

DATABASE, PARQUET = "library.duckdb", "tables"


class Outdated(Exception):
    """The catalogue is missing, damaged or of an older version: it is to be made anew."""


def has_duckdb() -> bool:
    """Tell whether DuckDB is installed."""
    from importlib.util import find_spec

    return find_spec("duckdb") is not None


def database_files() -> tuple[str, ...]:
    """Return the paths, below a library, of what is written where DuckDB is installed."""
    parquet = tuple(f"{PARQUET}/{table.name}.parquet" for table in TABLES)
    return (DATABASE, *parquet) if has_duckdb() else ()


def write_database(source: Source, folder: Path) -> None:
    """Write all tables as Parquet and into one file of DuckDB, each beside and renamed.

    Raises
    ------
    OSError
        If a file cannot be written.
    """
    (folder / PARQUET).mkdir(exist_ok=True)
    with _naming(folder / DATABASE), written_beside(folder / DATABASE, durable=True) as part:
        database = _opened(part)
        try:
            for table in TABLES:
                path = folder / PARQUET / f"{table.name}.parquet"
                _write_table(database, table, table.rows(source), path)
            _describe(database)
        finally:
            database.close()
            part.with_name(f"{part.name}.wal").unlink(missing_ok=True)


def _opened(path: Path, *, read_only: bool = False) -> DuckDBPyConnection:
    import duckdb

    config: dict[str, Any] = {"threads": 1, "autoinstall_known_extensions": False}
    return duckdb.connect(str(path), read_only=read_only, config=config)


def _write_table(
    database: DuckDBPyConnection, table: Table, rows: Iterable[dict[str, Any]], path: Path
) -> None:
    """Write rows as Parquet, in the order of their key, and take them into the database."""
    types: dict[str, str] = {name: kind for name, (kind, _) in table.columns.items()}
    columns = ", ".join(f"{_quoted(name)}: {_text(kind)}" for name, kind in types.items())
    order = ", ".join(table.key)
    with written_beside(path, durable=True) as part:
        with _lines(rows, types, part.with_suffix(".jsonl")) as lines:
            read = f"read_json({_text(lines)}, format='newline_delimited', columns={{{columns}}}"
            database.execute(
                f"CREATE TABLE {table.name} AS SELECT * FROM {read}, "
                f"maximum_object_size=1073741824) ORDER BY {order}"
            )
        database.execute(
            f"COPY (SELECT * FROM {table.name} ORDER BY {order}) "
            f"TO {_text(part)} (FORMAT parquet, COMPRESSION zstd)"
        )


@contextmanager
def _lines(rows: Iterable[dict[str, Any]], columns: Iterable[str], path: Path) -> Iterator[Path]:
    """Hold rows as lines of JSON while they are taken in."""
    try:
        with path.open("w", encoding="ascii", newline="\n") as file:
            for row in rows:
                kept = {name: row[name] for name in columns if row.get(name) is not None}
                told = json.dumps(kept, allow_nan=False)
                file.write((json.dumps(as_text(kept)) if "\\ud" in told else told) + "\n")
        yield path
    finally:
        path.unlink(missing_ok=True)


def _describe(database: DuckDBPyConnection) -> None:
    """Put words to tables and columns, and the version beside them."""
    for table in TABLES:
        database.execute(f"COMMENT ON TABLE {table.name} IS {_text(table.words)}")
        for name, (_, words) in table.columns.items():
            place = f"{table.name}.{_quoted(name)}"
            database.execute(f"COMMENT ON COLUMN {place} IS {_text(words)}")
    database.execute("CREATE TABLE catalogue (format INTEGER, roundelay VARCHAR)")
    database.execute("INSERT INTO catalogue VALUES (?, ?)", [SCHEMA, __version__])


def _quoted(name: str) -> str:
    return f'"{name}"'


def _text(value: str | Path) -> str:
    escaped = str(value).replace("'", "''")
    return f"'{escaped}'"


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Tell faults of DuckDB as those of the file that it writes."""
    import duckdb

    try:
        yield
    except duckdb.Error as error:
        raise OSError(None, in_a_line(error), str(path)) from None


@contextmanager
def connected(folder: Path) -> Iterator[DuckDBPyConnection]:
    """Open the catalogue of a library to read it.

    Raises
    ------
    Outdated
        If it is not there, damaged or of an older version.
    FormatError
        If it is of a newer version.
    """
    path = folder / DATABASE
    if not path.is_file():
        raise Outdated
    import duckdb

    try:
        database = _opened(path, read_only=True)
    except duckdb.Error:
        raise Outdated from None
    try:
        _check(database, path)
        yield database
    finally:
        database.close()


def _check(database: DuckDBPyConnection, path: Path) -> None:
    import duckdb

    try:
        (found,) = database.execute("SELECT format FROM catalogue").fetchone() or (0,)
    except duckdb.Error:
        raise Outdated from None
    if found > SCHEMA:
        told = f"expected a catalogue of format {SCHEMA} or older, found {found}"
        raise FormatError(f"{told}; use the roundelay that made it", path=path)
    if found < SCHEMA:
        raise Outdated


def in_a_line(error: Exception) -> str:
    """Return what DuckDB complains of, without the picture of the query below it."""
    lines = [line.strip() for line in str(error).splitlines()]
    kept = [line for line in lines if line and not line.startswith(("LINE ", "^"))]
    return " ".join(kept)
