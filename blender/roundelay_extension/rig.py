# SPDX-License-Identifier: GPL-3.0-or-later
"""Which bones of an armature take part, and how they look to roundelay.

A bone's rotation, as roundelay has it, is relative to its parent and along the armature's axes:
identity at rest, as in a BVH. With the bone's rest rotation R, Blender's own is R^-1 q R.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from roundelay import Motion, Skeleton, SkeletonMismatch
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics

from . import compat
from .compat import Armature, State

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Rig:
    """A tree of bones.

    Attributes
    ----------
    armature : bpy.types.Object
    bones : tuple of bpy.types.PoseBone
        The root first, parents before children.
    keyed : (J,) ndarray of bool
        Bones that move in the search and get keys; the others are held at rest.
    skeleton : Skeleton
        The bones, followed by the tips of moving bones without children where no joint shows
        their motion, and of the root where it stays: what hangs on it alone is not the root.
    rest : (J, 4) ndarray
        Rest rotations in the armature.
    up : int
        The axis that points up in the world.
    """

    armature: Armature
    bones: tuple[bpy.types.PoseBone, ...]
    keyed: NDArray[np.bool_]
    skeleton: Skeleton
    rest: Array
    up: int

    def motion(self, rotations: Array, locations: Array, frame_time: float) -> Motion:
        """Make a motion of the bones' own rotations (F, J, 4) and locations (F, J, 3)."""
        local = rot.multiply(rot.multiply(self.rest, rotations), rot.conjugate(self.rest))
        local[:, ~self.keyed] = (1.0, 0.0, 0.0, 0.0)
        moved = rot.rotate(self.rest, locations)
        moved[:, ~self.keyed] = 0.0
        translations = None
        if np.abs(moved[:, 1:]).max(initial=0.0) > 1e-5 * self.skeleton.size:
            translations = self._with_tips(self.skeleton.offsets[: len(self.bones)] + moved)
        tips = rot.identity(len(local), self.skeleton.n_joints - len(self.bones))
        return Motion(
            skeleton=self.skeleton,
            rotations=np.concatenate([local, tips], axis=1),
            root_path=self.skeleton.offsets[0] + moved[:, 0],
            frame_time=frame_time,
            translations=translations,
            name=self.armature.animation_data.action.name,
            up=self.up,
        )

    def channels(self, motion: Motion) -> tuple[Array, Array]:
        """Return the bones' own rotations and locations: the inverse of `motion`."""
        count = len(self.bones)
        local = motion.rotations[:, :count].copy()
        free = [not bone.bone.use_inherit_rotation for bone in self.bones]
        if any(free):
            turned = forward_kinematics(motion.skeleton, motion.rotations)[1]
            local[:, free] = turned[:, :count][:, free]
        back = rot.conjugate(self.rest)
        moved = np.zeros((len(motion), count, 3))
        if motion.translations is not None:
            moved = motion.translations[:, :count] - self.skeleton.offsets[:count]
        moved[:, 0] = motion.root_path - self.skeleton.offsets[0]
        return rot.multiply(rot.multiply(back, local), self.rest), rot.rotate(back, moved)

    def _with_tips(self, translations: Array) -> Array:
        tips = self.skeleton.offsets[len(self.bones) :]
        return np.concatenate(
            [translations, np.broadcast_to(tips, (len(translations), *tips.shape))], axis=1
        )


