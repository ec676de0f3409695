"""The standard joints, and the ones that correspond on other skeletons."""

import numpy as np
import pytest
from tests.segmentation.conftest import make_capture, skeleton

from roundelay.base.errors import SkeletonMismatch
from roundelay.segmentation import STANDARD_JOINTS, corresponding_joints, joint_quaternions

MIXAMO = """Spine Spine1 Spine2 Neck Head HeadTop_End LeftShoulder LeftArm LeftForeArm LeftHand
LeftHandThumb1 RightShoulder RightArm RightForeArm RightHand LeftUpLeg LeftLeg LeftFoot
LeftToeBase RightUpLeg RightLeg RightFoot"""
MIXAMO_CHOSEN = """Spine Spine1 Spine2 Neck Head LeftArm LeftForeArm RightArm RightForeArm
LeftUpLeg LeftLeg RightUpLeg RightLeg"""
UNREAL = """pelvis spine_01 spine_02 neck_01 head clavicle_l upperarm_l lowerarm_l hand_l
upperarm_r lowerarm_r thigh_l calf_l foot_l thigh_r calf_r upperarm_twist_01_l"""
UNREAL_CHOSEN = """spine_01 spine_02 neck_01 head upperarm_l lowerarm_l upperarm_r lowerarm_r
thigh_l calf_l thigh_r calf_r"""
MAKEHUMAN = """Spine1 Spine2 Spine3 Neck Head Jaw Eye_L Clavicle_L UpArm_L LoArm_L Hand_L Thumb1_L
UpArm_R LoArm_R Hip_L UpLeg_L LoLeg_L Foot_L UpLeg_R LoLeg_R Toe_R"""
MAKEHUMAN_CHOSEN = """Spine1 Spine2 Spine3 Neck Head UpArm_L LoArm_L UpArm_R LoArm_R UpLeg_L LoLeg_L
UpLeg_R LoLeg_R"""
MOTIONBUILDER = """LHipJoint LeftUpLeg LeftLeg LeftFoot RHipJoint RightUpLeg RightLeg RightToeBase
LowerBack Spine Spine1 Neck Neck1 Head LeftShoulder LeftArm LeftForeArm LeftHand LThumb
RightShoulder RightArm RightForeArm RightFingerBase"""
MOTIONBUILDER_CHOSEN = """LeftUpLeg LeftLeg RightUpLeg RightLeg LowerBack Spine Spine1 Neck Neck1
Head LeftArm LeftForeArm RightArm RightForeArm"""


def test_standard_joints_themselves():
    names = corresponding_joints(skeleton(("lhand", *reversed(STANDARD_JOINTS), "rfoot")))
    assert names == STANDARD_JOINTS


@pytest.mark.parametrize(
    ("names", "chosen", "prefix"),
    [
        (MIXAMO, MIXAMO_CHOSEN, "mixamorig:"),
        (UNREAL, UNREAL_CHOSEN, ""),
        (MAKEHUMAN, MAKEHUMAN_CHOSEN, ""),
        (MOTIONBUILDER, MOTIONBUILDER_CHOSEN, ""),
    ],
)
def test_usual_names(names, chosen, prefix):
    found = corresponding_joints(skeleton([prefix + name for name in names.split()]))
    assert list(found) == [prefix + name for name in chosen.split()]


def test_unknown_skeleton_takes_all_joints_but_the_root():
    assert corresponding_joints(skeleton(["b1", "b2", "tail"])) == ("b1", "b2", "tail")
    assert corresponding_joints(skeleton([])) == ("root",)


def test_missing_joints_are_named():
    names = [name for name in STANDARD_JOINTS if name not in ("head", "rtibia")]
    with pytest.raises(SkeletonMismatch, match="rtibia"):
        corresponding_joints(skeleton(names))


def test_quaternions_have_56_columns_without_the_root():
    motion = make_capture("a").motion
    values = joint_quaternions(motion)
    assert values.shape == (len(motion), 56)
    np.testing.assert_array_equal(values.reshape(-1, 14, 4), motion.rotations[:, 1:])
