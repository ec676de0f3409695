"""What people expect of any command: several files, names, packed input, wrong rates, refusals."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.cli import app
from roundelay.formats import read


def run(*arguments: object, **more: object):
    return CliRunner().invoke(app, [str(one) for one in arguments], **more)


@pytest.fixture(scope="module")
def captures(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("captures")
    rl.write(synth.gait("walk", repetitions=3, fps=30).motion, folder / "walk.bvh")
    rl.write(synth.gait("run", repetitions=4, fps=30).motion, folder / "run.bvh")
    rl.write(synth.wander(4.0, fps=30).motion, folder / "wander.bvh")
    both = synth.sequence(
        synth.gait("walk", repetitions=4, fps=30), synth.gait("punch", repetitions=5, fps=30)
    )
    rl.write(both.motion, folder / "both.bvh")
    (folder / "notes.txt").write_text("no capture")
    (folder / "plain").write_text("no folder")
    return folder


def files(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


# Several captures.


def test_several_captures_have_a_record_each(captures, tmp_path):
    asked = ["loop", captures / "walk.bvh", captures / "run.bvh", "-o", tmp_path, "--no-picture"]
    result = run(*asked, "--json")
    assert result.exit_code == 0, result.output
    assert files(tmp_path) == ["run_loop.bvh", "run_loop.json", "walk_loop.bvh", "walk_loop.json"]
    told = json.loads(result.stdout)
    assert [one["capture"]["file"] for one in told] == ["walk.bvh", "run.bvh"]
    assert told[1] == json.loads((tmp_path / "run_loop.json").read_text())
    assert run(*asked).stdout.count("motion 1: ") == 2


@pytest.mark.parametrize(
    ("names", "code"),
    [
        (["walk.bvh", "wander.bvh"], 3),
        (["wander.bvh", "notes.txt", "walk.bvh"], 2),
        (["walk.bvh", "missing.bvh"], 2),
    ],
)
def test_the_worst_exit_code_counts_and_the_others_are_made(captures, tmp_path, names, code):
    result = run("loop", *(captures / name for name in names), "-o", tmp_path, "--no-picture")
    assert result.exit_code == code
    assert "walk_loop.bvh" in files(tmp_path)
    faults = [line for line in result.stderr.splitlines() if ": note: " not in line]
    assert len(faults) == len(names) - 1


# Where results go.


@pytest.mark.parametrize(
    ("arguments", "made"),
    [
        (["loop", "{walk}", "-o", "{to}/new/", "--no-picture"], "walk_loop.bvh walk_loop.json"),
        (["loop", "{walk}", "-o", "{to}/new/w.glb"], "w.glb w.json w.png"),
        (["loop", "{walk}", "-o", "{to}/new/W.BVH", "--no-picture"], "W.bvh W.json"),
        (["timeline", "{walk}", "-o", "{to}/new"], "walk_timeline.csv walk_timeline.json"),
        (["timeline", "{walk}", "-o", "{to}/new/t.csv"], "t.csv t.json"),
        (
            ["strides", "{walk}", "-o", "{to}/new"],
            "walk_strides.csv walk_strides.json walk_strides.png",
        ),
        (["strides", "{walk}", "-o", "{to}/new/t.csv", "--no-picture"], "t.csv t.json"),
        (["inspect", "{walk}", "-o", "{to}/new/i.json", "--no-picture"], "i.json"),
        (["excitations", "{walk}", "-o", "{to}/new/", "--no-picture"], "walk_excitations.json"),
        (["reproduce", "{walk}", "-o", "{to}/new/"], "walk_papers.json"),
        (["segment", "{walk}", "-o", "{to}/new/s.json"], "s.csv s.json s.png"),
        (["segment", "{walk}", "-o", "{to}/new/s.json", "--split"], "s.csv s.json s.png s01.bvh"),
        (["view", "{walk}", "-o", "{to}/new/"], "walk.html"),
        (["view", "{walk}", "-o", "{to}/new/page.html"], "page.html"),
        (["blend", "{walk}", "{walk}", "-o", "{to}/new/", "--format", "glb"], "walk_blend.glb"),
        (["blend", "{walk}", "{walk}", "-o", "{to}/new/b.bvh"], "b.bvh"),
        (["transition", "{walk}", "{walk}", "-o", "{to}/new"], "walk_to_walk.bvh"),
        (["convert", "{walk}", "{to}/new/c.glb"], "c.glb"),
        (["convert", "{walk}", "{to}/new/", "--format", "fbx"], "walk.fbx"),
    ],
)
def test_a_suffix_means_a_file_and_all_else_a_folder(captures, tmp_path, arguments, made):
    walk = captures / "walk.bvh"
    result = run(*(one.format(walk=walk, to=tmp_path) for one in arguments))
    assert result.exit_code == 0, result.output
    assert files(tmp_path / "new") == made.split()


@pytest.mark.parametrize(
    "arguments",
    [
        ["loop", "{walk}", "-o", "{to}/x.glb"],
        ["convert", "{walk}", "{to}/x.glb"],
        ["blend", "{walk}", "{walk}", "-o", "{to}/x.glb"],
        ["transition", "{walk}", "{walk}", "-o", "{to}/x.glb"],
    ],
)
def test_a_suffix_that_contradicts_the_format_is_refused(captures, tmp_path, arguments):
    asked = [one.format(walk=captures / "walk.bvh", to=tmp_path) for one in arguments]
    result = run(*asked, "--format", "bvh")
    assert result.exit_code == 2
    assert result.stderr == (
        "roundelay: expected a file of the suffix of --format bvh, found 'x.glb'; "
        "leave one of them out\n"
    )
    assert files(tmp_path) == []


@pytest.mark.parametrize("how", [["-o", "{to}/x.glb"], ["-o", "{to}", "--format", "glb"]])
def test_a_format_that_the_target_does_not_read_is_refused(captures, tmp_path, how):
    how = [one.format(to=tmp_path) for one in how]
    result = run("loop", captures / "walk.bvh", "--for", "unity", *how)
    assert result.exit_code == 2
    assert result.stderr == ("roundelay: expected a format that unity reads (fbx), found 'glb'\n")
    assert files(tmp_path) == []


def test_a_suffix_chooses_among_the_formats_of_the_target(captures, tmp_path):
    asked = ["loop", captures / "walk.bvh", "--for", "blender", "-o", tmp_path / "x.glb"]
    result = run(*asked, "--no-picture", "--json")
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["sampling"]["file_format"] == "glb"
    assert files(tmp_path) == ["x.glb", "x.json"]


def test_further_loops_are_numbered_behind_the_name(captures, tmp_path):
    result = run("loop", captures / "both.bvh", "-o", tmp_path / "x.bvh", "--no-picture")
    assert result.exit_code == 0, result.output
    assert files(tmp_path) == ["x.bvh", "x.json", "x2.bvh"]


def test_a_folder_whose_name_has_a_suffix_is_a_folder(captures, tmp_path):
    (tmp_path / "takes.bvh").mkdir()
    for name in ("takes.bvh", "v1.2", "old.takes/"):
        asked = f"{tmp_path / name}{'/' if name.endswith('/') else ''}"
        assert run("loop", captures / "walk.bvh", "-o", asked, "--no-picture").exit_code == 0
        assert files(tmp_path / name) == ["walk_loop.bvh", "walk_loop.json"]


# What is written.


def test_what_is_written_is_mirrored_and_resized(captures, tmp_path):
    walk = captures / "walk.bvh"
    for asked in (["convert", walk], ["transition", walk, walk, "-o"], ["blend", walk, walk, "-o"]):
        one, two = tmp_path / "one.bvh", tmp_path / "two.bvh"
        # A mirrored loop begins on its left foot, too.
        other = ["--start", "right"] if asked[0] == "blend" else []
        assert run(*asked, one, *other).exit_code == 0
        assert run(*asked, two, "--mirror", "--resize", "2").exit_code == 0
        wanted = read(one).mirror().scaled(2.0).positions()
        assert np.abs(read(two).positions() - wanted).max() < 0.02 * np.abs(wanted).max()


# How captures are read.


@pytest.mark.filterwarnings("default::roundelay.RoundelayWarning")
def test_a_wrong_frame_rate_is_told_and_mended(captures, tmp_path):
    slow = tmp_path / "slow.bvh"
    motion = synth.gait("walk", repetitions=3, fps=120).motion
    rl.write(rl.Motion(**vars(motion) | {"frame_time": 1 / 24}), slow)
    asked = ["loop", slow, "-o", tmp_path, "--no-picture"]
    result = run(*asked)
    assert result.exit_code == 0, result.output
    assert "takes too long" in result.stderr
    assert "--capture-fps" in result.stderr
    result = run(*asked, "--capture-fps", "120")
    assert result.stderr == ""
    assert "period 1.10 s" in result.stdout
    assert read(slow, fps=120).fps == pytest.approx(120)


@pytest.mark.parametrize("command", ["loop", "timeline", "inspect", "segment", "view"])
def test_the_rate_of_a_capture_is_taken_by_all(captures, tmp_path, command):
    asked = [command, captures / "walk.bvh", "-o", f"{tmp_path}/", "--capture-fps", "40"]
    result = run(*asked)
    assert result.exit_code == 0, result.output
    records = [json.loads(path.read_text()) for path in tmp_path.glob("*.json")]
    for record in records:
        told = record.get("capture", record)
        assert told.get("fps", 1 / told.get("frame_time", 1 / 40)) == pytest.approx(40)


@pytest.mark.filterwarnings("default::roundelay.RoundelayWarning")
def test_an_assumed_rate_is_told_unless_one_is_given(captures, tmp_path):
    amc = tmp_path / "walk.amc"
    rl.write(rl.Motion(**vars(read(captures / "walk.bvh")) | {"frame_time": 1 / 120}), amc)
    asked = ["convert", amc, tmp_path / "walk.bvh"]
    note = "tells no frame rate, 120 a second assumed; give another by --capture-fps"
    assert run(*asked).stderr.count(note) == 1
    result = run(*asked, "--capture-fps", "30")
    assert result.stderr == ""
    assert read(tmp_path / "walk.bvh").fps == pytest.approx(30)


def test_packed_captures_are_read(captures, tmp_path):
    packed = tmp_path / "walk.BVH.gz"
    packed.write_bytes(gzip.compress((captures / "walk.bvh").read_bytes()))
    result = run("loop", packed, "-o", tmp_path, "--no-picture")
    assert result.exit_code == 0, result.output
    assert files(tmp_path) == ["walk.BVH.gz", "walk_loop.bvh", "walk_loop.json"]
    run("loop", captures / "walk.bvh", "-o", tmp_path / "plain", "--no-picture")
    same = [folder / "walk_loop.bvh" for folder in (tmp_path, tmp_path / "plain")]
    assert same[0].read_bytes() == same[1].read_bytes()
    packed.write_bytes(packed.read_bytes()[:-100])
    result = run("loop", packed, "-o", tmp_path)
    assert result.exit_code == 2
    assert f"{packed}: expected a whole gzip file" in result.stderr
    with pytest.raises(ValueError, match="file of type"):
        rl.write(read(captures / "walk.bvh"), tmp_path / "loop.bvh.gz")


def test_standard_input_is_read(captures, tmp_path):
    data = (captures / "walk.bvh").read_bytes()
    asked = ["loop", "-", "-o", tmp_path, "--no-picture"]
    result = run(*asked, "--as", "BVH", input=data)
    assert result.exit_code == 0, result.output
    assert files(tmp_path) == ["stdin_loop.bvh", "stdin_loop.json"]
    result = run(*asked, input=data)
    assert result.exit_code == 2
    assert "name its format by --as" in result.stderr


# Loops of an earlier run.


def test_loops_that_are_none_any_more_are_removed_by_name(captures, tmp_path):
    asked = ["loop", captures / "both.bvh", "-o", tmp_path, "--no-picture"]
    assert run(*asked, "--gif").exit_code == 0
    (tmp_path / "both_loop3.bvh").write_text("of somebody else")
    assert {"both_loop2.bvh", "both_loop2.gif"} < set(files(tmp_path))
    assert run(*asked, "--most", 1).exit_code == 0
    assert files(tmp_path) == ["both_loop.bvh", "both_loop.json", "both_loop3.bvh"]
    assert run(*asked, "--frames", "0:12").exit_code == 3
    assert files(tmp_path) == ["both_loop.json", "both_loop3.bvh"]


def test_pictures_and_other_formats_of_an_earlier_run_are_removed_by_name(captures, tmp_path):
    asked = ["loop", captures / "walk.bvh", "-o", tmp_path]
    assert run(*asked, "--format", "amc").exit_code == 0
    (tmp_path / "walk_loop.glb").write_text("of somebody else")
    made = ["walk_loop.amc", "walk_loop.asf", "walk_loop.glb", "walk_loop.json", "walk_loop.png"]
    assert files(tmp_path) == made
    assert run(*asked, "--no-picture").exit_code == 0
    assert files(tmp_path) == ["walk_loop.bvh", "walk_loop.glb", "walk_loop.json"]


def test_only_files_that_the_record_names_are_removed(captures, tmp_path):
    record, other = tmp_path / "walk_loop.json", tmp_path / "other.bvh"
    other.write_text("of somebody else")
    for text in (
        '{"cycles": [{"files": ["other.bvh", "../other.bvh"]}]}',
        "no record",
        "[]",
        "[0]",
    ):
        record.write_text(text)
        asked = ["loop", captures / "walk.bvh", "-o", tmp_path, "--no-picture"]
        assert run(*asked).exit_code == 0
        assert other.exists()


# Refusals: one line, exit code 2, what to try.


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["loop", "{c}/walk.bvh", "-o", "{c}/plain"], "{c}/plain: expected a folder, found a file"),
        (["loop", "{c}/walk.bvh", "-o", "{c}/plain/in"], "{c}/plain: expected a folder, found a f"),
        (["loop", "{c}/walk.bvh", "-o", "{c}/plain/x.bvh"], "{c}/plain: expected a folder, found"),
        (["loop", "{c}/walk.bvh", "-o", "x.abc"], "found 'x.abc'; end the name of a folder with /"),
        (["loop", "{c}/walk.bvh", "-o", "{c}/walk.bvh"], "another file than the capture itself"),
        (["timeline", "{c}/walk.bvh", "-o", "x.bvh"], "a file of type .json, .csv, found 'x.bvh'"),
        (
            ["loop", "{c}/walk.bvh", "{c}/run.bvh", "-o", "x.bvh"],
            "expected a folder for 2 captures",
        ),
        (["loop", "{c}/walk.bvh", "{c}/walk.bvh"], "different names, found 'walk' twice"),
        (["loop", "{c}/walk.bvh", "-o", "x.bvh", "--format", "glb"], "leave one of them out"),
        (["loop", "{c}/walk.bvh", "--fps", "0"], "expected fps as a number, more than 0"),
        (["loop", "{c}/walk.bvh", "--fps", "20000"], "at most 10000"),
        (["loop", "{c}/walk.bvh", "--capture-fps", "0"], "expected capture-fps as a number, more"),
        (["loop", "{c}/walk.bvh", "--capture-fps", "20000"], "at most 10000"),
        (["loop", "{c}/walk.bvh", "--frames", "3:9"], "at least 8 frames, found 6"),
        (["timeline", "{c}/walk.bvh", "--frames", "3:9"], "at least 8 frames, found 6"),
        (["inspect", "{c}/walk.bvh", "--frames", "3:9"], "at least 8 frames, found 6"),
        (["view", "{c}/walk.bvh", "--frames", "3:9"], "at least 8 frames, found 6"),
        (["excitations", "{c}/walk.bvh", "--frames", "3:9"], "at least 8 frames, found 6"),
        (["loop", "{c}/notes.txt"], "file of type"),
        (["loop", "-", "--as", "abc"], "file of type"),
    ],
)
def test_bad_input_is_one_line(captures, tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    result = run(*(one.format(c=captures) for one in arguments))
    assert result.exit_code == 2, result.output
    assert message.format(c=captures) in result.stderr
    assert result.stderr.startswith("roundelay: ")
    assert result.stderr.count("\n") == 1
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_a_rate_that_no_camera_has_is_one_line(captures, tmp_path):
    fast = tmp_path / "fast.bvh"
    text = (captures / "walk.bvh").read_text()
    head, _, rest = text.partition("Frame Time:")
    fast.write_text(f"{head}Frame Time: 0.00005{rest[rest.index(chr(10)) :]}")
    result = run("loop", fast, "-o", tmp_path)
    assert result.exit_code == 2
    assert result.stderr == (
        f"roundelay: {fast}: expected from 0.0001 to 10000 frames a second, found 20000; "
        "give the true rate (--capture-fps)\n"
    )
