"""The benchmarks' harness: reports, targets, and what compares one house with another."""

from __future__ import annotations

import argparse
import json

import pytest
from benchmarks import _harness, house, unchanged
from benchmarks._harness import Target, figure, report


@pytest.fixture
def reported(capsys, monkeypatch, tmp_path):
    """Report a result; return what was printed and the file that was kept."""
    monkeypatch.setattr(_harness, "RESULTS", tmp_path)

    def made(result, *targets, **asked):
        arguments = argparse.Namespace(**{"json": False, "keep": True, "data": "/there", **asked})
        report("made", result, targets, arguments, table=["a line"], bulk=("rows",))
        return capsys.readouterr().out, json.loads((tmp_path / "made.json").read_text())

    return made


def test_a_report_names_the_targets_that_are_missed(reported):
    right = Target("right", ">=", 3, "strides found")
    summary = {"right": 2, "error": {"walk": 0.3}}
    met = Target("error.walk", "<=", 0.3, "error")
    absent = Target("error.run", "<=", 0.3, "error of runs")
    _, kept = reported({"summary": summary}, right, met, absent)
    assert kept["summary"] == {**summary, "short": kept["summary"]["short"]}
    assert kept["summary"]["short"] == [
        "strides found: expected right >= 3, found 2",
        "error of runs: expected error.run <= 0.3, found not measured",
    ]


def test_a_report_tells_the_circumstances_and_no_path(reported):
    printed, kept = reported({"summary": {}, "rows": [1]}, runs=20)
    assert {"date", "commit", "machine", "threads", "options"} <= set(kept)
    assert kept["options"] == {"runs": 20}
    assert "/there" not in json.dumps(kept)
    assert "rows" not in kept
    # For people, too, the report ends in JSON.
    line, _, rest = printed.partition("\n")
    assert line == "a line"
    assert json.loads(rest)["summary"] == {"short": []}


def test_as_json_a_report_prints_everything_and_nothing_else(reported):
    printed, _ = reported({"summary": {}, "rows": [1], "else": 2}, json=True)
    assert json.loads(printed)["rows"] == [1]
    assert json.loads(printed)["else"] == 2


def test_a_figure_lies_at_a_path_whose_keys_may_hold_dots():
    summary = {"a": {"b.py": [1, {"c": 2}]}}
    assert figure(summary, "a.b.py.0") == 1
    assert figure(summary, "a.b.py.1.c") == 2
    assert figure(summary, "a.b.py.2") is None
    assert figure(summary, "a.d") is None


def test_results_are_the_same_to_1e_12_but_for_options():
    old = {"period": 1.5, "options": 1, "runs": [1, 2], "name": "a"}
    assert list(unchanged.differences(old, {**old, "options": 2, "period": 1.5 + 1e-13})) == []
    changed = {**old, "period": 1.5 + 1e-11, "runs": [1, 3], "name": "b"}
    assert len(list(unchanged.differences(old, changed))) == 3
    assert list(unchanged.differences(old, {**old, "more": 1})) == ["/more: only now"]
    assert list(unchanged.differences(old, {**old, "runs": [1]})) != []


def test_a_house_is_counted(tmp_path):
    tree = tmp_path / "made"
    (tree / "base").mkdir(parents=True)
    (tree / "__init__.py").write_text('"""The house."""\n')
    (tree / "base" / "__init__.py").write_text("")
    (tree / "base" / "files.py").write_text("def _hidden():\n    pass\n")
    (tree / "top.py").write_text(
        "from made.base.files import _hidden\n\n\n"
        'def shown():\n    """Say it."""\n    a = 1\n    return a\n'
    )
    counted = house.counted(tree)
    assert counted == {
        "rooms": 2, "arrows": 1, "modules": 4, "lines": 10, "public_functions": 1,
        "functions": 2, "median_body": 1.5, "longest_body": 2,
    }  # fmt: skip
