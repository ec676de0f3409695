"""The cloud that topology sees: poses of some frames, told apart by where they are going.

A motion that returns to a pose half-way through its period crosses itself; velocities, or
delays, keep the passages apart ([C] 3.8).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.brief import brief
from roundelay.base.numeric import GOLDEN
from roundelay.base.spans import Span, Spans
from roundelay.motion.poses import principal_components, with_velocity
from roundelay.timeline.options import TopologyOptions
from roundelay.timeline.search import Search
from roundelay.timeline.thresholds import CLOUD
from roundelay.topology.coordinate import CircularCoordinate
from roundelay.topology.distances import Metric, cross_distances, pairwise_distances
from roundelay.topology.landmarks import choose_landmarks
from roundelay.topology.rips import Barcode, persistent_cohomology

__all__ = ["PoseCloud", "joined_in_time", "make_cloud", "variance_normalised"]

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class PoseCloud:
    """Poses of some runs with their barcode.

    Attributes
    ----------
    runs : Spans
        The capture's frames.
    frames : (m,) ndarray of int
        The frames taken.
    local : Spans
        The runs as ranges of `frames`.
    data : (m, d) or (m, L) ndarray
        Points, or distances to the landmarks.
    landmarks : (L,) ndarray of int
        The places in `frames` of the points of the barcode.
    barcode : Barcode
        Of the landmarks.
    """

    runs: Spans
    frames: Indices
    local: Spans
    data: Array
    landmarks: Indices
    barcode: Barcode

    __repr__ = brief

    @property
    def landmark_runs(self) -> Spans:
        """The runs as ranges of landmarks."""
        return _runs_of(self.landmarks, self.local)

    def extended(self, coordinate: CircularCoordinate) -> Array:
        """Return the phase (m,) of all frames from that of the landmarks."""
        every = len(self.landmarks) == len(self.frames)
        return coordinate.phase if every else coordinate.evaluate(self.data)


def make_cloud(search: Search, runs: Spans, period: float) -> PoseCloud:
    """Embed the poses of some frames and compute their barcode.

    Parameters
    ----------
    search : Search
    runs : Spans
        Frames that show one motion.
    period : float
        Rough period in frames.

    Returns
    -------
    PoseCloud

    Raises
    ------
    TooShort
        If there are fewer than 4 frames, or a part is shorter than the delays.
    """
    options, step = search.options.topology, search.step
    thin = [np.arange(start, stop, step) for start, stop in runs]
    frames, local = np.concatenate(thin), Spans.end_to_end(len(part) for part in thin)
    poses = _scaled(search.points[frames], options)
    if options.delays is None:
        delay = period / (2 * np.pi) if options.delay is None else options.delay * search.fps
        cloud = with_velocity(poses, local, 2 * np.pi * delay / step)
    else:
        cloud, begins = _delayed(poses, local, period / step, options.delays)
        runs = Spans(run for run, own in zip(runs, begins, strict=True) if len(own))
        frames = frames[np.concatenate(begins)]
        local = Spans.end_to_end(len(own) for own in begins if len(own))
    landmarks = _landmarks(cloud)
    near = cloud[landmarks]
    if options.metric == "adjacent":
        above = pairwise_distances(near)
        joined = joined_in_time(above + above.T, _runs_of(landmarks, local))
        barcode = _barcode(joined, "precomputed", options)
        cloud = np.asarray(cross_distances(cloud, near), float)
    else:
        barcode = _barcode(near, "euclidean", options)
    return PoseCloud(runs, frames, local, cloud, landmarks, barcode)


def _barcode(data: NDArray[np.floating], metric: Metric, options: TopologyOptions) -> Barcode:
    barcode = persistent_cohomology(data, metric=metric, prime=options.prime)
    return barcode if options.max_scale is None else barcode.up_to(options.max_scale)


def _landmarks(points: Array) -> Indices:
    """Choose landmarks among points: those far from each other, that no quick move be missed.

    They are chosen from a pool with one of each few neighbours, at no steady beat: at one, motion
    that repeats exactly would show the same few phases again and again.
    """
    count = len(points)
    if count <= CLOUD.landmarks:
        return np.arange(count)
    stride = -(-count // CLOUD.pool)
    starts = np.arange(0, count, stride)
    inside = (np.arange(len(starts)) * GOLDEN % 1.0 * stride).astype(np.intp)
    pool = np.minimum(starts + inside, count - 1)
    return pool[choose_landmarks(points[pool], count=CLOUD.landmarks, method="greedy").indices]


def _runs_of(landmarks: Indices, local: Spans) -> Spans:
    return Spans(np.searchsorted(landmarks, local).tolist())


def _scaled(poses: Array, options: TopologyOptions) -> Array:
    if options.metric == "variance":
        poses = variance_normalised(poses)
    return poses if options.dimensions is None else principal_components(poses, options.dimensions)


def variance_normalised(points: Array) -> Array:
    """Divide every column by its standard deviation ([A] 6.4); those that rest become 0."""
    spread = np.std(points, axis=0)
    return points / np.where(spread > CLOUD.rests * spread.max(initial=0.0), spread, np.inf)


def _delayed(poses: Array, local: Spans, period: float, count: int) -> tuple[Array, list[Indices]]:
    """Embed poses by delays over half a period, at the scale of the poses.

    Returns
    -------
    cloud : (n, (k + 1) d) ndarray
    begins : list of ndarray of int
        The places at which the points of each run begin.
    """
    delays = np.unique(np.round(np.linspace(0.0, 0.5 * period, count + 1)).astype(np.intp))
    begins = [np.arange(start, stop - delays[-1]) for start, stop in local]
    whole = np.concatenate(begins)[:, None] + delays
    rows = poses[whole].reshape(len(whole), len(delays) * poses.shape[1])
    return rows / np.sqrt(len(delays)), begins


def joined_in_time(distances: NDArray[np.float32], runs: Sequence[Span]) -> NDArray[np.float32]:
    """Return distances in which poses next to each other in time are at distance 0 ([A] 3.2).

    Nearer than neighbours in time usually lie, no pose is told from another: all other distances
    are at least the median step. Without that, every chance meeting would close a loop that is
    born at nearly 0.

    Parameters
    ----------
    distances : (n, n) ndarray
        Symmetric.
    runs : sequence of (start, stop)
        Points that follow each other.
    """
    after = np.concatenate([np.arange(start + 1, stop) for start, stop in runs])
    if len(after) == 0:
        return distances
    joined = np.maximum(distances, np.median(distances[after - 1, after]))
    joined[after - 1, after] = joined[after, after - 1] = 0.0
    np.fill_diagonal(joined, 0.0)
    return joined
