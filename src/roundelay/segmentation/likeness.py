"""How alike two stretches of a take are: how much worse one predicts the other than itself.

A stretch is cut into short windows of what is left of its poses when slow posture is taken off,
so that a person who sinks or leans in the course of a minute is the same all along. A window is
predicted by the one most like it: of its own stretch, but not of the same moment, and of the
other stretch. Means of logarithms are compared, for one step that nothing predicts must not
decide. What predicts nothing but stands in another posture altogether counts by its posture.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.segmentation.model import smoothed
from roundelay.segmentation.thresholds import LIKENESS

__all__ = ["Stretch", "unlikeness"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Stretch:
    """Frames of one kind, as windows of poses.

    Parameters
    ----------
    frames : int
    resolution : float
        A difference between poses too small to matter, in the unit of the poses.
    mean : (d,) ndarray
        Its posture.
    windows : (m, k d) ndarray
        Motion about the slow posture; distances are those of poses, averaged over a window.
    asked : (a, k d) ndarray
        Windows at even places, which are to be predicted.
    own : (a,) ndarray
        Squared error with which the rest of the stretch predicts each.
    shows : frozenset of int
        What is known to repeat in most of its frames, by number.
    """

    frames: int
    resolution: float
    mean: Array
    windows: Array
    asked: Array
    own: Array
    shows: frozenset[int] = frozenset()

    @classmethod
    def of(cls, points: Array, fps: float, resolution: float) -> Stretch:
        """Take poses (n, d) at a rate apart, n of at least 1."""
        moving = points - smoothed(points, LIKENESS.posture * fps, ends="reflect")
        places, windows = _windows(moving, fps)
        chosen = np.unique(np.linspace(0, len(windows) - 1, LIKENESS.asked).astype(int))
        errors = _squared(windows[chosen], windows)
        near = min(LIKENESS.apart * fps, len(points) // 4)
        errors[np.abs(places[chosen, None] - places) <= near] = np.inf
        # A window that has no other to be predicted by is predicted by standing still.
        alone = ~np.isfinite(errors).any(axis=1)
        own = np.where(alone, np.sum(windows[chosen] ** 2, axis=1), errors.min(axis=1))
        return cls(len(points), resolution, points.mean(axis=0), windows, windows[chosen], own)

    @property
    def still(self) -> bool:
        """Whether it moves no more than errors that do not matter."""
        moved = np.mean(np.sum(self.windows**2, axis=1))
        return bool(moved < (LIKENESS.error * self.resolution) ** 2)


def unlikeness(one: Stretch, other: Stretch) -> tuple[float, float]:
    """Return how much worse stretches are predicted by each other than by themselves.

    Parameters
    ----------
    one, other : Stretch
        Of one resolution.

    Returns
    -------
    tuple of float
        Of the side that is predicted better, and of both together: logarithms of how many times
        larger errors are, and a share of that of the distance of their postures. Where the
        same is known to repeat in both, they are the same.
    """
    if one.shows & other.shows:
        return LIKENESS.same, LIKENESS.same
    error = LIKENESS.error * one.resolution
    step = float(np.linalg.norm(one.mean - other.mean)) + LIKENESS.offset * one.resolution
    if one.still and other.still:
        # Nothing moves that could be predicted.
        held = float(np.log(step / (error + LIKENESS.offset * one.resolution)))
        return held, held
    sides = [_worse(a, b, error) for a, b in ((one, other), (other, one))]
    posture = LIKENESS.share * float(np.log(step / (LIKENESS.far * one.resolution)))
    return min(sides) + posture, sum(sides) / 2.0 + posture


def _worse(asked: Stretch, by: Stretch, error: float) -> float:
    """Return the mean logarithm of how many times worse another stretch predicts windows."""
    theirs = _squared(asked.asked, by.windows).min(axis=1)
    return float(0.5 * np.mean(np.log((theirs + error**2) / (asked.own + error**2))))


def _windows(points: Array, fps: float) -> tuple[NDArray[np.intp], Array]:
    """Return where windows begin (m,), and windows (m, k d) of k poses each of points (n, d)."""
    step, count = max(1, round(LIKENESS.window * fps / (LIKENESS.poses - 1))), LIKENESS.poses
    begun = max(1, len(points) - step * (count - 1))
    places = np.linspace(0, begun - 1, min(LIKENESS.windows, begun)).astype(int)
    # A stretch shorter than a window holds its last pose.
    poses = np.minimum(places[:, None] + step * np.arange(count), len(points) - 1)
    windows = points[poses]
    # Distances of windows are then means of those of their poses.
    return places, windows.reshape(len(places), -1) / np.sqrt(count)


def _squared(one: Array, other: Array) -> Array:
    """Return squared distances (a, b) between points (a, d) and (b, d)."""
    lengths = np.sum(one**2, axis=1)[:, None] + np.sum(other**2, axis=1)
    return np.maximum(lengths - 2.0 * one @ other.T, 0.0)
