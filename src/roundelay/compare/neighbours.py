"""Nearest signatures among many: candidates by vectors, then exact distances.

Vectors are the same wherever a cycle begins, and no farther apart than the cycles, so that few
candidates are enough. They are found by a graph of near neighbours (usearch, an extra), where there
are many, else by all products.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import SIX_DIGITS
from roundelay.compare.packed import Packed, pair_distances
from roundelay.compare.thresholds import NEAR

__all__ = ["Finder", "graph_of", "has_usearch"]

Numbers = NDArray[np.float32]
Rows = NDArray[np.intp]

# Vectors compared with all others at once: 64 MB for 100,000 of them.
_BLOCK = 160


def has_usearch() -> bool:
    """Tell whether usearch is installed."""
    return find_spec("usearch") is not None


def graph_of(vectors: Numbers) -> Any:
    """Return a graph of near neighbours (a `usearch.index.Index`) of vectors, in their order."""
    graph = _empty(vectors.shape[1])
    # One thread: the same vectors in the same order give the same graph.
    graph.add(np.arange(len(vectors)), vectors, threads=1)
    return graph


def _empty(width: int) -> Any:
    from usearch.index import Index

    return Index(
        ndim=width,
        metric="l2sq",
        dtype="f16",
        connectivity=NEAR.links,
        expansion_add=NEAR.added,
        expansion_search=NEAR.searched,
    )


@dataclass(frozen=True, eq=False)
class Finder:
    """Find the nearest of many signatures of one body.

    Attributes
    ----------
    packed : Packed
    graph : usearch.index.Index or None
        Of their vectors; without one all are compared.
    """

    packed: Packed
    graph: Any = None

    @cached_property
    def vectors(self) -> Numbers:
        """The vectors (n, d) of the signatures."""
        return self.packed.vectors()

    @cached_property
    def _squares(self) -> Numbers:
        return np.asarray(np.einsum("nd,nd->n", self.vectors, self.vectors))

    @classmethod
    def of(cls, packed: Packed) -> Finder:
        """Prepare the search among signatures; many get a graph, where usearch is installed."""
        many = len(packed) >= NEAR.many and has_usearch()
        return cls(packed, graph_of(packed.vectors()) if many else None)

    @classmethod
    def opened(cls, packed: Packed, path: Path | None) -> Finder:
        """Prepare the search by a graph that was saved, read from disk as it is needed."""
        if path is None or not has_usearch():
            return cls(packed)
        graph = _empty(packed[:1].vectors().shape[1])
        graph.view(str(path))
        return cls(packed, graph)

    def nearest(
        self, queries: Packed, count: int, within: float | None = None
    ) -> tuple[Numbers, Rows]:
        """Return the nearest of all signatures to each of some.

        Parameters
        ----------
        queries : Packed
            Of the same body.
        count : int
        within : float, optional
            What is surely farther is not compared, and told as infinitely far.

        Returns
        -------
        distances : (q, k) ndarray of float32
            Nearest first.
        rows : (q, k) ndarray of int
        """
        count = min(count, len(self.packed))
        tried = min(len(self.packed), max(NEAR.candidates, NEAR.times * count))
        rows, squares = self._candidates(queries.vectors(), tried)
        apart = np.full(rows.shape, np.inf, np.float32)
        reach = self._reach(queries, rows, squares, count) if within is None else within
        # Vectors are no farther apart than cycles, but for their rounding.
        tested = squares <= NEAR.slack * np.square(reach) + SIX_DIGITS
        asked = np.nonzero(tested)[0]
        apart[tested] = pair_distances(queries, self.packed, asked, rows[tested])
        # Equally near ones come in the order of their rows.
        order = np.lexsort((rows, apart), axis=1)[:, :count]
        return np.take_along_axis(apart, order, 1), np.take_along_axis(rows, order, 1)

    def _reach(self, queries: Packed, rows: Rows, squares: Numbers, count: int) -> Numbers:
        """Return how far (q, 1) some are that are many enough: the nearest are no farther."""
        first = np.argpartition(squares, count - 1, axis=1)[:, :count]
        near = np.take_along_axis(rows, first, 1).ravel()
        asked = np.repeat(np.arange(len(rows)), count)
        found = pair_distances(queries, self.packed, asked, near)
        return np.asarray(found.reshape(len(rows), count).max(axis=1, keepdims=True))

    def _candidates(self, vectors: Numbers, count: int) -> tuple[Rows, Numbers]:
        """Return rows (q, count) whose vectors are near, and the squares of how far."""
        if self.graph is not None:
            found = self.graph.search(vectors, count, threads=1)
            shape = (len(vectors), count)
            return np.reshape(found.keys, shape).astype(np.intp), np.reshape(found.distances, shape)
        blocks = range(0, len(vectors), _BLOCK)
        parts = [self._compared(vectors[k : k + _BLOCK], count) for k in blocks]
        rows, squares = (np.vstack(part) for part in zip(*parts, strict=True))
        return rows, squares

    def _compared(self, vectors: Numbers, count: int) -> tuple[Rows, Numbers]:
        own = np.einsum("nd,nd->n", vectors, vectors)
        apart = own[:, None] + self._squares - 2.0 * vectors @ self.vectors.T
        if count == len(self.packed):
            return np.tile(np.arange(count), (len(vectors), 1)), apart
        rows = np.argpartition(apart, count - 1, axis=1)[:, :count]
        return rows, np.take_along_axis(apart, rows, 1)
