# SPDX-License-Identifier: GPL-3.0-or-later
"""Find loops in motion capture without leaving Blender.

::

    panel.py -> extract.py    operators: read, search, write
                  capture.py  which armatures, which frames
                  reading.py  an action as a roundelay.Motion    rig.py  bones.py
                  loops.py    the library's options and results
                  writing.py  a loop as an action                compat.py
"""

from __future__ import annotations

import bpy

from . import blending, extract, importing, panel, preview, segmenting, settings

_CLASSES = (
    *extract.CLASSES,
    *segmenting.CLASSES,
    *preview.CLASSES,
    *blending.CLASSES,
    *importing.CLASSES,
    *panel.CLASSES,
)


def register() -> None:
    """Add settings, operators, panel and menu entry."""
    settings.register()
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.TOPBAR_MT_file_import.append(importing.menu_entry)


def unregister() -> None:
    """Remove them."""
    bpy.types.TOPBAR_MT_file_import.remove(importing.menu_entry)
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
    settings.unregister()
