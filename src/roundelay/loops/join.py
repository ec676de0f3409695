"""How hard a loop jerks where it is joined: the one measure that loops are judged by."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import TINY

__all__ = ["join_ratio"]

Array = NDArray[np.float64]


def join_ratio(
    points: Array, period: int, *, missing: int = 0, last_key: Array | None = None
) -> float:
    """Return the largest acceleration at the joins of a loop over the largest elsewhere.

    Parameters
    ----------
    points : (n, k, 3) ndarray
        Of whole periods, the frame after whose last is the first again; in one's own place.
    period : int
        Frames of a period. It is joined to the next by its last frame and that one's first.
    missing : int
        So many frames at the end are none of the file's: what they are joined by is judged, too.
    last_key : (k, 3) ndarray, optional
        What a file holds in place of the first frame, where the loop begins again.
    """
    around = np.concatenate([points[-1:], points, points[:1]])
    bends = np.linalg.norm(np.diff(around, n=2, axis=0), axis=-1).max(axis=1)
    frame = np.arange(len(points))
    joined = np.isin(frame % period, (0, period - 1)) | (frame >= len(points) - missing - 1)
    hardest = bends[joined].max()
    if last_key is not None:
        bend = np.linalg.norm(points[-1] - 2 * last_key + points[1], axis=-1).max()
        hardest = max(hardest, bend)
    return float(hardest / max(bends[~joined].max(initial=0.0), TINY))
