"""The phase of a cycle, and a period, frame by frame."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth


def off(told, truth):
    """How far phases are off, in turns."""
    return (np.array([one.phase for one in told]) - truth + 0.5) % 1.0 - 0.5


@pytest.fixture(scope="module")
def walk():
    made = synth.gait("walk", repetitions=6, rng=1)
    cycle = rl.find_cycles(made.motion)[0]
    turns = np.exp(2j * np.pi * (cycle.phase - made.phase))
    return made, cycle, float(np.angle(np.nanmean(turns)) / (2 * np.pi))


@pytest.mark.parametrize(
    ("seed", "period", "limit"), [(1, 1.1, 0.02), (1, 1.5, 0.02), (1, 0.8, 0.02), (7, 1.2, 0.05)]
)
def test_the_phase_is_followed_at_another_pace_and_of_another_person(walk, seed, period, limit):
    _, cycle, begins = walk
    made = synth.gait("walk", repetitions=6, rng=seed, period=period, start=0.4, noise=0.02)
    told = rl.PhaseTracker(cycle).follow(made.motion)
    whole = round(period * 120)
    assert np.sqrt(np.mean(off(told, made.phase + begins)[whole:] ** 2)) < limit
    assert all(one.found for one in told[whole:])
    assert np.mean([one.speed for one in told[whole:]]) == pytest.approx(1.0 / period, rel=0.02)


def test_another_rate_is_told_to_the_tracker(walk):
    _, cycle, begins = walk
    made = synth.gait("walk", repetitions=6, rng=1, fps=30.0)
    told = rl.PhaseTracker(cycle, fps=30.0).follow(made.motion)
    assert np.sqrt(np.mean(off(told, made.phase + begins)[33:] ** 2)) < 0.02
    with pytest.raises(ValueError, match="expected 120 frames a second, found 30; give the rate"):
        rl.PhaseTracker(cycle).follow(made.motion)


def test_it_is_causal(walk):
    made, cycle, _ = walk
    whole = rl.PhaseTracker(cycle).follow(made.motion)
    assert rl.PhaseTracker(cycle).follow(made.motion[:200]) == whole[:200]


def test_who_was_lost_is_found_within_a_cycle(walk):
    made, cycle, begins = walk
    lost = synth.wander(4.0, rng=2).motion
    again = synth.gait("walk", repetitions=4, rng=1, start=0.55)
    tracker = rl.PhaseTracker(cycle)
    tracker.follow(made.motion)
    strange = tracker.follow(replace(lost, root_path=0.0 * lost.root_path))
    assert not any(one.found for one in strange[-240:])
    told = tracker.follow(again.motion)
    period = round(again.period * 120)
    assert all(one.found for one in told[period:])
    assert np.abs(off(told, again.phase + begins)[period:]).max() < 0.05


def test_who_stands_still_is_not_followed(walk):
    made, cycle, _ = walk
    tracker = rl.PhaseTracker(cycle)
    tracker.follow(made.motion)
    told = [tracker.frame(made.motion.rotations[-1]) for _ in range(600)]
    assert not told[-1].found


def test_the_next_event_comes_when_it_was_told(walk):
    made, cycle, _ = walk
    told = rl.PhaseTracker(cycle).follow(made.motion)
    names = [one.event for one in told[200:]]
    assert set(names) == {
        f"{side} {what}" for side in ("left", "right") for what in ("contact", "off")
    }
    changes = [k for k, (one, after) in enumerate(pairwise(names)) if one != after]
    for number in changes[:-1]:
        ahead = told[200 + number + 1].seconds * 120
        after = min(k for k in changes if k > number)
        assert ahead == pytest.approx(after - number, abs=4)


def test_signs_of_quaternions_do_not_matter(walk):
    made, cycle, _ = walk
    signs = np.random.default_rng(0).choice([-1.0, 1.0], size=made.motion.rotations.shape[:2])
    turned = replace(made.motion, rotations=made.motion.rotations * signs[..., None])
    told, same = (rl.PhaseTracker(cycle).follow(one) for one in (turned, made.motion))
    assert np.allclose(off(told, np.array([one.phase for one in same])), 0.0, atol=1e-6)


def test_other_bodies_and_frames_are_refused(walk):
    _, cycle, _ = walk
    tracker = rl.PhaseTracker(cycle)
    with pytest.raises(rl.SkeletonMismatch, match="joints only in the first"):
        tracker.follow(synth.gait("trot").motion)
    with pytest.raises(ValueError, match=r"expected rotations of shape \(19, 4\), found \(18, 4\)"):
        tracker.frame(np.ones((18, 4)))
    with pytest.raises(ValueError, match="expected finite rotations"):
        tracker.frame(np.full((19, 4), np.nan))
    still = np.tile([1.0, 0.0, 0.0, 0.0], (19, 1))
    assert tracker.frame(still).phase >= 0.0  # the frame refused left nothing behind
    points = synth.as_points(synth.gait("walk").motion)
    with pytest.raises(rl.SkeletonMismatch, match="found one of points"):
        rl.PhaseTracker(rl.find_cycles(points)[0])


def announced(motion):
    finder = rl.PeriodFinder(motion.skeleton, motion.fps)
    return [finder.frame(rotations) for rotations in motion.rotations]


@pytest.mark.parametrize("kind", ["walk", "run", "jacks", "trot"])
@pytest.mark.parametrize("fps", [120.0, 30.0])
def test_a_period_is_told_within_one_of_the_third_repetition(kind, fps):
    made = synth.gait(kind, repetitions=6, fps=fps, noise=0.01)
    told = announced(made.motion)
    first = next(number for number, one in enumerate(told) if one is not None)
    assert 2.8 < first / fps / made.period < 4.0
    assert told[-1].period == pytest.approx(made.period, rel=0.03)
    assert told[-1].repetitions == pytest.approx(6.0, abs=0.4)
    assert told[-1].alike > 0.9


def test_random_motion_is_no_period_and_one_ends():
    made = synth.gait("walk", repetitions=5, fps=60.0)
    lost = synth.wander(40.0, rng=5, fps=60.0)
    told = announced(synth.sequence(lost, made, lost).motion)
    assert not any(told[: len(lost.motion)])
    assert any(told)
    assert told[-1] is None


def test_the_finder_forgets_and_goes_on():
    made = synth.gait("jacks", repetitions=60, fps=30.0)
    told = announced(made.motion)
    assert told[-1].period == pytest.approx(made.period, rel=0.02)
    assert told[-1].repetitions == pytest.approx(60.0, abs=2.0)


def test_the_finder_refuses_what_is_no_frame():
    finder = rl.PeriodFinder(synth.humanoid(), 60.0)
    with pytest.raises(ValueError, match=r"expected rotations of shape \(19, 4\)"):
        finder.frame(np.ones(4))
    finder.frame(np.ones((19, 4)))  # at 60 a second every other frame is looked at
    with pytest.raises(ValueError, match="expected finite rotations"):
        finder.frame(np.full((19, 4), np.nan))
