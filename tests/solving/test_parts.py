"""Parts of solving: names, noise, equations, centres of rotation."""

from __future__ import annotations

import numpy as np
import pytest

from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.solving import rigid, smoothing
from roundelay.solving.body import Body, Poses
from roundelay.solving.equations import Targets, marker_places, normal_equations, pose_cost
from roundelay.solving.fitting import fitted_poses, fitted_shape
from roundelay.solving.landmarks import computed, landmarks_of
from roundelay.solving.smoothing import measured_noise


@pytest.fixture
def arm():
    """Two bones with four markers each, and poses of thirty frames."""
    rng = np.random.default_rng(0)
    body = Body(
        ("upper", "lower"),
        (-1, 0),
        np.array([[0.0, 0.0, 0.0], [0.0, -0.3, 0.0]]),
        np.full((2, 3), 0.05),
        np.repeat([0, 1], 4),
        rng.normal(scale=0.1, size=(8, 3)),
        np.full((8, 3), 0.02),
        np.full((2, 3), np.inf),
        np.zeros(2),
    )
    time = np.linspace(0.0, 6.0, 30)
    turns = np.stack(
        [np.sin(time[:, None] * [[1.0, 0.7], [1.3, 0.9], [0.4, 1.1]][k]) for k in range(3)], 2
    )
    root = np.stack([np.sin(time), np.cos(time), time / 3], axis=1)
    return body, Poses(root, rot.from_rotation_vector(0.8 * turns))


def test_the_equations_point_downhill_as_the_cost_does(arm):
    body, poses = arm
    rng = np.random.default_rng(1)
    targets = Targets(
        marker_places(body, poses) + rng.normal(scale=0.004, size=(30, 8, 3)), np.full((30, 8), 1e4)
    )
    right = normal_equations(body, poses, targets).right
    for column in range(right.shape[1]):
        step = np.zeros(right.shape)
        step[:, column] = 1e-6
        up, down = (pose_cost(body, poses.moved(s), targets) for s in (step, -step))
        np.testing.assert_allclose(-2.0 * right[:, column], (up - down) / 2e-6, rtol=1e-3, atol=0.1)


def test_poses_are_found_from_markers(arm):
    body, poses = arm
    targets = Targets(marker_places(body, poses), np.full((30, 8), 1e4))
    rng = np.random.default_rng(2)
    near = poses.moved(rng.normal(scale=0.3, size=(30, 9)))
    found = fitted_poses(body, near, targets, 20)
    assert np.abs(marker_places(body, found) - targets.places).max() < 1e-5


def test_the_shape_is_found_with_the_poses(arm):
    body, poses = arm
    targets = Targets(marker_places(body, poses), np.full((30, 8), 1e8))
    rng = np.random.default_rng(3)
    other = body.shaped(body.shape + rng.normal(scale=0.01, size=body.shape.shape))
    found, _ = fitted_shape(other, fitted_poses(other, poses, targets, 10), targets)
    lower = found.places[4:]
    np.testing.assert_allclose(
        np.linalg.norm(lower[:, None] - lower, axis=2),
        np.linalg.norm(body.places[4:, None] - body.places[4:], axis=2),
        atol=1e-3,
    )


def test_one_banded_step_solves_the_whole_system():
    rng = np.random.default_rng(0)
    for frames in (3, 4, 7):
        raw = rng.normal(size=(frames, 3, 3))
        matrix, right = raw @ np.swapaxes(raw, 1, 2), rng.normal(size=(frames, 3))
        stiffness = np.array([1.0, 20.0, 300.0])
        whole = np.zeros((3 * frames, 3 * frames))
        for frame in range(frames):
            own = slice(3 * frame, 3 * frame + 3)
            whole[own, own] = matrix[frame]
        second = np.diff(np.eye(frames), n=2, axis=0)
        whole += np.kron(second.T @ second, np.diag(stiffness))
        found = smoothing._banded_step(matrix, right, stiffness, 0.0)
        np.testing.assert_allclose(found.ravel(), np.linalg.solve(whole, right.ravel()), rtol=1e-5)


@pytest.mark.parametrize("spread", [0.0, 1e-3, 2e-2])
def test_noise_is_measured(spread):
    rng = np.random.default_rng(0)
    time = np.linspace(0.0, 20.0, 2000)
    path = np.sin(time)[:, None, None] * np.ones((1, 5, 3))
    seen = rng.random((2000, 5)) < 0.9
    found = measured_noise(path + spread * rng.normal(size=path.shape), seen)
    assert found == pytest.approx(spread, rel=0.05, abs=1e-5)


def test_noise_of_nothing_is_none():
    assert measured_noise(np.zeros((2, 3, 3)), np.ones((2, 3), bool)) == 0.0
    assert measured_noise(np.zeros((20, 3, 3)), np.zeros((20, 3), bool)) == 0.0


@pytest.mark.parametrize(
    ("name", "landmark", "bone"),
    [
        ("LASI", "asis", "Hips"),
        ("Anna:R.ASIS", "asis", "Hips"),
        ("Daphnee:ASISr", "asis", "Hips"),
        ("l asis", "asis", "Hips"),
        ("V.Sacral", "sacrum", "Hips"),
        ("R_FLE", "knee lateral", "RightUpLeg"),
        ("L.Knee.Medial", "knee medial", "LeftUpLeg"),
        ("r bar 2", "shank", "RightLeg"),
        ("LateralEpicondyleL", "elbow lateral", "LeftArm"),
    ],
)
def test_landmarks_are_known_by_many_names(name, landmark, bone):
    found = landmarks_of([name])[0]
    assert (found.name, found.bone) == (landmark, bone)


@pytest.mark.parametrize("name", ["Start", "*115", "WheelchairL:Marker1", "m1", ""])
def test_other_names_are_no_landmarks(name):
    assert landmarks_of([name]) == [None]


def test_what_a_model_computes_is_no_marker():
    assert computed("LHipAngles")
    assert computed("RFEA")
    assert computed("Anna:CentreOfMass")
    assert not computed("LFHD")
    assert not computed("RTIB")


def test_bones_of_markers_meet_where_they_turn():
    """A ball joint: its centre is known in all directions."""
    rng = np.random.default_rng(0)
    frames = 200
    time = np.linspace(0.0, 12.0, frames)
    first = rot.from_rotation_vector(
        0.3 * np.stack([np.sin(time), np.cos(0.7 * time), 0 * time], 1)
    )
    swing = np.stack([np.sin(1.1 * time), np.sin(0.8 * time), np.sin(0.5 * time)], axis=1)
    second = rot.multiply(first, rot.from_rotation_vector(0.6 * swing))
    root = np.stack([time / 5, np.sin(time), 0 * time], axis=1)
    joint = root + rot.rotate(first, [0.0, -0.4, 0.0])
    near, far = rng.normal(scale=0.08, size=(2, 5, 3)) - np.array([0.0, 0.2, 0.0])
    points = np.concatenate(
        [
            root[:, None] + rot.rotate(first[:, None], near),
            joint[:, None] + rot.rotate(second[:, None], far),
        ],
        axis=1,
    )
    points += rng.normal(scale=1e-3, size=points.shape)
    seen = rng.random(points.shape[:2]) < 0.9
    guess = rigid.guessed_bones(points, seen)
    assert len(guess.body.names) == 2
    places, _ = forward_kinematics(guess.body.skeleton, guess.poses.rotations, guess.poses.root)
    assert np.median(np.linalg.norm(places[:, 1] - joint, axis=1)) < 0.006
