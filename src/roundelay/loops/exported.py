"""A loop as the program that plays it wants it: its unit, its axes, its facing, its root bone."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from roundelay.cycles.above import Above
from roundelay.cycles.cycle import Cycle
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.geometry.symmetry import facing, sides
from roundelay.loops.units import Lengths
from roundelay.motion.motion import Motion
from roundelay.motion.points import METRES

if TYPE_CHECKING:
    from roundelay.loops.options import LoopOptions

__all__ = ["Placement", "exported", "placement", "root_bone_name"]

Array = NDArray[np.float64]

_AXES: dict[str | None, int] = {"y": 1, "z": 2}
# Metres of the units that lengths can be written in.


@dataclass(frozen=True, eq=False)
class Placement:
    """What takes the capture's world to that of a file.

    Parameters
    ----------
    scale : float
        The file's lengths over the capture's.
    axes : (4,) ndarray
        Turns the axis that points up to the file's.
    turn : (4,) ndarray
        Turns the body about the vertical, before.
    up : {0, 1, 2}
        The axis that points up in the file.
    metres : float or None
        Metres that the file's unit has; None where it is not known.
    """

    scale: float
    axes: Array
    turn: Array
    up: int
    metres: float | None

    def vector(self, vector: Array) -> Array:
        """Return a vector (3,) of the capture's world in the file's."""
        return self.scale * rot.rotate(rot.multiply(self.axes, self.turn), vector)


def exported(cycle: Cycle, written: LoopOptions, sampled: Motion | None = None) -> Motion:
    """Return the frames of a loop as they are written.

    Parameters
    ----------
    cycle : Cycle
    written : LoopOptions
    sampled : Motion, optional
        The cycle's frames as the options sample them, if they are there already.

    Returns
    -------
    Motion

    Raises
    ------
    ValueError
        If the program cannot tell all joints by their names.
    """
    motion = cycle.sample(**written.sampling) if sampled is None else sampled
    if written.target is not None:
        _check_names(motion.skeleton, written.target)
    if written.root_bone and not written.in_place:
        motion = _with_root_bone(motion, cycle, written)
    where = placement(cycle, written)
    motion = _on_axes(motion.turned(where.turn), where.axes, where.up)
    motion = motion if where.scale == 1.0 else motion.scaled(where.scale)
    return replace(motion, name=f"{motion.name}-loop") if written.target == "godot" else motion


def placement(cycle: Cycle, written: LoopOptions) -> Placement:
    """Return what takes the capture's world to that of the file.

    Lengths whose unit is not known stay as they are.
    """
    metres = Lengths.of(cycle.skeleton, written.resize).metres
    wanted = METRES.get(written.unit or "file")
    scale = metres / wanted if metres and wanted else 1.0
    up = _AXES.get(written.up, cycle.up)
    axes = rot.multiply(rot.conjugate(rot.axis_to_y(up)), rot.axis_to_y(cycle.up))
    turn = rot.identity(1)[0]
    if written.face_forward:
        turn = rot.from_rotation_vector(_turn_to_front(cycle) * np.eye(3)[cycle.up])
    return Placement(scale, axes, turn, up, metres and metres / scale)


def root_bone_name(skeleton: Skeleton) -> str:
    """Return the bone that carries the root motion where one is asked for: its own, or a new."""
    if len(skeleton.trunk) > 1:
        return skeleton.names[0]
    name, taken = "root", {one.lower() for one in skeleton.names}
    while name in taken:
        name = f"{name}_motion"
    return name


def _check_names(skeleton: Skeleton, target: str) -> None:
    """Refuse names that differ by capitals alone: engines take them for one."""
    (name, times), *_ = Counter(name.lower() for name in skeleton.names).most_common(1)
    if times > 1:
        alike = [one for one in skeleton.names if one.lower() == name]
        raise ValueError(f"expected joints that {target} can tell apart, found {alike}")


def _turn_to_front(cycle: Cycle) -> float:
    """Return the angle by which the body is to be turned to face +Z where Y points up.

    Without left and right, it is turned so that it travels there; or not, if it does not travel.
    """
    ahead = _facing(cycle)
    if ahead is None:
        ahead = cycle.velocity.constant if cycle.travels else None
    if ahead is None:
        return 0.0
    x, _, z = rot.rotate(rot.axis_to_y(cycle.up), ahead)
    return -float(np.arctan2(x, z))


def _facing(cycle: Cycle) -> Array | None:
    """Return the mean direction (3,) that the body faces, its steady turning left out."""
    left, right = sides(cycle.skeleton)
    if not len(left):
        return None
    points = cycle.sample(in_place=True).with_root_motion().positions()
    return facing(points[:, left], points[:, right], cycle.up, cycle.skeleton.size)


def _on_axes(motion: Motion, axes: Array, up: int) -> Motion:
    """Turn the world and the skeleton in it, so that it is upright at rest, too."""
    if up == motion.up:
        return motion
    skeleton, moved = motion.skeleton, motion.translations
    ends = tuple((joint, rot.rotate(axes, offset)) for joint, offset in skeleton.end_sites)
    offsets = rot.rotate(axes, skeleton.offsets)
    figure = skeleton.figure and skeleton.figure.rebased(rot.to_matrix(axes))
    return replace(
        motion,
        skeleton=Skeleton(skeleton.names, skeleton.parents, offsets, ends, figure=figure),
        rotations=rot.multiply(rot.multiply(axes, motion.rotations), rot.conjugate(axes)),
        root_path=rot.rotate(axes, motion.root_path),
        translations=None if moved is None else rot.rotate(axes, moved),
        up=up,
    )


def _with_root_bone(motion: Motion, cycle: Cycle, written: LoopOptions) -> Motion:
    """Let the root glide and turn steadily on the ground, and the hips move on it."""
    motion = motion.with_root_motion()
    if len(motion.skeleton.trunk) == 1:
        motion = _under_root(motion)
    above = len(motion.skeleton.trunk) - 1
    phase = np.arange(len(motion)) / max(1, round(cycle.period * motion.fps))
    turn = rot.from_rotation_vector(cycle.heading(phase)[:, None] * motion.up_vector)
    every = np.ones(above, bool)
    bones = Above(rot.identity(above), np.zeros((above, 3)), every, every)
    return bones.given(motion, turn, cycle.steady_path(phase))


def _under_root(motion: Motion) -> Motion:
    """Hang the skeleton on a new bone, which moves as the body does."""
    skeleton, moved = motion.skeleton, motion.translations
    name = root_bone_name(skeleton)
    offset = motion.up_vector * motion.root_path[:, motion.up].mean()
    offsets = np.concatenate([np.zeros((1, 3)), [offset], skeleton.offsets[1:]])
    ends = tuple((joint + 1, end) for joint, end in skeleton.end_sites)
    parents = (-1, *(parent + 1 for parent in skeleton.parents))
    turns, still = motion.rotations, rot.identity(len(motion))[:, None]
    if moved is not None:
        ours = np.broadcast_to(offsets[:2], (len(motion), 2, 3))
        moved = np.concatenate([ours, moved[:, 1:]], axis=1)
    return replace(
        motion,
        skeleton=Skeleton((name, *skeleton.names), parents, offsets, ends, figure=skeleton.figure),
        rotations=np.concatenate([turns[:, :1], still, turns[:, 1:]], axis=1),
        root_path=motion.root_path - rot.rotate(turns[:, 0], offset),
        translations=moved,
    )
