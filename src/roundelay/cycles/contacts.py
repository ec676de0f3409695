"""When the feet of a cycle stand."""

from __future__ import annotations

import numpy as np

from roundelay.cycles.cycle import Cycle
from roundelay.geometry.contacts import Foot, Mask, contacts
from roundelay.motion.feet import feet_of

__all__ = ["standing_feet"]


def standing_feet(cycle: Cycle, count: int) -> tuple[tuple[Foot, ...], Mask]:
    """Tell when the feet stand, at even phases of one period.

    Parameters
    ----------
    cycle : Cycle
    count : int
        How many phases.

    Returns
    -------
    feet : tuple of Foot
    standing : (count, n) ndarray of bool
    """
    # The periods before and after decide about feet that stand across the seam.
    phases = np.arange(-count, 2 * count) / count
    around = cycle.at(phases, frame_time=cycle.period / count).with_root_motion()
    feet, points = feet_of(around)
    size = around.skeleton.size
    standing = contacts(points, fps=around.fps, size=size, up=around.up)
    return feet, standing[count : 2 * count]
