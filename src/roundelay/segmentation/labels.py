"""Which segments show the same behaviour: merging Gaussians while that explains the data better.

Every segment is a Gaussian cloud of poses ([B] 3.2, figure 6). Two clouds that one Gaussian
describes as well, but for what it saves in parameters, are one behaviour.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from roundelay.segmentation.moments import Moments, normalized

__all__ = ["recurring_labels"]

Array = NDArray[np.float64]
Cost = Callable[[Array, Array], Array]


def recurring_labels(
    moments: Moments, bounds: Sequence[int], cost: Cost, penalty: float
) -> list[int]:
    """Label segments so that a behaviour that comes back bears the same label.

    Parameters
    ----------
    moments : Moments
    bounds : sequence of int
        Boundaries of the s segments, both ends included: s + 1 numbers.
    cost : callable
        From numbers (...) and covariances (..., d, d) to minus twice the log-likelihood.
    penalty : float
        What a behaviour of its own must gain.

    Returns
    -------
    list of int
        Labels of the s segments, numbered by first appearance.
    """
    sums = _Sums.of_segments(moments, np.asarray(bounds))
    owner = np.arange(len(bounds) - 1)
    alone = sums.cost(cost, owner)
    worth = np.full((len(owner), len(owner)), np.inf)
    for row in owner:
        worth[row, :row] = sums.joined(int(row), owner[:row]).cost(cost) - alone[row] - alone[:row]
    while np.min(worth, initial=np.inf) < penalty:
        gone, kept = np.unravel_index(np.argmin(worth), worth.shape)
        owner[owner == gone] = kept
        sums = sums.merged(int(kept), int(gone))
        alone[kept] = sums.cost(cost, np.array([kept]))[0]
        _renew(worth, sums, cost, alone, int(kept), int(gone), np.unique(owner))
    return _by_appearance(owner)


class _Sums:
    """Sums over the frames of each behaviour."""

    def __init__(self, count: Array, total: Array, products: Array) -> None:
        self.parts = (count, total, products)

    @classmethod
    def of_segments(cls, moments: Moments, bounds: NDArray[np.intp]) -> _Sums:
        kept = (moments.counts, moments.sums, moments.products)
        count, total, products = (np.diff(part[bounds], axis=0) for part in kept)
        return cls(count, total, products)

    def joined(self, one: int, others: NDArray[np.intp]) -> _Sums:
        return _Sums(*(part[others] + part[one] for part in self.parts))

    def merged(self, kept: int, gone: int) -> _Sums:
        for part in self.parts:
            part[kept] += part[gone]
        return self

    def cost(self, cost: Cost, rows: NDArray[np.intp] | slice = slice(None)) -> Array:
        count, total, products = (part[rows] for part in self.parts)
        count, _, covariance = normalized(count, total, products)
        return cost(count, covariance)


def _renew(
    worth: Array,
    sums: _Sums,
    cost: Cost,
    alone: Array,
    kept: int,
    gone: int,
    living: NDArray[np.intp],
) -> None:
    """Bring the table of what keeping apart is worth up to date after a merger."""
    worth[gone], worth[:, gone] = np.inf, np.inf
    others = living[living != kept]
    if len(others) == 0:
        return
    gained = sums.joined(kept, others).cost(cost) - alone[kept] - alone[others]
    worth[np.maximum(others, kept), np.minimum(others, kept)] = gained


def _by_appearance(owner: NDArray[np.intp]) -> list[int]:
    number: dict[int, int] = {}
    return [number.setdefault(int(label), len(number)) for label in owner]
