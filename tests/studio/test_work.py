"""The work file: what it holds, what it refuses, and its loops without a browser."""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay.cli import app
from roundelay.studio.making import loops_of
from roundelay.studio.words import as_command, as_python

run = CliRunner().invoke


def test_a_work_comes_back(walk_file, work_of, tmp_path):
    part = rl.Part(
        "stride", ((0, 100), (120, 200)), period=1.1, limbs="legs", class_index=1, start="right"
    )
    work = work_of(walk_file, part, rl.Part("found", ((0, 50),), 1), fps=30, in_place=True)
    work.write(tmp_path / "walk.work.json")
    assert rl.read_work(tmp_path / "walk.work.json") == work


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda data: data.pop("roundelay work"), "expected a work of the studio"),
        (lambda data: data.update({"roundelay work": 9}), "expected version 1"),
        (lambda data: data.pop("parts"), "expected 'parts' as list, found None"),
        (lambda data: data["parts"][0].update(spans=[[5, 3]]), "part 1: expected spans in order"),
        (lambda data: data["parts"][0].update(spans=[]), "part 1: expected spans as a range"),
        (lambda data: data["parts"][0].update(spans=[["a", 3]]), "part 1: expected spans as"),
        (lambda data: data["parts"][0].update(spans=[[0, 10**9]]), "expected parts within"),
        (lambda data: data["parts"][0].update(speed=3), "part 1: expected no 'speed'"),
        (lambda data: data["parts"][0].update(period=-1), "part 1: expected period as a number"),
        (lambda data: data["parts"][0].update(start="nowhere"), "part 1: expected"),
        (lambda data: data.update(render={"fps": "fast"}), "render: expected fps"),
        (lambda data: data["capture"].update(file="../../etc/passwd"), "beside the work"),
        (lambda data: data["capture"].update(frames=True), "expected 'frames' as int"),
    ],
)
def test_what_is_no_work_is_refused_in_one_line(walk_file, work_of, tmp_path, change, told):
    data = work_of(walk_file, rl.Part("stride", ((0, 100),))).to_dict()
    change(data)
    path = tmp_path / "walk.work.json"
    path.write_text(json.dumps(data))
    with pytest.raises(rl.FormatError) as refused:
        rl.read_work(path)
    assert told in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("text", ["", "rubbish", "[" * 100_000, "[1, 2]", '"work"'])
def test_rubbish_is_refused(tmp_path, text):
    path = tmp_path / "walk.work.json"
    path.write_text(text)
    with pytest.raises(rl.FormatError, match="expected"):
        rl.read_work(path)


def test_another_take_of_the_name_is_refused(walk_file, work_of, walk):
    work = work_of(walk_file, rl.Part("stride", ((0, 100),)))
    rl.write(walk[:150], walk_file)
    with pytest.raises(rl.FormatError, match="expected the take that the work was made of"):
        work.loops()


def test_what_was_found_is_looped_as_by_itself(walk_file, work_of):
    usual = rl.make_loops(rl.read(walk_file))[0]
    part = rl.Part("stride", tuple(usual.cycle.evidence.runs), 1)
    (made,) = work_of(walk_file, part).loops()
    assert np.array_equal(made.motion.rotations, usual.motion.rotations)


def test_frames_limbs_and_period_of_a_person_decide(walk_file, work_of):
    whole, half, legs = work_of(
        walk_file,
        rl.Part("all", ((0, 250),)),
        rl.Part("half", ((0, 140),)),
        rl.Part("legs", ((0, 250),), limbs="legs"),
    ).loops()
    assert whole.cycle.period == pytest.approx(1.1, rel=0.03)
    assert half.cycle.evidence.runs[-1][1] <= 140
    assert set(legs.cycle.evidence.partial) == {"left leg", "right leg"}
    (twice,) = work_of(walk_file, rl.Part("twice", ((0, 250),), period=2.2)).loops()
    assert twice.cycle.period == pytest.approx(2 * whole.cycle.period, rel=0.05)


def test_several_ranges_are_one_behaviour(walk_file, work_of):
    (made,) = work_of(walk_file, rl.Part("stride", ((0, 120), (130, 250)))).loops()
    assert len(made.cycle.evidence.runs) == 2
    assert made.cycle.period == pytest.approx(1.1, rel=0.03)


def test_a_part_that_shows_nothing_is_named(walk_file, work_of):
    with pytest.raises(rl.NoPeriod, match=r"^nothing: no periodic motion found"):
        work_of(walk_file, rl.Part("nothing", ((0, 20),))).loops()
    with pytest.raises(ValueError, match="expected limbs as one of body, legs"):
        work_of(walk_file, rl.Part("wings", ((0, 200),), limbs="wings")).loops()


def test_the_command_makes_the_same_loops(walk_file, work_of, tmp_path):
    part = rl.Part("stride", ((10, 200),), start="right")
    work = work_of(walk_file, part, target="godot")
    work.write(tmp_path / "walk.work.json")
    out = tmp_path / "out"
    words = ["loop", "--work", str(tmp_path / "walk.work.json"), "-o", str(out), "--no-picture"]
    result = run(app, words)
    assert result.exit_code == 0, result.output
    work.loops()[0].write(tmp_path / "other.glb")
    assert (out / "walk_loop.glb").read_bytes() == (tmp_path / "other.glb").read_bytes()
    record = json.loads((out / "walk_loop.json").read_text())
    assert record["options"] == json.loads(json.dumps(work.to_dict()))


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "expected a CAPTURE, or --work, found neither"),
        (["--work", "WORK", "--fps", "30"], "expected --work alone"),
        (["--work", "WORK", "x.bvh"], "expected --work alone"),
        (["--work", "missing.work.json"], "missing.work.json: No such file"),
    ],
)
def test_what_does_not_go_with_work(walk_file, work_of, tmp_path, words, told):
    work_of(walk_file, rl.Part("stride", ((10, 200),))).write(tmp_path / "walk.work.json")
    words = [str(tmp_path / "walk.work.json") if one == "WORK" else one for one in words]
    result = run(app, ["loop", *words])
    assert result.exit_code == 2
    assert told in result.output
    assert result.output.count("\n") == 1


def test_words_of_what_was_found_need_no_work_file(walk_file, work_of):
    found = rl.Part("renamed", ((0, 250),), 1)
    work = work_of(walk_file, found, target="unity", in_place=True)
    assert as_command(work, 1) == "roundelay loop walk.bvh --for unity --in-place -o loops"
    assert as_command(work, 2) == "roundelay loop --work walk.work.json -o loops"
    assert "rl.make_loops(rl.read('walk.bvh'), render=rl.LoopOptions(" in as_python(work, 1)
    touched = work_of(walk_file, rl.Part("cut", ((0, 200),)))
    assert "rl.read_work('walk.work.json').loops()" in as_python(touched, 1)


@pytest.mark.parametrize("touched", [False, True])
def test_the_python_runs(walk_file, work_of, tmp_path, monkeypatch, touched):
    monkeypatch.chdir(tmp_path)
    part = rl.Part("stride", ((0, 200),)) if touched else rl.Part("stride", ((0, 252),), 1)
    work = work_of(walk_file, part, target="web")
    work.write("walk.work.json")
    exec(compile(as_python(work, 1), "copied", "exec"), {})
    assert len(rl.read(tmp_path / "walk_loop.glb")) == len(work.loops()[0].motion)


def test_all_loops_need_the_same_take(walk_file, work_of, walk):
    with pytest.raises(ValueError, match="expected a take of"):
        loops_of(work_of(walk_file, rl.Part("stride", ((0, 100),))), walk[:150])
