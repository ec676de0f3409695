"""Captures of one closed period: a loop where the ends meet, else why not."""

import numpy as np
import pytest

from roundelay import (
    LiftError,
    NoPeriod,
    Options,
    PoseArray,
    TooShort,
    TopologyOptions,
    find_cycles,
    find_periodic,
    synth,
)
from roundelay.geometry import rotations as rot
from roundelay.motion.motion import Motion


def seam_and_steps(loop: Motion) -> tuple[float, float]:
    steps = rot.angle_between(loop.rotations, np.roll(loop.rotations, 1, axis=0)).max(axis=1)
    return float(steps[0]), float(steps[1:].max())


@pytest.mark.parametrize("repeats_first", [False, True])
@pytest.mark.parametrize("kind", ["walk", "run", "jacks", "spin"])
def test_one_period_whose_ends_meet_is_a_loop(kind: synth.Gait, repeats_first: bool) -> None:
    made = synth.gait(kind, repetitions=2.0, period=1.0)
    cycle = find_cycles(made.motion[: 120 + repeats_first])[0]
    assert cycle.evidence.closed
    assert cycle.evidence.repetitions == 1.0
    assert cycle.period == pytest.approx(1.0, abs=0.7 / 120)
    seam, step = seam_and_steps(cycle.sample(in_place=True))
    assert seam <= 1.3 * step


def test_ends_apart_are_no_loop_and_it_says_what_to_try() -> None:
    made = synth.gait("walk", repetitions=2.0, period=1.0)
    with pytest.raises(NoPeriod, match="give them by --frames START:STOP"):
        find_cycles(made.motion[:100])


def test_frames_chosen_by_hand_may_lie_a_few_steps_apart() -> None:
    made = synth.gait("walk", repetitions=2.0, period=1.0)
    with pytest.raises(NoPeriod):
        find_cycles(made.motion[:118])
    cycle = find_cycles(made.motion, Options(frames=(0, 118)))[0]
    seam, step = seam_and_steps(cycle.sample(in_place=True))
    assert seam <= 1.5 * step


def test_standing_still_is_no_loop() -> None:
    rng = np.random.default_rng(0)
    made = synth.gait("walk").motion
    still = made.rotations[:1] * np.ones((90, 1, 1))
    shaken = rot.multiply(still, rot.from_rotation_vector(rng.normal(scale=1e-4, size=(90, 19, 3))))
    with pytest.raises(NoPeriod):
        find_cycles(Motion(made.skeleton, shaken, made.root_path[:90] * 0.0, 1 / 60))


def test_too_few_frames_are_too_short() -> None:
    with pytest.raises(TooShort, match="8 frames"):
        find_cycles(synth.gait("walk").motion[:7])


def test_a_closed_capture_has_the_classes_that_it_has() -> None:
    made = synth.gait("walk", repetitions=2.0, period=1.0)
    with pytest.raises(NoPeriod, match="none of them class 999"):
        find_cycles(made.motion[:120], Options(topology=TopologyOptions(class_index=999)))


def test_a_class_that_cannot_be_lifted_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    def unliftable(*_: object, **__: object) -> None:
        raise LiftError("class 0 lifts to no integer cocycle")

    monkeypatch.setattr("roundelay.timeline.evidence.circular_coordinate", unliftable)
    made = synth.gait("walk", repetitions=2.0, period=1.0).motion
    with pytest.raises(NoPeriod, match="lifts to no integer cocycle"):
        find_cycles(made[:120])


def test_noise_is_no_closed_pass() -> None:
    """In noise any two poses are a step apart, the ends as well."""
    values = np.random.default_rng(1).normal(size=(200, 4, 3))
    with pytest.raises(NoPeriod):
        find_periodic(PoseArray(("a", "b", "c", "d"), values, 30.0))
