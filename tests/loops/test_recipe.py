"""One recipe: what Python makes is what the command writes, to the byte."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.cli import app
from roundelay.cycles.edit.align import mirrored
from roundelay.loops.recipe import placed, rendered
from roundelay.output.records import loop_record

README = Path(__file__).parents[2] / "README.md"


@pytest.fixture(scope="module")
def folder(tmp_path_factory, captures) -> Path:
    """Captures: a gait, two behaviours, and real jumps."""
    made = tmp_path_factory.mktemp("captures")
    walk = synth.gait("walk", repetitions=2.6)
    both = synth.sequence(synth.gait("walk", repetitions=4), synth.gait("punch", repetitions=5))
    rl.write(walk.motion, made / "walk.bvh")
    rl.write(both.motion, made / "both.bvh")
    (made / "jumps.bvh").write_bytes((captures / "01_01.bvh").read_bytes())
    return made


@pytest.fixture(scope="module")
def walk(folder) -> rl.Motion:
    return rl.read(folder / "walk.bvh")


@pytest.fixture(scope="module")
def loop(walk) -> rl.Loop:
    return rl.make_loops(walk)[0]


OPTIONS = {
    "automatic": ([], rl.LoopOptions()),
    "sampled": (
        ["--fps", "30", "--periods", "2", "--in-place"],
        rl.LoopOptions(fps=30, periods=2, in_place=True),
    ),
    "as it came": (
        ["--no-foot-lock", "--no-repair", "--repeat-first"],
        rl.LoopOptions(foot_lock=False, repair=False, repeat_first=True),
    ),
    "placed": (["--mirror", "--resize", ".5"], rl.LoopOptions(mirror=True, resize=0.5)),
}


CASES = [(name, options) for name in ("walk", "both") for options in OPTIONS]


@pytest.mark.parametrize(("name", "options"), [*CASES, ("jumps", "automatic"), ("jumps", "placed")])
def test_python_writes_what_the_command_writes(folder, tmp_path, name, options):
    arguments, render = OPTIONS[options]
    loops = rl.make_loops(rl.read(folder / f"{name}.bvh"), render=render)
    (tmp_path / "python").mkdir()
    for file_format in ("bvh", "glb", "fbx"):
        asked = ["loop", str(folder / f"{name}.bvh"), "-o", str(tmp_path), "--no-picture", "--json"]
        result = CliRunner().invoke(app, [*asked, "--format", file_format, *arguments])
        assert result.exit_code == 0, result.output
        written = json.loads(result.stdout)["cycles"]
        assert len(loops) == len(written)
        for made, told in zip(loops, written, strict=True):
            (path,) = made.write(tmp_path / "python" / told["files"][0])
            assert path.read_bytes() == (tmp_path / path.name).read_bytes()
            assert str(made.verdict).startswith(told["verdict"]["word"])


def test_the_lines_of_the_readme_write_what_the_command_writes(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("walk.bvh").write_bytes((folder / "walk.bvh").read_bytes())
    (lines,) = re.findall(r"```python\n(import roundelay as rl\n.*?)```", README.read_text(), re.S)
    exec(lines, {})
    wanted = {
        "walk_loop.bvh": [],
        "walk_loop.glb": ["--format", "glb"],
        "in_place.fbx": ["--format", "fbx", "--fps", "30", "--in-place"],
    }
    for name, arguments in wanted.items():
        asked = ["loop", "walk.bvh", "-o", "command", "--no-picture", *arguments]
        assert CliRunner().invoke(app, asked).exit_code == 0
        made = Path("command", f"walk_loop{Path(name).suffix}")
        assert Path(name).read_bytes() == made.read_bytes()


def test_a_loop_holds_what_it_is_and_how_good(walk, loop):
    assert repr(loop).startswith("Loop(Cycle('walk', period 1.1")
    assert str(loop.verdict) == "good"
    assert loop.quality == rl.quality(loop.cycle, walk)
    assert len(loop.motion) == loop.playback["frames"] == 132
    assert loop.parted == ()


def test_a_file_has_the_frames_that_its_format_needs(loop, tmp_path):
    (bvh,) = loop.write(tmp_path / "loop")
    assert bvh == tmp_path / "loop.bvh"
    (glb,) = loop.write(tmp_path / "loop.glb")
    assert len(rl.read(glb)) == len(rl.read(bvh)) + 1 == 133
    assert loop.write(tmp_path / "loop.amc") == (tmp_path / "loop.amc", tmp_path / "loop.asf")
    with pytest.raises(ValueError, match="expected a format among"):
        loop.write(tmp_path / "loop.obj")


def test_what_is_mirrored_and_resized_is_the_loop_as_it_is_measured(walk):
    """Feet, travel and verdict are those of what is written; the mirrored begins on its left."""
    loop = rl.make_loops(walk, render=rl.LoopOptions(start="right"))[0]
    other = rl.make_loops(walk, render=rl.LoopOptions(mirror=True, resize=100.0))[0]
    there = loop.motion.mirror().scaled(100.0)
    assert np.abs(other.motion.positions() - there.positions()).max() < 0.01
    contacts, swapped = loop.playback["contacts"], other.playback["contacts"]
    assert swapped == {"LeftFoot": contacts["RightFoot"], "RightFoot": contacts["LeftFoot"]}
    across = np.array(other.playback["root_motion"]["travel"])
    assert np.allclose(across, 100 * np.array([-1, 1, 1]) * loop.playback["root_motion"]["travel"])
    assert other.verdict == loop.verdict
    assert other.quality.template_error == pytest.approx(loop.quality.template_error, rel=1e-6)
    assert other.quality.seam_length == pytest.approx(100 * loop.quality.seam_length, rel=1e-3)


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_a_resized_loop_tells_its_own_speed_in_metres(walk, loop, factor):
    plain = loop_record(loop)["verdict"]
    told = loop_record(rl.make_loops(walk, render=rl.LoopOptions(resize=factor))[0])["verdict"]
    assert told["metres_a_unit"] == plain["metres_a_unit"] == 1.0
    assert told["speed"] == pytest.approx(factor * plain["speed"])
    assert (told["word"], told["body_size"]) == ("good", factor * plain["body_size"])


def on_the_ground(motion: rl.Motion) -> rl.Motion:
    """Hang a gait on a bone that glides along the ground below it."""
    old, ground = motion.skeleton, motion.root_path * [1.0, 0.0, 1.0]
    ends = tuple((joint + 1, offset) for joint, offset in old.end_sites)
    parents = (-1, *(parent + 1 for parent in old.parents))
    offsets = np.vstack([np.zeros(3), [0.0, 0.9, 0.0], old.offsets[1:]])
    moved = np.tile(offsets, (len(motion), 1, 1))
    moved[:, 1] = motion.root_path - ground
    none = np.tile([1.0, 0.0, 0.0, 0.0], (len(motion), 1, 1))
    rotations = np.concatenate([none, motion.rotations], axis=1)
    skeleton = rl.Skeleton(("Ground", *old.names), parents, offsets, ends)
    return rl.Motion(skeleton, rotations, ground, motion.frame_time, moved)


def test_what_stands_above_the_hips_is_resized_too():
    cycle = rl.find_cycles(on_the_ground(synth.gait("walk", repetitions=3).motion))[0]
    assert cycle.above is not None
    half = placed(cycle, rl.LoopOptions(resize=0.5))
    assert np.allclose(half.sample().positions(), 0.5 * cycle.sample().positions(), atol=1e-9)
    mirror = rl.LoopOptions(mirror=True)
    both = placed(placed(cycle, mirror), mirror)
    assert np.allclose(both.sample().positions(), cycle.sample().positions(), atol=1e-9)


def test_a_blend_is_rendered_without_a_capture(walk, loop):
    mixed = rl.blend([loop.cycle, mirrored(loop.cycle)], [0.5, 0.5])
    made = rendered(mixed, [walk], rl.LoopOptions(fps=30))
    assert len(made.motion) == 33
    assert not hasattr(made, "verdict")


def test_progress_is_told_and_a_loop_without_evidence_refused(walk, loop):
    from roundelay.loops.recipe import made_loop

    told = []
    rl.make_loops(walk, progress=lambda done, stage: told.append(done))
    assert told == sorted(told)
    assert told[-1] == 1.0
    with pytest.raises(ValueError, match="evidence"):
        made_loop(replace(loop.cycle, evidence=None), walk)
