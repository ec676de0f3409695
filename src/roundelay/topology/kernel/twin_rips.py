"""The filtration run of the NumPy twin: one edge at a time, in order."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.topology.kernel.reduction import (
    F32,
    NO_VERTEX,
    U64,
    Columns,
    Reduction,
    bit_labels,
    ends,
    lengths_of,
)

__all__ = ["Run"]

Form = dict[int, int]
"""A sum of births: number -> coefficient."""


class Run:
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
        """Add the edges; return how many until the last death, or all if a class still lives."""
        i, j = ends(keys)
        length = lengths_of(keys)
        ended = edge = -1
        for edge in range(len(keys)):
            died = len(self.reduced)
            self._add_edge(int(i[edge]), int(j[edge]), length[edge], int(keys[edge]))
            ended = edge if len(self.reduced) > died else ended
            if len(self.longest) and self._is_settled(length[edge], limit):
                break
        return 1 + (edge if -1 in self.killer else ended)

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
            others = self._other_components(lune, through) if -1 in self.killer else []
            for other in others:
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
        """Return what the run found on these edges."""
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


def _length(key: int) -> np.float32:
    return np.float32(lengths_of(np.array([key], np.uint64))[0])
