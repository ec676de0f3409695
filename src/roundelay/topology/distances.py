"""Distance matrices: Euclidean distances, and checks of those given.

Inside the package a distance matrix is float32; its upper triangle is the one that counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from roundelay.base.checks import as_numbers
from roundelay.base.errors import TooShort
from roundelay.topology.kernel import engine
from roundelay.topology.kernel.reduction import F32, F64
from roundelay.topology.memory import check_memory

__all__ = [
    "Metric",
    "Runs",
    "check_distances",
    "check_metric",
    "check_points",
    "cross_distances",
    "in_unit",
    "is_sparse",
    "largest_finite",
    "pairwise_distances",
    "rounded_points",
]

Runs = Sequence[tuple[int, int]]
"""Half-open ranges [start, stop) of consecutive frames; no motion is counted between two."""

Metric = Literal["euclidean", "precomputed"]
"""Whether data are points (n, d) or their distances; see `check_distances` for their forms."""

FEWEST_POINTS = 4
# Between these float32 resolves as finely as it does.
_SMALLEST, _LARGEST = float(np.finfo(np.float32).tiny), float(np.finfo(np.float32).max)


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


def rounded_points(points: F64) -> tuple[F32, float]:
    """Return points (n, d) centred, without constant columns, and the unit they are in."""
    with np.errstate(over="ignore", invalid="ignore"):
        moved = np.nan_to_num(points - points.mean(axis=0), nan=np.inf)
    size = float(abs(moved).max())
    rounded = _rounded(moved, size)
    return rounded[:, rounded.any(axis=0)], _unit(size)


def cross_distances(points: ArrayLike, others: ArrayLike) -> F32:
    """Euclidean distances (m, n) from points (m, d) to others (n, d)."""
    left = np.asarray(as_numbers(points, "points (m, d)"), np.float64)
    right = np.asarray(others, np.float64)
    if left.ndim != 2 or left.shape[1:] != right.shape[1:]:
        raise ValueError(f"expected points (m, {right.shape[1]}), found {left.shape}")
    centre = right.mean(axis=0)
    size = float(abs(right - centre).max(initial=0.0))
    near, far = _rounded(right - centre, size), _rounded(left - centre, size)
    return in_unit(engine().distances(far, near), _unit(size))


def _unit(size: float) -> float:
    """Power of two near the size of the points, or 1 where float32 holds their squares well."""
    if not (size == 0.0 or _SMALLEST <= size <= _LARGEST):
        told = f"from {_SMALLEST:.2g} to {_LARGEST:.2g}, found one of {size:.2g}"
        raise ValueError(f"expected points in a unit in which their cloud has a size {told}")
    return 1.0 if 1e-4 < size < 1e12 or size == 0 else 2.0 ** float(np.frexp(size)[1] - 1)


def in_unit(distances: F32, unit: float) -> F32:
    """Return distances of rounded points in the unit of the data.

    Raises
    ------
    ValueError
        If the largest is more than float32 holds.
    """
    if unit == 1:
        return distances
    with np.errstate(over="ignore"):
        scaled = distances * np.float32(unit)
    if np.isinf(scaled).any():
        raise ValueError(f"expected distances up to {_LARGEST:.2g}, found larger ones")
    return scaled


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
    array = np.asarray(as_numbers(points, "points (n, d)"), np.float64)
    if array.ndim != 2 or array.shape[1] == 0:
        raise ValueError(f"expected points (n, d), found an array of shape {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError("expected finite points, found NaN or infinity")
    _check_count(len(array))
    return array


def is_sparse(data: object) -> bool:
    """Tell whether data are a sparse matrix, as SciPy makes them."""
    return hasattr(data, "tocoo")


def check_distances(distances: Any) -> F32:
    """Return distances as a symmetric matrix of float32, or raise what is wrong with them.

    Parameters
    ----------
    distances : (n, n) array_like or sparse matrix, or (n (n - 1) / 2,) array_like
        All of them; or condensed, the rows above the diagonal one after the other as from
        SciPy's ``pdist``; or sparse, where what is not stored is no edge and one triangle is
        enough. Infinity is no edge, too.

    Returns
    -------
    (n, n) array of float32
        Infinite where there is no edge.

    Raises
    ------
    ValueError
        If they are not such, not symmetric, below 0 or NaN, or the diagonal is not 0.
    TooShort
        If they are of fewer than 4 points.
    TooLarge
        If they are condensed or sparse, and too many for the memory that is free.
    """
    if is_sparse(distances):
        matrix = _of_sparse(distances)
    else:
        array = as_numbers(distances, "distances")
        matrix = _of_condensed(array) if array.ndim == 1 else _of_square(array)
    _check_entries(matrix)
    return matrix


def _of_square(array: np.ndarray) -> F32:
    if array.ndim != 2 or array.shape[0] != array.shape[1]:
        raise ValueError(
            f"expected distances (n, n) or (n (n - 1) / 2,), found an array of shape {array.shape}"
        )
    _check_count(len(array))
    return _narrow(np.ascontiguousarray(array))


def _of_condensed(values: np.ndarray) -> F32:
    n = round((1 + np.sqrt(1 + 8 * len(values))) / 2)
    if n * (n - 1) // 2 != len(values):
        raise ValueError(f"expected n (n - 1) / 2 condensed distances, found {len(values)}")
    _check_count(n)
    check_memory(n)
    matrix = np.zeros((n, n), np.float32)
    matrix[~np.tri(n, dtype=bool)] = _narrow(values)
    return matrix + matrix.T


def _of_sparse(distances: Any) -> F32:
    shape = tuple(distances.shape)
    if len(shape) != 2 or shape[0] != shape[1]:
        raise ValueError(f"expected distances (n, n), found a sparse matrix of shape {shape}")
    _check_count(shape[0])
    check_memory(shape[0])
    edges = distances.tocsr().tocoo()
    matrix = np.full(shape, np.inf, np.float32)
    np.fill_diagonal(matrix, 0)
    matrix[edges.row, edges.col] = _narrow(as_numbers(edges.data, "distances"))
    if (edges.row <= edges.col).all() or (edges.row >= edges.col).all():
        matrix = np.minimum(matrix, matrix.T)
    return matrix


def _narrow(values: np.ndarray) -> F32:
    """Round to float32; adding 0 makes -0.0, whose bits are those of a large number, 0.0."""
    with np.errstate(over="ignore"):
        narrow = np.asarray(values, np.float32) + np.float32(0)
    if np.isinf(narrow).any() and not np.array_equal(np.isinf(narrow), np.isinf(values)):
        raise ValueError(f"expected distances up to {_LARGEST:.2g} or infinity, found larger ones")
    if largest_finite(narrow) < _SMALLEST and np.any(np.isfinite(values) & (values != 0)):
        raise ValueError(f"expected distances of {_SMALLEST:.2g} and more, found smaller ones only")
    return np.asarray(narrow, np.float32)


def _check_count(n: int) -> None:
    if n < FEWEST_POINTS:
        raise TooShort(f"a loop needs at least {FEWEST_POINTS} points, found {n}")


def _check_entries(distances: F32) -> None:
    low = float(distances.min())
    if np.isnan(low):
        raise ValueError("expected distances, finite or infinite, found NaN")
    if low < 0:
        raise ValueError(f"expected distances of at least 0, found {low:g}")
    if distances.diagonal().any():
        raise ValueError("expected a zero diagonal: the distance of a point from itself")
    if not _is_symmetric(distances, 1e-5 * largest_finite(distances)):
        raise ValueError("expected symmetric distances: d[i, j] and d[j, i] differ")


def largest_finite(distances: F32) -> float:
    """Return the largest distance of two points that an edge can join; 0 if there is none."""
    return float(distances.max(initial=0.0, where=np.isfinite(distances)))


def _is_symmetric(distances: F32, tolerance: float, block: int = 256) -> bool:
    return all(
        _agree(distances[a : a + block, a:], distances[a:, a : a + block].T, tolerance)
        for a in range(0, len(distances), block)
    )


def _agree(first: F32, second: F32, tolerance: float) -> bool:
    with np.errstate(invalid="ignore"):  # infinity minus infinity
        return bool(((first == second) | (abs(first - second) <= tolerance)).all())
