# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a rig is plain: every bone that moves is keyed itself, as importers leave it."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from mathutils import Matrix

from .bones import placing_curves
from .keyed import ROTATIONS, Keyed, Property
from .rig import Rig

# Less is no change; body sizes, and what matrices of rotations and scales differ by.
_LEAST = 1e-4
# At so many frames constraints are looked at.
_LOOKED = 9


def is_plain(
    rig: Rig, keyed: Keyed, chosen: Collection[str] | None, scene: Any, frames: range
) -> bool:
    """Tell whether the loop can be made bone by bone.

    Parameters
    ----------
    rig : Rig
    keyed : Keyed
    chosen : collection of str or None
        The only bones that count.
    scene : bpy.types.Scene
    frames : range
    """
    own = {bone.name for bone in rig.bones}
    moving = [one for one in keyed.curves if keyed.spans(one) > _LEAST]
    if chosen is not None:
        moving = [one for one in moving if one.bone in chosen]
    if not all(_of_bones(one, own, rig) for one in moving):
        return False
    if any(curve.data_path.startswith("pose.bones") for curve in _drivers(rig.armature)):
        return False
    if not any(c.enabled for bone in rig.bones for c in bone.constraints):
        return True
    return _unconstrained(rig, scene, frames)


def _of_bones(one: Property, own: Collection[str], rig: Rig) -> bool:
    """Tell whether a property is a rotation, place or scale of a bone, or moves no bone at all."""
    if one.owner != rig.armature:
        return True
    if one.bone:
        return one.bone in own and one.name in ("location", "scale", *ROTATIONS)
    return any(one.path == curve.data_path for curve in placing_curves(rig.armature))


def _drivers(armature: Any) -> list[Any]:
    return [curve for curve in armature.animation_data.drivers if not curve.mute]


def _unconstrained(rig: Rig, scene: Any, frames: range) -> bool:
    """Tell whether constraints leave the bones where their own channels put them."""
    current, size = scene.frame_current, rig.skeleton.size
    try:
        for frame in np.linspace(frames[0], frames[-1], _LOOKED).astype(int):
            scene.frame_set(int(frame))
            if not all(_own(bone, size) for bone in rig.bones):
                return False
    finally:
        scene.frame_set(current)
    return True


def _own(bone: Any, size: float) -> bool:
    """Tell whether a bone is where its parent and its own channels put it."""
    known: dict[str, Matrix] = {}
    if bone.parent is not None:
        known["parent_matrix"] = bone.parent.matrix
        known["parent_matrix_local"] = bone.parent.bone.matrix_local
    put = bone.bone.convert_local_to_pose(bone.matrix_basis, bone.bone.matrix_local, **known)
    apart = np.abs(np.array(bone.matrix) - np.array(put))
    return bool(apart[:3, 3].max() < _LEAST * size and apart[:3, :3].max() < 10 * _LEAST)
