"""From phased frames to closed curves: turns, glitches, travel, seams."""

import dataclasses

import numpy as np
import pytest

from roundelay import find_cycles, synth
from roundelay.geometry import rotations as rot
from roundelay.motion.motion import Motion
from roundelay.phase.harmonic import crossfade_weights, design_matrix, fit_harmonic


def steps(motion: Motion) -> np.ndarray:
    """Angles (F, J) from each frame to the next, around the loop."""
    return rot.angle_between(motion.rotations, np.roll(motion.rotations, -1, axis=0))


def test_a_whole_turn_of_the_root_comes_back_continuous() -> None:
    made = synth.gait("spin", repetitions=3.0)
    cycle = find_cycles(made.motion)[0]
    assert cycle.period == pytest.approx(made.period, rel=0.01)
    loop = cycle.sample()
    usual = 2 * np.pi / len(loop)
    assert steps(loop).max() < 1.5 * usual
    # It turns all the way: half a period later it looks the other way.
    half = rot.angle_between(loop.rotations[0, 0], loop.rotations[len(loop) // 2, 0])
    assert half == pytest.approx(np.pi, abs=0.2)


@pytest.mark.parametrize("fps", [30.0, 120.0])
def test_whole_turns_are_no_gain_of_heading(fps: float) -> None:
    cycle = find_cycles(synth.gait("spin", repetitions=3.0, fps=fps).motion)[0]
    assert cycle.turning == pytest.approx(0.0, abs=0.02)


def test_a_joint_that_turns_all_the_way_comes_back_continuous() -> None:
    made = synth.gait("walk", repetitions=3.2)
    spun = made.motion.rotations.copy()
    arm = made.motion.skeleton.index("LeftArm")
    turn = 2 * np.pi * made.phase[:, None] * np.array([1.0, 0.0, 0.0])
    spun[:, arm] = rot.multiply(rot.from_rotation_vector(turn), spun[:, arm])
    cycle = find_cycles(dataclasses.replace(made.motion, rotations=spun))[0]
    assert cycle.odd_pose is not None
    assert cycle.period == pytest.approx(made.period, rel=0.01)
    loop = cycle.sample()
    assert steps(loop)[:, arm].max() < 3.0 * steps(loop)[:, arm].mean()


def test_a_glitch_of_one_joint_is_bridged() -> None:
    made = synth.gait("walk", repetitions=2.4)
    broken = made.motion.rotations.copy()
    hand = made.motion.skeleton.index("RightHand")
    flip = rot.from_rotation_vector(np.array([3.1, 0.0, 0.0]))
    broken[140:145, hand] = rot.multiply(broken[140:145, hand], flip)
    whole = find_cycles(made.motion)[0].sample()
    mended = find_cycles(dataclasses.replace(made.motion, rotations=broken))[0].sample()
    assert len(whole) == len(mended)
    assert rot.angle_between(whole.rotations, mended.rotations).max() < 0.05


@pytest.mark.parametrize("turning", [0.0, 0.8, -1.5])
def test_a_walk_on_a_circle_stays_one(turning: float) -> None:
    made = synth.gait("walk", repetitions=2.6, turning=turning)
    cycle = find_cycles(made.motion)[0]
    assert cycle.turning == pytest.approx(turning, rel=0.01, abs=1e-3)
    chord = 2.0 if turning == 0.0 else abs(4.0 * np.sin(turning / 2) / turning)
    stride = 0.75 * 1.75 * chord / 2.0
    assert np.linalg.norm(cycle.travel[[0, 2]]) == pytest.approx(stride, rel=0.02)


def test_the_seam_is_no_worse_than_the_rest() -> None:
    made = synth.gait("run", repetitions=1.6, noise=0.02, unevenness=0.3)
    loop = find_cycles(made.motion)[0].sample(in_place=True)
    angles = steps(loop)
    assert angles[-1].max() <= 1.2 * angles[:-1].max()


def test_crossfade_covers_the_circle_once_where_seen_once() -> None:
    turns = np.linspace(0.0, 1.4, 281)
    weights = crossfade_weights(turns, [(0, 281)])
    assert weights[140] == 1.0
    assert weights[0] < 1e-3 > weights[-1]
    assert np.all(weights >= 0.0)


def test_smoothing_follows_the_noise() -> None:
    rng = np.random.default_rng(0)
    phase = np.linspace(0.0, 3.0, 400)
    clean = design_matrix(phase, 3) @ rng.normal(size=(7, 2))
    for noise in (0.0, 0.05, 0.3):
        fitted = fit_harmonic(phase, clean + rng.normal(scale=noise, size=clean.shape), 40)
        assert np.sqrt(np.mean((fitted(phase) - clean) ** 2)) < 0.35 * noise + 1e-3


def test_odd_curves_change_sign_after_a_turn() -> None:
    phase = np.linspace(0.0, 2.0, 200)
    fitted = fit_harmonic(phase, np.sin(np.pi * phase)[:, None], 5, odd=True)
    assert np.allclose(fitted(phase + 1.0), -fitted(phase), atol=1e-12)
    assert np.allclose(fitted(phase)[:, 0], np.sin(np.pi * phase), atol=1e-3)
