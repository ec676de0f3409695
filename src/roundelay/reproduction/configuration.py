"""Motions as the papers see them: the channels of the file, in degrees or radians."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.formats.acclaim import AcclaimLayout
from roundelay.formats.euler import decompose
from roundelay.geometry import rotations as rot
from roundelay.motion.motion import Motion

__all__ = ["configuration", "euler_angles"]

Array = NDArray[np.float64]


def euler_angles(motion: Motion, rotations: Array) -> Array:
    """Return the file's rotation channels, unwrapped; three for every joint.

    In the order of a BVH's channels; of ASF/AMC about the bone's own axes, rx ry rz, as [C]'s
    figures are reproduced best. A loop may leave the channels a bone has: all three count.

    Parameters
    ----------
    motion : Motion
        Whose file tells the channels.
    rotations : (F, J, 4) ndarray
        Of the motion, or of a loop of it.

    Returns
    -------
    (F, J, 3) ndarray
        In radians.
    """
    layout = motion.skeleton.layout
    if isinstance(layout, AcclaimLayout):
        axes = layout.local_axes()
        rotations = rot.multiply(rot.conjugate(axes), rot.multiply(rotations, axes))
        return np.radians(decompose(rotations, "ZYX", "continuous"))
    result = np.zeros((*rotations.shape[:2], 3))
    for order in set(layout.orders):
        joints = [joint for joint, other in enumerate(layout.orders) if other == order]
        angles = decompose(rotations[:, joints], order, "continuous")
        result[:, joints, : len(order)] = np.radians(angles)
    return result


def configuration(motion: Motion) -> Array:
    """Return a motion in the space of [A] 3.1, the root by first differences (4.1).

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    (F, 3 + 3 J) ndarray
        Steps of the root in the file's unit, steps of its three angles in degrees, and the angles
        of all other joints in degrees; the last steps repeat the ones before. Of the CMU skeleton
        62 columns vary: 6 of the root and 56 of joints.
    """
    angles = np.degrees(euler_angles(motion, motion.rotations)).reshape(len(motion), -1)
    root = np.hstack([motion.root_path, angles[:, :3]])
    steps = np.diff(root, axis=0)
    steps = np.vstack([steps, steps[-1:] if len(steps) else np.zeros((1, 6))])
    return np.hstack([steps, angles[:, 3:]])
