"""A library by the workers of a Dask cluster: the same tables, whatever dies."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay.cli import app
from roundelay.library import workers
from roundelay.library.database import DATABASE, database_files
from roundelay.library.workers import Limits, in_child

runner = CliRunner()


@pytest.fixture(autouse=True)
def no_child_is_left():
    """A child is kept for the next task; none is left for other tests."""
    yield
    kept = vars(workers._KEPT).pop("worker", None)
    if kept is not None:
        kept.end()


def half(number: int) -> float:
    if number == 13:
        os._exit(1)
    return number / 2


def lost(number: int) -> float:
    return -number


def test_a_child_is_kept_and_one_that_dies_costs_its_task():
    told = {"limits": Limits(), "late": lost}
    found = [in_child(half, number, lost, **told) for number in (1, 13, 2, 3)]
    assert found == [0.5, -13, 1.0, 1.5]


def test_workers_of_dask_make_the_same_tables(shared, made, tmp_path):
    pytest.importorskip("distributed")
    library = rl.build_library(shared, tmp_path / "library", cluster=1)
    for name in set(database_files()) - {DATABASE, "tables/runs.parquet"}:
        assert (library.folder / name).read_bytes() == (made[0].folder / name).read_bytes(), name


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--scheduler", "tcp://127.0.0.1:1"], "tcp://127.0.0.1:1: expected a Dask scheduler"),
        (["--scheduler", "tcp://a", "--cluster", "2"], "expected --scheduler or --cluster"),
    ],
)
def test_a_cluster_that_is_not_there_is_one_line(clips, tmp_path, arguments, said, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("roundelay.library.cluster._PATIENCE", "1s")
    result = runner.invoke(app, ["library", str(clips), "-o", str(tmp_path / "l"), *arguments])
    assert result.exit_code == 2
    assert said in result.stderr
    assert result.stderr.count("\n") == 1
    assert not Path(tmp_path / "l" / "loops").exists()


def test_without_dask_it_is_said(clips, tmp_path, monkeypatch):
    monkeypatch.setattr("roundelay.library.cluster.find_spec", lambda name: None)
    with pytest.raises(rl.RoundelayError, match="found none; pip install distributed"):
        rl.build_library(clips, tmp_path / "library", cluster=2)
