"""Alignment, blends and transitions."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.cycles.edit.align import align, mirrored, shifted
from roundelay.geometry import rotations as rot
from roundelay.motion.features import point_cloud
from roundelay.phase.harmonic import HarmonicCurve


@pytest.fixture(scope="module")
def walk() -> rl.Cycle:
    return rl.find_cycles(synth.gait("walk", repetitions=2.5, turning=0.3).motion)[0]


@pytest.fixture(scope="module")
def run() -> rl.Cycle:
    return rl.find_cycles(synth.gait("run", repetitions=2.5, start=0.4).motion)[0]


def poses(cycle: rl.Cycle, phase: np.ndarray) -> np.ndarray:
    return point_cloud(cycle.at(phase, frame_time=0.01))


def test_shifting_is_exact(walk):
    phase = np.linspace(0.0, 1.0, 17)
    moved = shifted(walk, 0.37)
    assert np.allclose(poses(moved, phase), poses(walk, phase + 0.37))
    assert np.allclose(moved.velocity.constant, walk.velocity.constant)


def test_mirroring_a_cycle_is_mirroring_its_motion(walk):
    phase = np.linspace(0.0, 1.5, 20)
    there = mirrored(walk).at(phase, frame_time=0.01).positions()
    assert np.allclose(there, walk.at(phase, frame_time=0.01).mirror().positions())
    again = mirrored(mirrored(walk)).at(phase, frame_time=0.01).positions()
    assert np.allclose(again, walk.at(phase, frame_time=0.01).positions())


@pytest.mark.parametrize("offset", [0.0, 0.13, 0.5, 0.81])
def test_alignment_finds_the_phase_and_the_heading(walk, offset):
    turned = walk.at(np.arange(400) / 130.0, frame_time=walk.period / 130.0)
    spin = rot.from_rotation_vector([0.0, 1.2, 0.0])
    rotations = turned.rotations.copy()
    rotations[:, 0] = rot.multiply(spin, rotations[:, 0])
    other = rl.find_cycles(
        rl.Motion(turned.skeleton, rotations, rot.rotate(spin, turned.root_path), turned.frame_time)
    )[0]
    found = align(walk, shifted(other, offset))
    assert found.distance < 0.002
    phase = np.linspace(0, 1, 30)
    assert np.allclose(poses(found.cycle, phase), poses(walk, phase), atol=0.02)
    assert np.allclose(found.cycle.velocity.constant, walk.velocity.constant, atol=0.05)


def test_mirroring_is_used_where_it_fits_better(walk):
    other = mirrored(walk)
    plain, better = align(walk, other), align(walk, other, mirror=True)
    assert better.mirrored
    assert better.distance < 1e-6 < plain.distance


def test_feet_can_decide_about_the_phase():
    walk = rl.find_cycles(synth.gait("walk", repetitions=2.6, fps=60).motion)[0]
    legs = [n for n, name in enumerate(walk.skeleton.names) if re.search("Hips|Leg|Foot|Toe", name)]
    other = np.repeat(~np.isin(np.arange(walk.skeleton.n_joints), legs), 4)
    late = shifted(walk, 0.25).pose
    # All above the hips moves thrice as far, a quarter of a period late.
    dancing = replace(
        walk.pose,
        sine=np.where(other, 3.0 * late.sine, walk.pose.sine),
        cosine=np.where(other, 3.0 * late.cosine, walk.pose.cosine),
    )
    dance = shifted(replace(walk, pose=dancing), 0.3)
    assert abs(align(walk, dance).offset - 0.7) > 0.05
    assert abs(align(walk, dance, by="contacts").offset - 0.7) < 0.03
    with pytest.raises(ValueError, match="contacts"):
        align(walk, dance, by="eye")


def test_poses_decide_where_there_are_no_feet():
    rope = rl.Skeleton(("a", "b", "c"), (-1, 0, 1), np.array([[0, 0, 0], [0, 1, 0], [0, 1, 0]]))
    angle = 2 * np.pi * np.arange(300) / 60
    vectors = np.zeros((300, 3, 3))
    vectors[:, 1, 0], vectors[:, 1, 2] = np.sin(angle), np.cos(angle)
    swung = rl.Motion(rope, rot.from_rotation_vector(vectors), np.zeros((300, 3)), 1 / 60)
    cycle = rl.find_cycles(swung)[0]
    found = align(cycle, shifted(cycle, 0.2), by="contacts")
    assert found.offset == pytest.approx(0.8, abs=0.01)


def test_blends_go_from_one_to_the_other_without_a_turn_back(walk, run):
    space = rl.CycleSpace.of([walk, run])
    shares = np.linspace(0.0, 1.0, 11)
    cycles = [space.cycle([1.0 - share, share]) for share in shares]
    periods = [cycle.period for cycle in cycles]
    speeds = [np.linalg.norm(cycle.velocity.constant) / cycle.period for cycle in cycles]
    assert np.all(np.diff(periods) < 0.0)
    assert np.all(np.diff(speeds) > 0.0)
    phase = np.linspace(0, 1, 20)
    assert np.allclose(poses(cycles[0], phase), poses(walk, phase))
    assert cycles[-1].period == pytest.approx(run.period)


def test_a_space_evaluates_what_its_blend_does(walk, run):
    space = rl.CycleSpace.of([walk, run])
    phase = np.linspace(0, 2, 13)
    assert np.allclose(space.rotations([0.3, 0.7], phase), space.cycle([0.3, 0.7]).rotations(phase))


def test_a_space_of_spins_evaluates_whole_turns():
    spins = [
        rl.find_cycles(synth.gait("spin", repetitions=3, seed=seed).motion)[0] for seed in (0, 1)
    ]
    space, phase = rl.CycleSpace.of(spins), np.linspace(0, 2, 13)
    shares = np.linspace([1.0, 0.0], [0.0, 1.0], 13)
    alone = [space.cycle(w).rotations([x])[0] for w, x in zip(shares, phase, strict=True)]
    assert np.allclose(space.rotations(shares, phase), alone)


def test_weights_at_a_speed(walk, run):
    space = rl.CycleSpace.of([run, walk])
    slow, fast = (np.linalg.norm(c.velocity.constant) / c.period for c in (walk, run))
    assert space.weights_at(slow) == pytest.approx([0.0, 1.0])
    assert space.weights_at(0.5 * (slow + fast)) == pytest.approx([0.5, 0.5])
    with pytest.raises(ValueError, match="expected a speed from"):
        space.weights_at(2 * fast)
    with pytest.raises(ValueError, match="speed, turning or period"):
        space.weights_at(1.0, by="mood")


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ([0.5], "expected 2 weights"),
        ([1.5, -0.5], "not negative"),
        ([0.5, 0.6], "sum of 1"),
        ([np.nan, 1.0], "not negative"),
    ],
)
def test_bad_weights_are_refused(walk, run, weights, message):
    with pytest.raises(ValueError, match=message):
        rl.blend([walk, run], weights)


def test_other_skeletons_are_refused_by_name(walk, jump_cycles):
    with pytest.raises(rl.SkeletonMismatch, match="only in the first: Chest"):
        rl.blend([walk, jump_cycles[0]], [0.5, 0.5])


def test_joints_that_turn_in_one_cycle_only_are_named(walk):
    spin = rl.find_cycles(synth.gait("spin", repetitions=3).motion)[0]
    with pytest.raises(ValueError, match="Hips"):
        rl.CycleSpace.of([walk, spin])


def test_a_transition_jumps_nowhere(walk, run):
    motion = rl.transition(walk, run, 0.6, before=0.8, after=0.8, fps=120)
    assert len(motion) == round(2.2 * 120) + 1
    places = motion.positions()
    speed = np.linalg.norm(np.diff(places, axis=0), axis=-1).max(axis=1)
    alone = [
        np.linalg.norm(np.diff(c.sample(120, periods=2).positions(), axis=0), axis=-1).max()
        for c in (walk, run)
    ]
    assert speed.max() < 1.1 * max(alone)
    first = motion.rotations[:50, 1:]
    assert np.allclose(
        np.abs(
            np.sum(
                first * walk.at(np.arange(50) / 120 / walk.period, frame_time=1).rotations[:, 1:],
                -1,
            )
        ),
        1.0,
    )


def test_bad_durations_are_refused(walk, run):
    for seconds, before in ((0.0, 1.0), (-1.0, 1.0), (61.0, 1.0), (0.5, -1.0), (0.5, 1e9)):
        with pytest.raises(ValueError, match="negative durations"):
            rl.transition(walk, run, seconds, before=before)


def stretching(cycle: rl.Cycle) -> rl.Cycle:
    """The same with bones a tenth longer at phase 1/4 and shorter at 3/4."""
    offsets = cycle.skeleton.offsets.reshape(1, -1)
    curve = HarmonicCurve(np.ones(1), offsets[0], 0.1 * offsets, 0.0 * offsets)
    return replace(cycle, translations=curve)


@pytest.mark.parametrize("both", [False, True])
def test_bones_that_change_length_go_along(walk, run, both):
    first, second = stretching(walk), stretching(run) if both else run
    space = rl.CycleSpace.of([first, second])
    phase = np.linspace(0, 1, 20)
    for weights, cycle in zip(np.eye(2), space.cycles, strict=True):
        assert np.allclose(poses(space.cycle(weights), phase), poses(cycle, phase))
    made = rl.transition(first, second, 0.3, before=0.5, after=0.5, fps=60)
    begun = np.arange(30) / (60 * walk.period)
    assert np.allclose(point_cloud(made)[:30], poses(first, begun))
    longest = np.linalg.norm(made.translations, axis=-1).max(axis=1)
    assert np.abs(np.diff(longest)).max() < 0.03 * longest.max()
    assert np.ptp(longest[-30:]) > 0.1 * longest.max() if both else np.ptp(longest[-30:]) < 1e-9


def test_cycles_with_other_verticals_are_refused(walk):
    with pytest.raises(ValueError, match="found Y and Z"):
        rl.blend([walk, replace(walk, up=2)], [0.5, 0.5])
