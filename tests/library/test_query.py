"""The tables of a library: what is in them, who can open them, what is refused."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys

import duckdb
import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay.cli import app
from roundelay.library.database import DATABASE, database_files
from roundelay.library.query import answer
from roundelay.library.schema import TABLES

runner = CliRunner()


def run(*arguments):
    return runner.invoke(app, [*map(str, arguments)])


@pytest.fixture
def copy(made, tmp_path):
    return shutil.copytree(made[0].folder, tmp_path / "copy")


def test_tables_tell_what_the_records_tell(made):
    library = made[0]
    found = answer(
        library.folder, "SELECT clip, cycle, period_seconds, parts FROM cycles"
    ).records()
    told = [
        {"clip": clip["file"], "cycle": number, "period_seconds": cycle["period_seconds"]}
        | {"parts": cycle["parts"]}
        for clip in library.clips
        for number, cycle in enumerate(clip["cycles"], 1)
    ]
    assert found == told
    counts = answer(library.folder, "SELECT count(*), count(error), sum(cycles) FROM clips").rows
    assert counts == [(len(library.clips), 1, library.summary["loops"])]
    (count,) = answer(library.folder, "SELECT count(*) FROM behaviours").rows
    assert count == (sum(len(clip["segments"]) for clip in library.clips),)
    (row,) = answer(
        library.folder, "SELECT record->>'loop' FROM cycles WHERE clip = 'ben/jacks.bvh'"
    ).rows
    assert row == ("loops/ben/jacks.bvh/jacks_loop.bvh",)


def test_strides_are_those_of_strides(made, shared):
    found = answer(made[0].folder, "SELECT foot, time FROM strides WHERE clip = 'anna/walk.bvh'")
    own = rl.strides(rl.read(shared / "anna/walk.bvh")).strides
    assert len(own) > 2
    assert [(foot, pytest.approx(time)) for foot, time in found.rows] == [
        (stride.foot, stride.time) for stride in own
    ]


def test_every_table_has_its_key_its_words_and_a_file(made):
    for table in TABLES:
        key = ", ".join(table.key)
        twice = f"SELECT {key} FROM {table.name} GROUP BY ALL HAVING count(*) > 1"
        assert answer(made[0].folder, twice).rows == []
        path = made[0].folder / "tables" / f"{table.name}.parquet"
        columns = duckdb.sql(f"SELECT * FROM read_parquet('{path}')").columns
        assert columns == list(table.columns)
    listed = run("query", made[0].folder).stdout
    assert all(table.words in listed for table in TABLES)


def test_a_run_is_told_once(made):
    (row,) = answer(made[0].folder, "SELECT * FROM runs").records()
    assert (row["clips"], row["refused"], row["jobs"]) == (8, 1, 1)
    assert json.loads(row["options"])["file_format"] == "bvh"


def test_a_question_on_the_command_line(made):
    sql = "SELECT clip, frames FROM clips WHERE cycles = 0 ORDER BY frames"
    lines = run("query", made[0].folder, sql).stdout.splitlines()
    assert [line.split() for line in lines] == [
        ["clip", "frames"],
        ["broken.bvh", "0"],
        ["still.bvh", "300"],
    ]
    found = json.loads(run("query", made[0].folder, sql, "--json").stdout)
    assert found == [{"clip": "broken.bvh", "frames": 0}, {"clip": "still.bvh", "frames": 300}]


@pytest.mark.parametrize("suffix", [".csv", ".json", ".parquet"])
def test_an_answer_as_a_file(made, tmp_path, suffix):
    path = tmp_path / f"answer{suffix}"
    result = run("query", made[0].folder, "SELECT clip, frames FROM clips;", "-o", path)
    assert result.exit_code == 0, result.output
    assert len(duckdb.sql(f"SELECT * FROM '{path}'").fetchall()) == len(made[0].clips)
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("sql", "said"),
    [
        ("SELEC 1", "syntax error"),
        ("SELECT nothing FROM clips", "nothing"),
        ("SELECT * FROM cycels", "cycels"),
        ("DROP TABLE clips", "read-only"),
    ],
)
def test_a_wrong_question_is_one_line(made, sql, said):
    result = run("query", made[0].folder, sql)
    assert result.exit_code == 2
    assert said in result.stderr
    assert result.stderr.count("\n") == 1
    assert answer(made[0].folder, "SELECT count(*) FROM clips").rows == [(8,)]


def test_what_is_no_library_and_no_file_type(made, tmp_path):
    assert "expected a folder made by" in run("query", tmp_path, "SELECT 1").stderr
    result = run("query", made[0].folder, "SELECT 1", "-o", tmp_path / "a.xlsx")
    assert result.stderr == (
        "roundelay: expected a file of type .csv, .json, .parquet, found 'a.xlsx'\n"
    )
    assert list(tmp_path.iterdir()) == []


def change(folder, sql):
    with duckdb.connect(str(folder / DATABASE)) as database:
        database.execute(sql)


def test_tables_that_are_gone_damaged_or_older_are_made_anew(made, copy):
    sql = "SELECT * EXCLUDE (crc32) FROM loops"
    told = answer(made[0].folder, sql).rows
    (copy / DATABASE).unlink()
    assert answer(copy, sql).rows == told
    (copy / DATABASE).write_bytes(b"no database")
    assert answer(copy, sql).rows == told
    change(copy, "UPDATE catalogue SET format = 0; DROP TABLE loops")
    assert answer(copy, sql).rows == told
    assert {path.name for path in copy.iterdir()} == {
        path.name for path in made[0].folder.iterdir()
    }


def test_tables_of_a_later_version_are_refused(copy):
    change(copy, "UPDATE catalogue SET format = 99")
    result = run("query", copy, "SELECT 1")
    assert result.exit_code == 2
    assert "expected a catalogue of format" in result.stderr
    assert result.stderr.endswith("found 99; use the roundelay that made it\n")


def test_equal_libraries_have_equal_tables(shared, made, tmp_path):
    library = rl.build_library(shared, tmp_path / "library", jobs=2)
    for name in set(database_files()) - {DATABASE, "tables/runs.parquet"}:
        assert (library.folder / name).read_bytes() == (made[0].folder / name).read_bytes(), name


def test_a_library_without_duckdb(clips, tmp_path):
    code = """
import sys
sys.modules["duckdb"] = None
import importlib.util
find = importlib.util.find_spec
importlib.util.find_spec = lambda name, *rest: None if name == "duckdb" else find(name, *rest)
from roundelay.__main__ import main
main()
"""
    command = [sys.executable, "-c", code]
    made = [*command, "library", str(clips), "-o", str(tmp_path / "library"), "--jobs", "1"]
    said = subprocess.run(made, capture_output=True, text=True, check=True)
    assert said.stderr == (
        "roundelay: note: DuckDB is not installed: no tables for other programs are written; "
        "pip install duckdb\n"
    )
    asked = [*command, "query", str(tmp_path / "library"), "SELECT 1"]
    said = subprocess.run(asked, capture_output=True, text=True, check=False)
    assert (said.returncode, said.stderr) == (
        2,
        "roundelay: expected DuckDB, found none; pip install duckdb\n",
    )
    assert answer(tmp_path / "library", "SELECT sum(cycles) FROM clips").rows == [(2,)]


def test_the_help_loads_no_database():
    code = "import sys; import roundelay.cli; print('duckdb' in sys.modules)"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout == "False\n"
