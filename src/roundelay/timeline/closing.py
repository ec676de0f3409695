"""One pass whose ends meet: a clip that is a loop already, seen once.

Nothing is seen twice, so there is no probability; it is told only where nothing repeats.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import TINY
from roundelay.base.spans import Span
from roundelay.timeline.thresholds import CLOSING

__all__ = ["closing_span"]

Array = NDArray[np.float64]


def closing_span(points: Array, fps: float, first: int = 0) -> Span | None:
    """Return the frames that are one closed pass, or None.

    Parameters
    ----------
    points : (F, d) ndarray
        One pose a frame, in body sizes.
    fps : float
        Frames a second.
    first : int
        Frames before this one do not count.
    """
    x = points[first:]
    if not CLOSING.fewest <= len(x) <= CLOSING.longest * fps:
        return None
    if np.sqrt(np.sum(np.var(x, axis=0)) / (x.shape[1] / 3)) < CLOSING.least:
        return None
    lengths = range(len(x) - int(CLOSING.many * len(x)), len(x) + 1)
    worst, length = min((_seam(x[:length]), -length) for length in lengths)
    if worst > CLOSING.seam or not _ends_meet(x[:-length]):
        return None
    return first, first - length


def _ends_meet(clip: Array) -> bool:
    """Tell whether the way from the last pose to the first is no longer than a step."""
    steps = np.linalg.norm(np.diff(clip, axis=0), axis=1)
    step = max(float(np.median(steps)), 0.5 * float(steps[0] + steps[-1]))
    return bool(np.linalg.norm(clip[-1] - clip[0]) <= CLOSING.gap * step)


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
