"""FBX as the library writes it, read by Blender's importers, frame by frame."""

import bpy
import numpy as np
import pytest

import roundelay
from conftest import CAPTURES
from roundelay import synth
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics

# Body sizes by which a joint may be elsewhere.
CLOSE = 1e-5
CENTIMETRES = 100.0
# From the motion's world to Blender's, where X, Y or Z points up.
WORLDS = {
    0: np.array([[0, -1, 0], [0, 0, -1], [1, 0, 0]]),
    1: np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]),
    2: np.eye(3),
}

importers = [pytest.param(bpy.ops.import_scene.fbx, id="import_scene.fbx")]
if "fbx_import" in dir(bpy.ops.wm):
    importers.append(pytest.param(bpy.ops.wm.fbx_import, id="wm.fbx_import"))


def capture(name):
    return roundelay.read(CAPTURES / f"{name}.bvh")


def walk():
    return synth.gait("walk", repetitions=2, turning=0.4, fps=30).motion


def z_up():
    made = walk()
    turn = rot.from_rotation_vector([np.pi / 2, 0.0, 0.0])
    turns = made.rotations.copy()
    turns[:, 0] = rot.multiply(turn, turns[:, 0])
    path = rot.rotate(turn, made.root_path)
    return roundelay.Motion(made.skeleton, turns, path, made.frame_time, name="z up", up=2)


def moving():
    made = walk()
    moved = np.tile(made.skeleton.offsets, (len(made), 1, 1))
    moved[:, 3, 1] += 0.1 * np.sin(np.arange(len(made)))
    return roundelay.Motion(made.skeleton, made.rotations, made.root_path, 1 / 30, moved, "Gång")


SAMPLES = {
    "loop": lambda: roundelay.find_cycles(capture("01_01"))[0].sample(fps=30, repeat_first=True),
    "Boxing_Toes": lambda: capture("Boxing_Toes"),
    "01_03": lambda: capture("01_03").resample(60),
    "z up": z_up,
    "moving": moving,
    "one frame": lambda: walk()[:1],
}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", SAMPLES)
@pytest.mark.parametrize("read", importers)
def test_blender_reads_what_was_written(read, name, tmp_path):
    motion = SAMPLES[name]()
    roundelay.write(motion, tmp_path / "a.fbx")
    assert read(filepath=str(tmp_path / "a.fbx")) == {"FINISHED"}
    (armature,) = (one for one in bpy.data.objects if not one.name.startswith("Original"))
    names, skeleton = list(motion.skeleton.names), motion.skeleton
    bones = armature.data.bones
    assert len(bones) == skeleton.n_joints + len(skeleton.end_sites)
    turn = rot.identity(1, skeleton.n_joints)
    rest = forward_kinematics(skeleton, turn, skeleton.offsets[:1])[0][0]
    # At rest a joint that moves on its parent lies aside by a ten thousandth of the body.
    aside = 1.001e-4 if motion.translations is not None else CLOSE
    compare(armature, [bones[one].head_local for one in names], rest, motion, aside)
    render = bpy.context.scene.render
    assert render.fps / render.fps_base == pytest.approx(motion.fps, rel=1e-6)
    assert armature.animation_data.action.name.endswith(motion.name)
    assert armature.animation_data.action.frame_range[:] == pytest.approx((1, len(motion)))
    for frame, places in enumerate(motion.positions()):
        bpy.context.scene.frame_set(frame + 1)
        compare(armature, [armature.pose.bones[one].head for one in names], places, motion)


def compare(armature, heads, places, motion, close=CLOSE):
    """Compare bones' heads in the armature with places of joints in the motion's world."""
    world = np.array(armature.matrix_world)
    found = CENTIMETRES * (np.array(heads) @ world[:3, :3].T + world[:3, 3])
    away = np.abs(found - places @ WORLDS[motion.up].T).max() / motion.skeleton.size
    assert away < close
