"""One idea of sane: what may be written can be read, and what may not is refused at both doors."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.formats.sane import LARGEST, SHORTEST, SLOWEST

WALK = synth.gait("walk", repetitions=1.0, fps=30.0).motion
SUFFIXES = ["bvh", "amc", "glb", "gltf"]


def scaled(factor: float) -> rl.Motion:
    return WALK.scaled(factor)


def rated(fps: float) -> rl.Motion:
    return replace(WALK, frame_time=1.0 / fps)


def named(name: str) -> rl.Motion:
    names = (*WALK.skeleton.names[:-1], name)
    return replace(WALK, skeleton=replace(WALK.skeleton, names=names))


def longest(motion: rl.Motion) -> float:
    ends = [offset for _, offset in motion.skeleton.end_sites]
    return float(abs(np.concatenate([motion.skeleton.offsets[1:], ends])).max())


EDGES = {
    "short": scaled(1.001 * SHORTEST / longest(WALK)),
    "long": scaled(0.999 * LARGEST / abs(WALK.root_path).max()),
    "slow": rated(1.001 * SLOWEST),
    "fast": rated(9999.0),
    "a name of any letters": named("a b\tc{}#é=\u2028"),
    "a long name": named("x" * 5000),
}
BEYOND = {
    "shorter": (scaled(0.999 * SHORTEST / longest(WALK)), "a bone of at least 1e-05 in length"),
    "vanishing": (scaled(1e-310), "a bone of at least 1e-05 in length"),
    "longer": (scaled(1.001 * LARGEST / abs(WALK.root_path).max()), r"at most 1e\+12"),
    "endless": (scaled(1e290), r"at most 1e\+12"),
    "slower": (rated(0.999 * SLOWEST), "frames a second"),
    "frozen": (replace(WALK, frame_time=1e300), "frames a second"),
    "faster": (rated(10001.0), "frames a second"),
    "at once": (replace(WALK, frame_time=1e-320), "frames a second"),
    "half a letter": (named("\ud800"), "joint names that UTF-8 can hold"),
    "a byte of a file name": (named("caf\udce9"), "joint names that UTF-8 can hold"),
}


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("edge", EDGES)
def test_what_is_written_can_be_read(edge, suffix, tmp_path):
    motion, path = EDGES[edge], tmp_path / f"a.{suffix}"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rl.RoundelayWarning)
        rl.write(motion, path)
        again = rl.read(path)
    assert len(again) == len(motion)
    assert again.fps == pytest.approx(motion.fps, rel=1e-5)
    assert again.skeleton.size == pytest.approx(motion.skeleton.size, rel=1e-2)


@pytest.mark.parametrize("suffix", [*SUFFIXES, "fbx"])
@pytest.mark.parametrize("wrong", BEYOND)
def test_what_no_file_may_hold_is_not_written(wrong, suffix, tmp_path):
    motion, told = BEYOND[wrong]
    with pytest.raises(ValueError, match=f"^expected .*{told}.*, found "):
        rl.write(motion, tmp_path / f"a.{suffix}")
    assert list(tmp_path.iterdir()) == []


BVH = """HIERARCHY
ROOT a
{{
OFFSET 0 0 0
CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
JOINT b
{{
OFFSET 0 {bone} 0
CHANNELS 3 Zrotation Xrotation Yrotation
End Site
{{
OFFSET 0 {bone} 0
}}
}}
}}
MOTION
Frames: 2
Frame Time: {time}
{place} 0 0 0 0 0 {angle} 0 0
0 0 0 0 0 0 0 0 0
"""
WRONG = {
    "time of no length": ({"time": "1e-320"}, "frames a second, found inf"),
    "no end": ({"time": "1e9"}, "frames a second, found 1e-09"),
    "small bone": ({"bone": "1e-300"}, "a bone of at least 1e-05 in length, found 1e-300"),
    "large bone": ({"bone": "9e99"}, "three numbers after OFFSET, found '9e99', more than"),
    "far away": ({"place": "9e99"}, r"a number, found '9e99', more than 1e\+12"),
    "many turns": ({"angle": "1e13"}, r"a number, found '1e13', more than 1e\+12"),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_what_no_file_may_hold_is_not_read(wrong, tmp_path):
    given, told = WRONG[wrong]
    path = tmp_path / "a.bvh"
    path.write_text(BVH.format(**{"time": "0.01", "bone": "1", "place": "0", "angle": "0"} | given))
    with pytest.raises(rl.FormatError, match=told):
        rl.read(path)


def test_the_true_rate_reads_a_file_with_a_wrong_one(tmp_path):
    path = tmp_path / "a.bvh"
    path.write_text(BVH.format(time="1e-320", bone="1", place="0", angle="0"))
    assert rl.read(path, fps=30.0).fps == pytest.approx(30.0)


def test_a_body_without_lengths_is_sane(tmp_path):
    path = tmp_path / "a.bvh"
    path.write_text(BVH.format(time="0.01", bone="0", place="0", angle="0"))
    assert rl.read(path).skeleton.size == 1.0


def test_a_frozen_motion_is_not_copied():
    again = replace(WALK, name="again")
    assert again.rotations is WALK.rotations
    assert again.root_path is WALK.root_path
    own = WALK.rotations.copy()
    motion = replace(WALK, rotations=own)
    own[:] = 0.0
    assert np.all(motion.rotations == WALK.rotations)
    view = WALK.rotations.copy()
    shown = view[:]
    shown.flags.writeable = False
    motion = replace(WALK, rotations=shown)
    view[:] = 0.0
    assert np.all(motion.rotations == WALK.rotations)


def test_frozen_rotations_of_other_signs_become_continuous():
    flipped = WALK.rotations.copy()
    flipped[10:] *= -1.0
    flipped.flags.writeable = False
    assert np.all(replace(WALK, rotations=flipped).rotations == WALK.rotations)
