"""Several classes at once: their linear combinations, and the least correlated ones.

[A] 7 suggests combinations of coclasses where one motion shows as several classes; toroidal
coordinates (Scoccola, Gakhar, Bush, Schonsheck, Rask, Zhou, Perea, SoCG 2023) choose them by
lattice reduction. For one periodic motion a single class is the better choice.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from roundelay.base.checks import as_numbers
from roundelay.base.threads import one_thread
from roundelay.topology.coordinate import CircularCoordinate, Smoothing, Weights
from roundelay.topology.kernel.reduction import F64, I64, count_up_to, ends
from roundelay.topology.landmarks import Landmarks
from roundelay.topology.lattice import reduce_lattice
from roundelay.topology.rips import Barcode
from roundelay.topology.thresholds import COORDINATE, LATTICE

__all__ = ["combined_coordinates", "toroidal_coordinates"]


@one_thread
def toroidal_coordinates(
    barcode: Barcode,
    *,
    classes: Sequence[int] = (0, 1),
    scale: float | None = None,
    weights: Weights = "density",
    landmarks: Landmarks | None = None,
) -> tuple[CircularCoordinate, ...]:
    """Decorrelate the coordinates of several classes.

    The harmonic cocycles of the classes span a lattice with inner products summed over the
    edges; its reduced basis gives coordinates that change as little as can be, and as
    independently of each other.

    Parameters
    ----------
    barcode : Barcode
        Where the classes are from.
    classes : sequence of int
        Bars that are alive together at some scale.
    scale : float, optional
        A scale in all their lives; default: at .7 of the time they live together.
    weights : {"density", "uniform"}
        Edge weights, as in :func:`roundelay.topology.coordinate.circular_coordinate`.
    landmarks : Landmarks, optional
        The barcode is that of these landmarks; coordinates are extended to all points.

    Returns
    -------
    tuple of CircularCoordinate
        As many as classes; `combination` says how each is made of them.

    Raises
    ------
    ValueError
        If the classes are not all alive at the scale, or at any one.
    LiftError
        If a class lifts to no integer cocycle.
    """
    span = _Span.of_classes(barcode, classes, scale, weights)
    return span.combined(reduce_lattice(span.gram()), landmarks)


@one_thread
def combined_coordinates(
    barcode: Barcode,
    coefficients: Sequence[Sequence[int]],
    *,
    classes: Sequence[int] = (0, 1),
    scale: float | None = None,
    weights: Weights = "density",
    landmarks: Landmarks | None = None,
) -> tuple[CircularCoordinate, ...]:
    """Make coordinates of given linear combinations of classes ([A] 7).

    Parameters
    ----------
    barcode, classes, scale, weights, landmarks
        As in :func:`toroidal_coordinates`.
    coefficients : (r, c) sequence of int
        One row a coordinate, one column a class.

    Returns
    -------
    tuple of CircularCoordinate
        One for each row.

    Raises
    ------
    ValueError
        If the rows do not have one coefficient a class, or the classes no scale in common.
    """
    given = as_numbers(coefficients, "coefficients (r, c)")
    if given.dtype.kind == "f" and not np.array_equal(given, np.trunc(given)):
        raise ValueError("expected coefficients as whole numbers, found others")
    with np.errstate(invalid="ignore"):
        rows = np.asarray(given, np.int64)
    if rows.ndim != 2 or rows.shape[1] != len(classes):
        raise ValueError(f"expected {len(classes)} coefficients a row, found {rows.shape}")
    return _Span.of_classes(barcode, classes, scale, weights).combined(rows, landmarks)


class _Span:
    """Harmonic cocycles of several classes at one scale."""

    def __init__(self, problems: list[Smoothing], classes: Sequence[int], scale: float) -> None:
        start = np.zeros(problems[0].barcode.n_points)
        self.problems, self.classes, self.scale = problems, tuple(classes), scale
        self.count = count_up_to(problems[0].keys, scale)
        self.w = np.array([each.smooth(scale, start, COORDINATE.tolerance)[0] for each in problems])
        i, j = ends(problems[0].keys[: self.count])
        self.steps = np.array([each.values[: self.count] for each in problems])
        self.steps = self.steps + self.w[:, j] - self.w[:, i]

    @classmethod
    def of_classes(
        cls, barcode: Barcode, classes: Sequence[int], scale: float | None, weights: Weights
    ) -> _Span:
        problems = [Smoothing.of_class(barcode, k, weights) for k in classes]
        low = max(each.birth for each in problems)
        high = min(each.death for each in problems)
        if scale is None:
            scale = low + LATTICE.life * (high - low)
        if not low <= scale < high:
            raise ValueError(
                f"expected a scale in [{low:g}, {high:g}), where the classes "
                f"{list(classes)} are alive together, found {scale:g}"
            )
        return cls(problems, classes, scale)

    def gram(self) -> F64:
        """Inner products (r, r) of the harmonic cocycles."""
        return np.asarray((self.steps * self._edge_weights()) @ self.steps.T, np.float64)

    def _edge_weights(self) -> F64:
        first = self.problems[0]
        i, j = ends(first.keys[: self.count])
        close = first.close(self.scale)
        n = first.barcode.n_points
        density = 1.0 + np.bincount(np.concatenate((i[:close], j[:close])), minlength=n)
        return np.asarray(1.0 / (density[i] * density[j]), np.float64)

    def combined(self, rows: I64, landmarks: Landmarks | None) -> tuple[CircularCoordinate, ...]:
        return tuple(self._combination(row, landmarks) for row in rows)

    def _combination(self, row: I64, landmarks: Landmarks | None) -> CircularCoordinate:
        leading = self.problems[int(abs(row).argmax())]
        largest = float(abs(row @ self.steps).max())
        terms = tuple((k, int(c)) for k, c in zip(self.classes, row, strict=True) if c)
        return leading.coordinate(row @ self.w, largest, self.scale, terms, landmarks)
