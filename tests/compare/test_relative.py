"""Relative phase of two joints, and statistics of directions."""

import numpy as np
import pytest
from scipy import stats

import roundelay as rl
from roundelay import synth
from roundelay.compare.relative import circular_mean


@pytest.fixture(scope="module")
def walk():
    motion = synth.gait("walk", repetitions=6.5, fps=60.0).motion
    return rl.repetitions(rl.find_cycles(motion)[0], motion)


def test_feet_go_against_each_other_and_an_arm_with_the_other_foot(walk):
    feet = rl.relative_phase(walk, "LeftFoot", "RightFoot")
    assert abs(feet.mean) == pytest.approx(0.5, abs=0.05)
    assert feet.resultant > 0.99
    assert feet.first.shape == (len(walk), 48)
    across = rl.relative_phase(walk, "LeftHand", "RightFoot")
    along = rl.relative_phase(walk, "LeftHand", "LeftFoot")
    assert abs(across.mean) < 0.2
    assert abs(along.mean) > 0.3
    assert across.low <= across.mean <= across.high


def test_who_swings_later_is_positive(walk):
    one = rl.relative_phase(walk, "LeftHand", "RightFoot").mean
    assert rl.relative_phase(walk, "RightFoot", "LeftHand").mean == pytest.approx(-one)


def test_directions_have_the_mean_of_scipy():
    draw = np.random.default_rng(0)
    turns = 0.45 + 0.05 * draw.normal(size=40)
    mean, resultant, reach = circular_mean(turns, 0.95)
    theirs = stats.circmean(turns, high=1.0)
    assert mean % 1.0 == pytest.approx(theirs % 1.0)
    assert 1.0 - resultant == pytest.approx(stats.circvar(turns, high=1.0))
    assert reach == pytest.approx(1.96 * turns.std() / np.sqrt(40), rel=0.1)


def test_intervals_hold_the_mean_as_often_as_they_say():
    draw = np.random.default_rng(1)
    held = 0
    for _ in range(400):
        mean, _, reach = circular_mean(0.1 * draw.normal(size=25), 0.95)
        held += abs(mean) <= reach
    assert 0.9 < held / 400 < 0.98


def test_directions_all_over_have_no_interval():
    _, resultant, reach = circular_mean(np.arange(8) / 8, 0.95)
    assert resultant < 1e-9
    assert np.isnan(reach)
    with pytest.raises(ValueError, match="expected finite directions"):
        circular_mean([], 0.95)
    with pytest.raises(ValueError, match="expected a level between 0 and 1, found 2"):
        circular_mean([0.1], level=2.0)


def test_other_joints_are_refused(walk):
    with pytest.raises(rl.SkeletonMismatch, match="no joint 'Paw'"):
        rl.relative_phase(walk, "Paw", "LeftFoot")
    with pytest.raises(ValueError, match="expected joints that swing, found Hips at rest"):
        rl.relative_phase(walk, "Hips", "LeftFoot")


def test_a_coordination_diagram_shows_each_repetition(walk):
    from roundelay.output import figures

    axes = figures.coordination(rl.relative_phase(walk, "LeftHand", "RightFoot"))
    assert len(axes.get_lines()) == len(walk) + 1
