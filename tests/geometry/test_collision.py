"""Capsules along bones: distances of segments, and limbs that meet."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from roundelay import synth
from roundelay.geometry import rotations as rot
from roundelay.geometry.collision import collisions, nearest_points
from roundelay.geometry.skeleton import Skeleton

points = arrays(float, (4, 3), elements=st.integers(-3, 3).map(float))


def by_sampling(p, p_end, q, q_end):
    along = np.linspace(0, 1, 201)[:, None]
    first, second = p + along * (p_end - p), q + along * (q_end - q)
    return np.linalg.norm(first[:, None] - second, axis=-1).min()


@settings(max_examples=150, deadline=None)
@given(points)
def test_distance_of_segments_is_the_least_of_their_points(ends):
    p, p_end, q, q_end = ends
    near, other = nearest_points((p[None], p_end[None]), (q[None], q_end[None]))
    found = np.linalg.norm(near - other)
    sampled = by_sampling(p, p_end, q, q_end)
    assert found <= sampled + 1e-9
    assert found >= sampled - 0.06


@pytest.fixture(scope="module")
def crossing():
    """Both arms swing across the chest, one through the other, at frame 30 of 60."""
    skeleton = synth.humanoid()
    rotations = np.tile([1.0, 0.0, 0.0, 0.0], (60, skeleton.n_joints, 1))
    swing = np.sin(np.pi * np.arange(60) / 60)
    forward = rot.from_rotation_vector([-np.pi / 2, 0.0, 0.0])
    for side, sign in (("Left", -1.0), ("Right", 1.0)):
        inward = rot.from_rotation_vector(np.outer(swing, [0.0, 0.7 * sign, 0.0]))
        rotations[:, skeleton.index(f"{side}Arm")] = rot.multiply(inward, forward)
    return skeleton, rotations


def test_arms_that_cross_meet_at_their_frame(crossing):
    found = collisions(*crossing)
    assert found
    for met in found:
        assert {name.removeprefix("Left").removeprefix("Right") for name in met.bones} <= {
            "ForeArm",
            "Hand",
        }
        assert met.start <= met.frame < met.stop
        assert met.depth > 0.0
        assert 0 < met.start < 30 < met.stop < 60


def test_thin_limbs_meet_less(crossing):
    thin, thick = collisions(*crossing, thickness=0.5), collisions(*crossing)
    assert sum(met.stop - met.start for met in thin) < sum(met.stop - met.start for met in thick)
    with pytest.raises(ValueError, match="positive thickness"):
        collisions(*crossing, thickness=0.0)


def test_a_walk_at_ease_meets_nothing():
    motion = synth.gait("walk").motion
    assert collisions(motion.skeleton, motion.rotations) == []


def test_a_single_joint_meets_nothing(crossing):
    skeleton, _ = crossing
    assert collisions(skeleton, np.tile([1.0, 0, 0, 0], (1, skeleton.n_joints, 1))) == []


def test_the_way_from_a_root_on_the_ground_is_no_bone(crossing):
    skeleton, rotations = crossing
    # A root below the hips, so that the way to them passes between the feet.
    parents = (-1, *(parent + 1 for parent in skeleton.parents))
    offsets = np.concatenate([np.zeros((1, 3)), skeleton.offsets])
    offsets[1] = [0.0, 0.92, 0.0]
    grounded = Skeleton(("Root", *skeleton.names), parents, offsets)
    held = np.concatenate([np.tile([1.0, 0.0, 0.0, 0.0], (60, 1, 1)), rotations], axis=1)
    names = {name for met in collisions(grounded, held) for name in met.bones}
    assert names == {name for met in collisions(skeleton, rotations) for name in met.bones}
    together = held.copy()
    for side, sign in (("Left", -1.0), ("Right", 1.0)):
        inward = rot.from_rotation_vector([0.0, 0.0, 0.08 * sign])
        together[:, grounded.index(f"{side}UpLeg")] = inward
    assert "Hips" not in {name for met in collisions(grounded, together) for name in met.bones}
