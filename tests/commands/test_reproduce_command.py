"""``roundelay reproduce``: the papers' rows of a capture."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from roundelay.cli import app

CAPTURE = Path(__file__).parents[2] / "data" / "captures" / "01_01.bvh"


def run(*words: object):
    return CliRunner().invoke(app, ["reproduce", *map(str, words)])


def test_rows_are_printed_and_written(tmp_path):
    result = run(CAPTURE, "-o", tmp_path, "--frames", "1:220", "--epsilon", "5", "--nearest", "6")
    assert result.exit_code == 0, result.stderr
    record = json.loads((tmp_path / "01_01_papers.json").read_text())
    assert record["options"]["[C]"]["scale"] == 5.0
    assert record["options"]["[A]"]["neighbours"] == 6
    for name in ("[A] table 1", *(f"[C] {name}" for name in record["[C]"])):
        assert name in result.stdout
    told = run(CAPTURE, "-o", tmp_path, "--frames", "1:220", "--epsilon", "5", "--json")
    assert json.loads(told.stdout)["[C]"]["M1"] == record["[C]"]["M1"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--frames", "9:7"], "expected frames within"),
        (["--epsilon", "0"], "expected epsilon as a number, more than 0"),
        (["--frames", "1:4"], "found 3"),
    ],
)
def test_bad_input_is_one_line_and_2(tmp_path, words, message):
    result = run(CAPTURE, "-o", tmp_path, *words)
    assert result.exit_code == 2
    assert message in result.stderr
    assert result.stderr.count("\n") == 1
