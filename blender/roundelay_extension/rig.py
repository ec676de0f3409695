# SPDX-License-Identifier: GPL-3.0-or-later
"""An armature's bones as roundelay's skeleton, and what they do as its motion.

A bone's rotation, as roundelay has it, is relative to its parent and along the armature's axes:
identity at rest, as in a BVH. With the bone's rest rotation R, Blender's own is R^-1 q R.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roundelay import Motion, Skeleton, SkeletonMismatch
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.geometry.symmetry import partners

from . import bones as which
from .compat import Armature

Array = NDArray[np.float64]

# How far from its bone the joint of a scale lies, in body sizes: too little to be seen.
_BESIDE = 1e-4


class Channels(NamedTuple):
    """What is keyed: own rotations (F, J, 4), locations and scales (F, J, 3), which may be none."""

    rotations: Array
    locations: Array
    scales: Array | None


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
    scaled : bool
        Whether the scale of a bone changes. Scales ride along as the places of joints beside
        the bones, so that all that is done to poses is done to them.
    carried : bool
        Whether the armature's own motion is part of the root's.
    skeleton : Skeleton
        The bones, followed by the tips of moving bones without children where no joint shows
        their motion, and of the root where it stays: what hangs on it alone is not the root;
        at last the scales.
    rest : (J, 4) ndarray
        Rest rotations in the armature.
    base : (4, 4) ndarray
        The root's parent in the armature, relative to rest.
    up : int
        The axis that points up in the world.
    """

    armature: Armature
    bones: tuple[Any, ...]
    keyed: NDArray[np.bool_]
    scaled: bool
    carried: bool
    skeleton: Skeleton
    rest: Array
    base: Array
    up: int

    def motion(
        self, channels: Channels, placed: Array | None, frame_time: float, name: str = ""
    ) -> Motion:
        """Make a motion of what is keyed.

        Parameters
        ----------
        channels : Channels
        placed : (F, 4, 4) ndarray or None
            The armature relative to its first frame, where that is carried.
        frame_time : float
        name : str
        """
        rotations = rot.multiply(rot.multiply(self.rest, channels.rotations), self._back)
        rotations[:, ~self.keyed] = (1.0, 0.0, 0.0, 0.0)
        moved = rot.rotate(self.rest, channels.locations)
        moved[:, ~self.keyed] = 0.0
        path = self.skeleton.offsets[0] + moved[:, 0]
        if placed is not None:
            turn, path = self._carried(placed, path)
            rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
        added = rot.identity(len(path), self.skeleton.n_joints - len(self.bones))
        return Motion(
            skeleton=self.skeleton,
            rotations=np.concatenate([rotations, added], axis=1),
            root_path=path,
            frame_time=frame_time,
            translations=self._translations(moved, channels.scales),
            name=name,
            up=self.up,
        )

    def _carried(self, placed: Array, path: Array) -> tuple[Array, Array]:
        """Return by what the armature turns the root (F, 4), and where it takes it (F, 3)."""
        moves = np.linalg.inv(self.base) @ placed @ self.base
        linear = moves[:, :3, :3]
        turns = rot.from_matrix(linear / np.linalg.norm(linear, axis=-2, keepdims=True))
        return turns, np.einsum("fij,fj->fi", linear, path) + moves[:, :3, 3]

    def _translations(self, moved: Array, scales: Array | None) -> Array | None:
        """Return where joints are on their parents (F, joints, 3), if any but the root moves."""
        count = len(self.bones)
        if scales is None and np.abs(moved[:, 1:]).max(initial=0.0) <= 1e-5 * self.skeleton.size:
            return None
        translations = np.tile(self.skeleton.offsets, (len(moved), 1, 1))
        translations[:, :count] += moved
        if scales is not None:
            translations[:, -count:] *= scales
        return translations

    def channels(self, motion: Motion) -> Channels:
        """Return what to key for a motion: the inverse of `motion`, the armature standing."""
        count = len(self.bones)
        local = motion.rotations[:, :count].copy()
        free = [not bone.bone.use_inherit_rotation for bone in self.bones]
        if any(free):
            turned = forward_kinematics(motion.skeleton, motion.rotations)[1]
            local[:, free] = turned[:, :count][:, free]
        moved, scales = np.zeros((len(motion), count, 3)), None
        if motion.translations is not None:
            moved = motion.translations[:, :count] - self.skeleton.offsets[:count]
            if self.scaled:
                # A mirrored motion has other signs.
                scales = np.abs(motion.translations[:, -count:]) / self.skeleton.offsets[-count:]
        moved[:, 0] = motion.root_path - self.skeleton.offsets[0]
        return Channels(
            rot.multiply(rot.multiply(self._back, local), self.rest),
            rot.rotate(self._back, moved),
            scales,
        )

    def require_both_sides(self) -> None:
        """Check that what is keyed can be mirrored.

        Raises
        ------
        SkeletonMismatch
            Naming a bone that is missing.
        """
        names = [bone.name for bone, keyed in zip(self.bones, self.keyed, strict=True) if keyed]
        flat = Skeleton(("-", *names), (-1, *[0] * len(names)), np.zeros((len(names) + 1, 3)))
        try:
            partners(flat)
            partners(self.skeleton)
        except SkeletonMismatch as fault:
            raise SkeletonMismatch(f"mirroring needs both sides: {fault}") from None

    @property
    def _back(self) -> Array:
        return rot.conjugate(self.rest)


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
    moving = _moving(armature, chosen)
    root = which.main_root(moving) if chosen is None else which.common_root(moving)
    travels = which.travels(armature, root)
    # What carries the armature carries all that hangs on it.
    top = root if travels or root.parent is None else root.parent_recursive[-1]
    carried = which.moves(armature) and (chosen is None or top.name in chosen)
    if carried:
        root = top
    elif not travels and root.parent is not None:
        root = root.parent
    bones = (root, *which.below(root))
    moved = [*moving, root] if carried else moving
    keyed = np.array([chosen is None or bone in moved for bone in bones])
    scaled = not which.scaled_bones(armature).isdisjoint(bone.name for bone in bones)
    shown = chosen is None and any(bone.children for bone in moving if bone is not root)
    tips = [] if shown else [bone for bone in bones if bone in moving and not bone.children]
    tips += [] if travels or root in tips else [root]
    return Rig(
        armature=armature,
        bones=bones,
        keyed=keyed,
        scaled=scaled,
        carried=carried,
        skeleton=_skeleton(bones, tips, scaled=scaled),
        rest=rot.from_matrix(np.array([bone.bone.matrix_local.to_3x3() for bone in bones])),
        base=_base(root),
        up=_up_axis(armature, root),
    )


