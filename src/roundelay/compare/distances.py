"""Barcodes and cycles as signatures: how far apart two motions are ([A] section 7).

Two signatures of a periodic motion need no alignment by hand: its barcode, which says at which
scales its poses form loops, and its cycle, brought into phase and heading with another. A list
of captures is clustered by either; `roundelay.library` searches thousands.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.checks import as_numbers, as_sequence, expected
from roundelay.base.numeric import SMALLEST
from roundelay.base.threads import one_thread
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.edit.align import align
from roundelay.cycles.edit.points import of_common_points
from roundelay.topology.rips import Barcode

__all__ = [
    "bottleneck_distance",
    "cluster",
    "cycle_distance",
    "distance_matrix",
    "wasserstein_distance",
]

Array = NDArray[np.float64]
Labels = NDArray[np.intp]
Item = TypeVar("Item")
# The distance of two groups, and an item of each.
Merger = tuple[float, int, int]


def bottleneck_distance(first: Barcode, second: Barcode) -> float:
    """Return the least largest change of births and deaths that makes one barcode the other.

    Bars may also shrink to nothing, at half their length. Stable: clouds whose points moved by
    at most e have barcodes within 2 e (Chazal, de Silva and Oudot 2014).

    Parameters
    ----------
    first, second : Barcode
        Finite bars, in one unit.

    Returns
    -------
    float
        In the unit of the bars.

    Raises
    ------
    TypeError
        If one is no barcode.
    ValueError
        If a bar does not end.

    Examples
    --------
    >>> angle = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    >>> circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    >>> one, two = (rl.topology.persistent_cohomology(size * circle) for size in (1.0, 1.2))
    >>> round(rl.bottleneck_distance(one, two), 2)
    0.35
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import maximum_bipartite_matching

    costs = _costs(_bars(first), _bars(second))
    tried = np.unique(costs[np.isfinite(costs)])
    low, high = 0, len(tried) - 1
    while low < high:
        middle = (low + high) // 2
        matched = maximum_bipartite_matching(csr_array(costs <= tried[middle]))
        low, high = (low, middle) if np.all(matched >= 0) else (middle + 1, high)
    return float(tried[low]) if len(tried) else 0.0


def wasserstein_distance(first: Barcode, second: Barcode, *, order: float = 1.0) -> float:
    """Return the least total change of births and deaths that makes one barcode the other.

    As `bottleneck_distance`, with the p-th root of the sum of p-th powers for the largest.

    Parameters
    ----------
    first, second : Barcode
    order : float
        p, at least 1.

    Raises
    ------
    ValueError
        If a bar does not end, or the order is less than 1.

    Examples
    --------
    >>> angle = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    >>> circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    >>> one, two = (rl.topology.persistent_cohomology(size * circle) for size in (1.0, 1.2))
    >>> round(rl.wasserstein_distance(one, two), 2)
    0.35
    """
    from scipy.optimize import linear_sum_assignment

    if not 1.0 <= order < np.inf:
        raise ValueError(f"expected an order of at least 1, found {order:g}")
    costs = _costs(_bars(first), _bars(second)) ** order
    finite = np.isfinite(costs)
    # No best matching uses a pair that is dearer than all allowed ones together.
    costs[~finite] = 2.0 * costs[finite].sum() + 1.0
    return float(costs[linear_sum_assignment(costs)].sum() ** (1.0 / order))


def _bars(barcode: Barcode) -> Array:
    barcode = expected(Barcode, barcode)
    bars = np.column_stack([barcode.births, barcode.deaths])
    if not np.all(np.isfinite(bars)):
        raise ValueError("expected bars that end, found one alive at the largest scale")
    return bars


def _costs(first: Array, second: Array) -> Array:
    """Costs (n + m, m + n) of matching bars, each of which has a place of its own to vanish."""
    n, m = len(first), len(second)
    costs = np.full((n + m, m + n), np.inf)
    costs[:n, :m] = np.abs(first[:, None] - second).max(axis=-1, initial=0.0)
    costs[np.arange(n), m + np.arange(n)] = 0.5 * (first[:, 1] - first[:, 0])
    costs[n + np.arange(m), np.arange(m)] = 0.5 * (second[:, 1] - second[:, 0])
    costs[n:, m:] = 0.0
    return costs


@one_thread
def cycle_distance(first: Cycle, second: Cycle, *, mirror: bool = True) -> float:
    """Return the distance of cycles in phase and heading: RMS over joints, in body sizes.

    Parameters
    ----------
    first, second : Cycle
        Of one skeleton; bone lengths may differ. Of points, those that both have are compared.
    mirror : bool
        Take the distance to the mirrored cycle where that is less.

    Raises
    ------
    SkeletonMismatch
        If their joints differ.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> run = rl.read("run.bvh")
    >>> first, second = (rl.find_cycles(take)[0] for take in (walk, run))
    >>> rl.cycle_distance(first, first) < rl.cycle_distance(first, second)
    True
    """
    one, other = of_common_points([expected(Cycle, first), expected(Cycle, second)])
    return align(one, other, mirror=mirror).distance


