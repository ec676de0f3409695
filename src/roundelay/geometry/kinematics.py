"""Forward kinematics: from rotations to joint positions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.geometry.thresholds import UPRIGHT

__all__ = ["forward_kinematics", "heading", "vertical_axis"]

Array = NDArray[np.float64]


def forward_kinematics(
    skeleton: Skeleton,
    rotations: Array,
    root_path: Array | None = None,
    *,
    translations: Array | None = None,
) -> tuple[Array, Array]:
    """Place every joint.

    Parameters
    ----------
    skeleton : Skeleton
    rotations : (F, J, 4) ndarray
        Local rotations, unit quaternions.
    root_path : (F, 3) ndarray, optional
        Position of the root; the origin by default.
    translations : (F, J, 3) ndarray, optional
        Positions relative to the parent where they are not the skeleton's offsets.

    Returns
    -------
    positions : (F, J, 3) ndarray
        In the skeleton's length unit.
    orientations : (F, J, 4) ndarray
        Global rotations.
    """
    frames, joints = rotations.shape[:2]
    local = np.broadcast_to(skeleton.offsets, (frames, joints, 3))
    if translations is not None:
        local = translations
    parents = np.array(skeleton.parents)
    # Components first: numpy then works along frames, contiguous in memory.
    positions = np.empty((joints, frames, 3))
    orientations = np.empty((joints, frames, 4))
    positions[0] = 0.0 if root_path is None else root_path
    orientations[0] = rotations[:, 0]
    for level in skeleton.levels[1:]:
        above = parents[level]
        turn = orientations[above]
        orientations[level] = rot.multiply(turn, np.moveaxis(rotations[:, level], 1, 0))
        positions[level] = positions[above] + rot.rotate(turn, np.moveaxis(local[:, level], 1, 0))
    return np.moveaxis(positions, 0, 1), np.moveaxis(orientations, 0, 1)


def heading(orientations: Array, up: int = 1) -> Array:
    """Return the angle (...) in radians by which rotations (..., 4) turn about the up axis.

    The twist of the swing-twist decomposition, in (-pi, pi].
    """
    return np.asarray(2.0 * np.arctan2(*_twist_legs(orientations, up)))


def _twist_legs(orientations: Array, up: int) -> tuple[Array, Array]:
    w, along = orientations[..., 0], orientations[..., 1 + up]
    sign = np.where(w < 0.0, -1.0, 1.0)
    return sign * along, sign * w


def vertical_axis(positions: Array, size: float) -> int:
    """Guess which axis points up: Y, unless Z fits a floor much better.

    Along the vertical, the body stands well above its lowest joint, and the lowest joint keeps
    its height.

    Parameters
    ----------
    positions : (F, J, 3) ndarray
        Global joint positions.
    size : float
        The skeleton's size, in the same unit.

    Returns
    -------
    int
        1 or 2.
    """
    lowest = positions.min(axis=1)
    height = np.mean(positions.mean(axis=1) - lowest, axis=0)
    # A twentieth of the body is what a floor varies by at least (toes roll, heels lift).
    fit = height / (np.std(lowest, axis=0) + UPRIGHT.floor * size)
    better = fit[2] > UPRIGHT.better * max(fit[1], 0.0)
    return 2 if better and height[2] > UPRIGHT.height * size else 1