def _moving(armature: Armature, chosen: Collection[str] | None) -> list[Any]:
    names = which.animated_bones(armature)
    names &= set(armature.pose.bones.keys() if chosen is None else chosen)
    if not names:
        whose = "no bone" if chosen is None else "none of the selected bones"
        raise SkeletonMismatch(f"{armature.name}: {whose} is animated")
    return [bone for bone in armature.pose.bones if bone.name in names]


def _skeleton(bones: Sequence[Any], tips: Sequence[Any], *, scaled: bool) -> Skeleton:
    heads = np.array([bone.bone.head_local for bone in bones])
    parents = [-1] + [bones.index(bone.parent) for bone in bones[1:]]
    offsets = np.concatenate([heads[:1], heads[1:] - heads[parents[1:]]])
    hung = [(f"{bone.name} (tip)", bones.index(bone), _span(bone)) for bone in tips]
    beside = np.full(3, _BESIDE * max(np.ptp(heads, axis=0).max(), np.linalg.norm(_span(bones[0]))))
    hung += [(f"{bone.name} (scale)", i, beside) for i, bone in enumerate(bones) if scaled]
    return Skeleton(
        names=(*(bone.name for bone in bones), *(name for name, _, _ in hung)),
        parents=(*parents, *(joint for _, joint, _ in hung)),
        offsets=np.concatenate([offsets, *(span[None] for _, _, span in hung)]),
        end_sites=tuple((i, _span(bone)) for i, bone in enumerate(bones) if not bone.children),
    )


def _span(bone: Any) -> Array:
    return np.array(bone.bone.tail_local - bone.bone.head_local)


def _base(root: Any) -> Array:
    """Return where the root's parent is now, (4, 4) in the armature and relative to rest."""
    if root.parent is None:
        return np.eye(4)
    return np.array(root.parent.matrix @ root.parent.bone.matrix_local.inverted())


def _up_axis(armature: Armature, root: Any) -> int:
    """Return the axis nearest to the world's up, in the armature with the root's parent at rest."""
    turn = np.array(armature.matrix_world.to_3x3()) @ _base(root)[:3, :3]
    return int(np.argmax(np.abs(np.linalg.inv(turn)[:, 2])))
