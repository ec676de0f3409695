"""Fixtures: the extension installed from its zip, an empty scene, captures imported."""

import importlib
import json
import os
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

CAPTURES = Path(__file__).resolve().parents[2] / "data" / "captures"
MODULE = "bl_ext.user_default.roundelay"


def pytest_sessionstart():
    """Install the zip as a user does, wheel and all."""
    result = bpy.ops.extensions.package_install_files(
        filepath=os.environ["ROUNDELAY_ZIP"], repo="user_default", enable_on_install=True
    )
    assert result == {"FINISHED"}


@pytest.fixture
def extension():
    """Return the installed extension."""
    return importlib.import_module(MODULE)


@pytest.fixture(autouse=True)
def scene():
    """Leave nothing of the test before but the imported originals."""
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    for kind in (bpy.data.objects, bpy.data.armatures, bpy.data.actions, bpy.data.meshes):
        for block in list(kind):
            if not block.name.startswith("Original"):
                kind.remove(block)
    scene = bpy.context.scene
    scene.timeline_markers.clear()
    for name in scene.roundelay.bl_rna.properties.keys():  # noqa: SIM118
        if name not in ("rna_type", "name"):
            scene.roundelay.property_unset(name)
    return scene


def import_capture(name="01_01", mode="NATIVE"):
    """Return an armature as Blender's own importer makes it, at the capture's frame rate."""
    original = bpy.data.objects.get(f"Original {name} {mode}") or imported(name, mode)
    armature = original.copy()
    armature.data = original.data.copy()
    armature.animation_data.action = original.animation_data.action.copy()
    armature.name = armature.animation_data.action.name = name
    render = bpy.context.scene.render
    render.fps, render.fps_base = int(original["rate"][0]), original["rate"][1]
    bpy.context.scene.collection.objects.link(armature)
    for other in bpy.context.selected_objects:
        other.select_set(False)
    bpy.context.view_layer.objects.active = armature
    armature.select_set(True)
    bpy.context.view_layer.update()
    return armature


def drifting():
    """Return an armature whose poses never come back."""
    armature = import_capture("01_03")
    armature.name = armature.animation_data.action.name = "drifting"
    for number, curve in enumerate(
        sys.modules[f"{MODULE}.compat"].fcurves(armature.animation_data)
    ):
        keys = np.empty(2 * len(curve.keyframe_points))
        curve.keyframe_points.foreach_get("co", keys)
        keys[1::2] = (number % 5 - 2) * 1e-4 * keys[::2]
        curve.keyframe_points.foreach_set("co", keys)
        curve.update()
    return armature


def imported(name, mode):
    """Import a bundled capture, out of the scene."""
    bpy.ops.import_anim.bvh(
        filepath=str(CAPTURES / f"{name}.bvh"), rotate_mode=mode, update_scene_fps=True
    )
    original, render = bpy.context.view_layer.objects.active, bpy.context.scene.render
    original["rate"] = (float(render.fps), render.fps_base)
    for block in (original, original.data, original.animation_data.action):
        block.name = f"Original {name} {mode}"
        block.use_fake_user = True
    for collection in original.users_collection:
        collection.objects.unlink(original)
    return original


@pytest.fixture
def jumps():
    """CMU 01_01: ten forward jumps."""
    return import_capture()


@pytest.fixture(scope="session")
def _figures():
    """Keep the figures of rigs, and write them where they are asked for."""
    found = {}
    yield found
    target = os.environ.get("ROUNDELAY_FIGURES")
    if target:
        Path(target).write_text(json.dumps(found, indent=1) + "\n")


@pytest.fixture
def record_rig(_figures):
    """Keep what was measured of a rig."""

    def record(name, found):
        _figures[name] = {
            key: round(float(value), 5)
            for key, value in found.items()
            if isinstance(value, (int, float, bool, np.floating))
        }

    return record
