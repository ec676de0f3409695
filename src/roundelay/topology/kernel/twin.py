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
    NO_VERTEX,
    U64,
    Columns,
    Reduction,
    bit_labels,
    ends,
    lengths_of,
)

__all__ = ["Twin"]

Form = dict[int, int]
"""A sum of births: number -> coefficient."""

_LANES = 16
_LARGEST = 32767


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
        run = _Run(lengths, prime, np.zeros(longest, np.float32))
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
        if not self.modulus and abs(value).max(initial=0) > _LARGEST:
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


def _length(key: int) -> np.float32:
    return np.float32(lengths_of(np.array([key], np.uint64))[0])


class _Run:
    """One run of the filtration: an edge at a time, in order."""

    def __init__(self, lengths: F32, prime: int, longest: F32) -> None:
        n = len(lengths)
        self.lengths, self.prime, self.longest = lengths, prime, longest
        self.label = bit_labels(n).astype(np.intp)
        self.vertex = np.argsort(self.label)
        self.near = np.zeros((n, n), bool)
        self.near[np.arange(n), self.label] = True
        self.fill = np.full((n, n), NO_VERTEX, np.uint16)
        self.component = np.arange(n)
        self.merges: list[float] = []
        self.births: list[int] = []
        self.number: dict[tuple[int, int], int] = {}
        self.deaths: list[float] = []
        self.killer: list[int] = []
        self.relations: list[tuple[Form, float]] = []
        self.reduced: list[tuple[Form, float]] = []

    def run(self, keys: U64, limit: np.float32) -> int:
        i, j = ends(keys)
        length = lengths_of(keys)
        for edge in range(len(keys)):
            self._add_edge(int(i[edge]), int(j[edge]), length[edge], int(keys[edge]))
            if len(self.longest) and self._is_settled(length[edge], limit):
                return edge + 1
        return len(keys)

    def _is_settled(self, length: np.float32, limit: np.float32) -> bool:
        if len(self.merges) < len(self.lengths) - 1:
            return False
        alive = (k for k, killer in enumerate(self.killer) if killer < 0)
        oldest = next(alive, None)
        earliest = length if oldest is None else _length(self.births[oldest])
        return bool(limit - earliest < self.longest[-1])

    def _add_edge(self, i: int, j: int, length: np.float32, key: int) -> None:
        lune = self.near[i] & self.near[j]
        first = int(lune.argmax())
        if lune[first]:
            through = int(self.vertex[first])
            self.fill[i, j] = through
            for other in self._other_components(lune, through):
                self._relate(i, j, through, other, length)
        else:
            self._add_unfilled(i, j, length, key)
        self.near[i, self.label[j]] = self.near[j, self.label[i]] = True

    def _add_unfilled(self, i: int, j: int, length: np.float32, key: int) -> None:
        a, b = self.component[i], self.component[j]
        if a != b:
            self.component[self.component == max(a, b)] = min(a, b)
            self.merges.append(float(length))
            return
        self.number[i, j] = len(self.births)
        self.births.append(key)
        self.deaths.append(np.inf)
        self.killer.append(-1)

    def _other_components(self, lune: NDArray[np.bool_], through: int) -> list[int]:
        """First vertices of the lune's components, but for that of the fill vertex."""
        others = []
        rest = lune & ~self._reached(lune, through)
        while rest.any():
            others.append(int(self.vertex[rest.argmax()]))
            rest &= ~self._reached(rest, others[-1])
        return others

    def _reached(self, lune: NDArray[np.bool_], start: int) -> NDArray[np.bool_]:
        reached = lune & self.near[start]
        grown = 0
        while (count := int(reached.sum())) > grown:
            grown = count
            reached = lune & self.near[self.vertex[reached]].any(axis=0)
        return reached

    def _relate(self, i: int, j: int, through: int, other: int, length: np.float32) -> None:
        form = self._expand([(i, through, 1), (through, j, 1), (i, other, -1), (other, j, -1)])
        if form:
            self.relations.append((form, float(length)))
            self._reduce(form, length)

    def _expand(self, path: list[tuple[int, int, int]]) -> Form:
        """Write a sum of oriented edges as a sum of births, longest edges first."""
        total: dict[tuple[float, int, int], int] = {}
        form: Form = {}
        for edge in path:
            self._add_term(total, *edge)
        while total:
            top = max(total)
            _, i, j = top
            coefficient, through = total.pop(top), int(self.fill[i, j])
            if through != NO_VERTEX and coefficient:
                self._add_term(total, i, through, coefficient)
                self._add_term(total, through, j, coefficient)
            elif (i, j) in self.number and coefficient:
                form[self.number[i, j]] = coefficient
        return form

    def _add_term(
        self, total: dict[tuple[float, int, int], int], a: int, b: int, coefficient: int
    ) -> None:
        i, j = min(a, b), max(a, b)
        edge = (float(self.lengths[i, j]), i, j)
        total[edge] = total.get(edge, 0) + (coefficient if a < b else -coefficient)

    def _reduce(self, form: Form, length: np.float32) -> None:
        row = {birth: value % self.prime for birth, value in form.items() if value % self.prime}
        while row and self.killer[max(row)] >= 0:
            pivot = max(row)
            factor = row[pivot]
            for birth, value in self.reduced[self.killer[pivot]][0].items():
                row[birth] = (row.get(birth, 0) - factor * value) % self.prime
            row = {birth: value for birth, value in row.items() if value}
        if row:
            self._kill(row, length)

    def _kill(self, row: Form, length: np.float32) -> None:
        pivot = max(row)
        inverse = pow(row[pivot], -1, self.prime)
        column = {birth: row[birth] * inverse % self.prime for birth in sorted(row)}
        self.killer[pivot], self.deaths[pivot] = len(self.reduced), float(length)
        self.reduced.append((column, float(length)))
        if len(self.longest):
            life = length - _length(self.births[pivot])
            self.longest[-1] = max(self.longest[-1], life)
            self.longest[::-1].sort()

    def result(self, keys: U64) -> Reduction:
        return Reduction(
            keys,
            self.fill,
            np.array(self.merges, np.float32),
            np.array(self.births, np.uint64),
            np.array(self.deaths, np.float32),
            np.array(self.killer, np.int64),
            _columns(self.relations),
            _columns(self.reduced),
        )


def _columns(forms: list[tuple[Form, float]]) -> Columns:
    sizes = [len(form) for form, _ in forms]
    return Columns(
        np.concatenate(([0], np.cumsum(sizes, dtype=np.int64))).astype(np.int64),
        np.array([birth for form, _ in forms for birth in form], np.int32),
        np.array([value for form, _ in forms for value in form.values()], np.int64),
        np.array([time for _, time in forms], np.float32),
    )


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
