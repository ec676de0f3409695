"""Limbs that pass through each other, as the command line tells and repairs them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.cli import app
from roundelay.geometry import rotations as rot
from roundelay.geometry.collision import collisions

runner = CliRunner()


@pytest.fixture(scope="module")
def walks(tmp_path_factory) -> list[str]:
    """Two walks, one arm held before and behind the thigh: half way lies the thigh."""
    folder, paths = tmp_path_factory.mktemp("walks"), []
    for name, ahead in (("before", -0.9), ("behind", 0.9), ("within", 0.0)):
        motion = synth.gait("walk", repetitions=2.5).motion
        rotations, joint = motion.rotations.copy(), motion.skeleton.index("RightArm")
        turn = rot.from_rotation_vector([ahead, 0.0, 0.13])
        rotations[:, joint] = rot.multiply(turn, rotations[:, joint])
        path = folder / f"{name}.bvh"
        rl.write(rl.Motion(motion.skeleton, rotations, motion.root_path, motion.frame_time), path)
        paths.append(str(path))
    return paths


def meets(path: Path) -> bool:
    motion = rl.read(path)
    return bool(collisions(motion.skeleton, motion.rotations))


def test_a_blend_is_repaired_and_told(walks, tmp_path):
    result = runner.invoke(app, ["blend", *walks[:2], "-o", str(tmp_path / "mixed.bvh")])
    assert result.exit_code == 0, result.output
    assert "RightHand and RightLeg moved apart in frames " in result.stdout
    assert " deg\n" in result.stdout
    assert "may touch" not in result.stdout
    assert not meets(tmp_path / "mixed.bvh")


def test_a_blend_is_left_as_it_is_if_wished(walks, tmp_path):
    path = tmp_path / "mixed.bvh"
    result = runner.invoke(app, ["blend", *walks[:2], "--no-repair", "-o", str(path)])
    assert result.exit_code == 0, result.output
    assert "RightHand and RightLeg may touch in frames " in result.stdout
    assert "moved apart" not in result.stdout
    assert meets(path)


def test_a_transition_is_repaired_and_told(walks, tmp_path):
    path, timing = tmp_path / "there.bvh", ["--seconds", "0.6", "--before", "0.8"]
    result = runner.invoke(app, ["transition", *walks[:2], *timing, "-o", str(path)])
    assert result.exit_code == 0, result.output
    assert "moved apart in frames " in result.stdout
    assert not meets(path)


def test_what_meets_in_the_capture_stays_in_its_loop(walks, tmp_path):
    result = runner.invoke(app, ["loop", walks[2], "-o", str(tmp_path), "--no-picture"])
    assert result.exit_code == 0, result.output
    assert "may touch in frames " in result.stdout
    (cycle,) = json.loads((tmp_path / "within_loop.json").read_text())["cycles"]
    assert cycle["playback"]["collisions"]
    for one in cycle["playback"]["mended"]:
        assert one["largest_degrees"] < 1.0
