"""Circular coordinates: from a class of a barcode to a phase for every point ([A] 4.2, 4.3)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.errors import LiftError
from roundelay.topology.distances import Runs, cross_distances
from roundelay.topology.kernel import engine
from roundelay.topology.kernel.reduction import F64, I32, U64, count_up_to, ends
from roundelay.topology.landmarks import extend_phase
from roundelay.topology.lift import Lift, lift_to_integers
from roundelay.topology.rips import Barcode

__all__ = ["CircularCoordinate", "Weights", "circular_coordinate", "turns"]

Weights = Literal["density", "uniform"]

DEFAULT_LIFE = 0.7
LARGEST_STEP = 0.45
TOLERANCE = 1e-9
SCOUTING_TOLERANCE = 1e-3
SHARES = (0.95, 0.15, 8)
SCOUTS = 256
SLACK = 0.1


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
    if not 0 <= k < len(barcode):
        raise ValueError(f"expected a class from 0 to {len(barcode) - 1}, found {k}")
    if weights not in ("density", "uniform"):
        raise ValueError(f'expected weights "density" or "uniform", found {weights!r}')
    birth, death = float(barcode.births[k]), _death(barcode, k)
    if scale is not None and not birth <= scale < death:
        raise ValueError(f"expected a scale in [{birth:g}, {death:g}), found {scale:g}")
    lift, values = _integer_cocycle(barcode, k)
    problem = _Smoothing(barcode._keys_below(k), values, barcode.n_points, weights)
    if scale is None:
        scale = _choose_scale(problem, barcode, k, runs)
    w, largest = problem.smooth(scale, np.zeros(barcode.n_points), TOLERANCE)
    return CircularCoordinate(
        w % 1.0 % 1.0, k, birth, death, scale, weights, lift.multiplier, lift.divisor, largest,
        barcode._points,
    )  # fmt: skip


def _integer_cocycle(barcode: Barcode, k: int) -> tuple[Lift, I32]:
    """Lift class k and evaluate it on all edges below its death."""
    reduction, death = barcode._reduction, float(barcode.deaths[k])
    lift = lift_to_integers(barcode._on_births(k), barcode.prime, reduction.relations, death)
    try:
        count = len(barcode._keys_below(k))
        return lift, engine().propagate(reduction, count, lift.values, 0)
    except OverflowError as error:
        raise LiftError(f"the lift of class {k} has values beyond 15 bits on some edge") from error


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
    """One integer cocycle on the edges below its death, to be smoothed at several scales."""

    keys: U64
    values: I32
    n: int
    weights: Weights

    def smooth(self, scale: float, start: F64, tolerance: float) -> tuple[F64, float]:
        """Return w (n,) and the largest |z + dw| at a scale."""
        count = count_up_to(self.keys, scale)
        close = count_up_to(self.keys, scale / 2) if self.weights == "density" else 0
        return engine().harmonic(
            self.keys[:count], self.values[:count], start, close=close, tolerance=tolerance
        )

    def restricted(self, members: NDArray[np.bool_]) -> _Smoothing:
        """Keep only the edges between some of the vertices."""
        i, j = ends(self.keys)
        kept = members[i] & members[j]
        return _Smoothing(self.keys[kept], self.values[kept], self.n, self.weights)


def _choose_scale(problem: _Smoothing, barcode: Barcode, k: int, runs: Runs | None) -> float:
    birth, life = float(barcode.births[k]), _death(barcode, k) - float(barcode.births[k])
    if runs is None:
        return birth + DEFAULT_LIFE * life
    stride = -(-problem.n // SCOUTS)
    members = np.arange(problem.n) % stride == 0
    few = problem.restricted(members)
    w, scores = np.zeros(problem.n), {}
    for share in np.linspace(*SHARES):
        scale = birth + share * life
        w, largest = few.smooth(scale, w, SCOUTING_TOLERANCE)
        if largest <= LARGEST_STEP and (barcode.components <= scale).all():
            scores[share] = _score(
                w[members], [(-(-a // stride), -(-b // stride)) for a, b in runs]
            )
    good = [share for share in scores if scores[share] >= max(scores.values()) - SLACK]
    return birth + life * min(
        good, key=lambda share: abs(share - DEFAULT_LIFE), default=DEFAULT_LIFE
    )


def _score(phase: F64, runs: Runs) -> float:
    """Net turns minus twice the backward motion."""
    net, total = turns(phase, runs)
    return abs(net) - (total - abs(net))


def _death(barcode: Barcode, k: int) -> float:
    return float(min(barcode.deaths[k], barcode.max_scale))
