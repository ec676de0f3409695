"""The pipeline of [A] to the letter: from poses to a typical trajectory.

::

    configuration (3.1, 4.1) -> principal axes (5.1) -> Rips complex up to a scale (4.2)
        -> most persistent class -> circular coordinate near the end of its life (4.3)
        -> mixture of three copies (5.2) -> samples -> centroids of neighbours (4.4)
        -> one period at the rate of the capture

Everything is in the unit of the values given; [A] has degrees and the unit of the CMU database.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.brief import brief
from roundelay.base.errors import NoPeriod
from roundelay.base.threads import one_thread
from roundelay.motion.poses import principal_components
from roundelay.phase.mixture import CircularMixture, fit_circular_mixture
from roundelay.phase.period import line_period
from roundelay.phase.unwrap import unwrap
from roundelay.reproduction.options import TrajectoryOptions
from roundelay.topology.coordinate import CircularCoordinate, circular_coordinate
from roundelay.topology.distances import pairwise_distances
from roundelay.topology.rips import Barcode, persistent_cohomology

__all__ = [
    "TypicalTrajectory",
    "centroids",
    "count_simplices",
    "typical_trajectory",
]

Array = NDArray[np.float64]
_Result = TypeVar("_Result")


@dataclass(frozen=True, eq=False)
class TypicalTrajectory:
    """Hold what [A] tells of a capture in its table 1, and the trajectory.

    Attributes
    ----------
    loop : (N, d) ndarray
        One period at the rate of the capture.
    centroids : (samples, d) ndarray
        The closed curve of centroids.
    places : (samples,) ndarray
        Their phases, which part the density into equal shares.
    coordinate : CircularCoordinate
    density : CircularMixture
    barcode : Barcode
        Up to the scale, longest first.
    born : float
        Scale at which the class is born.
    simplices : int
        Vertices, edges and triangles up to the scale.
    cohomology_seconds, processing_seconds : float
        CPU time of the complex and the coordinate, and of all that follows.
    """

    loop: Array = field(repr=False)
    centroids: Array = field(repr=False)
    places: Array = field(repr=False)
    coordinate: CircularCoordinate = field(repr=False)
    density: CircularMixture = field(repr=False)
    barcode: Barcode = field(repr=False)
    born: float
    simplices: int
    cohomology_seconds: float
    processing_seconds: float

    __repr__ = brief


@one_thread
def typical_trajectory(
    values: ArrayLike, options: TrajectoryOptions | None = None
) -> TypicalTrajectory:
    """Find the most persistent class of a capture and make its typical trajectory.

    Parameters
    ----------
    values : (F, d) array_like
        One pose a frame, as from `roundelay.reproduction.configuration.configuration`.
    options : TrajectoryOptions, optional

    Raises
    ------
    NoPeriod
        If no class is born below the scale.
    TooShort
        If there are fewer than 4 frames, or the coordinate does not advance.
    LiftError
        If the class lifts to no integer cocycle: another prime may do.
    ValueError
        If there are fewer frames than neighbours.
    """
    options = options or TrajectoryOptions()
    poses = np.asarray(values, float)
    (barcode, coordinate, simplices), before = _timed(lambda: _cohomology(poses, options))
    (density, places, curve, loop), after = _timed(
        lambda: _trajectory(poses, coordinate.phase, options)
    )
    return TypicalTrajectory(
        loop=loop,
        centroids=curve,
        places=places,
        coordinate=coordinate,
        density=density,
        barcode=barcode,
        born=float(barcode.births[0]),
        simplices=simplices,
        cohomology_seconds=before,
        processing_seconds=after,
    )


def _timed(work: Callable[[], _Result]) -> tuple[_Result, float]:
    begun = time.process_time()
    return work(), time.process_time() - begun


def _cohomology(
    poses: Array, options: TrajectoryOptions
) -> tuple[Barcode, CircularCoordinate, int]:
    """Return the barcode, the coordinate of its longest bar, and the size of the complex."""
    cloud = poses if options.dimensions is None else principal_components(poses, options.dimensions)
    above = pairwise_distances(cloud)
    if options.metric == "adjacent":
        after = np.arange(1, len(above))
        above[after - 1, after] = 0.0
    distances = above + above.T
    barcode = persistent_cohomology(distances, metric="precomputed", prime=options.prime)
    barcode = barcode.up_to(options.scale)
    if not len(barcode):
        raise NoPeriod(f"no class is born below the scale {options.scale:g}", barcode)
    # 4.3: the best coordinates are near the end of a life; the class is there just below it.
    at = float(np.nextafter(np.float32(barcode.deaths[0]), np.float32(0.0)))
    at = max(at, float(barcode.births[0]))
    coordinate = circular_coordinate(barcode, scale=at, weights="uniform")
    return barcode, coordinate, count_simplices(distances, options.scale)


def count_simplices(distances: ArrayLike, scale: float) -> int:
    """Return the number of vertices, edges and triangles of a Rips complex.

    Parameters
    ----------
    distances : (n, n) array_like
    scale : float
        Largest length of an edge.
    """
    near = np.asarray(distances) <= scale
    np.fill_diagonal(near, False)
    joined = near.astype(np.float32)
    # Paths of two edges whose ends are joined: six for every triangle.
    paths = sum(
        float(np.einsum("ij,ij->", joined[rows] @ joined, joined[rows], dtype=np.float64))
        for rows in _rows(len(joined))
    )
    return len(near) + int(near.sum()) // 2 + round(paths / 6)


def _rows(count: int) -> list[slice]:
    return [slice(start, start + 512) for start in range(0, count, 512)]


def _trajectory(
    poses: Array, phase: Array, options: TrajectoryOptions
) -> tuple[CircularMixture, Array, Array, Array]:
    """Return the density, the places of the samples, their centroids, and one period of frames."""
    if len(poses) < options.neighbours:
        raise ValueError(
            f"expected at least {options.neighbours} frames, one a neighbour, found {len(poses)}"
        )
    run = [(0, len(phase))]
    turns = unwrap(phase, run)
    if turns[-1] < turns[0]:
        phase, turns = -phase % 1.0, -turns
    density = fit_circular_mixture(phase)
    places = density.quantiles(options.samples)
    curve = centroids(
        poses, phase, places, neighbours=options.neighbours, gaussian=options.gaussian
    )
    frames = max(2, round(line_period(turns, run)))
    # Samples are even in the density, which is that of frames: even in time.
    at = np.arange(frames) / frames * options.samples
    loop = np.column_stack(
        [np.interp(at, np.arange(options.samples), column, period=options.samples)
         for column in curve.T]
    )  # fmt: skip
    return density, places, curve, loop


def centroids(
    poses: ArrayLike,
    phase: ArrayLike,
    places: ArrayLike,
    *,
    neighbours: int = 10,
    gaussian: bool = False,
) -> Array:
    """Return the mean of the poses nearest in phase to each place ([A] 4.4).

    Parameters
    ----------
    poses : (F, d) array_like
    phase : (F,) array_like
        In turns.
    places : (m,) array_like
        In turns.
    neighbours : int
        How many poses a centroid has, k.
    gaussian : bool
        Weigh them by a Gaussian of their distance, half as wide as that of the farthest.

    Returns
    -------
    (m, d) ndarray
    """
    y, theta = np.asarray(poses, float), np.asarray(phase, float)
    rows = []
    for place in np.asarray(places, float):
        apart = np.abs((theta - place + 0.5) % 1.0 - 0.5)
        nearest = np.argsort(apart, kind="stable")[:neighbours]
        weights = np.ones(len(nearest))
        if gaussian and apart[nearest[-1]] > 0.0:
            weights = np.exp(-2.0 * (apart[nearest] / apart[nearest[-1]]) ** 2)
        rows.append(weights @ y[nearest] / weights.sum())
    return np.array(rows)
