"""One vocabulary: the same behaviour is of one group in all clips, and stays in it.

What is known keeps its group. What is new joins the group of the nearest that is known, if that is
alike; what is left makes groups of its own. These are hills of density among near neighbours
(ToMATo: Chazal, Guibas, Oudot and Skraba, J. ACM 2013): two are one where the way between them is
hardly lower than the lesser top. Their order plays no part.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.compare.neighbours import Finder
from roundelay.compare.packed import Packed, pair_distances
from roundelay.compare.thresholds import GROUPS
from roundelay.library.shelves import Shelf

__all__ = ["Assigned", "assigned", "clusters", "nearest_named", "typical"]

Labels = NDArray[np.intp]
Numbers = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Assigned:
    """The groups of all behaviours.

    Attributes
    ----------
    labels : (n,) ndarray of int
        Numbers of groups.
    founded : dict
        Examples of each new group, by its number: every member is alike to one; the first is the
        densest.
    """

    labels: Labels
    founded: dict[int, Packed]


def assigned(shelves: Sequence[Shelf], known: Labels, examples: Mapping[int, Packed]) -> Assigned:
    """Give every behaviour of a library its group.

    Parameters
    ----------
    shelves : sequence of Shelf
    known : (n,) ndarray of int
        The groups that behaviours have already; -1 of those that are new.
    examples : mapping
        Of groups that there are, by their numbers.
    """
    labels, made = known.copy(), list[tuple[int, Packed, Labels]]()
    for shelf in shelves:
        own = shelf.packed
        _join(own, shelf.numbers, labels, examples)
        left = np.flatnonzero(labels[shelf.numbers] < 0)
        found = clusters(own[left]) if len(left) else left
        for label in range(int(found.max(initial=-1)) + 1):
            rows = left[found == label]
            made.append((int(shelf.numbers[rows].min()), own[rows], shelf.numbers[rows]))
    first = 1 + max([*examples, int(known.max(initial=-1))], default=-1)
    founded = {}
    # Numbered in the order in which they first occur.
    for number, (_, packed, numbers) in enumerate(sorted(made, key=lambda one: one[0]), first):
        labels[numbers] = number
        founded[number] = packed[_covering(packed)]
    return Assigned(labels, founded)


def _join(packed: Packed, numbers: Labels, labels: Labels, examples: Mapping[int, Packed]) -> None:
    """Let what is new join the group of the nearest that is known, if that is alike."""
    new = np.flatnonzero(labels[numbers] < 0)
    old = np.flatnonzero(labels[numbers] >= 0)
    same = {number: one for number, one in examples.items() if one.body == packed.body}
    told = np.repeat(list(same), [len(one) for one in same.values()]).astype(np.intp)
    values = [one.values for one in same.values()]
    if not len(new) or not len(old) + len(told):
        return
    reference = Packed(packed.body, np.concatenate([*values, packed.values[old]]))
    owner = np.concatenate([told, labels[numbers[old]]])
    apart, rows = Finder.of(reference).nearest(packed[new], 1, GROUPS.alike)
    alike = apart[:, 0] <= GROUPS.alike
    labels[numbers[new[alike]]] = owner[rows[alike, 0]]


def clusters(packed: Packed) -> Labels:
    """Put alike signatures into groups, in time that grows hardly faster than their number.

    Parameters
    ----------
    packed : Packed

    Returns
    -------
    (n,) ndarray of int
        Labels from 0, in no order; the same groups whatever the order of the signatures.
    """
    vectors = packed.vectors()
    order = np.lexsort(vectors[:, :3].T)
    sorted_ones = packed[order]
    count = GROUPS.neighbours + 1
    apart, near = Finder.of(sorted_ones).nearest(sorted_ones, count, GROUPS.alike)
    roots = _hills(apart, near)
    labels = np.empty(len(packed), np.intp)
    labels[order] = np.unique(roots, return_inverse=True)[1]
    return labels


def _hills(apart: Numbers, near: Labels) -> Labels:
    """Return the top of the hill (n,) on which each row stands, of neighbours (n, k)."""
    count = len(near)
    rows = np.arange(count)
    linked = (apart <= GROUPS.alike) & (near != rows[:, None])
    closeness = 1.0 - (np.where(linked, apart, 0.0) / GROUPS.alike) ** 2
    density = np.sum(closeness * linked, axis=1, dtype=float)
    rank = np.empty(count, np.intp)
    rank[np.lexsort((rows, -density))] = rows
    one, other = rows.repeat(linked.sum(axis=1)), near[linked]
    low = np.where(rank[one] > rank[other], one, other)
    ends = np.unique(np.column_stack([rank[low], rank[one + other - low]]), axis=0)
    return _merged(ends, np.sort(density)[::-1])[rank]


def _merged(ends: Labels, density: NDArray[np.float64]) -> Labels:
    """Return the top of each row, of links (m, 2) from rows to denser ones; rows by density."""
    top = list(range(len(density)))
    heights = density.tolist()

    def found(row: int) -> int:
        while top[row] != row:
            top[row] = top[top[row]]
            row = top[row]
        return row

    for low, high in ends.tolist():
        hill, own = found(high), found(low)
        # The densest neighbour comes first: a row that stands alone as yet joins its hill.
        lesser, greater = max(hill, own), min(hill, own)
        if lesser != greater and heights[lesser] - heights[low] < GROUPS.prominence:
            top[lesser] = greater
    return np.array([found(row) for row in range(len(top))], np.intp)


def _covering(packed: Packed) -> Labels:
    """Return rows to which all others are alike, the densest first."""
    left = np.arange(len(packed))
    if len(left) == 1:
        return left
    count = min(len(left), GROUPS.neighbours + 1)
    apart, _ = Finder.of(packed).nearest(packed, count)
    left, chosen = np.lexsort((left, apart.sum(axis=1))), list[int]()
    while len(left):
        first = int(left[0])
        chosen.append(first)
        far = pair_distances(packed, packed, np.full(len(left), first), left) > GROUPS.alike
        left = left[far & (left != first)]
    return np.array(chosen, np.intp)


def typical(
    shelves: Sequence[Shelf], labels: Labels, examples: Mapping[int, Packed]
) -> dict[int, int]:
    """Return the number of the behaviour of each group that is nearest to its first example."""
    best: dict[int, tuple[float, int]] = {}
    for shelf in shelves:
        own = labels[shelf.numbers]
        rows = np.array([k for k, label in enumerate(own.tolist()) if label in examples], np.intp)
        names = sorted(set(own[rows].tolist()))
        place = {label: number for number, label in enumerate(names)}
        if not names:
            continue
        firsts = Packed(shelf.packed.body, np.concatenate([examples[x].values[:1] for x in names]))
        others = np.array([place[label] for label in own[rows].tolist()], np.intp)
        apart = pair_distances(shelf.packed, firsts, rows, others)
        for row, distance in zip(rows.tolist(), apart.tolist(), strict=True):
            label, number = int(own[row]), int(shelf.numbers[row])
            best[label] = min(best.get(label, (np.inf, 0)), (distance, number))
    return {label: number for label, (_, number) in best.items()}


def nearest_named(
    shelves: Sequence[Shelf], labels: Labels, named: Mapping[int, str]
) -> dict[int, str]:
    """Return the name that likeness suggests for groups that nobody named.

    It is that of the nearest behaviour of a named group, if that is alike; where there are several
    names, also if that is near and nothing without a name is much nearer.
    """
    best: dict[int, tuple[float, str]] = {}
    reach = GROUPS.near if len(set(named.values())) > 1 else GROUPS.alike
    for shelf in shelves:
        own = labels[shelf.numbers]
        is_named = np.isin(own, list(named))
        told, asked = np.flatnonzero(is_named), np.flatnonzero(~is_named)
        if not len(told) or not len(asked):
            continue
        apart, rows = Finder.of(shelf.packed[told]).nearest(shelf.packed[asked], 1, reach)
        others = _nearest_of_others(shelf.packed[asked], own[asked])
        limit = np.clip(GROUPS.nearer * others, GROUPS.alike, reach)
        for place in np.flatnonzero(apart[:, 0] <= limit).tolist():
            found = float(apart[place, 0]), named[int(own[told[rows[place, 0]]])]
            label = int(own[asked[place]])
            best[label] = min(best.get(label, found), found)
    return {label: name for label, (_, name) in best.items()}


def _nearest_of_others(packed: Packed, labels: Labels) -> Numbers:
    """Return how far (n,) the nearest signature of another group is, among some near ones."""
    apart, rows = Finder.of(packed).nearest(packed, GROUPS.neighbours)
    return np.asarray(np.where(labels[rows] == labels[:, None], np.inf, apart).min(axis=1))
