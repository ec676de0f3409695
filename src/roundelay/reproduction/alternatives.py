"""What [C] chapter 6 discusses instead of its model: ridge, reweighting, whole turns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.threads import one_thread
from roundelay.phase.harmonic import HarmonicCurve, design_matrix

__all__ = ["TurningCurve", "fit_reweighted", "fit_ridge", "fit_turning"]

Array = NDArray[np.float64]

_PENALTIES = np.geomspace(1e-6, 10.0, 29)
_FOLDS = 8
# Huber's constant: 95 % efficiency where errors are Gaussian.
_HUBER = 1.345


@one_thread
def fit_ridge(phase: ArrayLike, values: ArrayLike, harmonics: int) -> tuple[HarmonicCurve, Array]:
    """Fit by ridge regression, its strength by cross-validation ([C] eq. 6.1).

    Frames are left out in stretches, since neighbours share their errors.

    Parameters
    ----------
    phase : (n,) array_like
        In turns.
    values : (n, d) array_like
        Consecutive frames.
    harmonics : int
        K.

    Returns
    -------
    curve : HarmonicCurve
    penalty : (d,) ndarray
        lambda of every column, a frame.
    """
    x, y = np.asarray(phase, float), np.asarray(values, float)
    design = design_matrix(x, harmonics)
    folds = np.arange(len(x)) * _FOLDS // len(x)
    missed = np.zeros((len(_PENALTIES), y.shape[1]))
    for fold in range(_FOLDS):
        out = folds == fold
        for row, penalty in zip(missed, _PENALTIES, strict=True):
            left = _ridge(design[~out], y[~out], penalty)
            row += np.sum((design[out] @ left - y[out]) ** 2, axis=0)
    best = np.argmin(missed, axis=0)
    solution = np.zeros((design.shape[1], y.shape[1]))
    for choice in np.unique(best):
        columns = best == choice
        solution[:, columns] = _ridge(design, y[:, columns], _PENALTIES[choice])
    return HarmonicCurve.from_solution(solution), _PENALTIES[best]


def _ridge(design: Array, values: Array, penalty: float) -> Array:
    # The last coefficient is the constant, which is not penalised.
    weights = np.full(design.shape[1], penalty * len(design))
    weights[-1] = 0.0
    return np.asarray(np.linalg.solve(design.T @ design + np.diag(weights), design.T @ values))


@one_thread
def fit_reweighted(
    phase: ArrayLike, values: ArrayLike, harmonics: int, *, iterations: int = 20
) -> tuple[HarmonicCurve, Array]:
    """Fit by iteratively reweighted least squares ([C] ch. 6), with Huber's weights.

    Parameters
    ----------
    phase : (n,) array_like
        In turns.
    values : (n, d) array_like
    harmonics : int
        K.
    iterations : int
        At most this many; fewer once weights settle.

    Returns
    -------
    curve : HarmonicCurve
    weights : (n, d) ndarray
        In (0, 1]: small for values that the others do not explain.
    """
    y = np.asarray(values, float)
    design = design_matrix(phase, harmonics)
    weights = np.ones_like(y)
    for _ in range(iterations):
        gram = (design.T * weights.T[:, None]) @ design
        side = np.einsum("na,nj->ja", design, weights * y)
        solution = np.einsum("jab,jb->aj", np.linalg.pinv(gram, hermitian=True), side)
        away = np.abs(y - design @ solution)
        scale = 1.4826 * np.median(away, axis=0) + 1e-12
        before, weights = weights, np.minimum(1.0, _HUBER * scale / np.maximum(away, 1e-300))
        if np.max(np.abs(weights - before)) < 1e-3:
            break
    return HarmonicCurve.from_solution(solution), weights


@dataclass(frozen=True)
class TurningCurve:
    """An angle as a function of phase that may gain whole turns.

    The pair (cos, sin) of [C] eq. 6.2 and 6.3 lies on the unit circle at every phase.

    Parameters
    ----------
    turns : (d,) ndarray
        Whole turns gained in a period.
    curve : HarmonicCurve
        The rest, periodic, in radians.
    """

    turns: Array
    curve: HarmonicCurve

    def __call__(self, phase: ArrayLike) -> Array:
        """Return angles (n, d) in radians at unwrapped phases (n,)."""
        x = np.asarray(phase, float)
        return 2 * np.pi * x[:, None] * self.turns + self.curve(x)


def fit_turning(
    phase: ArrayLike, angles: ArrayLike, harmonics: int, *, iterations: int = 20
) -> TurningCurve:
    """Solve [C] eq. 6.4: fit (cos, sin) under the constraint of unit norm at every phase.

    Two trigonometric polynomials u, v with u^2 + v^2 = 1 are a single harmonic (Fejer and
    Riesz), so the constraint is met by writing u + iv = exp(i a(x)) instead, a(x) being whole
    turns and a harmonic function; a is found by Gauss and Newton from the unwrapped angles.

    Parameters
    ----------
    phase : (n,) array_like
        Unwrapped, in turns, more than one.
    angles : (n, d) array_like
        Radians, whole turns not needed: only their cosines and sines count.
    harmonics : int
        K.
    iterations : int
        At most this many.

    Returns
    -------
    TurningCurve
    """
    x, y = np.asarray(phase, float), np.unwrap(np.asarray(angles, float), axis=0)
    line = np.linalg.lstsq(np.column_stack([x, np.ones_like(x)]), y, rcond=None)[0]
    turns = np.round(line[0] / (2 * np.pi))
    design = design_matrix(x, harmonics)
    inverse = np.linalg.pinv(design)
    solution = inverse @ (y - 2 * np.pi * x[:, None] * turns)
    for _ in range(iterations):
        model = 2 * np.pi * x[:, None] * turns + design @ solution
        # Of |exp(i a) - exp(i y)|^2 only the part along the circle can be changed.
        change = inverse @ np.sin(y - model)
        solution = solution + change
        if np.max(np.abs(change), initial=0.0) < 1e-10:
            break
    return TurningCurve(turns, HarmonicCurve.from_solution(solution))
