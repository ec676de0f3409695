"""Where the feet of a motion touch the ground."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.geometry.contacts import Foot, find_feet, foot_points
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.motion.motion import Motion

__all__ = ["feet_of", "touching"]

Array = NDArray[np.float64]


def feet_of(motion: Motion) -> tuple[tuple[Foot, ...], Array]:
    """Find the feet of a motion, and where they touch the ground.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    feet : tuple of Foot
        Empty if no limb of two bones comes near the ground.
    points : (F, n, 3) ndarray
        In the world, in the skeleton's length unit.
    """
    places, turns = _placed(motion)
    feet = find_feet(motion.skeleton, places, motion.up)
    return feet, foot_points(feet, places, turns)


def touching(motion: Motion, feet: tuple[Foot, ...]) -> Array:
    """Return where feet touch the ground that were found in another motion of the skeleton.

    Parameters
    ----------
    motion : Motion
    feet : tuple of Foot

    Returns
    -------
    (F, n, 3) ndarray
        In the world, in the skeleton's length unit.
    """
    return foot_points(feet, *_placed(motion))


def _placed(motion: Motion) -> tuple[Array, Array]:
    return forward_kinematics(
        motion.skeleton, motion.rotations, motion.root_path, translations=motion.translations
    )
