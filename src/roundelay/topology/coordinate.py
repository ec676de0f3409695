"""Circular coordinates: from a class of a barcode to a phase for every point ([A] 4.2, 4.3)."""

from __future__ import annotations

from dataclasses import dataclass, field
from numbers import Integral
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.brief import brief
from roundelay.base.checks import expected
from roundelay.base.errors import LiftError
from roundelay.base.threads import one_thread
from roundelay.topology.distances import Runs, cross_distances
from roundelay.topology.kernel import engine
from roundelay.topology.kernel.reduction import F32, F64, I32, U64, count_up_to, narrow_ends
from roundelay.topology.landmarks import Landmarks, extend_phase
from roundelay.topology.lift import Lift, lift_to_integers
from roundelay.topology.rips import Barcode
from roundelay.topology.significance import turns
from roundelay.topology.thresholds import COORDINATE

__all__ = ["CircularCoordinate", "Smoothing", "Weights", "circular_coordinate"]

Weights = Literal["density", "uniform"]


@dataclass(frozen=True)
class CircularCoordinate:
    """A map from points to the circle.

    Attributes
    ----------
    phase : (n,) array
        The coordinate of each point, in cycles [0, 1); of all points, also with landmarks.
    class_index : int
        Which bar of the barcode it belongs to (of a combination, the one that weighs most).
    combination : tuple of (int, int)
        The classes it is the sum of, with their factors: ``((class_index, 1),)`` for one class.
    birth, death, scale : float
        The life of the class, and the scale in it at which the cocycle was smoothed.
    weights : {"density", "uniform"}
        How edges were weighted.
    multiplier, divisor : int
        The class mod p was multiplied and its lift divided by these: 1 and 1 unless the lift
        had to be repaired.
    largest_step : float
        The largest change along an edge, in cycles; the coordinate is sound below .5.
    is_covered : (n,) array of bool
        Whether a point is within half the scale of a landmark (all are, without landmarks);
        the others have the phase of the nearest.
    """

    phase: F64
    class_index: int
    combination: tuple[tuple[int, int], ...]
    birth: float
    death: float
    scale: float
    weights: Weights
    multiplier: int
    divisor: int
    largest_step: float
    is_covered: NDArray[np.bool_] = field(repr=False)
    _anchor_phase: F64 = field(repr=False)
    _anchors: F64 | None = field(repr=False)

    def __repr__(self) -> str:
        terms = " + ".join(f"{factor} x {k}" for k, factor in self.combination)
        which = f"class {self.class_index}" if len(self.combination) == 1 else f"classes {terms}"
        return f"CircularCoordinate({len(self.phase)} points, {which}, scale {self.scale:.4g})"

    def evaluate(self, data: ArrayLike) -> F64:
        """Return the phase (m,) of new points.

        Perea's partition of unity over the points of the barcode (the landmarks, if there are)
        within half the scale; a point farther than that from all takes the phase of the nearest.

        Parameters
        ----------
        data : (m, d) or (m, L) array_like
            Points, if the barcode was made of points; else distances to its L points.

        Returns
        -------
        (m,) array
            Phases in cycles [0, 1).

        Raises
        ------
        ValueError
            If the data do not have d or L columns.
        """
        distances = self._distances(data)
        return extend_phase(distances, self._anchor_phase, self.scale / 2)

    def _distances(self, data: ArrayLike) -> F32:
        if self._anchors is not None:
            return cross_distances(data, self._anchors)
        distances = np.asarray(data, np.float32)
        if distances.ndim != 2 or distances.shape[1] != len(self._anchor_phase):
            expected = len(self._anchor_phase)
            raise ValueError(f"expected distances (m, {expected}), found {distances.shape}")
        return distances


