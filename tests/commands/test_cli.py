"""The command line, as people and programs use it."""

from __future__ import annotations

import json
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.cli import app

runner = CliRunner()


@pytest.fixture(scope="module")
def walk(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("captures") / "walk.bvh"
    rl.write(synth.gait("walk", repetitions=2.6).motion, path)
    return path


@pytest.fixture(scope="module")
def looped(walk, tmp_path_factory):
    folder = tmp_path_factory.mktemp("loops")
    result = runner.invoke(app, ["loop", str(walk), "-o", str(folder)])
    return folder, result


def test_loop_writes_the_loop_its_record_and_a_picture(looped):
    folder, result = looped
    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in folder.iterdir()) == [
        "walk_loop.bvh",
        "walk_loop.json",
        "walk_loop.png",
    ]
    assert "\n  motion 1: good\n    period 1.10 s" in result.stdout
    assert " sure; 1.19 m/s (1.19 units/s)\n" in result.stdout
    assert len(rl.read(folder / "walk_loop.bvh")) == 132


def test_the_record_holds_results_and_options(looped):
    record = json.loads((looped[0] / "walk_loop.json").read_text())
    (cycle,) = record["cycles"]
    assert record["roundelay"] == rl.__version__
    assert record["options"]["frames"] is None
    assert record["capture"]["file"] == "walk.bvh"
    assert cycle["period_seconds"] == pytest.approx(1.1, rel=0.01)
    assert cycle["parts"] == [[0, 343]]
    assert cycle["barcode"][0][1] > cycle["barcode"][0][0]
    assert set(cycle["quality"]) >= {"seam_rotation", "template_error", "loop_jerk"}
    verdict = cycle["verdict"]
    assert (verdict["word"], verdict["reasons"], verdict["travels"]) == ("good", [], True)
    assert verdict["metres_a_unit"] == 1.0
    assert verdict["speed"] == pytest.approx(0.75 * 1.75 / 1.1, rel=0.01)


def clip_seconds(path: Path) -> float:
    """Time of the last key in a GLB file, where players go back to the first."""
    raw = path.read_bytes()
    document = json.loads(raw[20 : 20 + struct.unpack_from("<I", raw, 12)[0]])
    samplers = document["animations"][0]["samplers"]
    return max(document["accessors"][sampler["input"]]["max"][0] for sampler in samplers)


def test_a_loop_for_engines(walk, tmp_path):
    arguments = ["loop", str(walk), "-o", str(tmp_path), "--format", "glb", "--no-picture"]
    result = runner.invoke(app, [*arguments, "--fps", "30"])
    assert result.exit_code == 0, result.output
    assert (tmp_path / "walk_loop.glb").read_bytes()[:4] == b"glTF"
    (cycle,) = json.loads((tmp_path / "walk_loop.json").read_text())["cycles"]
    assert (cycle["playback"]["frames"], cycle["playback"]["first_repeated"]) == (33, True)
    assert cycle["loop_frames"] == 34
    assert clip_seconds(tmp_path / "walk_loop.glb") == pytest.approx(33 / 30, abs=1e-6)
    assert set(cycle["playback"]["contacts"]) == {"LeftFoot", "RightFoot"}


def test_a_loop_in_fbx_lasts_a_whole_period(walk, tmp_path):
    arguments = ["loop", str(walk), "-o", str(tmp_path), "--format", "fbx", "--no-picture"]
    result = runner.invoke(app, [*arguments, "--fps", "30"])
    assert result.exit_code == 0, result.output
    (cycle,) = json.loads((tmp_path / "walk_loop.json").read_text())["cycles"]
    assert (cycle["playback"]["frames"], cycle["loop_frames"]) == (33, 34)
    raw = (tmp_path / "walk_loop.fbx").read_bytes()
    at = raw.index(b"LocalStop") + len(b"LocalStopS\5\0\0\0KTimeS\4\0\0\0TimeS\0\0\0\0L")
    assert struct.unpack_from("<q", raw, at)[0] / 46_186_158_000 == pytest.approx(33 / 30)


def test_a_capture_becomes_fbx(walk, tmp_path):
    result = runner.invoke(app, ["convert", str(walk), str(tmp_path / "walk.FBX")])
    assert result.exit_code == 0, result.output
    assert (tmp_path / "walk.FBX").read_bytes()[:18] == b"Kaydara FBX Binary"


def test_a_blend_for_engines_lasts_a_whole_period(walk, tmp_path):
    path = tmp_path / "mixed.GLB"
    result = runner.invoke(app, ["blend", str(walk), str(walk), "--fps", "30", "-o", str(path)])
    assert result.exit_code == 0, result.output
    assert clip_seconds(path) == pytest.approx(33 / 30, abs=1e-6)


