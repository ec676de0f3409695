"""From a skeleton's joints to the bones of an Acclaim skeleton.

An Acclaim bone ends where all its children start. A joint whose children start at different
places therefore gets a bone of no length, and connecting bones without channels.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.formats.acclaim import ROOT_DOF, AcclaimLayout, Bone, Vector
from roundelay.formats.euler import DEGREE, compose, decompose
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion

__all__ = ["Rig", "rig"]

Array = NDArray[np.float64]

_TURNS = ("rx", "ry", "rz")
_MOVES = ("tx", "ty", "tz")
# Radians by which a bone's channels may miss its rotation; parts of the skeleton's size by
# which two places may differ and be one.
_CLOSE = 1e-9


@dataclass(frozen=True)
class Rig:
    """Hold bones and their tree for writing.

    Parameters
    ----------
    layout : AcclaimLayout
        Its bones are those of the joints, in order, then connecting bones.
    parents : tuple of int
        Index of each bone's parent bone; -1 for the root.
    """

    layout: AcclaimLayout
    parents: tuple[int, ...]


def rig(motion: Motion) -> Rig:
    """Return the bones that carry a motion, as in the file it came from where they fit."""
    skeleton = motion.skeleton
    layout = _own_layout(skeleton)
    ends = _ends(skeleton)
    names = _names(skeleton)
    axes = layout.local_axes()
    bones = [
        _fitted(_reaching(replace(bone, name=name), end), motion, joint, axes[joint])
        for joint, (bone, name, end) in enumerate(zip(layout.bones, names, ends, strict=True))
    ]
    parents = list(skeleton.parents)
    _connect(skeleton, bones, parents, ends)
    return Rig(replace(layout, bones=tuple(bones)), tuple(parents))


def _own_layout(skeleton: Skeleton) -> AcclaimLayout:
    layout = skeleton.layout
    if isinstance(layout, AcclaimLayout) and layout.names == skeleton.names:
        return layout
    root = Bone("root", length=0.0, dof=ROOT_DOF)
    others = [Bone(name, dof=_TURNS) for name in skeleton.names[1:]]
    return AcclaimLayout((root, *others))


def _names(skeleton: Skeleton) -> list[str]:
    """Return names an ASF can hold: single words, all different, the first "root"."""
    names = ["root"]
    for name in skeleton.names[1:]:
        word = re.sub(r"[\s\x00-\x1f]|#|//|^:", "_", name) or "_"
        while word in names or word.isdecimal() or word.lower() in ("begin", "end"):
            word += "_"
        names.append(word)
    return names


def _ends(skeleton: Skeleton) -> Array:
    """Return where (J, 3) each joint's bone ends: where all below it starts, else no length."""
    targets: list[list[Array]] = [[] for _ in skeleton.names]
    for joint, parent in enumerate(skeleton.parents[1:], 1):
        targets[parent].append(skeleton.offsets[joint])
    for joint, offset in skeleton.end_sites:
        targets[joint].append(offset)
    ends = np.zeros((skeleton.n_joints, 3))
    for joint, own in enumerate(targets[1:], 1):
        if own and np.ptp(own, axis=0).max() <= _CLOSE * skeleton.size:
            ends[joint] = own[0]
    return ends


def _reaching(bone: Bone, end: Array) -> Bone:
    """Return a bone with another end, its own numbers kept where they lead there."""
    length = float(np.linalg.norm(end))
    if np.linalg.norm(bone.end - end) <= _CLOSE * length:
        return bone
    direction = end / length if length else np.array(bone.direction)
    return replace(bone, direction=_vector(direction), length=length)


def _connect(skeleton: Skeleton, bones: list[Bone], parents: list[int], ends: Array) -> None:
    """Add connecting bones to whatever does not start or lie at its parent bone's end."""
    close = _CLOSE * skeleton.size
    for joint, parent in enumerate(skeleton.parents[1:], 1):
        gap = skeleton.offsets[joint] - ends[parent]
        if np.linalg.norm(gap) > close:
            name = f"{bones[parent].name}_to_{bones[joint].name}"
            parents[joint] = _add(bones, parents, name, gap, parent)
    for joint, offset in skeleton.end_sites:
        gap = offset - ends[joint]
        if np.linalg.norm(gap) > close:
            _add(bones, parents, f"{bones[joint].name}_end", gap, joint)


def _add(bones: list[Bone], parents: list[int], name: str, end: Array, parent: int) -> int:
    taken = {bone.name for bone in bones}
    while name in taken:
        name += "_"
    bones.append(_reaching(Bone(name), end))
    parents.append(parent)
    return len(bones) - 1


def _fitted(bone: Bone, motion: Motion, joint: int, axes: Array) -> Bone:
    """Return a bone with the channels its motion needs, its own where they do."""
    turns = tuple(dof for dof in bone.dof if dof[0] == "r")
    if not _can_turn(motion.rotations[:, joint], bone.turns, axes):
        turns = _TURNS
    moves: tuple[str, ...] = _MOVES
    if joint and not _moves(motion, joint):
        moves = ()
    if {*bone.dof} == {*moves, *turns}:
        return bone
    return replace(bone, dof=moves + turns, limits=())


def _moves(motion: Motion, joint: int) -> bool:
    moved = motion.translations
    return moved is not None and bool(np.any(moved[:, joint] != motion.skeleton.offsets[joint]))


def _can_turn(turns: Array, order: str, axes: Array) -> bool:
    if len(order) == 3:
        return True
    local = rot.multiply(rot.multiply(rot.conjugate(axes), turns), axes)
    if not order:
        return bool(np.all(rot.angle_between(local, rot.identity()) < _CLOSE))
    angles = decompose(local[:, None], order, "principal")[:, 0]
    again = compose(angles, [order], [range(len(order))], unit=DEGREE)[:, 0]
    return bool(np.all(rot.angle_between(again, local) < _CLOSE))


def _vector(values: Array) -> Vector:
    return float(values[0]), float(values[1]), float(values[2])
