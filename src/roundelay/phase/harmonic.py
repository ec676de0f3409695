"""Harmonic regression: smooth periodic functions fitted to values at given phases ([C] 3.2).

The basis is 1, sin 2 pi k x, cos 2 pi k x for k = 1..K ([C] eq. 3.6), or half-integer k for
functions that change sign after a turn (quaternions of a joint that makes a whole turn).
Instead of [C]'s pull towards differences of the data (eq. 3.14), roughness is penalised by the
integral of the squared second derivative, its strength chosen for each value by generalised
cross-validation: a smoothing spline on the circle. The faithful models are in
`roundelay.reproduction.raunio`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.brief import brief
from roundelay.base.numeric import ROUNDING, SMALL, smoothstep
from roundelay.phase.thresholds import CROSSFADE, HARMONIC

__all__ = [
    "HarmonicCurve",
    "crossfade_weights",
    "design_matrix",
    "fit_harmonic",
    "highest_harmonic",
]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HarmonicCurve:
    """A periodic function from phase to d values.

    Parameters
    ----------
    frequencies : (m,) ndarray
        Turns per unit of phase: 1, 2, ..., K or 1/2, 3/2, ...
    constant : (d,) ndarray
        c of [C] eq. 3.6; zero for half-integer frequencies.
    sine, cosine : (m, d) ndarray
        a and b of [C] eq. 3.6.
    """

    frequencies: Array
    constant: Array
    sine: Array
    cosine: Array

    __repr__ = brief

    def __call__(self, phase: ArrayLike, derivative: int = 0) -> Array:
        """Evaluate the curve or a derivative by phase.

        Parameters
        ----------
        phase : (n,) array_like
            In turns.
        derivative : int
            0 for the value, 1 for the derivative by phase, and so on.

        Returns
        -------
        (n, d) ndarray
        """
        waves = _waves(phase, self.frequencies, derivative)
        value = waves @ np.concatenate([self.sine, self.cosine])
        return value + self.constant if derivative == 0 else value

    @classmethod
    def from_solution(cls, solution: Array) -> HarmonicCurve:
        """Take the coefficients (2 K + 1, d) that belong to the columns of `design_matrix`."""
        count = len(solution) // 2
        frequencies = np.arange(1.0, count + 1)
        return cls(frequencies, solution[-1], solution[:count], solution[count:-1])

    @classmethod
    def through(cls, values: Array, *, odd: bool = False) -> HarmonicCurve:
        """Return the trigonometric polynomial through values (n, d) at phases 0, 1 / n, ...

        Of even n it leaves the highest frequency out; `odd` gives one with h(x + 1) = -h(x).
        """
        spectrum = np.fft.rfft(np.concatenate([values, -values if odd else values]), axis=0)
        spectrum /= 2 * len(values)
        bins = np.arange(1 if odd else 2, len(values), 2)
        frequencies: Array = np.asarray(0.5 * bins, float)
        inner = spectrum[bins]
        return cls(frequencies, spectrum[0].real, -2.0 * inner.imag, 2.0 * inner.real)

    def shifted(self, offset: float) -> HarmonicCurve:
        """Return the curve that has at every phase x the value of this one at x + offset."""
        angle = 2 * np.pi * self.frequencies[:, None] * offset
        cosine, sine = np.cos(angle), np.sin(angle)
        return HarmonicCurve(
            self.frequencies,
            self.constant,
            cosine * self.sine - sine * self.cosine,
            sine * self.sine + cosine * self.cosine,
        )

    def integral(self, phase: ArrayLike) -> Array:
        """Return the integral over phase from 0, (n, d), the constant's included."""
        x = np.asarray(phase, float)
        angle = 2 * np.pi * x[:, None] * self.frequencies
        scale = 1.0 / (2 * np.pi * self.frequencies)
        value = (scale * (1.0 - np.cos(angle))) @ self.sine + (scale * np.sin(angle)) @ self.cosine
        return value + x[:, None] * self.constant


def design_matrix(phase: ArrayLike, harmonics: int, *, derivative: int = 0) -> Array:
    """Return the regressors (n, 2 K + 1) of [C] eq. 3.5: K sines, K cosines and the constant.

    Parameters
    ----------
    phase : (n,) array_like
        In turns.
    harmonics : int
        K.
    derivative : int
        0 for values, 1 for derivatives by phase, and so on; the constant's column is then 0.
    """
    waves = _waves(phase, np.arange(1.0, harmonics + 1), derivative)
    return np.hstack([waves, np.full((len(waves), 1), float(derivative == 0))])