@one_thread
def circular_coordinate(
    barcode: Barcode,
    *,
    k: int = 0,
    scale: float | None = None,
    weights: Weights = "density",
    runs: Runs | None = None,
    landmarks: Landmarks | None = None,
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
        Between birth and death. Default: with `runs`, of 8 scales the ones that come within .1
        of the most net turns minus twice the backward motion, and of these the one nearest to .7
        of the life; without `runs`, .7 of the life. Scales at which a step exceeds .45 cycles or
        the graph is not connected are left out; [A] 4.2 takes high scales by eye.
    weights : {"density", "uniform"}
        Edge weights 1 / (rho_i rho_j), with the local density rho counted within half the scale,
        which make the coordinate follow arc length whatever the speed (Paik and Park,
        density-robust circular coordinates), or 1 as in [A].
    runs : sequence of (start, stop), optional
        The points are frames in time order, in these runs of consecutive frames.
    landmarks : Landmarks, optional
        The barcode is that of these landmarks; the coordinate is extended to all points.

    Returns
    -------
    CircularCoordinate
        The phase of every point.

    Raises
    ------
    ValueError
        If there is no bar k, the scale is not in its life, or the landmarks are not those of the
        barcode.
    LiftError
        If the class lifts to no integer cocycle.
    """
    problem = Smoothing.of_class(barcode, k, weights)
    if landmarks is not None and len(landmarks.indices) != barcode.n_points:
        raise ValueError(
            f"expected a barcode of {len(landmarks.indices)} landmarks, found {barcode.n_points}"
        )
    if scale is None:
        scale = _choose_scale(problem, runs, landmarks)
    elif not problem.birth <= scale < problem.death:
        raise ValueError(
            f"expected a scale in [{problem.birth:g}, {problem.death:g}), found {scale:g}"
        )
    w, largest = problem.smooth(scale, np.zeros(barcode.n_points), COORDINATE.tolerance)
    return problem.coordinate(w, largest, scale, ((k, 1),), landmarks)


@dataclass(frozen=True)
class Smoothing:
    """The integer cocycle of one class on the edges below its death, to be smoothed.

    Attributes
    ----------
    barcode : Barcode
        Where the class is from.
    birth, death : float
        Its life, up to the largest scale of the barcode.
    lift : Lift
        Its integer cocycle on the births.
    keys, values : (m,) arrays
        The edges, by length, and the integer cocycle on them.
    weights : {"density", "uniform"}
        How edges are weighted.
    """

    barcode: Barcode
    birth: float
    death: float
    lift: Lift
    keys: U64
    values: I32
    weights: Weights

    __repr__ = brief

    @classmethod
    def of_class(cls, barcode: Barcode, k: int, weights: Weights) -> Smoothing:
        """Lift class k and evaluate it on all edges below its death."""
        if not (isinstance(k, Integral) and 0 <= k < len(expected(Barcode, barcode))):
            raise ValueError(f"expected a class from 0 to {len(barcode) - 1}, found {k!r}")
        if weights not in ("density", "uniform"):
            raise ValueError(f'expected weights "density" or "uniform", found {weights!r}')
        reduction, death = barcode._reduction, float(barcode.deaths[k])
        lift = lift_to_integers(barcode._on_births(k), barcode.prime, reduction.relations, death)
        keys = barcode._keys_below(k)
        try:
            values = engine().propagate(reduction, len(keys), lift.values, 0)
        except OverflowError as error:
            raise LiftError(f"the lift of class {k} exceeds 15 bits on some edge") from error
        birth = float(barcode.births[k])
        return cls(barcode, birth, min(death, barcode.max_scale), lift, keys, values, weights)

    def close(self, scale: float) -> int:
        """Count the edges on which the local density is measured; 0 for uniform weights."""
        return count_up_to(self.keys, scale / 2) if self.weights == "density" else 0

    def smooth(self, scale: float, start: F64, tolerance: float) -> tuple[F64, float]:
        """Return w (n,) and the largest |z + dw| at a scale."""
        count = count_up_to(self.keys, scale)
        return engine().harmonic(
            self.keys[:count],
            self.values[:count],
            start,
            close=self.close(scale),
            tolerance=tolerance,
        )

    def thinned(self, stride: int) -> Smoothing:
        """Keep only the edges between vertices whose number the stride divides."""
        i, j = narrow_ends(self.keys)
        kept = (i % stride == 0) & (j % stride == 0)
        keys, values = self.keys[kept], self.values[kept]
        return Smoothing(
            self.barcode, self.birth, self.death, self.lift, keys, values, self.weights
        )

    def coordinate(
        self,
        w: F64,
        largest: float,
        scale: float,
        combination: tuple[tuple[int, int], ...],
        landmarks: Landmarks | None,
    ) -> CircularCoordinate:
        """Wrap a solution, extended from the landmarks to all points."""
        anchors = w % 1.0 % 1.0
        phase, covered = anchors, np.ones(len(w), bool)
        if landmarks is not None:
            phase = extend_phase(landmarks._distances, anchors, scale / 2)
            covered = landmarks._distances.min(axis=1) <= scale / 2
        return CircularCoordinate(
            phase, max(combination, key=lambda term: abs(term[1]))[0], combination,
            self.birth, self.death, scale, self.weights,
            self.lift.multiplier, self.lift.divisor, largest,
            covered, anchors, self.barcode._points,
        )  # fmt: skip


def _choose_scale(problem: Smoothing, runs: Runs | None, landmarks: Landmarks | None) -> float:
    """Return the scale by the motion along time if there is one, else .7 of the life."""
    life = problem.death - problem.birth
    default = problem.birth + COORDINATE.life * life
    if runs is None:
        return default
    if landmarks is not None:
        runs = [tuple(np.searchsorted(landmarks.indices, run).tolist()) for run in runs]
    shares = np.linspace(COORDINATE.highest, COORDINATE.lowest, COORDINATE.scales)
    scores = _scores(problem, problem.birth + life * shares, runs)
    good = [scale for scale in scores if scores[scale] >= max(scores.values()) - COORDINATE.slack]
    return min(good, key=lambda scale: abs(scale - default), default=default)


def _scores(problem: Smoothing, scales: F64, runs: Runs) -> dict[float, float]:
    """Net turns minus twice the backward motion at each sound scale, on some of the frames."""
    stride = -(-problem.barcode.n_points // COORDINATE.scouts)
    thinned = problem.thinned(stride)
    fewer = [(-(-start // stride), -(-stop // stride)) for start, stop in runs]
    w, scores = np.zeros(problem.barcode.n_points), {}
    for scale in scales.tolist():
        w, largest = thinned.smooth(scale, w, COORDINATE.scouting)
        net, total = turns(w[::stride], fewer)
        if largest <= COORDINATE.largest_step and (problem.barcode.components <= scale).all():
            scores[scale] = 2 * abs(net) - total
    return scores
