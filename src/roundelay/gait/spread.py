"""Mean and spread of strides, with an interval of the mean by a block bootstrap.

Strides are not independent: a long one is followed by another. So blocks of neighbours are drawn,
as long as the cube root of their number, from the strides laid in a circle (Politis, Romano 1992).
Every draw is compared with its own spread between blocks (bootstrap-t), so that the intervals of
few strides are as wide as they should be. What short blocks miss of the relation of neighbours is
added as if strides were an autoregression of the first order, its correlation freed from the bias
of few (Marriott, Pope 1954).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import ROUNDING
from roundelay.gait.thresholds import SPREAD

__all__ = ["Spread", "mean_interval", "spread_of"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Spread:
    """Mean and spread of one quantity.

    Attributes
    ----------
    count : int
        Of the strides in which it is known.
    mean : float
        NaN without any.
    sd : float
        Standard deviation, of n - 1; NaN of one stride.
    cv : float
        It over the mean.
    low, high : float
        Interval of the mean; NaN of fewer than five strides.
    """

    count: int
    mean: float
    sd: float
    cv: float
    low: float
    high: float


def spread_of(
    values: Array, *, level: float, resamples: int, rng: int | np.random.Generator = 0
) -> Spread:
    """Tell mean and spread of values (n,) in order of time; those that are NaN do not count.

    Parameters
    ----------
    values : (n,) ndarray
    level : float
        Of the interval.
    resamples : int
        Draws of the bootstrap.
    rng : int or numpy.random.Generator
    """
    known = values[np.isfinite(values)]
    nothing = float("nan")
    if not len(known):
        return Spread(0, *[nothing] * 5)
    mean = float(known.mean())
    if len(known) == 1:
        return Spread(1, mean, *[nothing] * 4)
    sd = float(known.std(ddof=1))
    cv = sd / abs(mean) if mean else nothing
    low, high = mean_interval(known, level=level, resamples=resamples, rng=rng)
    return Spread(len(known), mean, sd, cv, low, high)


def mean_interval(
    values: Array, *, level: float, resamples: int, rng: int | np.random.Generator = 0
) -> tuple[float, float]:
    """Return an interval of the mean of values (n,) in order of time; NaN of fewer than five.

    Parameters
    ----------
    values : (n,) ndarray
    level : float
        How often, of 1, it holds the true mean.
    resamples : int
        Draws of the bootstrap.
    rng : int or numpy.random.Generator
    """
    count = len(values)
    if count < SPREAD.fewest:
        return float("nan"), float("nan")
    if np.ptp(values) <= ROUNDING * abs(values).max():
        return float(values.mean()), float(values.mean())
    length = max(1, min(round(count ** (1 / 3)), count // SPREAD.blocks))
    circle = np.concatenate([values, values[: length - 1]])
    means = np.convolve(circle, np.full(length, 1 / length), "valid")
    drawn = max(2, count // length)
    error = float(means.std()) * np.sqrt(count / (count - length) / drawn)
    picks = np.random.default_rng(rng).integers(0, count, (resamples, drawn))
    blocks = means[picks]
    spreads = blocks.std(axis=1, ddof=1) / np.sqrt(drawn)
    # A draw of one block again and again tells no spread.
    told = spreads > ROUNDING * error
    away = abs(blocks.mean(axis=1) - values.mean())[told] / spreads[told]
    reach = float(np.quantile(away, level)) * error * _missed(values, length)
    return float(values.mean() - reach), float(values.mean() + reach)


def _missed(values: Array, length: int) -> float:
    """Return by what errors grow for the relation of neighbours that blocks of a length miss."""
    away, count = values - values.mean(), len(values)
    told = float(away[1:] @ away[:-1]) / float(away @ away)
    related = float(np.clip(told + (1 + 3 * told) / count, 0.0, SPREAD.related))
    lags = np.arange(1, length)
    within = 1.0 + 2.0 * float(np.sum((1.0 - lags / length) * related**lags))
    return float(np.sqrt((1.0 + related) / (1.0 - related) / within))
