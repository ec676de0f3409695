"""A Gaussian mixture on the circle: the density of a circular coordinate ([A] 4.4, 5.2)."""

from __future__ import annotations

from dataclasses import dataclass
from math import erfc

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.brief import brief
from roundelay.base.numeric import TINY
from roundelay.phase.thresholds import MIXTURE

__all__ = ["CircularMixture", "fit_circular_mixture"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CircularMixture:
    """A mixture of normal distributions fitted to three copies of phases, one turn apart.

    Attributes
    ----------
    means, variances, shares : (k,) ndarray
        Of the components; only the middle turn [0, 1) counts.
    """

    means: Array
    variances: Array
    shares: Array

    __repr__ = brief

    def density(self, phase: ArrayLike) -> Array:
        """Return the density (n,) at phases (n,), with an integral of 1 over [0, 1)."""
        x = np.asarray(phase, float)[:, None]
        parts = np.exp(-0.5 * (x - self.means) ** 2 / self.variances)
        values = (parts / np.sqrt(2 * np.pi * self.variances)) @ self.shares
        low, high = self._below(np.array([0.0, 1.0]))
        return values / (high - low)

    def distribution(self, phase: ArrayLike) -> Array:
        """Return the share (n,) of the density that lies between 0 and each phase (n,)."""
        low, high = self._below(np.array([0.0, 1.0]))
        return (self._below(np.asarray(phase, float)) - low) / (high - low)

    def quantiles(self, count: int) -> Array:
        """Return phases (count,) that part the density into equal shares, in order."""
        grid = np.linspace(0.0, 1.0, 4001)
        return np.interp((np.arange(count) + 0.5) / count, self.distribution(grid), grid)

    def _below(self, x: Array) -> Array:
        scaled = (x[:, None] - self.means) / np.sqrt(2.0 * self.variances)
        normal = [0.5 * erfc(-value) for value in scaled.ravel().tolist()]
        return np.array(normal).reshape(scaled.shape) @ self.shares


def fit_circular_mixture(phase: ArrayLike) -> CircularMixture:
    """Fit a mixture by expectation and maximisation, as [A] 6.1 does.

    Parameters
    ----------
    phase : (n,) array_like
        In turns.
    """
    components = MIXTURE.components
    theta = np.asarray(phase, float) % 1.0
    x = np.concatenate([theta - 1.0, theta, theta + 1.0])
    means = np.quantile(x, (np.arange(components) + 0.5) / components)
    variances = np.full(components, (3 / components) ** 2)
    shares = np.full(components, 1.0 / components)
    for _ in range(MIXTURE.iterations):
        logs = np.log(shares / np.sqrt(variances)) - 0.5 * (x[:, None] - means) ** 2 / variances
        member = np.exp(logs - logs.max(axis=1, keepdims=True))
        member /= member.sum(axis=1, keepdims=True)
        weight = member.sum(axis=0) + TINY
        means = (x @ member) / weight
        spread = np.sum(member * (x[:, None] - means) ** 2, axis=0)
        variances = spread / weight + MIXTURE.least_variance
        shares = weight / weight.sum()
    return CircularMixture(means, variances, shares)
