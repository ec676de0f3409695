"""One pass whose ends meet: a clip that is a loop already, seen once.

Nothing is seen twice, so there is no probability; it is told only where nothing repeats.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import TINY
from roundelay.timeline.thresholds import CLOSING

__all__ = ["closing_length"]

Array = NDArray[np.float64]


def closing_length(points: Array, *, chosen: bool = False) -> int | None:
    """Return how many of some frames, from the first on, are one closed pass, or None.

    Parameters
    ----------
    points : (F, d) ndarray
        One pose a frame, in body sizes.
    chosen : bool
        A person says that the frames are one period: its ends may lie a few steps apart.
    """
    if len(points) < CLOSING.fewest:
        return None
    if np.sqrt(np.sum(np.var(points, axis=0)) / (points.shape[1] / 3)) < CLOSING.least:
        return None
    fewest = len(points) - (0 if chosen else int(CLOSING.many * len(points)))
    worst, length = min(
        (_seam(points[:length]), -length) for length in range(fewest, len(points) + 1)
    )
    if not _ends_meet(points[:-length], chosen=chosen) or (worst > CLOSING.seam and not chosen):
        return None
    return -length


def _ends_meet(clip: Array, *, chosen: bool) -> bool:
    """Tell whether the way from the last pose to the first is no longer than so many steps.

    Where the ends move slower than the rest, it must be short against the movement, too.
    """
    steps = np.linalg.norm(np.diff(clip, axis=0), axis=1)
    own = 0.5 * float(steps[0] + steps[-1])
    way = float(np.linalg.norm(clip[-1] - clip[0]))
    moved = float(np.sqrt(np.sum(np.var(clip, axis=0))))
    step = max(float(np.median(steps)), own)
    if chosen:
        return way <= CLOSING.chosen * step
    if step > moved:
        # Where steps are as long as the poses differ, any two are a step apart: noise.
        return False
    return way <= CLOSING.gap * step and way - CLOSING.gap * own <= CLOSING.apart * moved


def _seam(clip: Array) -> float:
    """Return how much velocity changes near the seam, over what it changes nearly anywhere.

    On a clock of the pass's own, with the last frame one step before the first.
    """
    ring = np.concatenate([clip, clip[:1]])
    where = np.arange(CLOSING.clock) * len(clip) / CLOSING.clock
    before = where.astype(np.intp)
    part = (where - before)[:, None]
    coarse = ring[before] * (1.0 - part) + ring[before + 1] * part
    change = np.linalg.norm(np.roll(coarse, -1, 0) - 2 * coarse + np.roll(coarse, 1, 0), axis=1)
    return float(
        max(change[[-1, 0, 1]]) / max(float(np.percentile(change[2:-1], CLOSING.nearly)), TINY)
    )
