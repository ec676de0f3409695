"""Rotations against SciPy, and the identities they must satisfy."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from roundelay.geometry import rotations as rot

ORDERS = ["".join(order) for order in itertools.permutations("XYZ")]


def oracle(quaternions) -> Rotation:
    return Rotation.from_quat(np.asarray(quaternions)[..., [1, 2, 3, 0]].reshape(-1, 4))


def random(shape, seed=0):
    return rot.normalize(np.random.default_rng(seed).normal(size=(*shape, 4)))


def assert_same(first, second, atol=1e-14):
    np.testing.assert_allclose(rot.angle_between(first, second), 0.0, atol=atol)


def test_identity_turns_nothing():
    vectors = np.arange(24.0).reshape(2, 4, 3)
    np.testing.assert_array_equal(rot.rotate(rot.identity(2, 4), vectors), vectors)
    assert rot.identity().shape == (4,)


def test_normalize():
    np.testing.assert_allclose(rot.normalize([0, 3, 0, 4]), [0, 0.6, 0, 0.8])
    with pytest.raises(ValueError, match="length 0"):
        rot.normalize([[1, 0, 0, 0], [0, 0, 0, 0]])


def test_multiply_applies_the_second_first():
    first, second = random((5, 3)), random((3,), 1)
    expected = oracle(first) * oracle(np.broadcast_to(second, (5, 3, 4)))
    product = rot.multiply(first, second)
    np.testing.assert_allclose(rot.to_matrix(product).reshape(-1, 3, 3), expected.as_matrix())


def test_conjugate_undoes():
    q = random((7,))
    assert_same(rot.multiply(q, rot.conjugate(q)), rot.identity(7))


def test_rotate():
    q, vectors = random((6,)), np.random.default_rng(1).normal(size=(6, 3))
    np.testing.assert_allclose(rot.rotate(q, vectors), oracle(q).apply(vectors))


@pytest.mark.parametrize("order", [*ORDERS, "XYX", "ZXZ", "X", "YZ", "ZYZX"])
def test_from_euler(order):
    angles = np.random.default_rng(2).uniform(-7, 7, (20, len(order)))
    expected = Rotation.identity(20)
    for letter, column in zip(order, angles.T, strict=True):
        expected = expected * Rotation.from_euler(letter, column[:, None])
    np.testing.assert_allclose(
        rot.to_matrix(rot.from_euler(angles, order)), expected.as_matrix(), atol=1e-14
    )


def test_from_euler_of_no_axis():
    np.testing.assert_array_equal(rot.from_euler(np.zeros((3, 2, 0)), ""), rot.identity(3, 2))


def test_an_unknown_axis():
    with pytest.raises(ValueError, match="expected an axis X, Y or Z, found 'W'"):
        rot.from_euler([1.0], "W")
    with pytest.raises(ValueError, match="three different axes"):
        rot.to_euler(rot.identity(), "ZXZ")


@pytest.mark.parametrize("order", ORDERS)
def test_to_euler(order):
    q = random((500,), 3)
    angles = rot.to_euler(q, order)
    assert_same(rot.from_euler(angles, order), q)
    np.testing.assert_allclose(angles, oracle(q).as_euler(order), atol=1e-11)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("off", [0.0, 1e-12, 1e-9, 1e-7, 1e-4])
@pytest.mark.parametrize("side", [-1, 1])
def test_to_euler_near_gimbal_lock(order, off, side):
    first = np.linspace(-3, 3, 13)
    second = np.full(13, side * (np.pi / 2 - off))
    q = rot.from_euler(np.stack([first, second, first[::-1] * 0.7], -1), order)
    angles = rot.to_euler(q, order)
    assert np.all(np.isfinite(angles))
    assert_same(rot.from_euler(angles, order), q, atol=1e-9)


@settings(max_examples=100, deadline=None)
@given(st.lists(st.integers(-8, 8), min_size=3, max_size=3), st.sampled_from(ORDERS))
def test_euler_angles_at_eighths_of_a_turn(eighths, order):
    q = rot.from_euler(np.array(eighths) * np.pi / 4, order)
    angles = rot.to_euler(q, order)
    assert_same(rot.from_euler(angles, order), q, atol=1e-9)
    assert np.all(np.abs(angles) <= np.pi + 1e-15)
    assert abs(angles[1]) <= np.pi / 2 + 1e-15


@settings(max_examples=100, deadline=None)
@given(
    st.lists(st.floats(-1, 1), min_size=3, max_size=3).filter(lambda v: np.linalg.norm(v) > 1e-6),
    st.sampled_from([0.0, 1e-300, 1e-16, 1e-9, 1e-5, 9.9e-5, 1.01e-4, 0.1, 3.0, np.pi - 1e-9]),
)
def test_rotation_vectors_come_back(axis, angle):
    vector = angle * np.array(axis) / np.linalg.norm(axis)
    q = rot.from_rotation_vector(vector)
    assert np.linalg.norm(q) == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(rot.to_rotation_vector(q), vector, atol=1e-15, rtol=1e-9)
    np.testing.assert_allclose(rot.to_rotation_vector(-q), vector, atol=1e-15, rtol=1e-9)


def test_rotation_vectors_against_scipy():
    vectors = np.random.default_rng(4).normal(size=(50, 3))
    assert_same(
        rot.from_rotation_vector(vectors),
        Rotation.from_rotvec(vectors).as_quat()[:, [3, 0, 1, 2]],
    )


def test_matrices_come_back():
    q = random((300,), 5)
    np.testing.assert_allclose(rot.to_matrix(q), oracle(q).as_matrix(), atol=1e-15)
    assert_same(rot.from_matrix(rot.to_matrix(q)), q)
    half_turns = np.eye(4)
    assert_same(rot.from_matrix(rot.to_matrix(half_turns)), half_turns)


def test_twist_and_swing():
    q = random((50,), 6)
    up = np.array([0.0, 1.0, 0.0])
    twist = rot.twist(q, up)
    swing = rot.multiply(q, rot.conjugate(twist))
    np.testing.assert_allclose(rot.to_rotation_vector(twist)[:, [0, 2]], 0.0, atol=1e-14)
    np.testing.assert_allclose(rot.to_rotation_vector(swing)[:, 1], 0.0, atol=1e-14)
    upside_down = rot.from_rotation_vector([np.pi, 0, 0])
    np.testing.assert_array_equal(rot.twist(upside_down, [0.0, 1.0, 0.0]), rot.identity())


def test_continuous_signs():
    angles = np.linspace(0, 20, 400)
    smooth = rot.from_euler(np.stack([angles, 0.5 * angles], -1)[:, None], "XY")
    flips = np.random.default_rng(7).choice([-1.0, 1.0], size=(400, 1, 1))
    flips[0] = 1.0
    np.testing.assert_array_equal(rot.continuous(smooth * flips), smooth)
    moved = np.moveaxis(smooth * flips, 0, 1)
    np.testing.assert_array_equal(rot.continuous(moved, axis=1), np.moveaxis(smooth, 0, 1))


def test_continuous_leaves_its_argument_alone():
    q = random((4, 2))
    before = q.copy()
    assert rot.continuous(q) is not q
    np.testing.assert_array_equal(q, before)
    assert rot.continuous(q[:0]).shape == (0, 2, 4)


def test_mean():
    q = random((30, 2), 8)
    w = np.random.default_rng(9).uniform(size=30)
    for joint in range(2):
        expected = oracle(q[:, joint]).mean(w).as_quat()[[3, 0, 1, 2]]
        assert_same(rot.mean(q, w)[joint], expected)
    assert_same(rot.mean(-q), rot.mean(q))
    assert_same(rot.mean(q[:1]), q[0])


def test_slerp():
    first, second = random((2, 4), 10)
    t = np.array([0.0, 0.3, 0.75, 1.0])
    for a, b, part, got in zip(first, second, t, rot.slerp(first, second, t), strict=True):
        expected = Slerp([0, 1], Rotation.concatenate([oracle(a), oracle(b)]))(part).as_quat()
        assert_same(got, np.ravel(expected)[[3, 0, 1, 2]])
    assert_same(rot.slerp(first, -second, t), rot.slerp(first, second, t))


def test_vector_between():
    first, second = random((2, 40), 12)
    vectors = rot.vector_between(first, second)
    expected = (oracle(first).inv() * oracle(second)).as_rotvec()
    np.testing.assert_allclose(vectors, expected, atol=1e-12)
    there = rot.multiply(first, rot.from_rotation_vector(vectors))
    np.testing.assert_allclose(rot.angle_between(there, second), 0.0, atol=1e-9)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_axis_to_y(axis):
    np.testing.assert_allclose(
        rot.rotate(rot.axis_to_y(axis), np.eye(3)[axis]), [0, 1, 0], atol=1e-15
    )


def test_angle_between():
    first, second = random((2, 40), 11)
    expected = (oracle(first).inv() * oracle(second)).magnitude()
    np.testing.assert_allclose(rot.angle_between(first, second), expected)
    tiny = rot.from_rotation_vector([1e-12, 0, 0])
    assert rot.angle_between(rot.identity(), -tiny) == pytest.approx(1e-12)
