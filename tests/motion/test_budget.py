"""What would not fit is refused before work starts, with what to do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.formats.sane import MOST_FRAMES, MOST_JOINTS, fault_of_size
from roundelay.motion.budget import WORK, require_budget

WALK = synth.gait("walk", repetitions=3.0, fps=30.0).motion
NEEDED = WORK * len(WALK) * WALK.skeleton.n_joints


@pytest.fixture
def free(monkeypatch):
    def given(count: int | None) -> None:
        monkeypatch.setattr("roundelay.base.memory.available_memory", lambda: count)

    return given


@pytest.mark.parametrize("door", [rl.find_cycles, rl.find_periodic, rl.understand, rl.make_loops])
def test_the_search_is_refused_where_it_would_not_fit(door, free):
    free(NEEDED - 1)
    told = r"^99 frames of 19 joints need about .* GB are free: take a part .*--frames START:STOP"
    with pytest.raises(rl.TooLarge, match=told):
        door(WALK)
    # A part of the frames fits.
    door(WALK, rl.Options(frames=(0, 98)))
    free(NEEDED)
    door(WALK)


def test_what_the_system_does_not_tell_is_no_limit(free):
    free(None)
    require_budget(WALK)


@pytest.mark.parametrize("suffix", ["bvh", "amc", "glb"])
def test_a_file_is_refused_where_its_poses_would_not_fit(suffix, free, tmp_path):
    path = tmp_path / f"a.{suffix}"
    rl.write(WALK, path)
    free(64 * 99 * 19 - 1)
    with pytest.raises(rl.TooLarge, match=r"^\d+ frames of \d+ joints need .*: close"):
        rl.read(path)
    free(64 * 99 * 40)
    assert len(rl.read(path)) == 99


def test_a_clip_too_large_is_tried_again(free, tmp_path):
    rl.write(WALK, tmp_path / "a.bvh")
    free(NEEDED - 1)
    refused: list[str] = []
    rl.build_library(tmp_path / "a.bvh", tmp_path / "out", jobs=1, refused=refused.append)
    assert "need about" in refused[0]
    free(None)
    library = rl.build_library(tmp_path / "a.bvh", tmp_path / "out", jobs=1)
    assert library.summary["loops"] == 1


def test_limits_of_size(tmp_path):
    assert fault_of_size(MOST_FRAMES, MOST_JOINTS) is None
    assert fault_of_size(MOST_FRAMES + 1, 1) == "expected at most 4000000 frames, found 4000001"
    bush = "JOINT j{} {{ OFFSET 0 1 0 CHANNELS 0 }}\n"
    text = (
        "HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n"
        + "".join(map(bush.format, range(MOST_JOINTS)))
        + "}\nMOTION\nFrames: 1\nFrame Time: 0.01\n1 2 3\n"
    )
    path = tmp_path / "a.bvh"
    path.write_text(text)
    with pytest.raises(rl.FormatError, match=r"a.bvh:\d+:\d+: expected at most 4096 joints, found"):
        rl.read(path)
    names = tuple(map(str, range(MOST_JOINTS + 1)))
    parents = (-1, *[0] * MOST_JOINTS)
    skeleton = rl.Skeleton(names, parents, np.ones((MOST_JOINTS + 1, 3)))
    rotations = np.tile([1.0, 0.0, 0.0, 0.0], (1, MOST_JOINTS + 1, 1))
    motion = rl.Motion(skeleton, rotations, np.zeros((1, 3)), 0.01)
    with pytest.raises(ValueError, match="expected at most 4096 joints, found 4097"):
        rl.write(replace(motion, name="bush"), tmp_path / "b.bvh")
