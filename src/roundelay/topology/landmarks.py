"""Landmarks: few points that stand for many, and the extension of a coordinate to all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from numbers import Integral
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.topology.distances import (
    Metric,
    check_distances,
    check_metric,
    check_points,
    in_unit,
    rounded_points,
)
from roundelay.topology.kernel import engine
from roundelay.topology.kernel.reduction import F32, F64

__all__ = ["Landmarks", "choose_landmarks", "extend_phase"]

Method = Literal["stride", "greedy"]
Columns = Callable[[NDArray[np.intp]], F32]

BLOCK = 512


@dataclass(frozen=True)
class Landmarks:
    """Points chosen to stand for all.

    Attributes
    ----------
    indices : (L,) array of int
        The chosen points, ascending, so that they keep the order of time.
    cover_radius : float
        Largest distance of a point from its nearest landmark, in the unit of the data.
    """

    indices: NDArray[np.intp]
    cover_radius: float
    _distances: F32 = field(repr=False)

    def __repr__(self) -> str:
        chosen, radius = len(self.indices), self.cover_radius
        return f"Landmarks({chosen} of {len(self._distances)} points, cover radius {radius:.4g})"

    @property
    def error_bound(self) -> float:
        """How far births and deaths of the landmarks' bars can be from those of all points.

        Twice the cover radius: the bottleneck distance of Rips barcodes is at most twice the
        Gromov-Hausdorff distance. Births are only ever over-estimated.
        """
        return 2.0 * self.cover_radius


def choose_landmarks(
    data: ArrayLike, *, count: int = 400, method: Method = "stride", metric: Metric = "euclidean"
) -> Landmarks:
    """Choose landmarks among points.

    Parameters
    ----------
    data : (n, d) array_like, or distances
        Points, or with ``metric="precomputed"`` their distances, in any form that
        `roundelay.topology.persistent_cohomology` takes.
    count : int
        How many, at least 4; all points when there are fewer.
    method : {"stride", "greedy"}
        At an even stride, which keeps the density of the sampling, or each time the point
        farthest from all chosen ones, which covers captures of several behaviours better.
    metric : {"euclidean", "precomputed"}
        What `data` is.

    Returns
    -------
    Landmarks
        The chosen points and how well they cover the others.

    Raises
    ------
    ValueError
        If the data, the count or the method are not as above.
    TooShort
        If there are fewer than 4 points.
    """
    check_metric(metric)
    if not (isinstance(count, Integral) and count >= 4) or method not in ("stride", "greedy"):
        raise ValueError(
            f'expected a count of at least 4 and method "stride" or "greedy", '
            f"found {count!r} and {method!r}"
        )
    columns = _columns_of(data, metric)
    n = len(columns(np.zeros(1, np.intp)))
    count = min(count, n)
    indices = np.arange(count, dtype=np.intp) * n // count
    if method == "greedy":
        indices = _farthest(columns, n, count)
    distances = columns(indices)
    return Landmarks(indices, float(distances.min(axis=1).max()), distances)


def _columns_of(data: ArrayLike, metric: Metric) -> Columns:
    """Return the function that gives the distances (n, m) of all points from some."""
    if metric == "precomputed":
        matrix = check_distances(data)
        return lambda indices: matrix[:, indices]
    rounded, unit = rounded_points(check_points(data))
    # As the engine wants them: else it would copy all points for every landmark.
    rounded = np.ascontiguousarray(np.pad(rounded, ((0, 0), (0, -rounded.shape[1] % 16))))
    return lambda indices: in_unit(engine().distances(rounded, rounded[indices]), unit)


def _farthest(columns: Columns, n: int, count: int) -> NDArray[np.intp]:
    """Indices (count,), ascending: from the first point on, the one farthest from all chosen."""
    chosen, nearest = np.zeros(count, np.intp), np.full(n, np.inf, np.float32)
    for place in range(1, count):
        nearest = np.minimum(nearest, columns(chosen[place - 1 : place])[:, 0])
        chosen[place] = nearest.argmax()
    return np.unique(chosen)


def extend_phase(distances: F32, phase: F64, radius: float) -> F64:
    """Extend a circular coordinate from landmarks to all points.

    Partition of unity on the balls around the landmarks (Perea 2020, sparse circular
    coordinates): from the phase of the nearest landmark, the mean of the short ways to the
    phases of all landmarks within the radius, the nearer the heavier. A point that none has
    within its radius takes the phase of the nearest.

    Parameters
    ----------
    distances : (m, L) array
        From each point to each landmark.
    phase : (L,) array
        Phase of the landmarks, in cycles.
    radius : float
        Half the scale of the coordinate: landmarks within it of one point are joined by an edge.

    Returns
    -------
    (m,) array
        Phases in cycles [0, 1).
    """
    narrow = phase.astype(np.float32)
    blocks = range(0, len(distances), BLOCK)
    parts = [_extend_block(distances[a : a + BLOCK], narrow, radius) for a in blocks]
    return np.asarray(np.concatenate([np.zeros(0), *parts]) % 1.0 % 1.0, np.float64)


def _extend_block(distances: F32, phase: F32, radius: float) -> F64:
    nearest = distances.argmin(axis=1)
    share = np.maximum(np.float32(radius) - distances, np.float32(0))
    step = phase[None, :] - phase[nearest][:, None]
    step -= np.rint(step)
    total = share.sum(axis=1, dtype=np.float64)
    moved = np.einsum("ij,ij->i", share, step, dtype=np.float64)
    return np.asarray(phase[nearest] + moved / np.where(total > 0, total, 1.0), np.float64)
