"""Strips of capture above loop, to be looked at: written to the folder ROUNDELAY_STRIPS names."""

import os
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Vector

import walkers
from inside import extract
from test_rigs import MADE, shown

SHOTS, WIDTH, HEIGHT = 8, 150, 230

pytestmark = pytest.mark.skipif(
    "ROUNDELAY_STRIPS" not in os.environ, reason="pictures are made where a folder is given"
)


@pytest.mark.parametrize("name", MADE)
def test_strips(name, tmp_path):
    armature = MADE[name](tmp_path)
    body = boxes(armature, shown(armature))
    action = extract()
    start, count = int(action.frame_start), int(action.frame_end - action.frame_start)
    walkers.select(armature)
    rows = []
    for loop in (False, True):
        if loop == (armature.animation_data.action != action):
            bpy.ops.roundelay.toggle()
        frames = start + np.linspace(0, count, SHOTS) + (0 if loop else walkers.PERIOD)
        rows.append(np.hstack([shot(armature, body, float(frame), tmp_path) for frame in frames]))
    picture = np.vstack(rows[::-1])
    assert picture.std() > 0.01
    save(picture, Path(os.environ["ROUNDELAY_STRIPS"]) / f"{name.replace(' ', '_')}.png")


def boxes(armature, names):
    """Make a mesh that follows the bones that show the body."""
    corners, faces, groups = [], [], []
    for name in names:
        bone = armature.data.bones[name]
        thick = 0.12 * bone.length
        across = [v for v in (bone.x_axis * thick, bone.z_axis * thick) for _ in (0,)]
        ring = [across[0] + across[1], across[0] - across[1], -across[0] - across[1]]
        ring.append(-across[0] + across[1])
        first = len(corners)
        corners += [end + side for end in (bone.head_local, bone.tail_local) for side in ring]
        faces += [
            [first + i, first + (i + 1) % 4, first + 4 + (i + 1) % 4, first + 4 + i]
            for i in range(4)
        ]
        faces += [[first + i for i in range(4)], [first + 4 + i for i in range(4)]]
        groups.append((name, range(first, first + 8)))
    mesh = bpy.data.meshes.new("Body")
    mesh.from_pydata(corners, [], faces)
    body = bpy.data.objects.new("Body", mesh)
    bpy.context.scene.collection.objects.link(body)
    body.parent = armature
    body.modifiers.new("Armature", "ARMATURE").object = armature
    for name, members in groups:
        body.vertex_groups.new(name=name).add(list(members), 1.0, "REPLACE")
    return body


def shot(armature, body, frame, folder):
    """Return the pixels of a frame seen from the side, the camera going along."""
    scene = bpy.context.scene
    scene.frame_set(int(frame), subframe=frame % 1.0)
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.resolution_percentage = 100
    graph = bpy.context.evaluated_depsgraph_get()
    seen = body.evaluated_get(graph)
    places = np.array([seen.matrix_world @ v.co for v in seen.data.vertices])
    middle = (places.max(axis=0) + places.min(axis=0)) / 2
    camera = scene.camera if scene.camera and scene.camera.name == "Strip" else None
    if camera is None:
        camera = bpy.data.objects.new("Strip", bpy.data.cameras.new("Strip"))
        scene.collection.objects.link(camera)
        camera.data.type, scene.camera = "ORTHO", camera
        camera.data.ortho_scale = 1.25 * float(np.ptp(places, axis=0).max())
        scene["strip_height"] = float(middle[2])
    away = Vector((4 * camera.data.ortho_scale, -camera.data.ortho_scale, 0.0))
    aim = Vector((middle[0], middle[1], scene["strip_height"]))
    camera.location = aim + away
    camera.data.clip_end = 100 * camera.data.ortho_scale
    camera.rotation_euler = (-away).to_track_quat("-Z", "Y").to_euler()
    scene.render.filepath = str(folder / "shot.png")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.array(image.pixels).reshape(HEIGHT, WIDTH, 4)
    bpy.data.images.remove(image)
    return pixels


def save(pixels, path):
    """Write pixels (rows from below, columns, 4) as PNG."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.new("Strip", width, height)
    image.pixels = pixels.ravel().tolist()
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
