# SPDX-License-Identifier: GPL-3.0-or-later
"""The body that a rig moves: its deforming bones where they are when it plays, as a motion.

Its axes are those of the armature turned so that Z points up in the world.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from mathutils import Matrix, Vector
from numpy.typing import NDArray

from roundelay import Motion, Skeleton, SkeletonMismatch
from roundelay.geometry import rotations as rot

from .compat import Armature
from .keyed import Keyed

Array = NDArray[np.float64]

# Bones that end where another begins, in spans of the armature.
_TOUCHING = 0.02
# So many bones are looked at whether they move or not; radians and body sizes that are no move.
_MANY, _STILL = 60, 2e-3


@dataclass(frozen=True, eq=False)
class Body:
    """Bones as joints.

    Attributes
    ----------
    armature : bpy.types.Object
    names : tuple of str
        The bones, the root first.
    skeleton : Skeleton
    rest : (J, 4) ndarray
        Their rest rotations, in the body's axes.
    turn : (4,) ndarray
        From the armature's axes to the body's.
    """

    armature: Armature
    names: tuple[str, ...]
    skeleton: Skeleton
    rest: Array = field(repr=False)
    turn: Array = field(repr=False)

    def placed(self, matrices: Array) -> tuple[Array, Array]:
        """Return places (F, J, 3) of the joints and their turns from rest (F, J, 4)."""
        linear = matrices[..., :3, :3]
        lengths = np.maximum(np.linalg.norm(linear, axis=-2, keepdims=True), 1e-9)
        turns = rot.multiply(self.turn, rot.from_matrix(linear / lengths))
        return self.at(matrices[..., :3, 3]), rot.multiply(turns, rot.conjugate(self.rest))

    def at(self, points: Array) -> Array:
        """Return points of the armature (..., 3) in the body's axes."""
        return rot.rotate(self.turn, points)

    def reduced(self, matrices: Array) -> Body:
        """Leave out the bones that never move on theirs, where there are many."""
        if len(self.names) <= _MANY:
            return self
        places, turns = self.placed(matrices)
        parents = np.array(self.skeleton.parents[: len(self.names)])
        back = rot.conjugate(turns[:, parents])
        own = rot.multiply(back, turns)
        moved = rot.rotate(back, places - places[:, parents])
        angles = rot.angle_between(own, own[:1]).max(axis=0)
        away = np.abs(moved - moved[:1]).max(axis=(0, 2)) / self.skeleton.size
        kept = set(np.flatnonzero((angles > _STILL) | (away > _STILL)).tolist()) | {0}
        for joint in range(len(parents) - 1, 0, -1):
            kept |= {int(parents[joint])} if joint in kept else set()
        names = self.names
        pairs = [(names[j], names[parents[j]] if j else "") for j in sorted(kept)]
        return _built(self.armature, pairs)

    def motion(self, matrices: Array, frame_time: float, name: str) -> Motion:
        """Make a motion of where bones are (F, J, 4, 4)."""
        places, turns = self.placed(matrices)
        count, added = len(self.names), self.skeleton.n_joints - len(self.names)
        parents = np.array(self.skeleton.parents[:count])
        parents[0] = 0
        back = rot.conjugate(turns[:, parents])
        rotations = rot.multiply(back, turns)
        moved = rot.rotate(back, places - places[:, parents])
        rotations[:, 0], moved[:, 0] = turns[:, 0], self.skeleton.offsets[0]
        tips = np.tile(self.skeleton.offsets[count:], (len(places), 1, 1))
        moved = np.concatenate([moved, tips], axis=1)
        still_tips = rot.identity(len(places), added)
        rotations = np.concatenate([rotations, still_tips], axis=1)
        still = np.abs(moved - self.skeleton.offsets).max() <= 1e-4 * self.skeleton.size
        return Motion(
            skeleton=self.skeleton,
            rotations=rotations,
            root_path=places[:, 0],
            frame_time=frame_time,
            translations=None if still else moved,
            name=name,
            up=2,
        )


def body_of(armature: Armature, keyed: Keyed, chosen: Collection[str] | None = None) -> Body:
    """Choose the bones that show what an armature does.

    Parameters
    ----------
    armature : bpy.types.Object
    keyed : Keyed
    chosen : collection of str, optional
        Look at these bones alone.

    Raises
    ------
    SkeletonMismatch
        If there is none, or the armature has no size.
    """
    above = {bone.name: [one.name for one in bone.parent_recursive] for bone in armature.pose.bones}
    shown = _shown(armature, above) if chosen is None else [n for n in above if n in chosen]
    if not shown:
        raise SkeletonMismatch(f"{armature.name} has no bones")
    root = _root(keyed, shown, above) if chosen is None else None
    if root is None:
        tops = [name for name in shown if not set(above[name]) & set(shown)]
        root = max(tops, key=lambda top: sum(top in above[name] for name in shown))
    kept = {name for name in shown if name != root and _goes_with(name, root, shown, above)}
    names = [root, *(name for name in above if name in kept)]
    return _built(armature, _ordered(_hung(armature, names, above)))


def _shown(armature: Armature, above: dict[str, list[str]]) -> list[str]:
    """Name the bones that deform and are no handles of others; all where none do."""
    pose = armature.pose.bones
    followed = {name for bone in pose for name in _followed(armature, bone)}
    deforming = [bone.name for bone in pose if bone.bone.use_deform]
    own = set(deforming) - followed
    body = [name for name in deforming if name in own or own.intersection(above[name])]
    return _connected(armature, body, above) or body or deforming or list(above)


