"""Steps and strides on the command line: table, files, refusals."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.cli import app


def run(*arguments: object):
    return CliRunner().invoke(app, ["strides", *map(str, arguments)])


@pytest.fixture(scope="module")
def takes(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("takes")
    walk = synth.steps(7, rng=3, fps=60.0).motion
    rl.write(walk, folder / "walk.bvh")
    rl.write(synth.wander(4.0, fps=30).motion, folder / "wander.bvh")
    names = tuple(name.replace("Left", "Port") for name in walk.skeleton.names)
    rl.write(replace(walk, skeleton=replace(walk.skeleton, names=names)), folder / "port.bvh")
    return folder


def test_table_and_files_say_the_same(takes, tmp_path):
    shown = run(takes / "walk.bvh", "-o", tmp_path)
    assert shown.exit_code == 0, shown.output
    assert "forward, over ground; moments by velocity" in shown.stdout
    record = json.loads((tmp_path / "walk_strides.json").read_text())
    rows = list(csv.DictReader((tmp_path / "walk_strides.csv").read_text().splitlines()))
    assert len(rows) == len(record["strides"])
    mean = record["summary"]["left"]["time"]["mean"]
    assert f"{mean:9.3f}" in next(x for x in shown.stdout.splitlines() if "time s" in x)
    assert (tmp_path / "walk_strides.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("name", "code", "words"),
    [
        ("wander.bvh", 3, "no gait found: "),
        ("port.bvh", 2, "expected a left and a right foot"),
    ],
)
def test_what_has_no_steps_is_refused_in_one_line(takes, tmp_path, name, code, words):
    shown = run(takes / name, "-o", tmp_path)
    assert shown.exit_code == code
    assert words in shown.stderr
    assert shown.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_rule_can_be_asked_for(takes, tmp_path):
    shown = run(takes / "walk.bvh", "-o", tmp_path, "--rule", "zeni", "--no-picture", "--json")
    assert json.loads(shown.stdout)["rule"] == "zeni"
    assert run(takes / "walk.bvh", "--rule", "guess").exit_code == 2
