"""Circular coordinates: from a class of a barcode to a phase for every point ([A] 4.2, 4.3)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from roundelay.topology.distances import Runs, cross_distances
from roundelay.topology.kernel import engine
from roundelay.topology.kernel.reduction import F32, F64, I32
from roundelay.topology.landmarks import extend_phase
from roundelay.topology.lift import Lift, lift_to_integers
from roundelay.topology.rips import Barcode

__all__ = ["CircularCoordinate", "Weights", "circular_coordinate", "turns"]

Weights = Literal["density", "uniform"]

SCALES = 8
DEFAULT_LIFE = 0.7
LARGEST_STEP = 0.45
TOLERANCE = 1e-9
SCOUTING_TOLERANCE = 1e-4


@dataclass(frozen=True)
class CircularCoordinate:
    """A map from points to the circle.

    Attributes
    ----------
    phase : (n,) array
        The coordinate of each point of the barcode, in cycles [0, 1).
    class_index : int
        Which bar of the barcode it belongs to.
    birth, death, scale : float
        The bar, and the scale in between at which the cocycle was smoothed.
    weights : {"density", "uniform"}
        How edges were weighted.
    multiplier, divisor : int
        The class mod p was multiplied and its lift divided by these (1 and 1 unless repaired).
    largest_step : float
        The largest change along an edge, in cycles; the coordinate is sound below .5.
    """

    phase: F64
    class_index: int
    birth: float
    death: float
    scale: float
    weights: Weights
    multiplier: int
    divisor: int
    largest_step: float
    _points: F64 | None = field(default=None, repr=False)

    def evaluate(self, data: ArrayLike) -> F64:
        """Return the phase (m,) of new points.

        Perea's partition of unity (Perea 2020, sparse circular coordinates) over the points of
        the barcode within half the scale; a point farther than that from all takes the phase of
        the nearest.

        Parameters
        ----------
        data : (m, d) or (m, n) array_like
            Points, if the barcode was made of points; else distances to its n points.

        Returns
        -------
        (m,) array
            Phases in cycles [0, 1).
        """
        if self._points is not None:
            distances = cross_distances(data, self._points)
        else:
            distances = np.asarray(data, np.float32)
        return extend_phase(distances, self.phase, self.scale / 2)


def circular_coordinate(
    barcode: Barcode,
    *,
    k: int = 0,
    scale: float | None = None,
    weights: Weights = "density",
    runs: Runs | None = None,
) -> CircularCoordinate:
    """Make a circular coordinate of one class.

    The cocycle that lives until the death is lifted to the integers, restricted to the scale
    and smoothed: w minimises the weighted norm of z + dw, and the phase is w mod 1 ([A] 4.2).

    Parameters
    ----------
    barcode : Barcode
        Result of :func:`roundelay.topology.persistent_cohomology`.
    k : int
        Which bar, 0 being the longest.
    scale : float, optional
        Between birth and death. Default: with `runs`, the one of 8 scales with the most net
        turns minus twice the backward motion; without, .7 of the life.
    weights : {"density", "uniform"}
        Edge weights 1 / (rho_i rho_j) with the local density rho, which make the coordinate
        follow arc length whatever the speed (Paik and Park, density-robust circular
        coordinates), or 1 as in [A].
    runs : sequence of (start, stop), optional
        The points are frames in time order, in these runs of consecutive frames.

    Returns
    -------
    CircularCoordinate
        The phase of every point.

    Raises
    ------
    ValueError
        If there is no bar k, or the scale is not in its life.
    LiftError
        If the class lifts to no integer cocycle.
    """
    problem = _Smoothing.of_class(barcode, k, weights)
    if scale is None:
        scale = problem.best_scale(runs)
    elif not problem.birth <= scale < problem.death:
        raise ValueError(
            f"expected a scale in [{problem.birth:g}, {problem.death:g}), found {scale:g}"
        )
    w, largest = problem.smooth(scale, np.zeros(barcode.n_points), TOLERANCE)
    return CircularCoordinate(
        w % 1.0 % 1.0, k, problem.birth, problem.death, scale, weights,
        problem.lift.multiplier, problem.lift.divisor, largest, barcode._points,
    )  # fmt: skip


def turns(phase: F64, runs: Runs) -> tuple[float, float]:
    """Count turns along time, taking the short way between consecutive frames.

    Returns
    -------
    net, total : float
        Turns forward minus backward, in cycles (the sign tells the direction), and their sum.
    """
    steps = [_wrapped(np.diff(phase[start:stop])) for start, stop in runs]
    moved = np.concatenate(steps) if steps else np.zeros(0)
    return float(moved.sum()), float(abs(moved).sum())


def _wrapped(change: F64) -> F64:
    return change - np.round(change)


@dataclass(frozen=True)
class _Smoothing:
    """One integer cocycle, to be smoothed at several scales."""

    barcode: Barcode
    birth: float
    death: float
    lift: Lift
    values: I32
    weights: Weights

    @classmethod
    def of_class(cls, barcode: Barcode, k: int, weights: Weights) -> _Smoothing:
        if not 0 <= k < len(barcode):
            raise ValueError(f"expected a class from 0 to {len(barcode) - 1}, found {k}")
        if weights not in ("density", "uniform"):
            raise ValueError(f'expected weights "density" or "uniform", found {weights!r}')
        birth, death = float(barcode.births[k]), float(min(barcode.deaths[k], barcode.max_scale))
        reduction = barcode._reduction
        lift = lift_to_integers(
            barcode._on_births(k), barcode.prime, reduction.relations, float(barcode.deaths[k])
        )
        values = engine().propagate(reduction, barcode._edges_below(k, None), lift.values, 0)
        return cls(barcode, birth, death, lift, values, weights)

    def smooth(self, scale: float, start: F64, tolerance: float) -> tuple[F64, float]:
        """Return w (n,) and the largest |z + dw| at a scale."""
        lengths = self.barcode._lengths
        weight = (
            np.ones(len(lengths)) if self.weights == "uniform" else _inverse_density(lengths, scale)
        )
        return engine().harmonic(lengths, self.values, scale, weight, start, tolerance)

    def best_scale(self, runs: Runs | None) -> float:
        if runs is None:
            return self.birth + DEFAULT_LIFE * (self.death - self.birth)
        scales = self.birth + (self.death - self.birth) * np.linspace(0.15, 0.95, SCALES)
        w = np.zeros(self.barcode.n_points)
        best, best_score = float(scales[-3]), -np.inf
        for scale in scales[::-1]:
            w, largest = self.smooth(float(scale), w, SCOUTING_TOLERANCE)
            net, total = turns(w, runs)
            score = abs(net) - (total - abs(net))
            if largest <= LARGEST_STEP and self._is_connected(scale) and score > best_score:
                best, best_score = float(scale), score
        return best

    def _is_connected(self, scale: float) -> bool:
        return bool((self.barcode.components <= scale).all())


def _inverse_density(lengths: F32, scale: float) -> F64:
    near = (lengths <= scale) & (lengths > 0)
    return 1.0 / (1.0 + near.sum(axis=0) + near.sum(axis=1))
