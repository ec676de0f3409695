import numpy as np
import pytest

from roundelay import Skeleton
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics, heading, vertical_axis

ARM = Skeleton(("root", "upper", "lower", "other"), (-1, 0, 1, 0), np.eye(4)[:, :3] * 2.0)


def slowly(skeleton, rotations, path, local):
    """Place joints one by one with matrices."""
    places, turns = np.zeros((*rotations.shape[:2], 3)), np.zeros((*rotations.shape[:2], 3, 3))
    for frame, pose in enumerate(rot.to_matrix(rotations)):
        for joint, parent in enumerate(skeleton.parents):
            if parent < 0:
                places[frame, joint], turns[frame, joint] = path[frame], pose[joint]
                continue
            above = turns[frame, parent]
            places[frame, joint] = places[frame, parent] + above @ local[frame, joint]
            turns[frame, joint] = above @ pose[joint]
    return places, turns


@pytest.fixture
def pose():
    rng = np.random.default_rng(0)
    return rot.normalize(rng.normal(size=(5, 4, 4))), rng.normal(size=(5, 3))


def test_joints_one_by_one(pose):
    local = np.broadcast_to(ARM.offsets, (5, 4, 3))
    places, turns = forward_kinematics(ARM, *pose)
    expected = slowly(ARM, *pose, local)
    np.testing.assert_allclose(places, expected[0], atol=1e-14)
    np.testing.assert_allclose(rot.to_matrix(turns), expected[1], atol=1e-14)


def test_translations_replace_offsets(pose):
    local = np.random.default_rng(1).normal(size=(5, 4, 3))
    places, _ = forward_kinematics(ARM, *pose, translations=local)
    np.testing.assert_allclose(places, slowly(ARM, *pose, local)[0], atol=1e-14)


def test_the_root_stands_at_the_origin_by_default(pose):
    places, _ = forward_kinematics(ARM, pose[0])
    moved, _ = forward_kinematics(ARM, *pose)
    np.testing.assert_allclose(places + pose[1][:, None], moved, atol=1e-14)


@pytest.mark.parametrize("up", [0, 1, 2])
def test_heading(up):
    angles = np.linspace(-3.1, 3.1, 30)
    axis = np.eye(3)[up]
    turns = rot.from_rotation_vector(angles[:, None] * axis)
    np.testing.assert_allclose(heading(turns, up), angles, atol=1e-14)
    np.testing.assert_allclose(heading(-turns, up), angles, atol=1e-14)
    tilt = rot.from_rotation_vector(0.5 * np.eye(3)[(up + 1) % 3])
    tilted = rot.multiply(turns, tilt)
    np.testing.assert_allclose(heading(tilted, up), angles, atol=1e-14)


def test_vertical_axis():
    rng = np.random.default_rng(2)
    standing = rng.uniform(-0.3, 0.3, (40, 5, 3))
    standing[:, 0, 1] = 1.0
    standing[:, 1:, 1] = [0.0, 0.5, 1.2, 1.6]
    standing[..., [0, 2]] += np.linspace(0, 3, 40)[:, None, None]
    assert vertical_axis(standing, 1.8) == 1
    assert vertical_axis(standing[..., [0, 2, 1]], 1.8) == 2
