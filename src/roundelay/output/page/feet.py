"""When the feet stand, for capture and loop."""

from __future__ import annotations

from typing import Any

import numpy as np

from roundelay.base.spans import Spans
from roundelay.cycles.cycle import Cycle
from roundelay.geometry.contacts import contacts
from roundelay.motion.feet import feet_of
from roundelay.motion.motion import Motion

__all__ = ["foot_spans", "loop_feet"]


def foot_spans(motion: Motion) -> list[dict[str, Any]]:
    """List each foot's joint and the half-open ranges of frames in which it stands."""
    feet, points = feet_of(motion)
    down = contacts(points, fps=motion.fps, size=motion.skeleton.size, up=motion.up)
    return [
        {"joint": foot.joint, "spans": Spans.of_mask(column)}
        for foot, column in zip(feet, down.T, strict=True)
    ]


def loop_feet(cycle: Cycle) -> list[dict[str, Any]]:
    """List the same for a loop, in phases of one period, which a span may leave at its end."""
    # The middle one of three periods knows what comes before and after.
    count = max(8, round(cycle.period * cycle.fps))
    thrice = cycle.at(np.arange(3 * count) / count, frame_time=cycle.period / count)
    thrice = thrice.with_root_motion()
    return [
        {
            "joint": foot["joint"],
            "spans": [
                (start / count - 1.0, stop / count - 1.0)
                for start, stop in foot["spans"]
                if stop > count and start < 2 * count
            ],
        }
        for foot in foot_spans(thrice)
    ]
