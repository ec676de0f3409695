# SPDX-License-Identifier: GPL-3.0-or-later
"""Which bones of an armature move, which of them is the root, and what moves besides."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from typing import Any

import bpy

from roundelay import SkeletonMismatch

from .compat import Armature, State
from .keyed import span
from .takes import curves_of

# Importers key what does not change, with the noise of single precision: less is no change.
_LEAST = 1e-4
_ROTATING = ("rotation_euler", "rotation_quaternion", "rotation_axis_angle")
_PLACING = ("location", *_ROTATING, "delta_location", *(f"delta_{name}" for name in _ROTATING[:2]))


def animated_bones(armature: Armature) -> State:
    """Name the bones that curves or constraints move."""
    moving = {bone.name for bone in armature.pose.bones if any(c.enabled for c in bone.constraints)}
    for name, _, curve in _bone_curves(armature):
        if name not in moving and span(curve) > 0.0:
            moving.add(name)
    return moving


def scaled_bones(armature: Armature) -> State:
    """Name the bones whose scale changes."""
    return {
        name
        for name, channel, curve in _bone_curves(armature)
        if channel == "scale" and span(curve) > _LEAST
    }


def travels(armature: Armature, bone: Any) -> bool:
    """Tell whether a bone changes place by itself, as the root of a body does."""
    if any(constraint.enabled for constraint in bone.constraints):
        return True
    return any(
        name == bone.name and channel == "location" and span(curve) > 0.0
        for name, channel, curve in _bone_curves(armature)
    )


def moves(thing: Any) -> bool:
    """Tell whether an object's own action moves it as a whole."""
    return any(curve.data_path in _PLACING and span(curve) > _LEAST for curve in curves_of(thing))


def placing_curves(armature: Armature) -> list[Any]:
    """Return the curves that place the object itself."""
    placing = (*_PLACING, "scale", "delta_scale")
    return [curve for curve in curves_of(armature) if curve.data_path in placing]


def main_root(moving: Sequence[Any]) -> Any:
    """Return the topmost moving bone with most moving bones below it."""
    tops = [bone for bone in moving if not any(above in moving for above in bone.parent_recursive)]
    return max(tops, key=lambda top: sum(bone in moving for bone in top.children_recursive))


def common_root(moving: Sequence[Any]) -> Any:
    """Return the lowest bone above all moving ones, one of them if it is.

    Raises
    ------
    SkeletonMismatch
        If there is none.
    """
    lines = [[*reversed(bone.parent_recursive), bone] for bone in moving]
    common = [level[0] for level in zip(*lines, strict=False) if len(set(level)) == 1]
    if not common:
        raise SkeletonMismatch("the selected bones hang on different roots")
    return common[-1]


def below(root: Any) -> list[Any]:
    """List what hangs on a bone, parents before children."""
    return [bone for child in root.children for bone in (child, *below(child))]


def left_out(armature: Armature, taken: Collection[str]) -> Iterator[str]:
    """Say what moves and is not in a loop of the bones taken, a line each."""
    others = sorted(animated_bones(armature).difference(taken))
    if others:
        more = f" and {len(others) - 1} more" if len(others) > 1 else ""
        yield f"{others[0]}{more} not in the loop: not below the root"
    parent = armature.parent
    while parent is not None:
        if moves(parent):
            yield f"{parent.name} moves {armature.name}: not in the loop, goes on as it is"
        parent = parent.parent
    if any(c.data_path == "scale" and span(c) > _LEAST for c in placing_curves(armature)):
        yield f"scale of {armature.name} itself is not in the loop"


def _bone_curves(armature: Armature) -> Iterator[tuple[str, str, Any]]:
    """Yield the curves of bones, each with its bone's name and its property."""
    for curve in curves_of(armature):
        parts = curve.data_path.split('"')
        if len(parts) == 3 and parts[0] == "pose.bones[":
            yield bpy.utils.unescape_identifier(parts[1]), parts[2][2:], curve
