"""The capture as the page plays it: joint positions at some 30 frames a second."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.motion import Motion
from roundelay.page.packing import Packer
from roundelay.skeleton import Skeleton

__all__ = ["Space", "bones", "capture_data", "sampling_step"]

Array = NDArray[np.float64]

_LEFT = re.compile(r"left|^l(?=[A-Z_.\s])|[._\s]l$|^l(?=[a-z]+$)", re.IGNORECASE)
_RIGHT = re.compile(r"right|^r(?=[A-Z_.\s])|[._\s]r$|^r(?=[a-z]+$)", re.IGNORECASE)
# Captures with more samples than this are thinned below 30 a second, but not below 10.
_MOST_SAMPLES = 3000


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


def sampling_step(motion: Motion) -> int:
    """Return how many frames of the capture one sample of the page stands for."""
    usual, slowest = round(motion.fps / 30.0), round(motion.fps / 10.0)
    return max(1, usual, min(math.ceil(len(motion) / _MOST_SAMPLES), slowest))


def capture_data(motion: Motion, space: Space, packer: Packer) -> dict[str, Any]:
    """Describe the capture: its skeleton, its rate, its joints' positions."""
    step = sampling_step(motion)
    sampled = motion.at(np.arange(0, len(motion), step))
    points = space.points(sampled).reshape(len(sampled), -1)
    return {
        "frames": len(motion),
        "fps": round(motion.fps, 6),
        "step": step,
        "joints": motion.skeleton.n_joints,
        "bones": bones(motion.skeleton),
        "points": packer.add(points, common_step=True),
    }


def bones(skeleton: Skeleton) -> list[list[int]]:
    """List the bones that have a length: from and to point, side (-1 left, 1 right), is head."""
    from_to = [(parent, joint) for joint, parent in enumerate(skeleton.parents) if joint]
    lengths = [float(np.linalg.norm(skeleton.offsets[joint])) for _, joint in from_to]
    for number, (joint, offset) in enumerate(skeleton.end_sites):
        from_to.append((joint, skeleton.n_joints + number))
        lengths.append(float(np.linalg.norm(offset)))
    result = []
    for (start, stop), length in zip(from_to, lengths, strict=True):
        joint = stop if stop < skeleton.n_joints else start
        name, is_end = skeleton.names[joint], stop >= skeleton.n_joints
        if length > 1e-6 * skeleton.size:
            result.append([start, stop, _side(name), int(is_end and "head" in name.lower())])
    return result


def _side(name: str) -> int:
    return int(_RIGHT.search(name) is not None) - int(_LEFT.search(name) is not None)
