"""Rigs made by hand, and ways to move and choose their parts."""

import bpy
import numpy as np

PERIOD, FRAMES = 40, range(1, 202)


def pendulum():
    """Make an armature by hand: a still root, a body that sways and travels, two swinging limbs."""
    data = bpy.data.armatures.new("Pendulum")
    armature = bpy.data.objects.new("Pendulum", data)
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    armature.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    for name, parent, head, tail in (
        ("root", None, (0, 0, 0), (0, 1, 0)),
        ("control", "root", (2, 0, 0), (2, 1, 0)),
        ("body", "root", (0, 0, 2), (0, 0, 3)),
        ("limb.L", "body", (1, 0, 2), (1, 0.2, 1)),
        ("limb.R", "body", (-1, 0, 2), (-1, 0.2, 1)),
    ):
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = head, tail
        bone.roll = 0.7
        bone.parent = data.edit_bones[parent] if parent else None
    bpy.ops.object.mode_set(mode="POSE")
    pose = armature.pose.bones
    pose["limb.R"].rotation_mode = "AXIS_ANGLE"
    pose["limb.L"].rotation_mode = "YXZ"
    for frame in FRAMES:
        swing = 2 * np.pi * (frame - 1) / PERIOD
        pose["limb.L"].rotation_euler = (0.6 * np.sin(swing), 0.1 * np.cos(swing), 0.2)
        pose["limb.R"].rotation_axis_angle = (-0.6 * np.sin(swing), 1.0, 0.0, 0.0)
        pose["body"].location = (0.05 * frame, 0.02 * np.sin(swing), 0.0)
        for name, path in (
            ("limb.L", "rotation_euler"),
            ("limb.R", "rotation_axis_angle"),
            ("body", "location"),
        ):
            pose[name].keyframe_insert(path, frame=frame)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.scene.render.fps, bpy.context.scene.render.fps_base = 30, 1.0
    return armature


def choose(armature, names):
    for bone in armature.pose.bones:
        place = bone if hasattr(bone, "select") else bone.bone
        place.select = bone.name in names
