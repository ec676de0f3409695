"""What engines are told about a loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.playback import foot_contacts, playback_record


@pytest.fixture(scope="module")
def walk() -> rl.Cycle:
    return rl.find_cycles(synth.gait("walk", repetitions=3, turning=0.4).motion)[0]


def test_root_motion_and_markers(walk):
    told = playback_record(walk, 30, periods=2, repeat_first=True)
    loop = walk.sample(30, periods=2, repeat_first=True)
    assert told["frames"] == 2 * told["frames_per_period"] == len(loop) - 1
    moved = loop.root_path[told["frames_per_period"]] - loop.root_path[0]
    assert np.allclose(told["root_motion"]["travel"], moved, atol=1e-6)
    assert told["root_motion"]["turning_degrees"] == pytest.approx(np.degrees(0.4), abs=0.5)
    assert [marker["phase"] for marker in told["markers"]] == [0.0, 0.25, 0.5, 0.75]
    assert not playback_record(walk, in_place=True)["root_motion"]["in_file"]


def test_feet_of_a_real_jump_stand_in_its_frames(jump_cycles):
    told = foot_contacts(jump_cycles[0], 30.0)
    count = round(jump_cycles[0].period * 30)
    assert len(told) == 2
    for stands in told.values():
        assert stands
        assert all(0 <= a < count and a < b <= a + count for a, b in stands)


def test_bones_that_meet_are_told(walk):
    assert playback_record(walk)["collisions"] == []
    # Legs that go out to their sides cross once the sides are exchanged.
    jacks = rl.find_cycles(synth.gait("jacks").motion)[0]
    exchanged = replace(jacks.skeleton, offsets=jacks.skeleton.offsets * [-1.0, 1.0, 1.0])
    told = playback_record(replace(jacks, skeleton=exchanged))["collisions"]
    assert ["LeftLeg", "RightLeg"] in [one["bones"] for one in told]
    for one in told:
        assert one["frames"][0] <= one["deepest"] < one["frames"][1]
