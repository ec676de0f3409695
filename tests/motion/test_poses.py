"""Poses as points."""

from __future__ import annotations

import numpy as np
import pytest

from roundelay import synth
from roundelay.base.errors import SkeletonMismatch
from roundelay.geometry import rotations as rot
from roundelay.motion.features import MotionPoses, first_differences, point_cloud
from roundelay.motion.motion import Motion
from roundelay.motion.poses import leading_rest_pose, principal_components, with_velocity


@pytest.fixture(scope="module")
def walk() -> Motion:
    return synth.gait("walk", repetitions=2.2, turning=0.8).motion


def turned(motion: Motion, angle: float) -> Motion:
    turn = rot.from_rotation_vector(angle * motion.up_vector)
    rotations = motion.rotations.copy()
    rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
    path = rot.rotate(turn, motion.root_path) + np.array([3.0, 0.0, -1.0])
    return Motion(motion.skeleton, rotations, path, motion.frame_time)


@pytest.mark.parametrize("features", ["positions", "heading", "quaternions", "angles"])
def test_points_do_not_depend_on_where_the_body_stands(walk, features):
    there = point_cloud(turned(walk, 1.1), features)
    assert np.allclose(there, point_cloud(walk, features), atol=1e-12)


def test_positions_do_not_depend_on_the_unit(walk):
    assert np.allclose(point_cloud(walk.scaled(39.37)), point_cloud(walk))


def test_weights_and_joints(walk):
    one = point_cloud(walk, joints=[3, 4])
    weights = np.zeros(walk.skeleton.n_joints)
    weights[[3, 4]] = 2.0
    weighted = point_cloud(walk, weights=weights)
    assert one.shape == (len(walk), 6)
    assert np.allclose(np.linalg.norm(weighted, axis=1), 2 * np.linalg.norm(one, axis=1))


def test_bad_features_and_no_joints(walk):
    with pytest.raises(ValueError, match="expected features among"):
        point_cloud(walk, "shape")
    with pytest.raises(SkeletonMismatch, match="at least one joint"):
        point_cloud(walk, joints=[0])


def test_angles_are_unwrapped():
    spin = rot.from_rotation_vector(np.linspace(0, 15, 200)[:, None] * np.array([0.0, 1.0, 0.0]))
    skeleton = synth.humanoid()
    rotations = rot.identity(200, skeleton.n_joints)
    rotations[:, 5] = spin
    motion = Motion(skeleton, rotations, np.zeros((200, 3)), 0.01)
    angles = point_cloud(motion, "angles", joints=[5])
    assert np.allclose(angles[:, 1], np.linspace(0, 15, 200), atol=1e-9)


def test_first_differences_are_the_body_s_own(walk):
    rates = first_differences(walk)
    assert rates.shape == (len(walk), 6)
    assert np.allclose(first_differences(turned(walk, -2.0)), rates)
    turning = rates[:, 3 + walk.up].mean() * 1.1
    assert turning == pytest.approx(0.8, rel=0.02)
    assert first_differences(walk[:1]).shape == (1, 6)


def test_first_differences_are_a_second_whatever_the_rate(walk):
    """Six columns: a root that glides and spins about one axis, at two rates."""
    skeleton = synth.humanoid()
    for fps in (30.0, 120.0):
        time = np.arange(int(2 * fps)) / fps
        rotations = rot.identity(len(time), skeleton.n_joints)
        rotations[:, 0] = rot.from_rotation_vector(time[:, None] * np.array([1.5, 0.0, 0.0]))
        path = time[:, None] * np.array([0.0, 0.0, 2.0]) * skeleton.size
        rates = first_differences(Motion(skeleton, rotations, path, 1.0 / fps))
        speed = np.linalg.norm(rates[:, :3], axis=1)
        assert np.allclose(speed, 2.0)
        assert np.allclose(np.linalg.norm(rates[:, 3:], axis=1), 1.5)


def test_a_configuration_is_angles_and_the_roots_rates(walk):
    cloud = point_cloud(walk, "configuration")
    angles = point_cloud(walk, "angles")
    assert np.array_equal(cloud, np.hstack([angles, first_differences(walk)]))
    poses = MotionPoses(walk, "configuration", "length")
    root = walk.skeleton.names[0]
    assert poses.names[-2:] == (f"velocity of {root}", f"turning of {root}")
    assert poses.values.shape == (len(walk), walk.skeleton.n_joints + 1, 3)
    assert np.array_equal(poses.values[:, -2:].reshape(-1, 6), first_differences(walk))


def test_velocities_of_a_sinusoid_make_a_circle():
    phase = 2 * np.pi * np.arange(300) / 100.0
    cloud = with_velocity(np.sin(phase)[:, None], [(0, 300)], 100.0)[10:-10]
    assert np.allclose(np.linalg.norm(cloud, axis=1), 1.0, atol=0.02)


def test_velocities_of_a_line_are_exact_up_to_the_ends():
    line = np.outer(np.arange(50.0), [1.0, -2.0])
    cloud = with_velocity(line, [(0, 20), (20, 50)], 48.0)
    assert np.allclose(cloud[:, 2:] * 2 * np.pi / 48.0, [1.0, -2.0])


def test_principal_components_keep_distances():
    rng = np.random.default_rng(2)
    points = rng.normal(size=(40, 3)) @ rng.normal(size=(3, 12))
    reduced = principal_components(points, 0.999999)
    assert reduced.shape[1] == 3
    assert np.allclose(
        np.linalg.norm(reduced[1:] - reduced[:-1], axis=1),
        np.linalg.norm(points[1:] - points[:-1], axis=1),
    )
    assert principal_components(points, 2).shape == (40, 2)


def test_a_rest_pose_in_front_is_noticed(jumps):
    points = point_cloud(jumps)
    assert leading_rest_pose(points)
    assert not leading_rest_pose(points[1:])
