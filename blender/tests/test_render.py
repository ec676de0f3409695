"""A picture of the loop, headless; looked at by people, and here only told from an empty one."""

import os
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

from conftest import import_capture
from inside import extract

FRAMES = 4


def test_workbench_shows_the_loop(tmp_path):
    armature = import_capture("01_01")
    action = extract()
    body = skinned(armature)
    folder = Path(os.environ.get("ROUNDELAY_RENDERS") or tmp_path)
    aim_camera(armature, action)
    start, end = int(action.frame_start), int(action.frame_end)
    for number, frame in enumerate(np.linspace(start, end, FRAMES).astype(int)):
        bpy.context.scene.frame_set(int(frame))
        bpy.context.scene.render.filepath = str(folder / f"loop{number}.png")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(bpy.context.scene.render.filepath)
        pixels = np.array(image.pixels).reshape(-1, 4)[:, :3]
        assert 0.002 < np.mean(np.abs(pixels - pixels[0]).max(axis=1) > 0.05) < 0.5
    bpy.data.objects.remove(body)


def skinned(armature):
    """Make a mesh that follows the bones: armatures themselves are not rendered."""
    corners, faces, groups = [], [], []
    for bone in armature.data.bones:
        head, tail = bone.head_local, bone.tail_local
        across = Vector((0.4, 0.0, 0.0)), Vector((0.0, 0.4, 0.0)), Vector((0.0, 0.0, 0.4))
        first = len(corners)
        corners += [end + side for end in (head, tail) for side in across]
        faces += [
            [first + i, first + j, first + 3 + j, first + 3 + i]
            for i, j in ((0, 1), (1, 2), (2, 0))
        ]
        groups.append((bone.name, range(first, first + 6)))
    mesh = bpy.data.meshes.new("Body")
    mesh.from_pydata(corners, [], faces)
    body = bpy.data.objects.new("Body", mesh)
    bpy.context.scene.collection.objects.link(body)
    body.parent = armature
    body.modifiers.new("Armature", "ARMATURE").object = armature
    for name, members in groups:
        body.vertex_groups.new(name=name).add(list(members), 1.0, "REPLACE")
    return body


def aim_camera(armature, action):
    """Look at where the loop goes, from the side."""
    scene = bpy.context.scene
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.render.resolution_x, scene.render.resolution_y = 480, 320
    places = []
    for frame in (action.frame_start, action.frame_end):
        scene.frame_set(int(frame))
        places.append(armature.pose.bones[0].head.copy())
    middle, way = (places[0] + places[1]) / 2, places[1] - places[0]
    side = Vector((way.y, -way.x, 0.0)).normalized()
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    camera.location = middle + side * 90.0 + Vector((0.0, 0.0, 15.0))
    camera.rotation_euler = (middle - camera.location).to_track_quat("-Z", "Y").to_euler()
    scene.camera = camera
