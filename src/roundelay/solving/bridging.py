"""Joints that the markers of a frame do not tell: bridged from frames that do."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.geometry import rotations as rot
from roundelay.motion.poses import Mask
from roundelay.solving.body import Body, Poses
from roundelay.solving.equations import Targets, in_blocks, normal_equations
from roundelay.solving.thresholds import SMOOTHING

__all__ = ["averaged", "bridged", "told"]

Array = NDArray[np.float64]


def told(body: Body, poses: Poses, targets: Targets, fps: float) -> Mask:
    """Return which joints (F, J) the markers of a frame tell.

    A joint is told if the axis about which markers tell least of it is known nearly as well as it
    usually is, by the least eigenvalue of its information; and if it turns no faster than joints
    can.
    """
    blocks = in_blocks(len(poses), body, 3 + 3 * len(body.parents))
    least = [_least_information(body, poses[block], targets[block]) for block in blocks]
    known = np.concatenate(least)
    turns = rot.vector_between(poses.rotations[:-1], poses.rotations[1:])
    slow = np.linalg.norm(turns, axis=2) * fps < SMOOTHING.fastest
    result = known > SMOOTHING.told * np.median(known, axis=0)
    result[1:] &= slow
    result[:-1] &= slow
    return np.asarray(result)


def _least_information(body: Body, poses: Poses, targets: Targets) -> Array:
    slopes = normal_equations(body, poses, targets).slopes[..., 3:]
    slopes = slopes.reshape(*slopes.shape[:2], len(body.parents), 3)
    blocks = np.einsum("fmjk,fmjl->fjkl", slopes, slopes)
    return np.asarray(np.linalg.eigvalsh(blocks)[..., 0])


def bridged(rotations: Array, known: Mask) -> Array:
    """Return rotations (F, J, 4) of which those not known (F, J) lie between those known."""
    result, frames = rot.continuous(rotations), np.arange(len(rotations))
    for joint in range(rotations.shape[1]):
        places = np.flatnonzero(known[:, joint])
        if 0 < len(places) < len(frames):
            after = places[np.minimum(np.searchsorted(places, frames), len(places) - 1)]
            at = np.maximum(np.searchsorted(places, frames, side="right") - 1, 0)
            before = places[at]
            part = np.clip((frames - before) / np.maximum(after - before, 1), 0.0, 1.0)
            own = result[:, joint]
            result[:, joint] = rot.slerp(own[before], own[after], part)
    return rot.continuous(result)


def averaged(rotations: Array, reach: int) -> Array:
    """Return rotations (F, J, 4) averaged over so many frames to either side."""
    q = rot.continuous(rotations)
    padded = np.concatenate([np.repeat(q[:1], reach, axis=0), q, np.repeat(q[-1:], reach, axis=0)])
    total = np.concatenate([np.zeros((1, *q.shape[1:])), np.cumsum(padded, axis=0)])
    return rot.normalize(total[2 * reach + 1 :] - total[: -2 * reach - 1])
