"""Feet that stand: a point on the ground is one place seen many times.

Where keypoints are noisy, the points of a foot are held where they are seen on average while they
stand, as `roundelay.geometry.contacts` tells it of the solved motion.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.spans import Spans
from roundelay.geometry.contacts import contacts
from roundelay.solving.body import Body, Poses
from roundelay.solving.equations import Targets, marker_places
from roundelay.solving.thresholds import STANDING

__all__ = ["standing_feet"]

Array = NDArray[np.float64]


def standing_feet(body: Body, poses: Poses, targets: Targets, *, fps: float) -> Targets:
    """Return targets whose feet stand while they stand in poses.

    Parameters
    ----------
    body : Body
    poses : Poses
        Smooth ones.
    targets : Targets
        What was seen.
    fps : float
    """
    feet = [marker for marker, joint in enumerate(body.joints) if "Foot" in body.names[joint]]
    if not feet:
        return targets
    points = marker_places(body, poses)[:, feet]
    size = body.skeleton.size
    standing = contacts(points, fps=fps, size=size, up=1)
    places, weights = targets.places.copy(), targets.weights.copy()
    for column, marker in enumerate(feet):
        for start, stop in Spans.of_mask(standing[:, column]):
            seen = targets.weights[start:stop, marker] > 0.0
            if seen.sum() >= STANDING.fewest:
                mean = targets.places[start:stop, marker][seen].mean(axis=0)
                places[start:stop, marker] = mean
                weights[start:stop, marker] = STANDING.firm**-2
    return replace(targets, places=places, weights=weights)
