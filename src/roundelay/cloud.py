"""The cloud that topology sees: poses of some frames, told apart by where they are going.

A motion that returns to a pose half-way through its period crosses itself; velocities, or
delays, keep the passages apart ([C] 3.8).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from roundelay.coordinate import CircularCoordinate
from roundelay.poses import principal_components, with_velocity
from roundelay.timing import Run
from roundelay.topology.distances import delay_distances
from roundelay.topology.landmarks import choose_landmarks
from roundelay.topology.rips import Barcode, persistent_cohomology

__all__ = ["PoseCloud", "PoseMetric", "TopologyOptions", "make_cloud", "variance_normalised"]

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
PoseMetric = Literal["euclidean", "variance", "adjacent"]
_Metric = Literal["euclidean", "precomputed"]

# More points than this are thinned to landmarks, chosen from a pool of at most so many; exact
# topology of them takes about 20 ms.
_LANDMARKS, _POOL = 500, 2000
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


@dataclass(frozen=True)
class TopologyOptions:
    """Choices that are automatic unless given.

    Parameters
    ----------
    prime : int
        Coefficients of the cohomology are integers modulo this prime.
    class_index : int, optional
        Which bar to use, 0 being the longest; chosen by hand, it need not stand out.
    max_scale : float, optional
        Largest scale of the filtration, in body sizes ([C] 5.3 item 5): classes born above are
        left out, and bars end there. By default that at which every class has died.
    scale : float, optional
        Scale of the coordinate, between birth and death of the bar, in body sizes.
    delay : float, optional
        Frames by which velocity is weighed against position: period / 2 pi by default, 0 for
        poses alone.
    delays : int, optional
        Use a delay embedding of so many delays over half a period ([C] 3.8; [A] 4.2) instead
        of velocities. It loses half a period at the end of every part.
    metric : {"euclidean", "variance", "adjacent"}
        Distances of poses as they are, of features divided by their standard deviations
        ([A] 6.4), or with frames next to each other in time at distance 0 ([A] 3.2).
    dimensions : int or float, optional
        Project on so many principal axes first, or on those that hold this share of the
        variance ([A] 5.1); none by default.
    """

    prime: int = 47
    class_index: int | None = None
    max_scale: float | None = None
    scale: float | None = None
    delay: float | None = None
    delays: int | None = None
    metric: PoseMetric = "euclidean"
    dimensions: int | float | None = None


@dataclass(frozen=True, eq=False)
class PoseCloud:
    """Poses of some runs with their barcode.

    Attributes
    ----------
    runs : tuple of (start, stop)
        Ranges of the capture's frames.
    frames : (m,) ndarray of int
        The frames taken.
    local : list of (start, stop)
        The runs as ranges of `frames`.
    data : (m, d) or (m, L) ndarray
        Points, or distances to the landmarks.
    landmarks : (L,) ndarray of int
        The places in `frames` of the points of the barcode.
    barcode : Barcode
        Of the landmarks.
    """

    runs: tuple[Run, ...]
    frames: Indices
    local: list[Run]
    data: Array
    landmarks: Indices
    barcode: Barcode

    @property
    def landmark_runs(self) -> list[Run]:
        """The runs as ranges of landmarks."""
        return _runs_of(self.landmarks, self.local)

    def extended(self, coordinate: CircularCoordinate) -> Array:
        """Return the phase (m,) of all frames from that of the landmarks."""
        every = len(self.landmarks) == len(self.frames)
        return coordinate.phase if every else coordinate.evaluate(self.data)


def make_cloud(
    points: Array, runs: Sequence[Run], period: float, step: int, options: TopologyOptions
) -> PoseCloud:
    """Embed the poses of some frames and compute their barcode.

    Parameters
    ----------
    points : (F, d) ndarray
        One pose a frame.
    runs : sequence of (start, stop)
        Frames that show one motion.
    period : float
        Rough period in frames.
    step : int
        Take every step-th frame only.
    options : TopologyOptions

    Returns
    -------
    PoseCloud

    Raises
    ------
    TooShort
        If there are fewer than 4 frames, or a part is shorter than the delays.
    ValueError
        If an option is out of range.
    """
    _check(options)
    thin = [np.arange(start, stop, step) for start, stop in runs]
    frames, local = np.concatenate(thin), _bounds([len(part) for part in thin])
    poses = _scaled(points[frames], options)
    if options.delays is not None:
        return _delayed(poses, runs, frames, local, period / step, options)
    weighing = period / step if options.delay is None else 2 * np.pi * options.delay / step
    cloud = with_velocity(poses, local, weighing)
    if options.metric == "adjacent":
        return _from_distances(_distances(cloud), runs, frames, local, options)
    landmarks = _landmarks(cloud, "euclidean")
    barcode = _barcode(cloud[landmarks], "euclidean", options)
    return PoseCloud(tuple(runs), frames, local, cloud, landmarks, barcode)


def _check(options: TopologyOptions) -> None:
    if options.metric not in get_args(PoseMetric):
        raise ValueError(
            f"expected a metric among {get_args(PoseMetric)}, found {options.metric!r}"
        )
    if options.max_scale is not None and not options.max_scale > 0.0:
        raise ValueError(f"expected a positive maximal scale, found {options.max_scale:g}")
    if options.delay is not None and not 0.0 <= options.delay < np.inf:
        raise ValueError(f"expected a delay of at least 0 frames, found {options.delay:g}")
    if options.delays is not None and options.delays < 1:
        raise ValueError(f"expected at least one delay, found {options.delays}")
    axes = options.dimensions
    if axes is not None and not (axes >= 1 if isinstance(axes, int) else 0.0 < axes < 1.0):
        raise ValueError(
            f"expected a whole number of dimensions or a share below 1, found {axes:g}"
        )


def _barcode(data: Array, metric: _Metric, options: TopologyOptions) -> Barcode:
    barcode = persistent_cohomology(data, metric=metric, prime=options.prime)
    return barcode if options.max_scale is None else barcode.up_to(options.max_scale)


def _landmarks(data: NDArray[np.floating], metric: _Metric) -> Indices:
    """Choose landmarks among points: those far from each other, that no quick move be missed.

    They are chosen from a pool with one of each few neighbours, at no steady beat: at one, motion
    that repeats exactly would show the same few phases again and again.
    """
    count = len(data)
    if count <= _LANDMARKS:
        return np.arange(count)
    stride = -(-count // _POOL)
    starts = np.arange(0, count, stride)
    inside = (np.arange(len(starts)) * _GOLDEN % 1.0 * stride).astype(np.intp)
    pool = np.minimum(starts + inside, count - 1)
    near = data[pool] if metric == "euclidean" else data[np.ix_(pool, pool)]
    return pool[choose_landmarks(near, count=_LANDMARKS, method="greedy", metric=metric).indices]


def _runs_of(landmarks: Indices, local: list[Run]) -> list[Run]:
    bounds = np.searchsorted(landmarks, local).tolist()
    return [(start, stop) for start, stop in bounds]


def _scaled(poses: Array, options: TopologyOptions) -> Array:
    if options.metric == "variance":
        poses = variance_normalised(poses)
    return poses if options.dimensions is None else principal_components(poses, options.dimensions)


def variance_normalised(points: Array) -> Array:
    """Divide every column by its standard deviation ([A] 6.4); those that rest become 0."""
    spread = np.std(points, axis=0)
    return points / np.where(spread > 1e-6 * spread.max(initial=0.0), spread, np.inf)


def _delayed(
    poses: Array,
    runs: Sequence[Run],
    frames: Indices,
    local: list[Run],
    period: float,
    options: TopologyOptions,
) -> PoseCloud:
    count = options.delays or 0
    delays = np.unique(np.round(np.linspace(0.0, 0.5 * period, count + 1)).astype(int))
    distances, kept, kept_runs = delay_distances(_distances(poses) ** 2, delays.tolist(), local)
    long_enough = [run for run, (a, b) in zip(runs, local, strict=True) if b - a > delays[-1]]
    return _from_distances(distances, long_enough, frames[kept], list(kept_runs), options)


def _from_distances(
    distances: NDArray[np.floating],
    runs: Sequence[Run],
    frames: Indices,
    local: list[Run],
    options: TopologyOptions,
) -> PoseCloud:
    landmarks = _landmarks(distances, "precomputed")
    near = np.array(distances[np.ix_(landmarks, landmarks)], float)
    if options.metric == "adjacent":
        for a, b in _runs_of(landmarks, local):
            after = np.arange(a + 1, b)
            near[after - 1, after] = near[after, after - 1] = 0.0
    barcode = _barcode(near, "precomputed", options)
    data = np.asarray(distances[:, landmarks], float)
    return PoseCloud(tuple(runs), frames, local, data, landmarks, barcode)


def _distances(points: Array) -> Array:
    squares = np.einsum("ij,ij->i", points, points)
    apart = np.maximum(squares[:, None] + squares - 2.0 * points @ points.T, 0.0)
    np.fill_diagonal(apart, 0.0)
    return np.sqrt(np.minimum(apart, apart.T))


def _bounds(lengths: list[int]) -> list[Run]:
    stops = np.cumsum(lengths).tolist()
    return list(zip([0, *stops[:-1]], stops, strict=True))
