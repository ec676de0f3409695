"""What a take shows does not depend on what else is in it, nor on how it is told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.geometry import rotations as rot


@pytest.fixture(scope="module")
def walk() -> rl.Motion:
    return synth.gait("walk", repetitions=6, fps=30, seed=3).motion


@pytest.fixture(scope="module")
def jacks() -> rl.Motion:
    return synth.gait("jacks", repetitions=6, fps=30, seed=3).motion


def periods(take: rl.Motion) -> list[float]:
    return sorted(each.period for each in rl.understand(take).cyclic)


def test_a_take_shows_what_its_parts_show(walk, jacks):
    both = rl.concatenate([walk, synth.wander(4.0, fps=30).motion, jacks])
    assert periods(both) == pytest.approx(periods(walk) + periods(jacks), rel=0.05)


@pytest.mark.parametrize("times", [2, 4])
def test_a_take_played_again_shows_the_same(walk, times):
    (once,), (again,) = (
        rl.understand(walk).cyclic,
        rl.understand(rl.concatenate([walk] * times)).cyclic,
    )
    assert again.period == pytest.approx(once.period, rel=0.03)
    assert again.repetitions > 0.8 * times * once.repetitions


@pytest.mark.parametrize("fps", [15.0, 24.0, 60.0, 240.0])
def test_the_rate_of_frames_changes_nothing(walk, fps):
    (here,), (there,) = rl.understand(walk).cyclic, rl.understand(walk.resample(fps)).cyclic
    assert there.period == pytest.approx(here.period, rel=0.02)
    assert there.repetitions == pytest.approx(here.repetitions, abs=0.2)


def test_a_mirrored_take_repeats_as_often(walk):
    (here,), (there,) = rl.understand(walk).cyclic, rl.understand(walk.mirror()).cyclic
    assert there.period == pytest.approx(here.period, rel=1e-3)
    assert there.whole == here.whole


def test_arms_twice_as_fast_as_legs_do_not_decide(walk):
    """Legs make one stride while the arms swing twice: the body's period is the stride's."""
    rotations, stride = walk.rotations.copy(), 1.1
    seconds = np.arange(len(walk)) / walk.fps
    for joint, name in enumerate(walk.skeleton.names):
        if "Arm" in name:
            swing = 0.5 * np.sin(4 * np.pi * seconds / stride)
            turn = np.stack([swing, 0 * swing, 0.3 * swing], axis=1)
            rotations[:, joint] = rot.from_rotation_vector(turn)
    found = rl.understand(replace(walk, rotations=rotations)).cyclic
    legs = [each for each in found if {"left leg", "right leg"} & set(each.limbs)]
    assert [each.period for each in legs] == pytest.approx([stride], rel=0.03)


def test_a_limb_that_rests_leaves_the_others(walk):
    rotations = walk.rotations.copy()
    arm = [joint for joint, name in enumerate(walk.skeleton.names) if name.startswith("LeftArm")]
    rotations[:, arm] = rotations[:1, arm]
    (there,) = rl.understand(replace(walk, rotations=rotations)).cyclic
    assert there.period == pytest.approx(1.1, rel=0.02)


def test_glitches_harm_their_own_limb_and_time_only(walk):
    rng, rotations = np.random.default_rng(5), walk.rotations.copy()
    hand = walk.skeleton.index("LeftHand")
    for frame in rng.choice(len(walk), 40, replace=False):
        rotations[frame, hand] = rot.from_rotation_vector(rng.normal(scale=1.5, size=3))
    (there,) = rl.understand(replace(walk, rotations=rotations)).cyclic
    assert there.period == pytest.approx(1.1, rel=0.02)
    assert {"left leg", "right leg", "right arm"} <= set(there.limbs)


def test_a_pause_is_told_and_cut_out(walk):
    middle = len(walk) // 2
    rest = rl.concatenate([walk[middle : middle + 1]] * 60)
    (found,) = rl.understand(rl.concatenate([walk[:middle], rest, walk[middle:]])).cyclic
    assert len(found.spans) == 2
    ((start, stop),) = found.paused
    assert abs(start - middle) < 10
    assert abs(stop - middle - 60) < 10
    assert found.repetitions == pytest.approx(6.0, abs=0.5)


def test_a_phrase_made_of_beats_is_told_with_them():
    made = synth.gait("jacks", repetitions=24, period=1.0, fps=30).motion
    seconds, rotations = np.arange(len(made)) / 30, made.rotations.copy()
    accents = (("LeftArm", 2, 0.5), ("Spine", 1, 0.4), ("RightArm", 1, 0.4), ("LeftUpLeg", 1, 0.4))
    for name, when, angle in accents:
        joint = made.skeleton.index(name)
        accent = angle * np.exp(-(((seconds % 4 - when) / 0.35) ** 2))
        turn = rot.from_rotation_vector(np.stack([accent, accent, 0 * accent], axis=1))
        rotations[:, joint] = rot.multiply(rotations[:, joint], turn)
    take = replace(made, rotations=rotations)
    (beat,) = rl.understand(take).cyclic
    assert beat.period == pytest.approx(1.0, rel=0.02)
    assert beat.phrase.period == pytest.approx(4.0, rel=0.02)
    assert rl.find_cycles(take, rl.Options(phrase=True))[0].period == pytest.approx(4.0, rel=0.02)
    assert rl.understand(made).cyclic[0].phrase is None


def test_poses_without_a_skeleton_have_a_timeline(walk):
    values = np.random.default_rng(2).normal(size=(len(walk), 1, 3)) * 0.001
    phase = 2 * np.pi * np.arange(len(walk)) / 30 / 1.1
    marker = np.stack([np.cos(phase), np.sin(phase), np.sin(2 * phase)], axis=1)[:, None] + values
    missing = np.zeros((len(walk), 1), bool)
    missing[40:45] = True
    poses = rl.PoseArray(("marker",), marker, 30.0, missing=missing)
    (found,) = rl.understand(poses).cyclic
    assert found.period == pytest.approx(1.1, rel=0.02)
    assert found.joints == ("marker",)