def _connected(armature: Armature, names: list[str], above: dict[str, list[str]]) -> list[str]:
    """Leave out bones that float: those on which nothing hangs, that hang on nothing."""
    taken, bones = set(names), armature.data.bones
    carrying = {one for name in names for one in above[name]}
    tails = np.array([bones[name].tail_local for name in names]).reshape(-1, 3)
    reach = _reach(armature, names)

    def held(name: str) -> bool:
        if name in carrying or taken.intersection(above[name]):
            return True
        near = np.linalg.norm(tails - np.array(bones[name].head_local), axis=1) < reach
        return int(near.sum()) > int(near[names.index(name)])

    return [name for name in names if held(name)]


def _reach(armature: Armature, names: Sequence[str]) -> float:
    heads = np.array([armature.data.bones[name].head_local for name in names]).reshape(-1, 3)
    return _TOUCHING * float(np.ptp(heads, axis=0).max()) if len(heads) else 0.0


def _followed(armature: Armature, bone: Any) -> set[str]:
    """Name the bones that a bone's constraints follow."""
    return {
        getattr(constraint, name, "")
        for constraint in bone.constraints
        for owner, name in (("target", "subtarget"), ("pole_target", "pole_subtarget"))
        if getattr(constraint, owner, None) == armature
    }


def _root(keyed: Keyed, shown: Sequence[str], above: dict[str, list[str]]) -> str | None:
    """Return the lowest keyed bone that carries most of what is shown, if there is one."""
    carrying = []
    for name in {one.bone for one in keyed.curves if one.bone}:
        count = sum(one == name or name in above[one] for one in shown)
        if 2 * count > len(shown):
            carrying.append((len(above[name]), name))
    return max(carrying)[1] if carrying else None


def _goes_with(name: str, root: str, shown: Sequence[str], above: dict[str, list[str]]) -> bool:
    """Tell whether a bone hangs on the root or is part of a chain, rather than stands beside."""
    if root in above[name]:
        return True
    if name in above[root]:
        return False
    below = any(name in above[other] for other in shown)
    return below or any(one in shown and one not in above[root] for one in above[name])


def _hung(armature: Armature, names: Sequence[str], above: dict[str, list[str]]) -> dict[str, str]:
    """Tell on which joint each bone hangs, none for the root: the first of all.

    What hangs on no bone shown hangs on one that ends where it begins, else on the root.
    """
    bones, joints = armature.data.bones, set(names)
    heads = np.array([bones[name].head_local for name in names])
    tails = np.array([bones[name].tail_local for name in names])
    reach = _reach(armature, names)
    hung = {names[0]: ""}
    for place, name in enumerate(names[1:], 1):
        parent = next((one for one in above[name] if one in joints), names[0])
        if parent == names[0]:
            near = np.flatnonzero(np.linalg.norm(tails - heads[place], axis=1) < reach)
            others = [names[int(one)] for one in near if one not in (0, place)]
            free = [other for other in others if name not in above[other]]
            parent = free[0] if free else parent
        hung[name] = parent
    return hung


def _ordered(hung: dict[str, str]) -> list[tuple[str, str]]:
    """Put parents before children; what hangs in a ring hangs on the root."""
    left, done, root = dict(hung), dict[str, str](), next(iter(hung))
    while left:
        ready = {one: top for one, top in left.items() if not top or top in done}
        ready = ready or {next(iter(left)): root}
        done |= ready
        left = {one: top for one, top in left.items() if one not in ready}
    return list(done.items())


def _built(armature: Armature, pairs: Sequence[tuple[str, str]]) -> Body:
    names = [name for name, _ in pairs]
    bones = [armature.data.bones[name] for name in names]
    parents = [-1, *(names.index(above) for _, above in pairs[1:])]
    turn = upright(armature)
    heads = rot.rotate(turn, np.array([bone.head_local for bone in bones]))
    offsets = np.concatenate([heads[:1], heads[1:] - heads[parents[1:]]])
    rest = rot.from_matrix(np.array([bone.matrix_local.to_3x3() for bone in bones]))
    leaves = sorted(set(range(len(bones))) - set(parents))
    # Bones that all hang on the root move no joint: their tips show what they do.
    tips = [] if any(parent > 0 for parent in parents) else list(range(1, len(bones)))
    spans = [rot.rotate(turn, _length(bones[i]))[None] for i in tips]
    skeleton = Skeleton(
        names=(*names, *(f"{names[i]} (tip)" for i in tips)),
        parents=(*parents, *tips),
        offsets=np.concatenate([offsets, *spans]),
        end_sites=tuple((i, rot.rotate(turn, _length(bones[i]))) for i in leaves),
    )
    return Body(armature, tuple(names), skeleton, rot.multiply(turn, rest), turn)


def _length(bone: Any) -> Array:
    return np.array(bone.tail_local - bone.head_local)


def upright(armature: Armature) -> Array:
    """Return the turn (4,) by which the world's up in the armature's axes becomes Z."""
    linear: Matrix = armature.matrix_world.to_3x3()
    if abs(linear.determinant()) < 1e-30:
        raise SkeletonMismatch(f"{armature.name} has a scale of zero: give it another")
    up = linear.inverted() @ Vector((0.0, 0.0, 1.0))
    return np.array(up.rotation_difference(Vector((0.0, 0.0, 1.0))))
