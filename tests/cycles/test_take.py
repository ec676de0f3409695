"""One repetition as it was played, and when the default takes it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.cycles.closing import closed_curve, closed_steps, padded
from roundelay.cycles.models import cycle_models
from roundelay.cycles.models.take import take_cycle
from roundelay.cycles.swings import swings
from roundelay.geometry import rotations as rot
from roundelay.motion.features import point_cloud

TAKE = rl.Options(method="take")


def jittered(kind="walk", repetitions=4.3, seed=3):
    """A gait each of whose repetitions comes at its own pace and strength."""
    made = synth.gait(kind, repetitions=repetitions, noise=0.002, seed=seed).motion
    turns = np.arange(len(made)) / len(made)
    strength = 1.0 + 0.1 * np.sin(2 * np.pi * 1.3 * turns)
    rest = rot.mean(made.rotations)
    away = rot.to_rotation_vector(rot.multiply(rot.conjugate(rest), made.rotations))
    turned = rot.from_rotation_vector(strength[:, None, None] * away)
    return replace(made, rotations=rot.multiply(rest, turned))


def accented():
    """A walk with a wave whose snap comes a little earlier or later every time: no mean has it."""
    made = synth.gait("walk", repetitions=6).motion
    names, rotations = made.skeleton.names, made.rotations.copy()
    turns = np.arange(len(made)) / len(made) * 6
    late = np.array([0.0, 0.12, -0.1, 0.08, -0.12, 0.02])[np.floor(turns).astype(int) % 6]
    snap = 1.6 * np.exp(-0.5 * (((turns % 1.0) - 0.5 - late) / 0.05) ** 2)
    turned = rot.from_rotation_vector(snap[:, None] * np.array([1.0, 0.0, 0.0]))
    rotations[:, names.index("LeftArm")] = turned
    rotations[:, names.index("LeftForeArm")] = rot.identity(len(made))
    return replace(made, rotations=rotations)


def test_what_closes_a_curve_bends_it_least():
    values = np.random.default_rng(0).normal(size=(41, 3)).cumsum(axis=0)
    change = closed_curve(padded(values, 2)[: 41 + 5], 2)(np.arange(41) / 41) - values
    # Nothing but a parabola is added, and nothing on average.
    assert np.abs(np.diff(change, n=3, axis=0)).max() < 1e-9
    assert np.abs(change.mean(axis=0)).max() < 0.05 * np.abs(change).max()
    flat = closed_curve(padded(np.ones((40, 2)), 1)[:43], 1)
    assert np.allclose(flat(np.arange(40) / 40), 1.0)


def test_closed_steps_keep_their_sum():
    steps = np.random.default_rng(1).normal(size=(56, 3))
    velocity = closed_steps(steps, 3)
    assert np.allclose(velocity.integral([1.0])[0], steps[3:-3].sum(axis=0))


@pytest.mark.parametrize("turning", [0.0, 0.5])
def test_it_is_a_repetition_frame_by_frame(turning):
    motion = synth.gait("walk", repetitions=4.3, turning=turning, noise=0.001, seed=5).motion
    (cycle,) = rl.find_cycles(motion, TAKE)
    assert cycle.method == "take"
    frames = np.flatnonzero(np.isfinite(cycle.phase))
    shown = cycle.rotations(cycle.phase[frames])[:, 1:]
    away = rot.angle_between(shown, motion.rotations[frames, 1:]).mean(axis=1)
    # The one repetition, but for what closes it.
    assert np.quantile(away, 0.2) < 0.003
    mean = rl.find_cycles(motion)[0]
    assert cycle.period == pytest.approx(mean.period, abs=1.0 / motion.fps)
    assert cycle.turning == pytest.approx(mean.turning, abs=0.05)
    assert cycle.speed == pytest.approx(mean.speed, rel=0.05)


def test_the_seam_is_no_more_than_a_step():
    motion = jittered()
    (cycle,) = rl.find_cycles(motion, TAKE)
    figures = rl.quality(cycle, motion)
    assert figures.seam_velocity < 1.5 * figures.capture_velocity
    assert figures.seam_rotation <= 1.1 * figures.step_rotation


def test_a_closed_pass_is_taken_whole():
    motion = synth.gait("walk", repetitions=1.0).motion
    (cycle,) = rl.find_cycles(motion, TAKE)
    assert cycle.period == pytest.approx(1.1, abs=0.02)


def test_the_default_keeps_accents_that_a_mean_would_lose():
    """The evidence is the legs'; the arm's snap comes at its own time."""
    evidence = rl.find_periodic(synth.gait("walk", repetitions=6).motion)[0]
    motion, phase = accented(), evidence.turns
    chosen, mean = (
        cycle_models[method].fit(motion, phase, evidence, rl.Options())
        for method in ("auto", "harmonic")
    )
    assert chosen.method == "take"
    kept = [
        {swing.limb: swing.kept for swing in swings(one.sample(foot_lock=False), motion, evidence)}
        for one in (chosen, mean)
    ]
    assert min(kept[1].values()) < 0.8 < min(kept[0].values())
    legs = replace(evidence.behaviour, whole=False, limbs=("left leg", "right leg"))
    alone = replace(evidence, behaviour=legs)
    assert cycle_models["auto"].fit(motion, phase, alone, rl.Options()).method == "harmonic"


def test_the_default_is_the_mean_where_it_keeps_them():
    motion = synth.gait("walk", repetitions=4.3, noise=0.01).motion
    assert rl.find_cycles(motion)[0].method == "harmonic"
    mean = rl.find_cycles(motion, rl.Options(method="harmonic"))[0]
    assert np.array_equal(mean.pose.sine, rl.find_cycles(motion)[0].pose.sine)


def test_the_nearest_repetition_is_taken():
    """Of four, one of which is done with half the swing."""
    made = synth.gait("walk", repetitions=4, noise=0.002, seed=2)
    motion, period = made.motion, len(made.motion) // 4
    rotations, rest = motion.rotations.copy(), rot.mean(motion.rotations)
    weak = slice(period, 2 * period)
    half = rot.slerp(np.broadcast_to(rest, rotations[weak].shape), rotations[weak], np.full(1, 0.5))
    rotations[weak, 1:] = half[:, 1:]
    motion = replace(motion, rotations=rotations)
    (cycle,) = rl.find_cycles(motion, rl.Options(method="take", uncertain=True))[:1]
    whole = point_cloud(made.motion).std(axis=0).sum()
    assert point_cloud(cycle.sample(foot_lock=False)).std(axis=0).sum() > 0.9 * whole


def test_a_cycle_without_evidence_is_refused():
    motion = synth.gait("walk", repetitions=3).motion
    cycle = rl.find_cycles(motion)[0]
    with pytest.raises(ValueError, match="its evidence and phase"):
        take_cycle(replace(cycle, phase=None), motion)
