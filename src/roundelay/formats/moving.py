"""Which joints move on their parents: those need translations in a file, others do not."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.motion.motion import Motion

__all__ = ["moving_joints"]

# A joint moves if it leaves its offset by more than this, in body sizes.
_MOVES = 1e-6


def moving_joints(motion: Motion) -> list[tuple[int, NDArray[np.float64]]]:
    """List the joints, the root left out, that leave their offsets; with their places (F, 3)."""
    if motion.translations is None:
        return []
    away = np.abs(motion.translations - motion.skeleton.offsets).max(axis=(0, 2))
    moving = np.flatnonzero(away > _MOVES * motion.skeleton.size).tolist()
    return [(joint, motion.translations[:, joint]) for joint in moving if joint]
