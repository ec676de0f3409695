"""The NumPy twin of the compiled kernel: the same work in the same order, a step per edge."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from roundelay.topology.kernel.reduction import (
    F32,
    F64,
    I32,
    I64,
    LARGEST_VALUE,
    NO_VERTEX,
    U64,
    Reduction,
    ends,
)
from roundelay.topology.kernel.twin_rips import Run

__all__ = ["Twin"]

_LANES = 16


class Twin:
    """See :class:`roundelay.topology.kernel.Engine`."""

    def distances(self, x: F32, y: F32 | None = None) -> F32:
        """Euclidean distances between rows, summed in the order of the kernel."""
        left, right = _lanes(x), _lanes(x if y is None else y)
        out = np.zeros((len(left), len(right)), np.float32)
        for i, row in enumerate(left):
            first = i + 1 if y is None else 0
            out[i, first:] = _row_distances(row, right[first:])
        return out

    def reduce(self, lengths: F32, *, limit: float, prime: int, longest: int) -> Reduction:
        """Run the filtration."""
        keys = _sorted_keys(lengths, limit)
        run = Run(lengths, prime, np.zeros(longest, np.float32))
        processed = run.run(keys, np.float32(limit))
        return run.result(keys[:processed])

    def propagate(self, reduced: Reduction, count: int, on_births: I64, modulus: int) -> I32:
        """Extend a cocycle from the births to the first edges, in waves of known halves."""
        table = _Table.empty(len(reduced.fill), modulus)
        i, j = ends(reduced.keys[:count])
        through = reduced.fill[i, j].astype(np.intp)
        given = np.zeros(count, np.int64)
        births = np.searchsorted(reduced.keys[:count], reduced.births)
        given[births[births < count]] = on_births[births < count]
        bare = through == NO_VERTEX
        table.store(i[bare], j[bare], given[bare])
        waiting = np.flatnonzero(~bare)
        while len(waiting):
            waiting = table.store_known(i, j, through, waiting)
        return table.values[i, j].astype(np.int32)

    def harmonic(
        self, keys: U64, values: I32, start: F64, *, close: int, tolerance: float
    ) -> tuple[F64, float]:
        """Minimise the weighted norm of values + dw by preconditioned conjugate gradients."""
        i, j = ends(keys)
        density = 1.0 + np.bincount(np.concatenate((i[:close], j[:close])), minlength=len(start))
        edges = _Edges(i, j, values.astype(np.float64), 1.0 / (density[i] * density[j]), len(start))
        w = _solve(edges, start.copy(), tolerance)
        return w, float(abs(edges.values + w[j] - w[i]).max(initial=0.0))


@dataclass(frozen=True)
class _Table:
    """Values of a cocycle on all pairs (n, n), antisymmetric, and which of them are known."""

    values: I64
    known: NDArray[np.bool_]
    modulus: int

    @classmethod
    def empty(cls, n: int, modulus: int) -> _Table:
        return cls(np.zeros((n, n), np.int64), np.eye(n, dtype=bool), modulus)

    def store(self, i: NDArray[np.intp], j: NDArray[np.intp], value: I64) -> None:
        if not self.modulus and abs(value).max(initial=0) > LARGEST_VALUE:
            raise OverflowError("values of the cocycle leave the range of 15 bits")
        self.values[i, j] = value % self.modulus if self.modulus else value
        self.values[j, i] = -self.values[i, j]
        self.known[i, j] = self.known[j, i] = True

    def store_known(
        self,
        i: NDArray[np.intp],
        j: NDArray[np.intp],
        through: NDArray[np.intp],
        waiting: NDArray[np.intp],
    ) -> NDArray[np.intp]:
        """Store the waiting edges of which both halves are known; return the others."""
        a, b, c = i[waiting], j[waiting], through[waiting]
        ready = self.known[a, c] & self.known[c, b]
        a, b, c = a[ready], b[ready], c[ready]
        self.store(a, b, self.values[a, c] + self.values[c, b])
        return waiting[~ready]


def _lanes(x: F32) -> F32:
    padded = np.pad(x, ((0, 0), (0, -x.shape[1] % _LANES)))
    return padded.reshape(len(x), -1, _LANES)


def _row_distances(row: F32, others: F32) -> F32:
    sums = np.zeros((len(others), _LANES), np.float32)
    for part in range(row.shape[0]):
        difference = row[part] - others[:, part]
        sums += difference * difference
    while sums.shape[1] > 1:
        half = sums.shape[1] // 2
        sums = sums[:, :half] + sums[:, half:]
    return np.asarray(np.sqrt(sums[:, 0]), np.float32)


def _sorted_keys(lengths: F32, limit: float) -> U64:
    i, j = np.triu_indices(len(lengths), 1)
    length = np.ascontiguousarray(lengths[i, j])
    bits = length.view(np.uint32).astype(np.uint64) << np.uint64(32)
    keys = bits | i.astype(np.uint64) << np.uint64(16) | j.astype(np.uint64)
    return np.sort(keys[length <= np.float32(limit)])


@dataclass(frozen=True)
class _Edges:
    """The graph of one smoothing."""

    i: NDArray[np.intp]
    j: NDArray[np.intp]
    values: F64
    weight: F64
    n: int
    diagonal: F64 = field(init=False)

    def __post_init__(self) -> None:
        total = self._sum(self.i, self.weight) + self._sum(self.j, self.weight)
        object.__setattr__(self, "diagonal", np.where(total > 0, total, np.inf))

    def _sum(self, ends: NDArray[np.intp], flow: F64) -> F64:
        return np.asarray(np.bincount(ends, flow, self.n), np.float64)

    def divergence(self, steps: F64) -> F64:
        """Weighted sum of a function on edges around each vertex (n,)."""
        flow = self.weight * steps
        return self._sum(self.i, flow) - self._sum(self.j, flow)

    def laplacian(self, w: F64) -> F64:
        return self.divergence(w[self.i] - w[self.j])


def _solve(edges: _Edges, w: F64, tolerance: float) -> F64:
    residual = edges.divergence(edges.values + w[edges.j] - w[edges.i])
    ready = residual / edges.diagonal
    direction, energy = ready.copy(), float(residual @ ready)
    for _ in range(4 * edges.n):
        if abs(ready).max() <= tolerance:
            break
        image = edges.laplacian(direction)
        length = energy / float(direction @ image)
        w += length * direction
        residual -= length * image
        ready = residual / edges.diagonal
        previous, energy = energy, float(residual @ ready)
        direction = ready + energy / previous * direction
    return w
