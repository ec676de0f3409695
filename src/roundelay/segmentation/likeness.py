"""How alike two stretches of a take are: how much worse one predicts the other than itself.

A stretch is cut into short windows of what is left of its poses when slow posture is taken off,
so that a person who sinks or leans in the course of a minute is the same all along. A window is
predicted by the one most like it: of its own stretch, but not of the same moment, and of the
other stretch. Means of logarithms are compared, for one step that nothing predicts must not
decide. What predicts nothing but stands in another posture altogether counts by its posture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.segmentation.model import smoothed
from roundelay.segmentation.thresholds import LIKENESS

__all__ = ["Stretch", "unlikeness"]

Array = NDArray[np.float64]
Windows = NDArray[np.float32]


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
    windows : (m, k d) ndarray of float32
        Motion about the slow posture; distances are those of poses, averaged over a window.
    asked : (a, k d) ndarray of float32
        Windows at even places, which are to be predicted.
    own : (a,) ndarray
        Squared error with which the rest of the stretch predicts each.
    shows : frozenset of int
        What is known to repeat in most of its frames, by number.
    """

    frames: int
    resolution: float
    mean: Array
    windows: Windows
    asked: Windows
    own: Array
    shows: frozenset[int] = frozenset()

    @classmethod
    def of(cls, points: Array, fps: float, resolution: float) -> Stretch:
        """Take poses (n, d) at a rate apart, n of at least 1."""
        slow = smoothed(points, LIKENESS.posture * fps, ends="reflect")
        # Halves memory and time; errors of a millionth of a pose's length do not matter.
        places, windows = _windows((points - slow).astype(np.float32), fps)
        chosen = np.unique(np.linspace(0, len(windows) - 1, LIKENESS.asked).astype(int))
        errors = _squared(windows[chosen], windows)
        near = min(LIKENESS.apart * fps, len(points) // 4)
        errors[np.abs(places[chosen, None] - places) <= near] = np.inf
        # A window that has no other to be predicted by is predicted by standing still.
        alone = ~np.isfinite(errors).any(axis=1)
        own = np.where(alone, np.sum(windows[chosen] ** 2, axis=1), errors.min(axis=1))
        return cls(len(points), resolution, points.mean(axis=0), windows, windows[chosen], own)

    @cached_property
    def still(self) -> bool:
        """Whether it moves no more than errors that do not matter."""
        moved = np.mean(np.sum(self.windows**2, axis=1))
        return bool(moved < (LIKENESS.error * self.resolution) ** 2)

    @cached_property
    def sketch(self) -> Stretch:
        """The same with few windows, to tell at little cost what it is not like."""
        windows = _some(self.windows, LIKENESS.sketched_windows)
        asked = _some(self.asked, LIKENESS.sketched_asked)
        return replace(self, windows=windows, asked=asked, own=_some(self.own, len(asked)))


def unlikeness(one: Stretch, others: Sequence[Stretch]) -> tuple[Array, Array]:
    """Return how much worse stretches are predicted by each other than by themselves.

    Parameters
    ----------
    one : Stretch
    others : sequence of Stretch
        Of its resolution; n of them.

    Returns
    -------
    least, mean : (n,) ndarray
        Of the side that is predicted better, and of both together: logarithms of how many times
        larger errors are, and a share of that of the distance of their postures. Where the
        same is known to repeat in both, they are the same.
    """
    error, near = LIKENESS.error * one.resolution, LIKENESS.offset * one.resolution
    sides = np.stack([_worse_by(one, others, error), _worse_than(one, others, error)])
    apart = np.linalg.norm([each.mean - one.mean for each in others], axis=-1) + near
    posture = LIKENESS.share * np.log(apart / (LIKENESS.far * one.resolution))
    least, mean = sides.min(axis=0) + posture, sides.mean(axis=0) + posture
    # Nothing moves that could be predicted.
    held = np.array([one.still and each.still for each in others])
    least[held] = mean[held] = np.log(apart[held] / (error + near))
    same = np.array([bool(one.shows & each.shows) for each in others])
    least[same] = mean[same] = LIKENESS.same
    return least, mean


def _worse_by(one: Stretch, others: Sequence[Stretch], error: float) -> Array:
    """Return the mean logarithm (n,) of how many times worse others predict a stretch."""
    windows = np.concatenate([each.windows for each in others])
    first = np.cumsum([0, *(len(each.windows) for each in others[:-1])])
    theirs = np.minimum.reduceat(_squared(one.asked, windows), first, axis=1)
    own = one.own[:, None]
    return np.asarray(0.5 * np.mean(np.log((theirs + error**2) / (own + error**2)), axis=0))


def _worse_than(one: Stretch, others: Sequence[Stretch], error: float) -> Array:
    """Return the mean logarithm (n,) of how many times worse a stretch predicts others."""
    asked = np.concatenate([each.asked for each in others])
    own = np.concatenate([each.own for each in others])
    counts = np.array([len(each.asked) for each in others])
    theirs = _squared(asked, one.windows).min(axis=1)
    worse = 0.5 * np.log((theirs + error**2) / (own + error**2))
    return np.asarray(np.add.reduceat(worse, np.cumsum(counts) - counts) / counts)


def _some(rows: NDArray[Any], most: int) -> NDArray[Any]:
    """Return rows (n, ...) at even places, so many at most."""
    return rows[np.linspace(0, len(rows) - 1, min(most, len(rows))).astype(int)]


def _windows(points: Windows, fps: float) -> tuple[NDArray[np.intp], Windows]:
    """Return where windows begin (m,), and windows (m, k d) of k poses each of points (n, d)."""
    step, count = max(1, round(LIKENESS.window * fps / (LIKENESS.poses - 1))), LIKENESS.poses
    begun = max(1, len(points) - step * (count - 1))
    places = np.linspace(0, begun - 1, min(LIKENESS.windows, begun)).astype(int)
    # A stretch shorter than a window holds its last pose.
    poses = np.minimum(places[:, None] + step * np.arange(count), len(points) - 1)
    windows = points[poses]
    # Distances of windows are then means of those of their poses.
    return places, windows.reshape(len(places), -1) / np.sqrt(count)


def _squared(one: Windows, other: Windows) -> Windows:
    """Return squared distances (a, b) between points (a, d) and (b, d)."""
    lengths = np.sum(one**2, axis=1)[:, None] + np.sum(other**2, axis=1)
    return np.maximum(lengths - 2.0 * one @ other.T, 0.0)
