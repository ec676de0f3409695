"""What engines are told about a loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.cycles.edit.separate import Mended
from roundelay.geometry.collision import collisions
from roundelay.loops.exported import exported
from roundelay.loops.options import LoopOptions
from roundelay.loops.profiles import foot_contacts, profiles


def told_of(cycle: rl.Cycle, *, mended: tuple[Mended, ...] = (), **sampling) -> dict:
    return profiles["generic"].record(cycle, LoopOptions(**sampling), mended)


@pytest.fixture(scope="module")
def walk() -> rl.Cycle:
    return rl.find_cycles(synth.gait("walk", repetitions=3, turning=0.4).motion)[0]


def test_root_motion_and_markers(walk):
    told = told_of(walk, fps=30, periods=2, repeat_first=True)
    loop = walk.sample(30, periods=2, repeat_first=True)
    assert told["frames"] == 2 * told["frames_per_period"] == len(loop) - 1
    moved = loop.root_path[told["frames_per_period"]] - loop.root_path[0]
    assert np.allclose(told["root_motion"]["travel"], moved, atol=1e-6)
    assert told["root_motion"]["turning_degrees"] == pytest.approx(np.degrees(0.4), abs=0.5)
    assert [marker["phase"] for marker in told["markers"]][:4] == [0.0, 0.25, 0.5, 0.75]
    assert not told_of(walk, in_place=True)["root_motion"]["in_file"]


def test_feet_of_a_real_jump_stand_in_its_frames(jump_cycles):
    told = foot_contacts(jump_cycles[0], 30.0)
    count = round(jump_cycles[0].period * 30)
    assert len(told) == 2
    for stands in told.values():
        assert stands
        assert all(0 <= a < count and a < b <= a + count for a, b in stands)


def test_bones_that_meet_are_told(walk):
    assert told_of(walk)["collisions"] == []
    # Legs that go out to their sides cross once the sides are exchanged.
    jacks = rl.find_cycles(synth.gait("jacks").motion)[0]
    exchanged = replace(jacks.skeleton, offsets=jacks.skeleton.offsets * [-1.0, 1.0, 1.0])
    told = told_of(replace(jacks, skeleton=exchanged))["collisions"]
    assert ["LeftLeg", "RightLeg"] in [one["bones"] for one in told]
    for one in told:
        assert one["frames"][0] <= one["deepest"] < one["frames"][1]


def test_bones_that_were_moved_apart_are_told_in_frames(walk):
    mended = Mended(("LeftHand", "LeftUpLeg"), ((0.1, 0.2), (1.0, 1.201)), np.radians(2.0))
    (told,) = told_of(walk, fps=30, mended=(mended,))["mended"]
    assert told["bones"] == ["LeftHand", "LeftUpLeg"]
    assert told["frames"] == [[3, 6], [30, 36]]
    assert told["largest_degrees"] == pytest.approx(2.0)
    assert told_of(walk)["mended"] == []


def test_what_is_told_is_what_is_in_the_loop(jump_cycles):
    for cycle in jump_cycles:
        loop = cycle.sample(24.0)
        met = collisions(loop.skeleton, loop.rotations)
        told = told_of(cycle, fps=24.0)["collisions"]
        assert [tuple(one["bones"]) for one in told] == [one.bones for one in met]


def test_the_record_of_a_target_is_of_its_file(walk):
    written = LoopOptions(target="unreal", fps=30.0)
    told = profiles["generic"].record(walk, written)
    loop = exported(walk, replace(written, repeat_first=True))
    way = loop.positions()[-1, 0] - loop.positions()[0, 0]
    assert np.allclose(told["root_motion"]["travel"], way, atol=1e-6)
    assert (told["target"], told["metres_a_unit"]) == ("unreal", pytest.approx(0.01))
    assert told["root_bone"] == loop.skeleton.names[0]
    assert told["first_repeated"]


def test_events_are_in_order_and_told_once(walk, jump_cycles):
    names = [event["name"] for event in told_of(walk)["events"] if "phase" not in event["name"]]
    assert names == ["left contact", "right off", "right contact", "left off"]
    told = told_of(jump_cycles[0], fps=30)
    names = [event["name"] for event in told["events"]]
    frames = [event["frame"] for event in told["events"]]
    assert names[0] == "phase 0"
    assert frames == sorted(frames)
    assert len(names) == len(set(zip(names, frames, strict=True)))
    for foot in told["contacts"]:
        assert names.count(f"{foot} down") == names.count(f"{foot} up")
