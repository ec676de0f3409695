"""What a capture will cost, told by its size before work starts."""

from __future__ import annotations

from roundelay.base.memory import require_room
from roundelay.motion.motion import Motion

__all__ = ["WORK", "require_budget"]

WORK = 400
"""Bytes a joint and frame that the search for cycles takes at its peak, with the motion itself.

Measured by the benchmark `budget` and by hand on walks of 4 to 19 joints and up to 480,000 frames:
340 to 460.
"""


def require_budget(motion: Motion, frames: tuple[int, int] | None = None) -> None:
    """Check that there is memory for the search in a capture, or in a range of its frames.

    Raises
    ------
    TooLarge
        If less is free than it would take: how much, and what to do.
    """
    start, stop = frames or (0, len(motion))
    count, joints = stop - start, motion.skeleton.n_joints
    require_room(
        WORK * count * joints,
        f"{count} frames of {joints} joints",
        "take a part of them (--frames START:STOP), or fewer a second (roundelay convert --fps)",
    )
