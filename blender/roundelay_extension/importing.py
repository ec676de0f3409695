# SPDX-License-Identifier: GPL-3.0-or-later
"""File > Import of ASF/AMC: read by roundelay, handed to Blender's own BVH importer."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import bpy
from bpy_extras.io_utils import ImportHelper

import roundelay

from .compat import Context, State


class ROUNDELAY_OT_import_acclaim(ImportHelper, bpy.types.Operator):  # type: ignore[misc]
    """Import an AMC capture; its ASF skeleton is found beside it"""

    bl_idname = "roundelay.import_acclaim"
    bl_label = "Import ASF/AMC"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".amc"
    filter_glob: bpy.props.StringProperty(default="*.amc", options={"HIDDEN"})
    skeleton: bpy.props.StringProperty(name="ASF", description="By default found beside the AMC")
    global_scale: bpy.props.FloatProperty(name="Scale", default=1.0, min=1e-6)
    keep_rate: bpy.props.BoolProperty(
        name="Scene's Frame Rate", description="Set the scene to the capture's rate", default=True
    )

    def execute(self, context: Context) -> State:
        """Read, convert and import."""
        path = Path(self.filepath)  # type: ignore[attr-defined]
        try:
            motion = roundelay.read(path, skeleton=self.skeleton or None)
        except (roundelay.RoundelayError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        with tempfile.TemporaryDirectory() as folder:
            converted = Path(folder) / f"{path.stem}.bvh"
            roundelay.write(motion, converted)
            result: Any = bpy.ops.import_anim.bvh(
                filepath=str(converted),
                global_scale=self.global_scale,
                update_scene_fps=self.keep_rate,
                update_scene_duration=True,
            )
        return result


def menu_entry(menu: Any, context: Context) -> None:
    """Draw the entry of File > Import."""
    menu.layout.operator(ROUNDELAY_OT_import_acclaim.bl_idname, text="Acclaim capture (.amc)")


CLASSES = (ROUNDELAY_OT_import_acclaim,)
