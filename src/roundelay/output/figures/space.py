"""Where a picture sees the body: joints in body sizes, Y up, on a floor at 0; its bones."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion

__all__ = ["Bone", "Space", "bones"]

Array = NDArray[np.float64]

_LEFT = re.compile(r"left|^l(?=[A-Z_.\s])|[._\s]l$|^l(?=[a-z]+$)", re.IGNORECASE)
_RIGHT = re.compile(r"right|^r(?=[A-Z_.\s])|[._\s]r$|^r(?=[a-z]+$)", re.IGNORECASE)


@dataclass(frozen=True)
class Space:
    """The page's space: lengths in body sizes, Y up, the floor at 0.

    Parameters
    ----------
    up : int
        The axis of the capture that points up.
    size : float
        The skeleton's size in the capture's unit.
    floor : float
        Height of the floor in the capture's unit.
    """

    up: int
    size: float
    floor: float

    @classmethod
    def of(cls, motion: Motion) -> Space:
        """Take the floor to be where the lowest joint is most of the time it is down."""
        lowest = motion.positions()[..., motion.up].min(axis=1)
        return cls(motion.up, motion.skeleton.size, float(np.percentile(lowest, 2)))

    def points(self, motion: Motion) -> Array:
        """Return joints and ends of limbs (F, P, 3) of a motion in this space."""
        places, turns = forward_kinematics(
            motion.skeleton, motion.rotations, motion.root_path, translations=motion.translations
        )
        ends = [
            places[:, joint] + rot.rotate(turns[:, joint], offset)
            for joint, offset in motion.skeleton.end_sites
        ]
        everything = np.concatenate([places, np.stack(ends, axis=1)], axis=1) if ends else places
        everything = everything - self.floor * np.eye(3)[self.up]
        return everything[..., [(self.up + 2) % 3, self.up, (self.up + 1) % 3]] / self.size


@dataclass(frozen=True)
class Bone:
    """A line between two of a `Space`'s points.

    Parameters
    ----------
    start, stop : int
    side : int
        -1 on the left, 1 on the right, 0 in the middle, as the joint's name tells.
    is_head : bool
        Whether it ends the neck.
    """

    start: int
    stop: int
    side: int
    is_head: bool


def bones(skeleton: Skeleton) -> list[Bone]:
    """List the bones that have a length; points are joints, then ends of limbs."""
    from_to = [(parent, joint) for joint, parent in enumerate(skeleton.parents) if joint]
    lengths = [float(np.linalg.norm(skeleton.offsets[joint])) for _, joint in from_to]
    for number, (joint, offset) in enumerate(skeleton.end_sites):
        from_to.append((joint, skeleton.n_joints + number))
        lengths.append(float(np.linalg.norm(offset)))
    result = []
    for (start, stop), length in zip(from_to, lengths, strict=True):
        is_end = stop >= skeleton.n_joints
        name = skeleton.names[start if is_end else stop]
        if length > 1e-6 * skeleton.size:
            result.append(Bone(start, stop, _side(name), is_end and "head" in name.lower()))
    return result


def _side(name: str) -> int:
    return int(_RIGHT.search(name) is not None) - int(_LEFT.search(name) is not None)
