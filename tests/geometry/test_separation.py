"""Limbs that pass through each other, moved apart by the least smooth turns."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roundelay import synth
from roundelay.geometry import rotations as rot
from roundelay.geometry.separation import Body, _non_negative, deepest, separate, turned

FRAMES = 240


def crossing(inward: float) -> Body:
    """Both arms held ahead come together once in two seconds, by so many radians."""
    skeleton = synth.humanoid()
    rotations = np.tile([1.0, 0.0, 0.0, 0.0], (FRAMES, skeleton.n_joints, 1))
    swing = np.exp(-0.5 * ((np.arange(FRAMES) - 120) / 15.0) ** 2)
    forward = rot.from_rotation_vector([-np.pi / 2, 0.0, 0.0])
    arms = skeleton.indices(["LeftArm", "RightArm"])
    for joint, sign in zip(arms, (-1.0, 1.0), strict=True):
        turn = rot.from_rotation_vector(np.outer(swing, [0.0, inward * sign, 0.0]))
        rotations[:, joint] = rot.multiply(turn, forward)
    return Body(skeleton, rotations, None, arms, np.ones((FRAMES, 2)), 120.0, closed=True)


@pytest.fixture(scope="module")
def touching() -> Body:
    return crossing(0.31)


def met_after(body: Body, turns: np.ndarray) -> dict:
    rotations = body.rotations.copy()
    rotations[:, body.joints] = rot.normalize(turned(rotations[:, body.joints], turns))
    return deepest(body.skeleton, rotations)


def test_arms_share_a_small_smooth_turn(touching):
    assert ("LeftHand", "RightHand") in deepest(touching.skeleton, touching.rotations)
    found = separate(touching, {})
    assert met_after(touching, found.turns) == {}
    angles = 2.0 * np.arctan(np.linalg.norm(found.turns, axis=-1))
    assert np.allclose(angles[:, 0], angles[:, 1], atol=1e-6)
    assert np.radians(0.5) < angles.max() < np.radians(5.0)
    assert max(found.angles.values()) == pytest.approx(angles.max())
    # Nothing half a second away, and no faster than a bump of a tenth of a second.
    assert angles[:40].max() < 1e-3 * angles.max()
    assert np.abs(np.diff(angles[:, 0], n=2)).max() * 120.0**2 < 2.0 * angles.max() / 0.1**2
    for pair, mask in found.met.items():
        assert pair in deepest(touching.skeleton, touching.rotations)
        assert mask[120]
        assert not mask[:90].any()


def test_no_smaller_turn_does(touching):
    turns = separate(touching, {}).turns
    assert met_after(touching, 0.8 * turns)


def test_the_seam_is_as_any_other_frame(touching):
    moved = replace(touching, rotations=np.roll(touching.rotations, 120, axis=0))
    turns = separate(touching, {}).turns
    assert np.allclose(separate(moved, {}).turns, np.roll(turns, 120, axis=0), atol=1e-6)


def test_what_small_turns_cannot_part_stays():
    body = crossing(0.9)
    found = separate(body, {})
    assert deepest(body.skeleton, body.rotations)
    assert found.met == {}
    assert not found.turns.any()


def test_what_the_limits_allow_stays(touching):
    limits = deepest(touching.skeleton, touching.rotations)
    assert not separate(touching, limits).turns.any()
    half = {pair: 0.5 * depth for pair, depth in limits.items()}
    left = met_after(touching, separate(touching, half).turns)
    assert left
    assert all(depth <= half[pair] for pair, depth in left.items())


def test_a_joint_that_is_not_free_does_not_turn(touching):
    freedom = np.ones((FRAMES, 2))
    freedom[:, 0] = 0.0
    found = separate(replace(touching, freedom=freedom), {})
    assert not found.turns[:, 0].any()
    assert found.turns[:, 1].any()
    assert met_after(touching, found.turns) == {}
    assert separate(replace(touching, freedom=0.0 * freedom), {}).met == {}
    none = replace(touching, joints=touching.joints[:0], freedom=freedom[:, :0])
    assert separate(none, {}).met == {}


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 12), st.integers(0, 10_000))
def test_the_least_push_meets_the_conditions_of_karush_kuhn_and_tucker(count, seed):
    rng = np.random.default_rng(seed)
    levers = rng.normal(size=(count, 4))
    gram, target = levers @ levers.T + 0.1 * np.eye(count), rng.normal(size=count)
    x = _non_negative(gram, target, 1e-9)
    slope = target - gram @ x
    assert np.all(x >= 0.0)
    assert np.all(slope <= 1e-8)
    assert np.all(np.abs(slope[x > 0.0]) < 1e-8)
