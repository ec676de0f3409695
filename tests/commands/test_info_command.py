"""``roundelay info``, as people and programs use it."""

from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.cli import app

runner = CliRunner()


@pytest.fixture(scope="module")
def walk():
    return synth.gait("walk", repetitions=2, fps=30).motion


@pytest.mark.parametrize("suffix", ["fbx", "glb", "bvh"])
def test_what_a_file_holds(walk, tmp_path, suffix):
    path = tmp_path / f"walk.{suffix}"
    rl.write(walk, path)
    shown = runner.invoke(app, ["info", str(path)])
    assert shown.exit_code == 0, shown.stderr
    assert f"walk: {len(walk)} frames at 30 fps" in shown.stdout
    told = json.loads(runner.invoke(app, ["info", str(path), "--json"]).stdout)
    assert (told["frames"], told["joints"], told["up"]) == (len(walk), 19, "Y")
    several = suffix != "bvh"
    assert told["characters"] == ["Hips"]
    assert len(told["animations"]) == int(several)
    assert told["conventions"].get("up") == ("Y" if several else None)


def test_a_choice_that_a_format_does_not_have(walk, tmp_path):
    rl.write(walk, tmp_path / "walk.amc")
    shown = runner.invoke(app, ["info", str(tmp_path / "walk.amc"), "--animation", "run"])
    assert shown.exit_code == 2
    assert "expected no --animation: walk.amc is of a format without such a choice" in shown.stderr
