"""The command ``roundelay view``."""

from __future__ import annotations

import pytest
from typer.testing import CliRunner

from roundelay import synth
from roundelay.cli import app
from roundelay.formats import write

run = CliRunner().invoke


@pytest.fixture
def walk(tmp_path):
    path = tmp_path / "walk.bvh"
    write(synth.gait("walk", repetitions=3.0).motion, path)
    return path


def test_a_page_is_written(walk, tmp_path):
    target = tmp_path / "new" / "page.html"
    result = run(app, ["view", str(walk), "-o", str(target)])
    assert result.exit_code == 0, result.output
    assert "1 periodic motion" in result.output
    assert target.read_text(encoding="utf-8").startswith("<!doctype html>")


def test_the_page_is_named_after_the_capture(walk, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(app, ["view", str(walk)]).exit_code == 0
    assert (tmp_path / "walk.html").exists()


def test_no_period_still_makes_a_page(walk, tmp_path):
    target = tmp_path / "page.html"
    result = run(app, ["view", str(walk), "-o", str(target), "--frames", "0:100"])
    assert result.exit_code == 0
    assert "no periodic motion" in result.output
    assert target.exists()


def test_bad_input_leaves_nothing(tmp_path):
    bad = tmp_path / "bad.bvh"
    bad.write_text("rubbish")
    result = run(app, ["view", str(bad), "-o", str(tmp_path / "page.html")])
    assert result.exit_code == 2
    assert not (tmp_path / "page.html").exists()


def test_a_page_goes_into_a_folder(walk, tmp_path):
    assert run(app, ["view", str(walk), "-o", str(tmp_path)]).exit_code == 0
    assert (tmp_path / "walk.html").exists()
