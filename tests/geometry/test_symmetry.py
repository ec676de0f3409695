import numpy as np
import pytest

from roundelay import Skeleton, SkeletonMismatch
from roundelay.geometry.symmetry import lateral_axis, partners

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