def _waves(phase: ArrayLike, frequencies: Array, derivative: int = 0) -> Array:
    """Return sines and cosines (n, 2 m) of all frequencies, or their derivatives by phase."""
    angle = 2 * np.pi * np.asarray(phase, float)[:, None] * frequencies
    angle += 0.5 * np.pi * derivative
    scale = (2 * np.pi * frequencies) ** derivative
    return np.hstack([scale * np.sin(angle), scale * np.cos(angle)])


def highest_harmonic(period: float) -> int:
    """Return the number of harmonics that a motion of this period can need.

    Parameters
    ----------
    period : float
        Seconds.
    """
    return int(np.clip(np.ceil(HARMONIC.bandwidth * period), HARMONIC.fewest, HARMONIC.most))


def crossfade_weights(turns: ArrayLike, runs: list[tuple[int, int]]) -> Array:
    """Weigh frames so that a run's ends blend into each other.

    A run of 1.1 turns shows a tenth of the circle twice; weights that rise over the first and
    fall over the last 0.1 turns make the seam a cross-fade instead of a step. A run of less
    than a turn shows nothing twice and counts in full.

    Parameters
    ----------
    turns : (n,) array_like
        Unwrapped phase.
    runs : list of (start, stop)

    Returns
    -------
    (n,) ndarray
        In [0, 1]; 0 outside the runs.
    """
    x = np.asarray(turns, float)
    weights = np.zeros(len(x))
    for start, stop in runs:
        made = x[start:stop] - x[start]
        length = made[-1]
        if length <= 1.0:
            weights[start:stop] = 1.0
            continue
        # Where more is seen twice, as much as possible counts in full.
        fade = np.clip(length - 1.0, CROSSFADE.shortest, CROSSFADE.longest)
        ramp = np.clip(np.minimum(made, length - made) / fade, 0.0, 1.0)
        weights[start:stop] = smoothstep(ramp)
    return np.maximum(weights, CROSSFADE.least * (weights > 0))


def fit_harmonic(
    phase: ArrayLike,
    values: ArrayLike,
    harmonics: int,
    *,
    weights: ArrayLike | None = None,
    odd: bool = False,
) -> HarmonicCurve:
    """Fit a smooth periodic function by penalised least squares.

    Minimises sum w |h(x) - y|^2 + lambda integral |h''|^2, lambda by generalised
    cross-validation for every column of `values` by itself.

    Parameters
    ----------
    phase : (n,) array_like
        In turns.
    values : (n, d) array_like
    harmonics : int
        K of [C] eq. 3.6: the highest frequency.
    weights : (n,) array_like, optional
        Uniform by default.
    odd : bool
        Fit a function with h(x + 1) = -h(x).

    Returns
    -------
    HarmonicCurve
    """
    x, y = np.asarray(phase, float), np.asarray(values, float)
    w = np.ones(len(x)) if weights is None else np.asarray(weights, float)
    w = w * (len(w) / w.sum())
    frequencies: Array = np.arange(1.0, harmonics + 1) - (0.5 if odd else 0.0)
    waves = _waves(x, frequencies)
    design = waves if odd else np.hstack([waves, np.ones((len(x), 1))])
    design = design * np.sqrt(w)[:, None]
    rough = np.concatenate([frequencies**4, frequencies**4, [] if odd else [0.0]])
    solution = _cross_validated(design, y * np.sqrt(w)[:, None], rough)
    constant = np.zeros(y.shape[1]) if odd else solution[-1]
    return HarmonicCurve(
        frequencies, constant, solution[:harmonics], solution[harmonics:][:harmonics]
    )


def _cross_validated(design: Array, values: Array, rough: Array) -> Array:
    """Solve the ridge problem with penalty diag(rough), strength by GCV a column."""
    n = len(design)
    # In units of the penalty the Gram matrix is diagonal for all strengths at once.
    gram = design.T @ design + ROUNDING * n * np.eye(len(rough))
    low = np.linalg.cholesky(gram)
    half = np.linalg.solve(low, np.diag(np.sqrt(rough)))
    strength, axes = np.linalg.eigh(half @ half.T)
    strength = np.maximum(strength, 0.0)
    target = axes.T @ np.linalg.solve(low, design.T @ values)
    total = np.einsum("ij,ij->j", values, values)
    penalties = np.geomspace(HARMONIC.least_penalty, HARMONIC.largest_penalty, HARMONIC.penalties)
    kept = 1.0 / (1.0 + n * penalties[:, None] * strength)
    # |y - X b|^2 = |y|^2 - sum (2 kept - kept^2) target^2
    residual = np.maximum(total - (2.0 * kept - kept**2) @ target**2, SMALL)
    freedom = np.maximum(n - kept.sum(axis=1), HARMONIC.least_freedom)
    best = np.argmin(residual / freedom[:, None] ** 2, axis=0)
    shrink = kept[best].T
    return np.asarray(np.linalg.solve(low.T, axes @ (shrink * target)))