@one_thread
def distance_matrix(items: Sequence[Item], distance: Callable[[Item, Item], float]) -> Array:
    """Return the distances (n, n) between all items by one of the distances here.

    Examples
    --------
    >>> rl.distance_matrix([0.0, 1.0, 3.0], lambda a, b: abs(a - b))
    array([[0., 1., 3.],
           [1., 0., 2.],
           [3., 2., 0.]])
    """
    items = as_sequence(items, "items")
    if not callable(distance):
        raise TypeError(f"expected a distance to call, found {type(distance).__name__}")
    result = np.zeros((len(items), len(items)))
    for i, item in enumerate(items):
        for j in range(i):
            result[i, j] = result[j, i] = distance(item, items[j])
    return result


@one_thread
def cluster(
    distances: ArrayLike, count: int | None = None, *, within: float | None = None
) -> Labels:
    """Put items into groups by average linkage.

    Parameters
    ----------
    distances : (n, n) array_like
        Symmetric, as from `distance_matrix`.
    count : int, optional
        How many groups; by default as many, from 2 to n - 1, as have the largest mean
        silhouette (Rousseeuw 1987).
    within : float, optional
        Instead of a count: groups are joined while their mean distance is at most this.

    Returns
    -------
    (n,) array of int
        The group of each item, numbered in the order in which they first occur.

    Raises
    ------
    ValueError
        If the distances are not square, or the count is not from 1 to n.

    Examples
    --------
    >>> places = np.array([0.0, 0.1, 5.0, 5.2])
    >>> rl.cluster(np.abs(places[:, None] - places), count=2)
    array([0, 0, 1, 1])
    """
    d = as_numbers(distances, "distances (n, n)")
    if d.ndim != 2 or d.shape[0] != d.shape[1]:
        raise ValueError(f"expected distances (n, n), found an array of shape {d.shape}")
    n, mergers = len(d), _linkage(d)
    if within is not None:
        return _joined(n, [merger for merger in mergers if merger[0] <= within])
    if count is None:
        tried = [_joined(n, mergers[:done]) for done in range(1, n - 1)]
        best = max(tried, key=lambda labels: _silhouette(d, labels), default=None)
        return _joined(n, mergers) if best is None else best
    if not 1 <= count <= n:
        raise ValueError(f"expected a count from 1 to {n}, found {count}")
    return _joined(n, mergers[: n - count])


def _linkage(distances: Array) -> list[Merger]:
    """Return the mergers of the nearest groups, nearest first.

    By chains of nearest neighbours (Murtagh 1983), in n^2 steps: groups that are each other's
    nearest are merged at once, which for average linkage gives the same tree.
    """
    d = distances.astype(np.promote_types(distances.dtype, np.float32))
    np.fill_diagonal(d, np.inf)
    sizes, chain, mergers = np.ones(len(d)), list[int](), list[Merger]()
    while len(mergers) < len(d) - 1:
        chain = chain or [int(np.argmax(sizes > 0))]
        nearest = int(np.argmin(d[chain[-1]]))
        if len(chain) < 2 or d[chain[-1], nearest] < d[chain[-1], chain[-2]]:
            chain.append(nearest)
            continue
        kept, gone = sorted((chain.pop(), chain.pop()))
        mergers.append((float(d[kept, gone]), kept, gone))
        sums = sizes[kept] * d[kept] + sizes[gone] * d[gone]
        sizes[kept], sizes[gone] = sizes[kept] + sizes[gone], 0
        d[kept] = d[:, kept] = sums / sizes[kept]
        d[gone] = d[:, gone] = d[kept, kept] = np.inf
    return sorted(mergers, key=lambda merger: merger[0])


def _joined(n: int, mergers: Sequence[Merger]) -> Labels:
    """Return the groups of n items after some mergers, numbered as they first occur."""
    owner = np.arange(n)
    for _, kept, gone in mergers:
        first, second = sorted((owner[kept], owner[gone]))
        owner[owner == second] = first
    return np.unique(owner, return_inverse=True)[1]


def _silhouette(distances: Array, labels: Labels) -> float:
    """Mean over items of (b - a) / max(a, b): a within its group, b to the next; 0 alone."""
    member = labels[:, None] == np.arange(labels.max() + 1)
    sums, sizes = distances @ member, member.sum(axis=0)
    own = sizes[labels]
    within = sums[np.arange(len(labels)), labels] / np.maximum(own - 1, 1)
    beyond = np.where(member, np.inf, sums / sizes).min(axis=1)
    widest = np.maximum(np.maximum(within, beyond), SMALLEST)
    return float(np.mean(np.where(own > 1, (beyond - within) / widest, 0.0)))
