# SPDX-License-Identifier: GPL-3.0-or-later
"""What differs between Blender 4.2 and later ones: actions have slots and layers from 4.4 on.

Nothing else in the extension asks for Blender's version.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

# What Blender's type stubs make optional in every part, and what operators return.
Armature = Any
Context = Any
State = set[Any]

_SLOTTED = bpy.app.version >= (4, 4, 0)


def slot_of(user: Any) -> Any:
    """Return the slot by which an action drives an object or an NLA strip; None without slots."""
    return user.action_slot if _SLOTTED else None


def curves_of_slot(action: bpy.types.Action, slot: Any) -> list[Any]:
    """Return the curves of one slot of an action; all of them where there are no slots."""
    if not _SLOTTED:
        return list(action.fcurves)
    if slot is None:
        return []
    strips: list[Any] = [strip for layer in action.layers for strip in layer.strips]
    bags = (strip.channelbag(slot) for strip in strips)
    return [curve for bag in bags if bag is not None for curve in bag.fcurves]


def fcurves(data: Any) -> list[Any]:
    """Return the curves by which the action of an object drives it."""
    return curves_of_slot(data.action, slot_of(data))


def other_slots(action: bpy.types.Action, slot: Any) -> Iterator[tuple[Any, Any]]:
    """Yield the slots by which an action drives shape keys, each with the keys it drives."""
    if not _SLOTTED:
        return
    for other in action.slots:
        if other == slot or other.target_id_type != "KEY":
            continue
        for user in other.users():
            yield other, user


class NewAction:
    """An action that is being made; an object's curves come first, those of shape keys after."""

    def __init__(self, name: str, user: bpy.types.Object) -> None:
        self.action = bpy.data.actions.new(name)
        self._user, self._bags = user, dict[Any, Any]()
        if not _SLOTTED:
            self.action.id_root = "OBJECT"
            return
        self._strip: Any = self.action.layers.new("Layer").strips.new(type="KEYFRAME")
        self._bag(user)

    def _bag(self, user: Any) -> Any:
        if not _SLOTTED:
            return self.action
        if user not in self._bags:
            slot = self.action.slots.new(user.id_type, user.name)
            self._bags[user] = self._strip.channelbag(slot, ensure=True)
        return self._bags[user]

    def curve(self, path: str, index: int, group: str, user: Any = None) -> bpy.types.FCurve:
        """Add a curve for the object, or for shape keys."""
        bag = self._bag(user or self._user)
        curve = bag.fcurves.new(path, index=index)
        if group:
            curve.group = bag.groups.get(group) or bag.groups.new(group)
        return curve


def assign(user: Any, action: bpy.types.Action, slot: str = "") -> None:
    """Let an action drive an object or an NLA strip, by the slot of that identifier if given."""
    user.action = action
    if not _SLOTTED:
        return
    known = {one.identifier: one for one in user.action_suitable_slots}
    if slot in known:
        user.action_slot = known[slot]
    elif user.action_slot is None and known:
        user.action_slot = next(iter(known.values()))
