# SPDX-License-Identifier: GPL-3.0-or-later
"""What differs between Blender 4.2, 4.5 and 5.0: actions have slots and layers from 4.4 on.

Nothing else in the extension asks for Blender's version.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import bpy

# What Blender's type stubs make optional in every part, and what operators return.
Armature = Any
Context = Any
State = set[Any]

_SLOTTED = bpy.app.version >= (4, 4, 0)


def fcurves(data: Any) -> Iterable[Any]:
    """Return the curves by which an action drives its object."""
    if not _SLOTTED:
        return data.action.fcurves
    if data.action_slot is None:
        return ()
    bags = (
        strip.channelbag(data.action_slot) for layer in data.action.layers for strip in layer.strips
    )
    return [curve for bag in bags if bag is not None for curve in bag.fcurves]


def new_action(name: str, user: bpy.types.Object) -> tuple[bpy.types.Action, Any]:
    """Make an empty action for an object; the second value is where its curves go."""
    action = bpy.data.actions.new(name)
    if not _SLOTTED:
        action.id_root = "OBJECT"
        return action, action
    slot = action.slots.new("OBJECT", user.name)
    strip: Any = action.layers.new("Layer").strips.new(type="KEYFRAME")
    return action, strip.channelbag(slot, ensure=True)


def new_fcurve(place: Any, path: str, index: int, group: str) -> bpy.types.FCurve:
    """Add a curve to what `new_action` returned."""
    curve = place.fcurves.new(path, index=index)
    curve.group = place.groups.get(group) or place.groups.new(group)
    return curve


def assign(user: Any, action: bpy.types.Action) -> None:
    """Let an action drive an object or an NLA strip."""
    user.action = action
    if _SLOTTED and user.action_slot is None and user.action_suitable_slots:
        user.action_slot = user.action_suitable_slots[0]
