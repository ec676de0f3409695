"""Distance matrices: Euclidean distances, and checks of those given.

Inside the package a distance matrix is float32; its upper triangle is the one that counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.errors import TooShort
from roundelay.topology.kernel import engine
from roundelay.topology.kernel.reduction import F32, F64

__all__ = ["Metric", "Runs", "cross_distances", "pairwise_distances"]

Runs = Sequence[tuple[int, int]]
"""Half-open ranges [start, stop) of consecutive frames; no motion is counted between two."""

Metric = Literal["euclidean", "precomputed"]
"""Whether data are points (n, d) or their distances (n, n)."""

FEWEST_POINTS = 4


def pairwise_distances(points: ArrayLike) -> F32:
    """Euclidean distances between points.

    Computed by differences, so that near points lose no digits and duplicates are at 0.

    Parameters
    ----------
    points : (n, d) array_like
        Points, in any unit.

    Returns
    -------
    (n, n) array of float32
        Distances above the diagonal, 0 elsewhere.

    Raises
    ------
    ValueError
        If the points are not a finite (n, d) array.
    TooShort
        If there are fewer than 4.
    """
    rounded, unit = rounded_points(check_points(points))
    return in_unit(engine().distances(rounded), unit)


def rounded_points(points: F64) -> tuple[F32, np.float32]:
    """Return points (n, d) centred, without constant columns, and the unit they are in."""
    moved = points - points.mean(axis=0)
    size = float(abs(moved).max())
    rounded = _rounded(moved, size)
    return rounded[:, rounded.any(axis=0)], _unit(size)


def cross_distances(points: ArrayLike, others: ArrayLike) -> F32:
    """Euclidean distances (m, n) from points (m, d) to others (n, d)."""
    left, right = np.asarray(points, np.float64), np.asarray(others, np.float64)
    if left.ndim != 2 or left.shape[1:] != right.shape[1:]:
        raise ValueError(f"expected points (m, {right.shape[1]}), found {left.shape}")
    centre = right.mean(axis=0)
    size = float(abs(right - centre).max(initial=0.0))
    near, far = _rounded(right - centre, size), _rounded(left - centre, size)
    return in_unit(engine().distances(far, near), _unit(size))


def _unit(size: float) -> np.float32:
    """Power of two near the size of the points, or 1 where float32 holds their squares well."""
    return np.float32(1.0 if 1e-4 < size < 1e12 or size == 0 else 2.0 ** np.frexp(size)[1])


def in_unit(distances: F32, unit: np.float32) -> F32:
    """Return distances of rounded points in the unit of the data."""
    return distances if unit == 1 else distances * unit


def _rounded(points: F64, size: float) -> F32:
    """Round to a grid finer than float32 resolves, so that no square is a (slow) denormal."""
    step = (size or 1.0) * 2.0**-40
    return np.asarray(np.round(points / step) * (step / _unit(size)), np.float32)


def check_metric(metric: str) -> None:
    """Raise ValueError for a metric that is none."""
    if metric not in ("euclidean", "precomputed"):
        raise ValueError(f'expected metric "euclidean" or "precomputed", found {metric!r}')


def check_points(points: ArrayLike) -> F64:
    """Return points as float64, or raise what is wrong with them."""
    array = np.asarray(points, np.float64)
    if array.ndim != 2 or array.shape[1] == 0:
        raise ValueError(f"expected points (n, d), found an array of shape {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError("expected finite points, found NaN or infinity")
    _check_count(len(array))
    return array


def check_distances(distances: ArrayLike) -> F32:
    """Return a distance matrix as float32, or raise what is wrong with it."""
    array: NDArray[Any] = np.asarray(distances)
    if array.ndim != 2 or array.shape[0] != array.shape[1]:
        raise ValueError(f"expected distances (n, n), found an array of shape {array.shape}")
    _check_count(len(array))
    narrow: F32 = np.ascontiguousarray(array, np.float32)
    _check_entries(narrow)
    return narrow


def _check_count(n: int) -> None:
    if n < FEWEST_POINTS:
        raise TooShort(f"a loop needs at least {FEWEST_POINTS} points, found {n}")


def _check_entries(distances: F32) -> None:
    low, high = float(distances.min()), float(distances.max())
    if not np.isfinite([low, high]).all():
        raise ValueError("expected finite distances, found NaN or infinity")
    if low < 0:
        raise ValueError(f"expected distances of at least 0, found {low:g}")
    if distances.diagonal().any():
        raise ValueError("expected a zero diagonal: the distance of a point from itself")
    if not _is_symmetric(distances, 1e-5 * high):
        raise ValueError("expected symmetric distances: d[i, j] and d[j, i] differ")


def _is_symmetric(distances: F32, tolerance: float, block: int = 256) -> bool:
    starts = range(0, len(distances), block)
    return all(
        bool(
            (abs(distances[a : a + block, a:] - distances[a:, a : a + block].T) <= tolerance).all()
        )
        for a in starts
    )