def rig_of(armature: Armature, chosen: Collection[str] | None = None) -> Rig:
    """Collect the animated bones of an armature with all that hangs on them.

    Parameters
    ----------
    armature : bpy.types.Object
        With an action.
    chosen : collection of str, optional
        Names of the only bones to use; all by default.

    Raises
    ------
    SkeletonMismatch
        If no bone is animated.
    """
    names = animated_bones(armature) & set(armature.pose.bones.keys() if chosen is None else chosen)
    moving = [bone for bone in armature.pose.bones if bone.name in names]
    if not moving:
        which = "no bone" if chosen is None else "none of the selected bones"
        raise SkeletonMismatch(f"{armature.name}: {which} is animated")
    root = _main_root(moving) if chosen is None else _common_root(moving)
    travels = _travels(armature, root)
    if not travels and root.parent is not None:
        root = root.parent
    bones = (root, *_below(root))
    keyed = np.array([chosen is None or bone in moving for bone in bones])
    rest = rot.from_matrix(np.array([bone.bone.matrix_local.to_3x3() for bone in bones]))
    shown = chosen is None and any(bone.children for bone in moving if bone is not root)
    tips = [] if shown else [bone for bone in bones if bone in moving and not bone.children]
    tips += [] if travels or root in tips else [root]
    return Rig(armature, bones, keyed, _skeleton(bones, tips), rest, _up_axis(armature, root))


def animated_bones(armature: Armature) -> State:
    """Name the bones that curves or constraints move."""
    moving = {bone.name for bone in armature.pose.bones if any(c.enabled for c in bone.constraints)}
    for curve in compat.fcurves(armature.animation_data):
        parts = curve.data_path.split('"')
        if len(parts) == 3 and parts[0] == "pose.bones[" and _varies(curve):
            moving.add(bpy.utils.unescape_identifier(parts[1]))
    return moving


def _travels(armature: Armature, bone: Any) -> bool:
    """Tell whether a bone changes place by itself, as the root of a body does."""
    if any(constraint.enabled for constraint in bone.constraints):
        return True
    path = bone.path_from_id("location")
    curves = compat.fcurves(armature.animation_data)
    return any(curve.data_path == path and _varies(curve) for curve in curves)


def _varies(curve: Any) -> bool:
    points = np.empty(2 * len(curve.keyframe_points), np.float32)
    curve.keyframe_points.foreach_get("co", points)
    return len(points) == 0 or bool(np.ptp(points[1::2]) > 0.0)


def _main_root(moving: Sequence[Any]) -> Any:
    """Return the topmost moving bone with most moving bones below it."""
    tops = [bone for bone in moving if not any(above in moving for above in bone.parent_recursive)]
    return max(tops, key=lambda top: sum(bone in moving for bone in top.children_recursive))


def _common_root(moving: Sequence[Any]) -> Any:
    """Return the lowest bone above all moving ones, one of them if it is."""
    lines = [[*reversed(bone.parent_recursive), bone] for bone in moving]
    common = [level[0] for level in zip(*lines, strict=False) if len(set(level)) == 1]
    if not common:
        raise SkeletonMismatch("the selected bones hang on different roots")
    return common[-1]


def _below(root: Any) -> list[Any]:
    """List what hangs on a bone, parents before children."""
    return [below for child in root.children for below in (child, *_below(child))]


def _skeleton(bones: Sequence[Any], tips: Sequence[Any]) -> Skeleton:
    heads = np.array([bone.bone.head_local for bone in bones])
    parents = [-1] + [bones.index(bone.parent) for bone in bones[1:]]
    offsets = np.concatenate([heads[:1], heads[1:] - heads[parents[1:]]])
    ends = [(i, _span(bone)) for i, bone in enumerate(bones) if not bone.children]
    hung = [(bones.index(bone), _span(bone)) for bone in tips]
    return Skeleton(
        names=(*(bone.name for bone in bones), *(f"{bone.name} (tip)" for bone in tips)),
        parents=(*parents, *(joint for joint, _ in hung)),
        offsets=np.concatenate([offsets, *(span[None] for _, span in hung)]),
        end_sites=tuple(ends),
    )


def _span(bone: Any) -> Array:
    return np.array(bone.bone.tail_local - bone.bone.head_local)


def _up_axis(armature: Armature, root: Any) -> int:
    """Return the axis nearest to the world's up, in the armature with the root's parent at rest."""
    turn = armature.matrix_world.to_3x3()
    if root.parent is not None:
        turn = (
            turn @ root.parent.matrix.to_3x3() @ root.parent.bone.matrix_local.to_3x3().inverted()
        )
    return int(np.argmax(np.abs(np.array(turn.inverted())[:, 2])))
