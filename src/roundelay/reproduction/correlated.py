"""Correlated errors, which [C] 3.4 discusses and leaves out; and tests of equal spread.

Errors of neighbouring frames are alike: those of values since a repetition differs from the mean
one for some time, those of differences since they share frames. Here those of each group (values,
velocities, accelerations) and channel are a first-order autoregression, so that the covariance of
[C] eq. 3.16 has three full blocks; generalised least squares (eq. 3.17) is then ordinary least
squares after every row is told from the one before it (Prais and Winsten).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.brief import brief
from roundelay.base.numeric import SMALLEST, TINY
from roundelay.base.threads import one_thread
from roundelay.cycles.models.constrained import M1, M3, Model, equations, fit_model, group_weights
from roundelay.phase.harmonic import HarmonicCurve

__all__ = ["CorrelatedFit", "equal_spread", "fit_correlated", "unequal_shares"]

Array = NDArray[np.float64]

# Beyond, a group of errors is a drift of which nothing is known.
_MOST = 0.999


@dataclass(frozen=True, eq=False)
class CorrelatedFit:
    """Hold a function of phase fitted with correlated errors.

    Attributes
    ----------
    curve : HarmonicCurve
        h of [C] eq. 3.6.
    correlations : (groups, d) ndarray
        Of an error with the one before, for values, velocities and accelerations.
    """

    curve: HarmonicCurve = field(repr=False)
    correlations: Array = field(repr=False)

    __repr__ = brief


@one_thread
def fit_correlated(
    phase: ArrayLike, values: ArrayLike, period: float, model: Model = M1
) -> CorrelatedFit:
    """Fit by feasible generalised least squares with errors that follow each other.

    1. Each group is fitted by itself, as [C] does for its variances.
    2. The residuals of each channel give the correlation of neighbours and the variance of what
       is new in each; the rows are whitened by them.
    3. All groups are fitted together.

    Parameters
    ----------
    phase : (M,) array_like
        In turns.
    values : (M, d) array_like
        Consecutive frames.
    period : float
        N in frames.
    model : Model
        Which derivatives are fitted, and the number of harmonics.

    Returns
    -------
    CorrelatedFit
    """
    _, designs, targets = equations(phase, values, period, model)
    channels = targets[0].shape[1]
    solution = np.zeros((designs[0].shape[1], channels))
    correlations = np.zeros((len(designs), channels))
    errors = [_residuals(design, target) for design, target in zip(designs, targets, strict=True)]
    for channel in range(channels):
        rows, sides = [], []
        for group, (design, target) in enumerate(zip(designs, targets, strict=True)):
            residual = errors[group][:, channel]
            near = _correlation(residual)
            new = _whitened(residual[:, None], near)
            freedom = max(len(new) - design.shape[1], 1)
            scale = np.sqrt(max(float(np.sum(new**2)) / freedom, SMALLEST))
            still = np.ptp(targets[0][:, channel]) < TINY
            scale = np.inf if still and group else 1.0 if still else scale
            rows.append(_whitened(design, near) / scale)
            sides.append(_whitened(target[:, channel, None], near) / scale)
            correlations[group, channel] = near
        whole, side = np.concatenate(rows), np.concatenate(sides)[:, 0]
        solution[:, channel] = np.linalg.pinv(whole.T @ whole, hermitian=True) @ (whole.T @ side)
    return CorrelatedFit(HarmonicCurve.from_solution(solution), correlations)


def _residuals(design: Array, target: Array) -> Array:
    used = design[:, np.any(design != 0.0, axis=0)]
    return target - used @ np.linalg.lstsq(used, target, rcond=None)[0]


def _correlation(residual: Array) -> float:
    power = float(residual[:-1] @ residual[:-1])
    near = float(residual[1:] @ residual[:-1]) / max(power, SMALLEST)
    return min(max(near, -_MOST), _MOST)


def _whitened(rows: Array, near: float) -> Array:
    """Take from every row (n, c) what the one before tells of it; the first keeps its variance."""
    return np.concatenate([rows[:1] * np.sqrt(1.0 - near**2), rows[1:] - near * rows[:-1]])


def equal_spread(groups: Sequence[ArrayLike]) -> Array:
    """Test three groups of errors for one variance, by Brown and Forsythe.

    An analysis of variance of the distances from each group's median: Levene's test with medians.

    Parameters
    ----------
    groups : sequence of 3 (n_i, d) array_like

    Returns
    -------
    (d,) ndarray
        Chance of such a difference of spread, or a larger one, if there is none.

    Raises
    ------
    ValueError
        If there are not three groups: only then has the distribution a closed form.
    """
    if len(groups) != 3:
        raise ValueError(f"expected 3 groups of errors, found {len(groups)}")
    away = [np.abs(x - np.median(x, axis=0)) for x in (np.asarray(g, float) for g in groups)]
    counts = np.array([len(each) for each in away])
    means = np.array([each.mean(axis=0) for each in away])
    whole = counts @ means / counts.sum()
    between = counts @ (means - whole) ** 2 / 2
    freedom = int(counts.sum()) - 3
    within = sum(np.sum((x - mean) ** 2, axis=0) for x, mean in zip(away, means, strict=True))
    ratio = between / np.maximum(within / freedom, SMALLEST)
    # The tail of Fisher's F with 2 degrees of freedom above.
    return np.asarray((1.0 + 2.0 * ratio / freedom) ** (-0.5 * freedom))


@one_thread
def unequal_shares(
    phase: ArrayLike,
    values: ArrayLike,
    period: float,
    *,
    harmonics: int = 20,
    level: float = 0.05,
) -> tuple[float, float]:
    """Return in which share of channels the three variances differ, before and after weighting.

    What [C] chapter 4 would test of its weights and does not: the errors of M3, and those of M1
    times the roots of its weights.

    Parameters
    ----------
    phase : (M,) array_like
        In turns.
    values : (M, d) array_like
    period : float
        N in frames.
    harmonics : int
        K.
    level : float
        Chance below which variances count as different.

    Returns
    -------
    before, after : float
        Of the channels that move.
    """
    moving = np.asarray(values, float)
    moving = moving[:, np.ptp(moving, axis=0) >= TINY]
    shares = []
    for plain in (M3, M1):
        model = Model(harmonics, weighted=plain.weighted)
        orders, designs, targets = equations(phase, moving, period, model)
        if len(orders) < 3:
            return float("nan"), float("nan")
        weights = group_weights(designs, targets) if model.weighted else np.ones((3, 1))
        curve = fit_model(phase, moving, period, model).curve
        solution = np.concatenate([curve.sine, curve.cosine, curve.constant[None]])
        errors = [
            np.sqrt(weight) * (target - design @ solution)
            for weight, design, target in zip(weights, designs, targets, strict=True)
        ]
        shares.append(float(np.mean(equal_spread(errors) < level)))
    return shares[0], shares[1]
