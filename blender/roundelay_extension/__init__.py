# SPDX-License-Identifier: GPL-3.0-or-later
"""Find loops in motion capture without leaving Blender.

::

    panel.py -> extract.py    operators: read, search, write
                  capture.py   which armatures, which frames   takes.py  keyed.py  playing.py
                  reading.py   bones that are keyed themselves  plain.py  rig.py  bones.py
                  body.py      what the controls of a rig move
                  loops.py     the library's options and results          exact.py
                  making.py    the loop's curves, played back    checking.py
                  controls.py  means of what is keyed            averaging.py  ground.py
                  writing.py   a loop as an action               tracks.py  compat.py
"""

from __future__ import annotations

import bpy

from . import (
    blending,
    diagram,
    exporting,
    extract,
    importing,
    joining,
    panel,
    preview,
    segmenting,
    settings,
)

_CLASSES = (
    *extract.CLASSES,
    *segmenting.CLASSES,
    *preview.CLASSES,
    *blending.CLASSES,
    *importing.CLASSES,
    *joining.CLASSES,
    *diagram.CLASSES,
    *exporting.CLASSES,
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
