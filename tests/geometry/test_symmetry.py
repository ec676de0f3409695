import numpy as np
import pytest

from roundelay import Skeleton, SkeletonMismatch
from roundelay.geometry.symmetry import facing, is_left, lateral_axis, partners

PAIRS = [
    ("LeftUpLeg", "RightUpLeg"),
    ("mixamorig:LeftArm", "mixamorig:RightArm"),
    ("left_hand", "right_hand"),
    ("ARM_LEFT", "ARM_RIGHT"),
    ("LHipJoint", "RHipJoint"),
    ("L_Foot", "R_Foot"),
    ("Hand.L", "Hand.R"),
    ("foot_l", "foot_r"),
    ("Bip01 L Thigh", "Bip01 R Thigh"),
    ("ArmL", "ArmR"),
    ("lfemur", "rfemur"),
    ("l-toe", "r-toe"),
]


def tree(*names):
    return Skeleton(names, (-1, *[0] * (len(names) - 1)), np.zeros((len(names), 3)))


@pytest.mark.parametrize("pair", PAIRS)
def test_pairs(pair):
    skeleton = tree("Root", "lowerback", *pair, "Reye", "LowerNeck")
    np.testing.assert_array_equal(partners(skeleton), [0, 1, 3, 2, 4, 5])


@pytest.mark.parametrize("pair", PAIRS)
def test_the_left_one(pair):
    assert is_left(*pair)
    assert not is_left(*pair[::-1])


@pytest.mark.parametrize("up", [0, 1, 2])
def test_where_a_body_faces(up):
    """Square to its sides on the mean, however one is above the other."""
    across, ahead = np.eye(3)[(up + 1) % 3], np.eye(3)[(up + 2) % 3]
    left = np.array([across, 3 * across + 0.2 * ahead, across - 0.2 * ahead]) + np.eye(3)[up]
    np.testing.assert_allclose(facing(left, -left, up, 1.0), -ahead, atol=1e-15)


@pytest.mark.parametrize("left", [[0.0, 0.0, 0.0], [0.0, 7.0, 0.0]])
def test_sides_at_one_place_or_above_each_other_face_nowhere(left):
    assert facing(np.array([left] * 4), np.zeros((4, 3)), 1, 2.0) is None


@pytest.mark.parametrize("name", ["LeftArm", "RHand", "Bip01 L Foot", "leg.R"])
def test_a_joint_without_partner(name):
    with pytest.raises(SkeletonMismatch, match="has no partner"):
        partners(tree("root", name))


def test_partners_on_joints_that_are_none():
    skeleton = Skeleton(("root", "chest", "LeftArm", "RightArm"), (-1, 0, 1, 0), np.zeros((4, 3)))
    with pytest.raises(SkeletonMismatch, match="its partner 'RightArm' does not hang"):
        partners(skeleton)
    lost = Skeleton(("root", "lhip", "rhip", "lfemur"), (-1, 0, 0, 1), np.zeros((4, 3)))
    with pytest.raises(SkeletonMismatch, match="'lfemur' hangs on 'lhip'"):
        partners(lost)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_axis_between_the_sides(axis):
    left = np.array([1.0, 2.0, 3.0])
    right = np.where(np.arange(3) == axis, -left, left)
    offsets = [[9.0, 9.0, 9.0], left, right]
    skeleton = Skeleton(("root", "L_leg", "R_leg"), (-1, 0, 0), offsets)
    assert lateral_axis(skeleton, partners(skeleton)) == axis
