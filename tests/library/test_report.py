"""The page of a library: what is on it, and that nothing of a name becomes part of it."""

from __future__ import annotations

import base64
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay.cli import app
from roundelay.compare.person import POINTS
from roundelay.library.naming import name_group
from roundelay.library.report import write_report

runner = CliRunner()


def told(page: Path) -> dict:
    text = page.read_text(encoding="utf-8")
    return json.loads(re.search(r'id="data">(.*?)</script>', text)[1])


def test_the_page_tells_what_the_library_tells(made, tmp_path):
    result = runner.invoke(app, ["report", str(made[0].folder), "-o", str(tmp_path / "page.html")])
    assert result.exit_code == 0, result.output
    page = told(tmp_path / "page.html")
    assert page["summary"] == made[0].summary
    assert [row[0] for row in page["refused"]] == ["broken.bvh"]
    assert {one["group"] for one in page["groups"]} == {
        x["group"] for x in made[0].record["groups"]
    }
    walk = next(one for one in page["groups"] if "anna/walk.bvh" in one["files"])
    assert (walk["behaviours"], walk["clips"]) == (4, 4)
    assert sum(walk["verdicts"].values()) == 4
    assert walk["lasts"] == pytest.approx(walk["period_seconds"], rel=1e-3)
    text = (tmp_path / "page.html").read_text()
    assert not re.findall(r"https?:|src=|@import", text)


def test_a_figure_is_that_of_the_behaviour(made, tmp_path):
    write_report(made[0], tmp_path / "page.html")
    page = told(tmp_path / "page.html")
    jacks = next(one for one in page["groups"] if one["files"] == ["ben/jacks.bvh"])
    numbers = np.frombuffer(base64.b64decode(jacks["figure"]), "<i2").reshape(-1, len(POINTS), 3)
    assert len(numbers) == 1 + 2 * page["harmonics"]
    means = numbers[0] * page["unit"]
    assert means[POINTS.index("head"), 1] > 0.2 > -0.3 > means[POINTS.index("left ankle"), 1]
    assert means[POINTS.index("left shoulder"), 2] > 0 > means[POINTS.index("right shoulder"), 2]


def test_a_name_is_no_part_of_the_page(made, tmp_path):
    copy = shutil.copytree(made[0].folder, tmp_path / "copy")
    library = name_group(copy, 0, "</script><b>walk")
    write_report(library, tmp_path / "page.html")
    assert "<b>walk" not in (tmp_path / "page.html").read_text()
    assert "</script><b>walk" in {one["name"] for one in told(tmp_path / "page.html")["groups"]}


def test_what_is_no_library_has_no_page(tmp_path):
    result = runner.invoke(app, ["report", str(tmp_path)])
    assert result.exit_code == 2
    assert "expected a folder made by roundelay library" in result.stderr
    assert list(tmp_path.iterdir()) == []
    assert "write_report" not in rl.__all__
