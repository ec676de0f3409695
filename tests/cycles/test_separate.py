"""Cycles and transitions whose limbs pass through each other, repaired by small changes."""

from __future__ import annotations

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.cycles.contacts import standing_feet
from roundelay.cycles.edit.separate import repaired, repaired_motion
from roundelay.geometry import rotations as rot
from roundelay.geometry.separation import deepest
from roundelay.loops.quality import jerk, velocity_changes


def meeting(motion: rl.Motion) -> dict:
    return deepest(motion.skeleton, motion.rotations, motion.translations)


def walking(**turns: tuple[float, float, float]) -> rl.Cycle:
    """Return a walk with some joints turned throughout, by rotation vectors."""
    motion = synth.gait("walk", repetitions=2.5).motion
    rotations = motion.rotations.copy()
    for name, vector in turns.items():
        joint = motion.skeleton.index(name)
        turn = rot.from_rotation_vector(vector)
        rotations[:, joint] = rot.multiply(turn, rotations[:, joint])
    return rl.find_cycles(
        rl.Motion(motion.skeleton, rotations, motion.root_path, motion.frame_time)
    )[0]


@pytest.fixture(scope="module")
def parents() -> list[rl.Cycle]:
    """Two walks, one arm held before and behind the thigh: half way lies the thigh."""
    return [
        walking(RightArm=(-0.9, 0.0, 0.13)),
        walking(RightArm=(0.9, 0.0, 0.13)),
    ]


@pytest.fixture(scope="module")
def blended(parents) -> rl.Cycle:
    return rl.blend(parents, [0.5, 0.5])


@pytest.fixture(scope="module")
def mended(blended):
    return repaired(blended)


@pytest.fixture(scope="module")
def narrow() -> rl.Cycle:
    """A walk whose swinging leg brushes the standing one."""
    return walking(LeftUpLeg=(0.0, 0.0, -0.09), RightUpLeg=(0.0, 0.0, 0.09))


def test_a_loop_that_meets_nothing_is_left_alone(jump_cycles):
    for cycle in (walking(), jump_cycles[0]):
        assert repaired(cycle) == (cycle, ())


@pytest.mark.parametrize("fps", [24.0, 30.0, 60.0, 120.0])
def test_a_blend_through_a_limb_is_repaired_at_any_frame_rate(parents, blended, mended, fps):
    cycle, told = mended
    assert not any(meeting(parent.sample(fps)) for parent in parents)
    assert meeting(blended.sample(fps))
    assert meeting(cycle.sample(fps)) == {}
    assert {name for one in told for name in one.bones} <= {
        "RightUpLeg",
        "RightLeg",
        "RightForeArm",
        "RightHand",
    }


def test_one_limb_changes_a_little_and_is_told(blended, mended):
    cycle, told = mended
    phase = np.arange(200) / 200
    turned = rot.angle_between(cycle.rotations(phase), blended.rotations(phase))
    arm = blended.skeleton.index("RightArm")
    leg = blended.skeleton.index("RightUpLeg")
    assert turned[:, arm].max() > 4.0 * turned[:, leg].max()
    assert np.delete(turned, [arm, leg], axis=1).max() < 1e-6
    assert turned.max() < np.radians(8.0)
    assert max(one.angle for one in told) == pytest.approx(turned.max(), rel=0.02)
    for one in told:
        for start, stop in one.seconds:
            assert 0.0 <= start < cycle.period
            assert start < stop <= start + cycle.period


def test_the_loop_stays_smooth(blended, mended):
    def figures(cycle: rl.Cycle) -> tuple[float, float, float]:
        loop = cycle.sample(120.0, periods=2)
        half = len(loop) // 2
        places = loop.positions() - loop.root_path[:, None]
        points = places.reshape(len(loop), -1)
        changes = velocity_changes(points, 120.0)
        # The frame between the periods, beside all others.
        seam = changes[half - 2 : half].max() / changes[: half - 2].max()
        return seam, float(np.abs(jerk(points, 120.0)).mean()), float(changes.max())

    before, after = figures(blended), figures(mended[0])
    assert after[0] <= 1.0
    assert after[1] < 1.1 * before[1]
    assert after[2] < 1.05 * before[2]


def test_contact_in_the_captures_stays(blended):
    assert repaired(blended, [blended.sample(fps=240)]) == (blended, ())


def test_a_swinging_leg_gives_way_and_standing_feet_stay(narrow):
    cycle, told = repaired(narrow)
    assert meeting(narrow.sample())
    assert meeting(cycle.sample()) == {}
    assert {one.bones for one in told} <= {("LeftLeg", "RightFoot"), ("LeftFoot", "RightFoot")}
    feet, standing = standing_feet(narrow, 132)
    phase = np.arange(132) / 132
    turned = rot.angle_between(cycle.rotations(phase), narrow.rotations(phase))
    hips = [foot.hip for foot in feet]
    assert standing.any()
    assert turned[:, hips][standing].max() < 0.02 * turned.max()
    assert np.delete(turned, hips, axis=1).max() < 1e-6


def test_a_hopeless_meeting_stays_as_it_is():
    through = walking(RightArm=(0.0, 0.0, 0.3), LeftArm=(0.0, 0.0, -0.3))
    assert meeting(through.sample())
    assert repaired(through) == (through, ())


def test_a_transition_is_repaired_too(parents):
    motion = rl.transition(*parents, 0.6, before=0.9, fps=60.0)
    fixed, told = repaired_motion(motion)
    assert meeting(motion)
    assert meeting(fixed) == {}
    assert told
    # Half a second before and after, nothing has changed.
    changed = rot.angle_between(fixed.rotations, motion.rotations).max(axis=1)
    assert changed.max() > 0.05
    assert changed[:20].max() < 1e-3
    assert changed[-30:].max() < 1e-3
    free = walking().sample()
    assert repaired_motion(free) == (free, ())


def test_a_joint_that_turns_all_the_way_round_is_repaired_too():
    motion = synth.gait("walk", repetitions=2.5).motion
    rotations, joint = motion.rotations.copy(), motion.skeleton.index("RightArm")
    turns = 2 * np.pi * np.arange(len(motion)) / (1.1 * motion.fps)
    inward = rot.from_rotation_vector([0.0, 0.0, 0.06])
    round_and_round = rot.from_rotation_vector(np.outer(turns, [-1.0, 0.0, 0.0]))
    rotations[:, joint] = rot.multiply(round_and_round, inward)
    windmill = rl.find_cycles(
        rl.Motion(motion.skeleton, rotations, motion.root_path, motion.frame_time)
    )[0]
    assert windmill.odd_pose is not None
    cycle, told = repaired(windmill)
    assert meeting(windmill.sample())
    assert told
    assert meeting(cycle.sample()) == {}
