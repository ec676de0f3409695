# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop that is shown, to a file by Blender's own exporters: its frames, the first repeated."""

from __future__ import annotations

from typing import Any

import bpy
from bpy_extras.io_utils import ExportHelper

from .capture import armatures_of, shows_loop
from .compat import Armature, Context, State


class ROUNDELAY_OT_export(ExportHelper, bpy.types.Operator):  # type: ignore[misc]
    """Write the loop that is shown, and what it moves, as glTF or FBX"""

    bl_idname = "roundelay.export"
    bl_label = "Export Loop"

    filename_ext = ".glb"
    check_extension = False
    filter_glob: bpy.props.StringProperty(default="*.glb;*.gltf;*.fbx", options={"HIDDEN"})

    @classmethod
    def poll(cls, context: Context) -> bool:
        """A loop must be shown."""
        return shows_loop(cls, context)

    def execute(self, context: Context) -> State:
        """Set the scene to the loop's frames, write, and set it back."""
        path: str = self.filepath  # type: ignore[attr-defined]
        if path.startswith("//") and not bpy.data.filepath:
            self.report({"ERROR"}, "the file is not saved, so that // is nowhere: save it first")
            return {"CANCELLED"}
        path, scene = bpy.path.abspath(path), context.scene
        armature = armatures_of(context)[0]
        before = scene.frame_start, scene.frame_end, list(context.selected_objects)
        action = armature.animation_data.action
        scene.frame_start, scene.frame_end = int(action.frame_start), int(action.frame_end)
        try:
            _only(context, [armature, *_skinned(armature)])
            _write(path)
        except RuntimeError as error:
            self.report({"ERROR"}, str(error).strip().splitlines()[-1])
            return {"CANCELLED"}
        finally:
            scene.frame_start, scene.frame_end = before[:2]
            _only(context, before[2])
        context.scene.roundelay.message = f"Wrote {bpy.path.basename(path)}"
        return {"FINISHED"}


def _skinned(armature: Armature) -> list[Any]:
    objects: Any = bpy.data.objects
    return [
        one
        for one in objects
        if any(m.type == "ARMATURE" and m.object == armature for m in one.modifiers)
    ]


def _only(context: Context, objects: list[Any]) -> None:
    for one in context.selected_objects:
        one.select_set(False)
    for one in objects:
        one.select_set(True)


def _write(path: str) -> None:
    export: Any = bpy.ops.export_scene
    if path.lower().endswith(".fbx"):
        export.fbx(
            filepath=path,
            use_selection=True,
            add_leaf_bones=False,
            bake_anim_use_nla_strips=False,
            bake_anim_use_all_actions=False,
            bake_anim_simplify_factor=0.0,
        )
        return
    export.gltf(
        filepath=path,
        use_selection=True,
        export_animation_mode="ACTIVE_ACTIONS",
        export_frame_range=True,
        export_optimize_animation_size=False,
    )


CLASSES = (ROUNDELAY_OT_export,)
