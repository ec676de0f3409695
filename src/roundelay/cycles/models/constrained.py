"""The regression models of [C] 3.2-3.4, 3.7 and 3.9: velocity and acceleration as constraints.

Minimises, for every value by itself ([C] eq. 3.14),

    sum |h(x_i) - y_i|^2 + alpha |h'(x_i) - y'_i|^2 + gamma |h''(x_i) - y''_i|^2,

with y', y'' by finite differences of the frames and alpha, gamma by the variances of three
separate fits (eq. 3.19).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.errors import TooShort
from roundelay.base.numeric import SMALLEST, TINY
from roundelay.base.spans import Span
from roundelay.phase.harmonic import HarmonicCurve, design_matrix

__all__ = [
    "M1",
    "M2",
    "M3",
    "Fit",
    "Model",
    "equations",
    "finite_differences",
    "fit_model",
    "group_weights",
]

Array = NDArray[np.float64]

# Central differences of 8th order ([C] eq. 3.23, 3.24).
_FIRST = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
_SECOND = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])
_REACH = 4


@dataclass(frozen=True)
class Model:
    """What the regression fits; the defaults are [C]'s.

    Parameters
    ----------
    harmonics : int
        K of eq. 3.6 ([C] 5.3 items 18, 19).
    velocity : bool
        Fit h' to the velocities ([C] 5.3 item 20).
    acceleration : bool
        Fit h'' to the accelerations ([C] 5.3 item 21).
    weighted : bool
        Weigh velocities and accelerations by their variances (eq. 3.19), else by 1.
    """

    harmonics: int = 20
    velocity: bool = True
    acceleration: bool = True
    weighted: bool = True


M1 = Model()
"""The weighted model of [C] eq. 3.14."""
M2 = Model(velocity=False, acceleration=False)
"""Positions only, [C] eq. 3.8."""
M3 = Model(weighted=False)
"""The unweighted model of [C] eq. 3.9."""


@dataclass(frozen=True, eq=False)
class Fit:
    """Hold a fitted function of phase.

    Attributes
    ----------
    curve : HarmonicCurve
        h of [C] eq. 3.6, or the periodic part of eq. 3.27.
    slope : (d,) ndarray
        l of eq. 3.27: what is gained a period; 0 without the line.
    errors : tuple of 3 float
        Root mean squared errors of values, velocities and accelerations, the latter two
        weighted (eq. 4.1-4.3); NaN where the model does not use them.
    """

    curve: HarmonicCurve
    slope: Array
    errors: tuple[float, float, float]


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
    phase: ArrayLike,
    values: ArrayLike,
    period: float,
    model: Model = M1,
    *,
    runs: Sequence[Span] | None = None,
    line: bool = False,
) -> Fit:
    """Fit a periodic function, or one with a line, to values at phases.

    Parameters
    ----------
    phase : (M,) array_like
        In turns; whole turns count for the line only.
    values : (M, d) array_like
    period : float
        N in frames.
    model : Model
    runs : sequence of (start, stop), optional
        Ranges of consecutive frames; all frames are one by default. No difference is taken
        across their borders.
    line : bool
        Add the line of eq. 3.27, which each run may begin at a place of its own.

    Returns
    -------
    Fit
        By values alone where the frames are too few for the variances of eq. 3.12 and 3.13.

    Raises
    ------
    TooShort
        If the model is not weighted and no run has 9 frames to differentiate.
    """
    orders, designs, targets = equations(phase, values, period, model, runs=runs, line=line)
    count = targets[0].shape[1]
    weights = group_weights(designs, targets) if model.weighted else np.ones((len(orders), count))
    solution = _solve(designs, targets, weights)
    errors = [float("nan")] * 3
    for order, design, target, weight in zip(orders, designs, targets, weights, strict=True):
        squares = weight * (design @ solution - target) ** 2
        errors[order] = float(np.sqrt(np.mean(np.sum(squares, axis=1))))
    return Fit(
        curve=HarmonicCurve.from_solution(solution[: 2 * model.harmonics + 1]),
        slope=solution[-1] if line else np.zeros(count),
        errors=(errors[0], errors[1], errors[2]),
    )


def equations(
    phase: ArrayLike,
    values: ArrayLike,
    period: float,
    model: Model = M1,
    *,
    runs: Sequence[Span] | None = None,
    line: bool = False,
) -> tuple[list[int], list[Array], list[Array]]:
    """Return what `fit_model` solves, a group of rows for each order of derivative.

    Parameters are those of `fit_model`.

    Returns
    -------
    orders : list of int
        0 for values, 1 and 2 for velocities and accelerations.
    designs : list of (m, c) ndarray
        Regressors, one column a coefficient.
    targets : list of (m, d) ndarray
    """
    x, y = np.asarray(phase, float), np.asarray(values, float)
    runs = [(0, len(x))] if runs is None else runs
    inner = np.concatenate([np.arange(start + _REACH, stop - _REACH) for start, stop in runs])
    orders = _orders(model, len(inner))
    targets = _targets(y, period, orders, runs)
    designs = [
        _design(x, model.harmonics, order, runs if line else None)[inner if order else slice(None)]
        for order in orders
    ]
    return orders, designs, targets


def _orders(model: Model, differences: int) -> list[int]:
    """Return the orders of the derivatives to fit, 0 for the values.

    No more differences than coefficients leave no residual to know their variance by.
    """
    if model.weighted and differences <= 2 * model.harmonics + 1:
        return [0]
    return [0] + [1] * model.velocity + [2] * model.acceleration


def _targets(values: Array, period: float, orders: list[int], runs: Sequence[Span]) -> list[Array]:
    """Return values and, of the orders asked for, their differences within runs."""
    if orders == [0]:
        return [values]
    long = [(start, stop) for start, stop in runs if stop - start > 2 * _REACH] or runs
    apart = [finite_differences(values[start:stop], period) for start, stop in long]
    return [values, *(np.concatenate([run[order - 1] for run in apart]) for order in orders[1:])]


def _design(x: Array, harmonics: int, order: int, lines: Sequence[Span] | None) -> Array:
    """Return regressors of values or derivatives: harmonics, a constant, and with lines those.

    With lines there is a column for where each run but the first begins, and the line's last.
    """
    design = design_matrix(x, harmonics, derivative=order)
    if lines is None:
        return design
    begins = np.zeros((len(x), len(lines) - 1))
    if order == 0:
        for number, (start, stop) in enumerate(lines[1:]):
            begins[start:stop, number] = 1.0
    slope = (x, np.ones(len(x)), np.zeros(len(x)))[order]
    return np.hstack([design, begins, slope[:, None]])


def group_weights(designs: Sequence[Array], targets: Sequence[Array]) -> Array:
    """Estimate 1, alpha_j and gamma_j (groups, d) by separate fits ([C] eq. 3.11-3.13, 3.19).

    Parameters
    ----------
    designs, targets : sequence of ndarray
        As from `equations`.
    """
    variances = []
    for design, target in zip(designs, targets, strict=True):
        used = design[:, np.any(design != 0.0, axis=0)]
        residual = target - used @ np.linalg.lstsq(used, target, rcond=None)[0]
        freedom = max(len(target) - used.shape[1], 1)
        variances.append(np.sum(residual**2, axis=0) / freedom)
    position, *others = np.maximum(variances, SMALLEST)
    # A joint that never moves has no errors to weigh.
    still = np.ptp(targets[0], axis=0) < TINY
    return np.array([np.ones_like(position)] + [np.where(still, 0.0, position / v) for v in others])


def _solve(designs: list[Array], targets: list[Array], weights: Array) -> Array:
    """Minimise the weighted sum of squares for every column by itself ([C] eq. 3.14)."""
    grams = np.array([design.T @ design for design in designs])
    sides = np.array([design.T @ target for design, target in zip(designs, targets, strict=True)])
    gram = np.einsum("gj,gab->jab", weights, grams)
    side = np.einsum("gj,gaj->ja", weights, sides)
    # The pseudo-inverse, for captures with fewer frames than coefficients.
    return np.einsum("jab,jb->aj", np.linalg.pinv(gram, hermitian=True), side)
