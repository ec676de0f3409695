"""Running sums: mean and covariance of any stretch of frames in constant time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.segmentation.thresholds import MODEL

__all__ = ["Moments", "normalized", "principal_axes"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Moments:
    """Hold the sums of values and of their products before every frame (or block of frames).

    Parameters
    ----------
    counts : (n + 1,) ndarray
        Frames before each boundary.
    sums : (n + 1, d) ndarray
    products : (n + 1, d, d) ndarray
    """

    counts: Array
    sums: Array
    products: Array

    @classmethod
    def of(cls, values: Array, block: int = 1) -> Moments:
        """Sum values (n, d); boundaries every `block` frames, what is left over is ignored."""
        boundaries = len(values) // block
        used = values[: boundaries * block].reshape(boundaries, block, -1)
        counts = np.arange(boundaries + 1.0) * block
        return cls(
            counts, _before(used.sum(axis=1)), _before(np.matmul(np.swapaxes(used, 1, 2), used))
        )

    def between(self, start: ArrayLike, stop: ArrayLike) -> tuple[Array, Array, Array]:
        """Return number (...), mean (..., d), covariance (..., d, d) of boundaries' ranges.

        The covariance is divided by the number of frames, as maximum likelihood does.
        """
        first, last = np.asarray(start), np.asarray(stop)
        return normalized(
            self.counts[last] - self.counts[first],
            self.sums[last] - self.sums[first],
            self.products[last] - self.products[first],
        )

    @cached_property
    def covariance(self) -> Array:
        """Covariance (d, d) of everything."""
        return self.between(0, len(self.counts) - 1)[2]


def normalized(count: Array, total: Array, products: Array) -> tuple[Array, Array, Array]:
    """Turn sums over frames into number, mean and covariance."""
    mean = total / count[..., None]
    covariance = products / count[..., None, None] - mean[..., :, None] * mean[..., None, :]
    return count, mean, covariance


def _before(terms: Array) -> Array:
    sums = np.zeros((len(terms) + 1, *terms.shape[1:]))
    np.cumsum(terms, axis=0, out=sums[1:])
    return sums


def principal_axes(values: Array) -> tuple[Array, Array]:
    """Return variances (k,), largest first, and axes (d, k) in columns, of values (n, d).

    All there are, k = d or n at most; of very many channels the largest alone, so that time
    grows with the square of d.
    """
    centred = values - values.mean(axis=0)
    count, channels = centred.shape
    if min(count, channels) > MODEL.axes:
        centred, basis = _largest(centred)
    elif count < channels:
        # The same variances, and at most as many axes as there are values.
        basis = np.linalg.qr(centred.T)[0]
        centred = centred @ basis
    else:
        basis = np.eye(channels)
    variances, axes = np.linalg.eigh(centred.T @ centred / count)
    return np.maximum(variances[::-1], 0.0), basis @ axes[:, ::-1]


def _largest(centred: Array) -> tuple[Array, Array]:
    """Return values (n, k) along a basis (d, k) of the subspace in which they vary most.

    By subspace iteration from a random start (Halko, Martinsson and Tropp 2011, algorithm 4.4).
    """
    start = np.random.default_rng(0).normal(size=(centred.shape[1], MODEL.axes))
    basis = np.linalg.qr(start)[0]
    for _ in range(MODEL.passes):
        basis = np.linalg.qr(centred.T @ (centred @ basis))[0]
    return centred @ basis, basis
