"""Which joints move on their parents: those need translations, others do not."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.motion.motion import Motion

__all__ = ["leave", "moving_joints"]

Array = NDArray[np.float64]

# A joint moves if it leaves its offset by more than this, in body sizes.
_MOVES = 1e-6


def leave(places: Array, offsets: Array, size: float) -> NDArray[np.bool_]:
    """Tell which joints leave their offsets, by more than a millionth of the body.

    Parameters
    ----------
    places : (F, ..., 3) ndarray
        Of joints on their parents, in the file's length unit; at least one frame.
    offsets : (..., 3) ndarray
        Where they are at rest.
    size : float
        The skeleton's size, in the same unit.

    Returns
    -------
    (...) ndarray of bool
    """
    return np.asarray(np.abs(places - offsets).max(axis=(0, -1)) > _MOVES * size)


def moving_joints(motion: Motion) -> list[tuple[int, Array]]:
    """List the joints, the root left out, that leave their offsets; with their places (F, 3)."""
    if motion.translations is None:
        return []
    moving = leave(motion.translations, motion.skeleton.offsets, motion.skeleton.size)
    places = motion.translations
    return [(joint, places[:, joint]) for joint in np.flatnonzero(moving).tolist() if joint]
