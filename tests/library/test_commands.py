"""``roundelay library`` and ``roundelay search``, as people and programs use them."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay.cli import app
from roundelay.formats import in_words, readers

runner = CliRunner()


def run(*arguments):
    return runner.invoke(app, [*map(str, arguments)])


def test_a_library_of_a_folder(clips, tmp_path):
    (clips / "broken.bvh").write_text("no capture")
    folder = tmp_path / "library"
    result = run("library", clips, "-o", folder, "--jobs", 1, "--fps", 30)
    assert result.exit_code == 0, result.output
    assert "clips: 3, loops: 2, groups: 2, refused: 1" in result.stdout
    assert result.stderr == "roundelay: broken.bvh:1:1: expected HIERARCHY, found 'no'\n"
    names = {path.name for path in folder.iterdir()}
    tables = {"cycles.csv", "library.duckdb", "tables"}
    assert names == tables | {"clips.jsonl", "library.json", "loops", "signatures"}
    again = run("library", clips, "-o", folder, "--jobs", 1, "--fps", 30, "--json")
    assert json.loads(again.stdout)["summary"]["loops"] == 2


def test_its_loops_are_those_of_loop(captures, tmp_path):
    capture, options = captures / "01_03.bvh", ["--fps", 30, "--in-place"]
    run("library", capture, "-o", tmp_path / "library", "--jobs", 1, *options)
    run("loop", capture, "-o", tmp_path, "--no-picture", *options)
    made = tmp_path / "library" / "loops" / "01_03.bvh" / "01_03_loop.bvh"
    assert made.read_bytes() == (tmp_path / "01_03_loop.bvh").read_bytes()


def test_an_interrupted_run_keeps_what_is_done(clips, tmp_path, monkeypatch):
    done = []

    def interrupted(motion, render, timeline):
        if done:
            raise KeyboardInterrupt
        done.append(motion)
        return rl.make_loops(motion, render=render, timeline=timeline)

    with monkeypatch.context() as patch:
        patch.setattr("roundelay.library.clips.make_loops", interrupted)
        result = run("library", clips, "-o", tmp_path, "--jobs", 1)
    assert result.exit_code == 130
    assert result.stderr == "roundelay: interrupted; run it again to go on\n"
    counts = rl.Library.open(tmp_path).summary
    assert (counts["loops"], counts["waiting"]) == (1, 1)
    assert run("library", clips, "-o", tmp_path, "--jobs", 1).exit_code == 0


def test_what_cannot_make_a_library(shared, tmp_path):
    empty = tmp_path / "empty"
    empty.mkdir()
    result = run("library", empty, "-o", tmp_path / "library")
    assert result.exit_code == 2
    told = f"expected {in_words(readers)} files, found none"
    assert result.stderr == f"roundelay: {empty}: {told}\n"
    still = run("library", shared / "still.bvh", "-o", tmp_path / "still", "--jobs", 1)
    assert still.exit_code == 3
    broken = run("library", shared / "broken.bvh", "-o", tmp_path / "broken", "--jobs", 1)
    assert broken.exit_code == 2
    assert run("library", shared, "-o", tmp_path, "--fps", 0).exit_code == 2


def test_search_lists_the_nearest_first(shared, made):
    result = run("search", shared / "anna" / "walk.bvh", made[0].folder, "--count", 2)
    assert result.exit_code == 0, result.output
    first, heading, nearest, _ = result.stdout.splitlines()
    assert first == "walk.bvh: period 1.10 s"
    assert heading.split()[:3] == ["distance", "group", "period"]
    assert nearest.split()[0] == "0.000"
    assert "anna/walk.bvh" in nearest


def test_search_for_programs(shared, made):
    result = run("search", shared / "ben" / "walk.amc", made[0].folder, "--json", "--count", 3)
    found = json.loads(result.stdout)
    assert found["left_out"] == 0
    assert len(found["matches"]) == 3
    assert {match["group"] for match in found["matches"]} == {found["matches"][0]["group"]}
    assert found["matches"][0]["distance"] < 1e-3


@pytest.mark.parametrize(
    ("name", "code", "message"),
    [("still.bvh", 3, "no periodic motion found"), ("broken.bvh", 2, "expected OFFSET")],
)
def test_queries_without_a_cycle(shared, made, name, code, message):
    result = run("search", shared / name, made[0].folder)
    assert result.exit_code == code
    assert message in result.stderr
    assert result.stderr.count("\n") == 1


def test_search_where_nothing_can_be_compared(shared, made, tmp_path):
    walk = shared / "anna" / "walk.bvh"
    result = run("search", walk, tmp_path)
    assert result.exit_code == 2
    assert "expected a folder made by roundelay library" in result.stderr
    motion = rl.read(walk)
    names = tuple(f"bone{number}" for number in range(motion.skeleton.n_joints))
    stranger = replace(motion, skeleton=replace(motion.skeleton, names=names))
    rl.write(stranger, tmp_path / "stranger.bvh")
    result = run("search", tmp_path / "stranger.bvh", made[0].folder)
    assert result.exit_code == 2
    assert "none of the library's 7 behaviours has the joints of the query" in result.stderr
