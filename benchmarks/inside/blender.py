"""Import files into Blender and say where the bones' heads are, step by step.

Run by the Python that holds bpy: ``python blender.py JOBS.json``, a list of ``file``,
``out``, ``fps``, ``frames`` and ``steps`` a frame.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np


def imported(file: Path) -> Any:
    """Import a file into an empty scene; return the armature."""
    if file.suffix == ".bvh":
        bpy.ops.import_anim.bvh(
            filepath=str(file), update_scene_fps=True, update_scene_duration=True
        )
    elif file.suffix == ".fbx":
        bpy.ops.import_scene.fbx(filepath=str(file))
    else:
        bpy.ops.import_scene.gltf(filepath=str(file))
    (armature,) = (one for one in bpy.data.objects if one.type == "ARMATURE")
    return armature


def first_key(armature: Any) -> float:
    """Return the frame at which the imported action begins."""
    return float(armature.animation_data.action.frame_range[0])


def played(job: dict[str, Any]) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    # What a user does before the import of a file that does not set the scene's rate.
    whole = max(1, round(job["fps"]))
    scene.render.fps, scene.render.fps_base = whole, whole / job["fps"]
    armature = imported(Path(job["file"]))
    rate = scene.render.fps / scene.render.fps_base
    begin, bones = first_key(armature), armature.pose.bones
    last = float(armature.animation_data.action.frame_range[1])
    places = np.empty((job["frames"] * job["steps"] + 1, len(bones), 3), np.float32)
    for number in range(len(places)):
        at = begin + number / job["steps"]
        scene.frame_set(int(at), subframe=at % 1.0)
        world = armature.matrix_world
        places[number] = [(world @ bone.head)[:] for bone in bones]
    np.savez(
        job["out"],
        places=places,
        names=[bone.name for bone in bones],
        duration=(last - begin) / rate,
        clip=armature.animation_data.action.name,
    )


for asked in json.loads(Path(sys.argv[1]).read_text()):
    try:
        played(asked)
    except Exception as error:  # one file that cannot be played costs itself alone
        np.savez(asked["out"], error=f"{type(error).__name__}: {error}")
