"""Harmonic regression as [C] has it, to the letter: the yardstick for the default method.

::

    angles -> delay embedding (3.26) -> most persistent class -> circular coordinate
           -> ranks (3.20) or mixture (3.21) -> unwrapped (fig. 3.8) -> line (3.6): N frames
           -> finite differences (3.23-3.25) -> M1 (3.14), M2 (3.8) or M3 (3.9)
           -> frames z_i (3.22), errors (4.1-4.5)

Everything is in the unit of the values given; [C] has Euler angles in radians. The
alternatives that its chapter 6 discusses are in `roundelay.cycles.alternatives`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.coordinate import circular_coordinate
from roundelay.cycles.harmonic import HarmonicCurve, design_matrix
from roundelay.errors import NoPeriod, TooShort
from roundelay.timing import line_period, mixture_remap, rank_remap, unwrap
from roundelay.topology.rips import Barcode, persistent_cohomology

__all__ = [
    "PaperCycle",
    "PaperOptions",
    "delay_embedding",
    "extract",
    "finite_differences",
    "fit_model",
    "fit_translation",
    "template_error",
]

Array = NDArray[np.float64]
Model = Literal["M1", "M2", "M3"]

# Central differences of 8th order ([C] eq. 3.23, 3.24).
_FIRST = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
_SECOND = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])
_REACH = 4


@dataclass(frozen=True)
class PaperOptions:
    """What a user of [C] sets; the defaults are those of its tables.

    Parameters
    ----------
    model : {"M1", "M2", "M3"}
        Weighted (3.14), positions only (3.8), unweighted (3.9).
    harmonics : int
        K.
    delay : int
        Embedding factor m of eq. 3.26.
    scale : float
        Maximum of the filtration's scale: 2 for walks, 3 for runs, 5 for boxing.
    prime : int
        Coefficients of the cohomology.
    remap : {"rank", "mixture"}
        From structure to time by eq. 3.20 or 3.21.
    """

    model: Model = "M1"
    harmonics: int = 20
    delay: int = 2
    scale: float = 2.0
    prime: int = 47
    remap: Literal["rank", "mixture"] = "rank"


@dataclass(frozen=True, eq=False)
class PaperCycle:
    """Hold a periodic motion as [C] extracts it.

    Attributes
    ----------
    curve : HarmonicCurve
        h of eq. 3.6, 3.7.
    period : float
        N in frames.
    phase : (M,) ndarray
        x of each frame, in [0, 1).
    unwrapped : (M,) ndarray
        The same with whole periods counted (fig. 3.8), for the translation's model.
    errors : tuple of 3 float
        Root mean squared errors of values, velocities and accelerations, the latter two
        weighted (eq. 4.1-4.3); NaN where the model does not use them.
    barcode : Barcode
    """

    curve: HarmonicCurve
    period: float
    phase: Array = field(repr=False)
    unwrapped: Array = field(repr=False)
    errors: tuple[float, float, float]
    barcode: Barcode = field(repr=False)

    @property
    def period_count(self) -> float:
        """Periods in the frames used."""
        return len(self.phase) / self.period

    def sample(self) -> Array:
        """Return one period, z_i for whole i from 1 to N ([C] eq. 3.22), (floor N, d)."""
        return self.curve(np.arange(int(self.period)) / self.period)


def extract(values: ArrayLike, options: PaperOptions | None = None) -> PaperCycle:
    """Extract the periodic motion of a capture.

    Parameters
    ----------
    values : (F, d) array_like
        Joint angles, one row a frame.
    options : PaperOptions, optional

    Returns
    -------
    PaperCycle
        Of the first F - m frames.

    Raises
    ------
    NoPeriod
        If no class is born below the scale.
    TooShort
        If the coordinate does not advance, or there are too few frames to differentiate.
    LiftError
        If the class lifts to no integer cocycle: another prime may do.
    """
    options = options or PaperOptions()
    y = np.asarray(values, float)
    cloud = delay_embedding(y, options.delay)
    y = y[: len(cloud)]
    barcode = persistent_cohomology(cloud, prime=options.prime)
    phase = _forward(_coordinate(barcode, options.scale))
    phase = (rank_remap if options.remap == "rank" else mixture_remap)(phase)
    run = [(0, len(phase))]
    unwrapped = unwrap(phase, run)
    period = line_period(unwrapped, run)
    curve, errors = fit_model(phase, y, period, options)
    return PaperCycle(curve, period, phase, unwrapped, errors, barcode)


def delay_embedding(values: ArrayLike, delay: int) -> Array:
    """Return rows (F - delay, (delay + 1) d) of successive rows (F, d) ([C] eq. 3.26)."""
    y = np.asarray(values, float)
    count = len(y) - delay
    if count < 1:
        raise TooShort(f"a delay of {delay} needs more than {delay} frames, found {len(y)}")
    return np.hstack([y[lag : lag + count] for lag in range(delay + 1)])


def _coordinate(barcode: Barcode, scale: float) -> Array:
    """Return the circular coordinate of the class that persists longest up to a scale."""
    if not np.any(barcode.births < scale):
        raise NoPeriod(f"no class is born below the scale {scale:g}", barcode)
    deaths = np.minimum(barcode.deaths, scale)
    chosen = int(np.argmax(deaths - barcode.births))
    at = min(scale, float(np.nextafter(np.float32(barcode.deaths[chosen]), np.float32(0.0))))
    return circular_coordinate(barcode, k=chosen, scale=at, weights="uniform").phase


def _forward(phase: Array) -> Array:
    """Reverse a coordinate that runs backwards in time."""
    unwrapped = unwrap(phase, [(0, len(phase))])
    return phase if unwrapped[-1] >= unwrapped[0] else -phase % 1.0


def finite_differences(values: ArrayLike, period: float) -> tuple[Array, Array]:
    """Return velocities and accelerations by phase ([C] eq. 3.23-3.25).

    Parameters
    ----------
    values : (M, d) array_like
    period : float
        N in frames; the step between frames is 1 / N.

    Returns
    -------
    velocity, acceleration : (M - 8, d) ndarray
        Of all frames but the first and last four.

    Raises
    ------
    TooShort
        If there are fewer than 9 frames.
    """
    y = np.asarray(values, float)
    if len(y) <= 2 * _REACH:
        raise TooShort(f"finite differences need at least 9 frames, found {len(y)}")
    windows = np.lib.stride_tricks.sliding_window_view(y, 2 * _REACH + 1, axis=0)
    return windows @ _FIRST * period, windows @ _SECOND * period**2


def fit_model(
    phase: ArrayLike, values: ArrayLike, period: float, options: PaperOptions
) -> tuple[HarmonicCurve, tuple[float, float, float]]:
    """Fit M1, M2 or M3 to values at phases.

    Parameters
    ----------
    phase : (M,) array_like
    values : (M, d) array_like
        Consecutive frames.
    period : float
        N in frames.
    options : PaperOptions

    Returns
    -------
    curve : HarmonicCurve
    errors : tuple of 3 float
        See `PaperCycle`.
    """
    x, y = np.asarray(phase, float), np.asarray(values, float)
    targets = [y]
    if options.model != "M2":
        targets += finite_differences(y, period)
    inner = x[_REACH:-_REACH]
    designs = [
        design_matrix(x if order == 0 else inner, options.harmonics, derivative=order)
        for order in range(len(targets))
    ]
    weights = np.ones((len(targets), y.shape[1]))
    if options.model == "M1":
        weights = _group_weights(designs, targets)
    solution = _solve(designs, targets, weights)
    errors = [
        float(np.sqrt(np.mean(np.sum(weight * (design @ solution - target) ** 2, axis=1))))
        for design, target, weight in zip(designs, targets, weights, strict=True)
    ]
    errors += [float("nan")] * (3 - len(errors))
    return HarmonicCurve.from_solution(solution), (errors[0], errors[1], errors[2])


def _group_weights(designs: list[Array], targets: list[Array]) -> Array:
    """Estimate 1, alpha_j and gamma_j (3, d) from separate fits ([C] eq. 3.11-3.13, 3.19)."""
    variances = []
    for design, target in zip(designs, targets, strict=True):
        used = design[:, np.any(design != 0.0, axis=0)]
        residual = target - used @ np.linalg.lstsq(used, target, rcond=None)[0]
        freedom = max(len(target) - used.shape[1], 1)
        variances.append(np.sum(residual**2, axis=0) / freedom)
    position, *others = np.maximum(variances, 1e-300)
    # A joint that never moves has no errors to weigh.
    still = np.ptp(targets[0], axis=0) < 1e-12
    return np.array([np.ones_like(position)] + [np.where(still, 0.0, position / v) for v in others])


def _solve(designs: list[Array], targets: list[Array], weights: Array) -> Array:
    """Minimise the weighted sum of squares for every column by itself ([C] eq. 3.14)."""
    grams = np.array([design.T @ design for design in designs])
    sides = np.array([design.T @ target for design, target in zip(designs, targets, strict=True)])
    gram = np.einsum("gj,gab->jab", weights, grams)
    side = np.einsum("gj,gaj->ja", weights, sides)
    # The pseudo-inverse, for captures with fewer frames than coefficients.
    return np.einsum("jab,jb->aj", np.linalg.pinv(gram, hermitian=True), side)


def fit_translation(
    unwrapped: ArrayLike, path: ArrayLike, harmonics: int, *, linear: ArrayLike = True
) -> tuple[HarmonicCurve, Array]:
    """Fit the root's path by a periodic function and a line ([C] eq. 3.27, 3.28).

    Parameters
    ----------
    unwrapped : (M,) array_like
        Phase with whole periods counted.
    path : (M, d) array_like
    harmonics : int
    linear : bool or (d,) array_like of bool
        Axes with the linear term; the others are periodic (eq. 3.6).

    Returns
    -------
    curve : HarmonicCurve
    slope : (d,) ndarray
        l of eq. 3.27: what is gained a period, 0 without the linear term.
    """
    x, y = np.asarray(unwrapped, float), np.asarray(path, float)
    design = design_matrix(x, harmonics)
    with_line = np.hstack([design, x[:, None]])
    plain = np.linalg.lstsq(design, y, rcond=None)[0]
    lined = np.linalg.lstsq(with_line, y, rcond=None)[0]
    chosen = np.broadcast_to(np.asarray(linear, bool), y.shape[1:])
    solution = np.where(chosen, lined[:-1], plain)
    return HarmonicCurve.from_solution(solution), np.where(chosen, lined[-1], 0.0)


def template_error(values: ArrayLike, loop: ArrayLike) -> tuple[float, int]:
    """Lay a repeated loop against a capture ([C] eq. 4.4, 4.5).

    Parameters
    ----------
    values : (M, d) array_like
        The capture.
    loop : (N, d) array_like
        One period, without the frame that repeats the first.

    Returns
    -------
    error : float
        Root mean square over frames of the distances, at the best offset.
    offset : int
        Frames by which the loop is shifted there: the least sum of distances.
    """
    y, z = np.asarray(values, float), np.asarray(loop, float)
    squares = np.sum(y**2, axis=1)[:, None] + np.sum(z**2, axis=1) - 2.0 * y @ z.T
    apart = np.sqrt(np.maximum(squares, 0.0))
    where = np.arange(len(y))
    sums = [apart[where, (where + n) % len(z)].sum() for n in range(len(z))]
    best = int(np.argmin(sums))
    return float(np.sqrt(np.mean(apart[where, (where + best) % len(z)] ** 2))), best