def test_json_is_all_that_is_printed(walk, tmp_path):
    result = runner.invoke(app, ["loop", str(walk), "-o", str(tmp_path), "--json", "--no-picture"])
    (cycle,) = json.loads(result.stdout)["cycles"]
    assert cycle["files"] == ["walk_loop.bvh"]
    # Programs read these by name.
    assert cycle["period_seconds"] == pytest.approx(1.1, rel=0.01)
    assert (cycle["repetitions"] > 2.0, 0.5 < cycle["confidence"] <= 1.0) == (True, True)
    assert cycle["parts"] == [[0, 343]]


def test_sampling_options(walk, tmp_path):
    arguments = ["--fps", "30", "--periods", "2", "--repeat-first", "--in-place", "--no-picture"]
    result = runner.invoke(app, ["loop", str(walk), "-o", str(tmp_path), *arguments])
    loop = rl.read(tmp_path / "walk_loop.bvh")
    assert result.exit_code == 0
    assert len(loop) == 2 * 33 + 1
    assert np.allclose(loop.root_path[0], loop.root_path[-1], atol=1e-4)
    assert np.allclose(loop.rotations[0], loop.rotations[-1], atol=1e-4)


def test_a_capture_without_period_ends_with_3_and_says_why(tmp_path):
    path = tmp_path / "wander.bvh"
    rl.write(synth.wander(5.0).motion, path)
    result = runner.invoke(app, ["loop", str(path), "-o", str(tmp_path)])
    assert result.exit_code == 3
    assert result.stderr.startswith(f"roundelay: {path}: no periodic motion found")
    assert result.stderr.count("\n") == 1
    record = json.loads((tmp_path / "wander_loop.json").read_text())
    assert record["cycles"] == []
    assert "no periodic motion" in record["reason"]
    assert not (tmp_path / "wander_loop.bvh").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["loop", "nothing.bvh"], "No such file"),
        (["loop", "{walk}", "--frames", "5"], "START:STOP, found '5'"),
        (["loop", "{walk}", "--frames", "a:b"], "START:STOP, found 'a:b'"),
        (["loop", "{walk}", "--frames", "1:2:3"], "START:STOP, found '1:2:3'"),
        (["loop", "{walk}", "--most", ""], "expected most as a whole number, at least 1, found ''"),
        (["loop", "{walk}", "--frames", "0:9999"], "frames within"),
        (["loop", "{walk}", "--joints", "Tail"], "no joint 'Tail'"),
        (["loop", "{walk}", "--prime", "48"], "prime"),
        (
            ["loop", "{walk}", "--fps", "-1"],
            "expected fps as a number, more than 0 and at most 10000",
        ),
        (
            ["loop", "{walk}", "--format", "obj"],
            "expected a format among",
        ),
        (["loop", "{walk}", "--fps", "1e9"], "in frames a second, found 1000000000.0"),
        (["loop", "{walk}", "--delay", "-1"], "expected delay as a number, at least 0, in seconds"),
        (["loop", "{walk}", "--dimensions", "0"], "expected dimensions as a whole number"),
        (["loop", "{walk}", "--dimensions", "2.5"], "number of dimensions"),
        (["loop", "{walk}", "--frames", "3:9"], "{walk}: a period needs at least 8 frames"),
        (["loop", "{walk}", "-o", "{walk}"], "{walk}: expected another file than the capture"),
        (["loop", "{walk}", "--periods", "0"], "'--periods'"),
        (["loop", "{walk}", "--fps", "fast"], "'--fps'"),
        (["loop", "{walk}", "--zzz"], "--zzz; see "),
        (["loop"], "expected a CAPTURE, or --work, found neither"),
        (["polka"], "no such command 'polka'"),
        (["loop", "{readme}"], "file of type"),
        (["loop", "{out}"], "file of type"),
        (["search", "{walk}", "{out}"], "no library.json in it"),
        (["blend", "{walk}", "{walk}", "-o", "{out}/b.bvh", "--shares", "1"], "2 in all, found 1"),
        (["convert", "{walk}", "{out}/walk.obj"], "file of type"),
        (["convert", "{walk}", "{out}/walk.bvh", "--resize", "0"], "expected resize as a number"),
        (["convert", "{walk}", "{out}/walk.bvh", "--frames", "9:3"], "frames within"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(walk, tmp_path, arguments, message):
    readme = tmp_path / "notes.txt"
    readme.write_text("no capture")
    filled = [a.format(walk=walk, readme=readme, out=tmp_path) for a in arguments]
    result = runner.invoke(app, filled)
    assert result.exit_code == 2, result.output
    assert message.format(walk=walk, out=tmp_path) in result.stderr
    assert result.stderr.startswith("roundelay: ")
    assert result.stderr.count("\n") == 1


def test_a_truncated_file_is_refused_with_its_place(walk, tmp_path):
    path = tmp_path / "cut.bvh"
    path.write_text(walk.read_text()[:-2000])
    result = runner.invoke(app, ["loop", str(path), "-o", str(tmp_path)])
    assert result.exit_code == 2
    assert f"{path}:" in result.stderr
    assert list(tmp_path.glob("*.json")) == []


def test_convert_there_and_back(walk, tmp_path):
    there, back = tmp_path / "walk.amc", tmp_path / "back.bvh"
    assert runner.invoke(app, ["convert", str(walk), str(there)]).exit_code == 0
    assert (tmp_path / "walk.asf").exists()
    assert runner.invoke(app, ["convert", str(there), str(back)]).exit_code == 0
    made, read = rl.read(walk), rl.read(back)
    joints = [read.skeleton.names.index(name) for name in ("LeftFoot", "RightHand")]
    wanted = [made.skeleton.names.index(name) for name in ("LeftFoot", "RightHand")]
    apart = read.positions()[:, joints] - made.positions()[:, wanted]
    assert np.abs(apart - apart[0, 0]).max() < 1e-3


def test_convert_resamples_crops_and_scales(walk, tmp_path):
    target = tmp_path / "small.bvh"
    arguments = ["--fps", "30", "--frames", "10:250", "--resize", "0.01"]
    result = runner.invoke(app, ["convert", str(walk), str(target), *arguments])
    assert result.exit_code == 0, result.output
    small = rl.read(target)
    assert len(small) == 60
    assert small.fps == pytest.approx(30.0)
    assert small.skeleton.size == pytest.approx(rl.read(walk).skeleton.size * 0.01, rel=1e-4)


def test_help_does_not_load_what_draws():
    code = (
        "import sys; from roundelay.cli import app; "
        "print([m for m in ('matplotlib', 'scipy', 'sklearn') if m in sys.modules])"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "[]"


def test_inspect_lists_the_classes_and_a_class_carries_into_loop(walk, tmp_path):
    result = runner.invoke(app, ["inspect", str(walk), "-o", str(tmp_path), "--classes", "2"])
    assert result.exit_code == 0, result.output
    assert "<- loop" in result.stdout
    assert (tmp_path / "walk_inspect.png").stat().st_size > 10_000
    record = json.loads((tmp_path / "walk_inspect.json").read_text())
    first = record["motions"][0]["classes"][0]
    middle = 0.5 * (first["birth"] + first["death"])
    again = runner.invoke(
        app,
        ["loop", str(walk), "-o", str(tmp_path), "--class", "0", "--scale", str(middle), "--json"],
    )
    cycle = json.loads(again.stdout)["cycles"][0]
    assert cycle["scale"] == pytest.approx(middle)
    assert cycle["barcode"][0] == pytest.approx([first["birth"], first["death"]], abs=1e-5)


def named(record: object) -> set[str]:
    """All names in a record but those that are options, joints, limbs or figures of quality."""
    if isinstance(record, list):
        return set().union(*map(named, record))
    if not isinstance(record, dict):
        return set()
    own = {"options", "contacts", "passing", "quality"}
    return set(record).union(*(named(value) for name, value in record.items() if name not in own))


@pytest.mark.parametrize(
    "command", ["loop", "timeline", "strides", "inspect", "excitations", "segment"]
)
def test_every_name_in_a_record_is_documented(walk, tmp_path, command):
    arguments = [command, str(walk), "-o", str(tmp_path), "--json"]
    arguments += [] if command == "timeline" else ["--no-picture"]
    result = runner.invoke(app, arguments)
    (written,) = tmp_path.glob("*.json")
    record = json.loads(result.stdout)
    assert record == json.loads(written.read_text())
    assert command == "segment" or record["capture"]["file"] == "walk.bvh"
    assert undocumented(record) == []


def undocumented(record: object) -> list[str]:
    told = (Path(__file__).parents[2] / "docs" / "records.md").read_text()
    return [name for name in sorted(named(record)) if f"`{name}`" not in told]


def test_every_name_that_check_prints_is_documented(walk):
    assert undocumented(json.loads(runner.invoke(app, ["check", str(walk), "--json"]).stdout)) == []


def test_python_runs_the_command_line_as_a_module():
    shown = subprocess.run(
        [sys.executable, "-m", "roundelay", "--version"], capture_output=True, text=True, check=True
    )
    assert shown.stdout == f"roundelay {rl.__version__}\n"
