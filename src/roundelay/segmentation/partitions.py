"""How far two labellings of the same frames agree."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["adjusted_rand", "best_assignment", "contingency", "mutual_information"]

Array = NDArray[np.float64]


def contingency(one: NDArray[Any], other: NDArray[Any]) -> NDArray[np.intp]:
    """Count the frames for each pair of labels."""
    rows, columns = (np.unique(labels, return_inverse=True)[1] for labels in (one, other))
    counts = np.zeros((rows.max() + 1, columns.max() + 1), dtype=np.intp)
    np.add.at(counts, (rows, columns), 1)
    return counts


def _entropy(shares: Array) -> float:
    positive = shares[shares > 0]
    return float(-np.sum(positive * np.log(positive)))


def mutual_information(counts: NDArray[np.intp]) -> float:
    """Return the mutual information over the mean of the entropies, of a table of counts."""
    shares = counts / counts.sum()
    one, other = _entropy(shares.sum(axis=1)), _entropy(shares.sum(axis=0))
    if one + other == 0.0:
        return 1.0
    return 2.0 * (one + other - _entropy(shares.ravel())) / (one + other)


def adjusted_rand(counts: NDArray[np.intp]) -> float:
    """Return the adjusted Rand index (Hubert and Arabie 1985) of a table of counts."""
    pairs, rows, columns = (
        float(np.sum(n * (n - 1.0) / 2.0)) for n in (counts, counts.sum(axis=1), counts.sum(axis=0))
    )
    total = counts.sum() * (counts.sum() - 1.0) / 2.0
    chance, best = rows * columns / total if total else 0.0, 0.5 * (rows + columns)
    return 1.0 if best == chance else (pairs - chance) / (best - chance)


def best_assignment(counts: NDArray[np.intp]) -> int:
    """Return the largest sum of entries, one a row and column at most (shortest paths).

    The Hungarian method in the form of Jonker and Volgenant, on a padded square table.
    """
    size = max(counts.shape)
    costs = np.zeros((size + 1, size + 1))
    costs[1 : counts.shape[0] + 1, 1 : counts.shape[1] + 1] = -counts
    rows, columns = np.zeros(size + 1), np.zeros(size + 1)
    owner = np.zeros(size + 1, dtype=int)
    for row in range(1, size + 1):
        owner[0] = row
        _assign(costs, rows, columns, owner)
    return int(-sum(costs[owner[column], column] for column in range(1, size + 1)))


def _assign(costs: Array, rows: Array, columns: Array, owner: NDArray[np.intp]) -> None:
    """Give the row at column 0 a column, moving others along the shortest path."""
    slack, way = np.full(len(owner), np.inf), np.zeros(len(owner), dtype=int)
    used, column = np.zeros(len(owner), dtype=bool), 0
    while owner[column] != 0:
        used[column] = True
        reduced = costs[owner[column]] - rows[owner[column]] - columns
        nearer = ~used & (reduced < slack)
        slack[nearer], way[nearer] = reduced[nearer], column
        target = int(np.argmin(np.where(used, np.inf, slack)))
        step = slack[target]
        rows[owner[used]] += step
        columns[used] -= step
        slack[~used] -= step
        column = target
    while column != 0:
        owner[column] = owner[way[column]]
        column = int(way[column])
