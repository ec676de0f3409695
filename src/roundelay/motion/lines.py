"""Lines between points: the tree by which they hang on the frame of their body."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from roundelay.geometry.symmetry import is_left, other_side
from roundelay.motion.point_sets import PointSet, known_set, plain_name
from roundelay.motion.poses import Mask
from roundelay.motion.thresholds import FRAME

__all__ = ["Links", "links_of", "symmetric_tree", "tree_of", "trunk_of"]

Array = NDArray[np.float64]
Places = NDArray[np.intp]
Links = tuple[tuple[int, int], ...]


def trunk_of(names: Sequence[str], positions: Array, seen: Mask) -> Places:
    """Return the points of the trunk: those of a known set, else the stiff middle of the body.

    Points that keep their distances hang together; what lies in the middle of the tree of all
    points, with what keeps its distance to it, is the trunk.

    Parameters
    ----------
    names : sequence of str
    positions : (F, J, 3) ndarray
    seen : (F, J) ndarray of bool
    """
    one, places = known_set(names), _places(names)
    if one is not None:
        return np.array(sorted(places[name] for name in one.trunk if name in places), np.intp)
    changes, lengths = _distances(positions, seen)
    middle = _middle(changes + FRAME.nearness * lengths, lengths)
    order = np.argsort(changes[middle], kind="stable")
    third = changes[middle, order[min(3, len(order) - 1)]]
    limit = max(FRAME.loose * third, FRAME.noise * lengths.max())
    # All distances of the trunk count: what turns about the middle keeps its distance to it.
    trunk: list[int] = []
    for point in order.tolist():
        if not trunk or changes[point, trunk].max() <= limit:
            trunk.append(point)
    return np.array(sorted(trunk), np.intp)


def _middle(costs: Array, lengths: Array) -> int:
    """Return the point of the cheapest tree from which the farthest is nearest along the tree."""
    count = len(costs)
    reached, above = np.zeros(count, bool), np.zeros(count, np.intp)
    along, best = np.zeros((count, count)), costs[0].copy()
    reached[0] = True
    while not reached.all():
        point = int(np.argmin(np.where(reached, np.inf, best)))
        ways = along[above[point], reached] + lengths[above[point], point]
        along[point, reached] = along[reached, point] = ways
        reached[point] = True
        nearer = costs[point] < best
        best[nearer], above[nearer] = costs[point, nearer], point
    return int(np.argmin(along.max(axis=1)))


def _distances(positions: Array, seen: Mask) -> tuple[Array, Array]:
    """Return how much (J, J) the distances of points change, and how long they are.

    What is never seen together changes as much as anything.
    """
    few = np.unique(np.linspace(0, len(seen) - 1, FRAME.frames).round().astype(int))
    x, mask = positions[few], seen[few]
    both = mask[:, :, None] & mask[:, None]
    apart = np.where(both, np.linalg.norm(x[:, :, None] - x[:, None], axis=-1), np.nan)
    with warnings.catch_warnings():
        # Of those never seen together there is no median.
        warnings.simplefilter("ignore", RuntimeWarning)
        # An outlier is no change: nine tenths of the frames count.
        low, lengths, high = np.nanquantile(apart, (FRAME.tail, 0.5, 1.0 - FRAME.tail), axis=0)
        changes = 0.5 * (high - low)
    never = ~both.any(axis=0)
    changes[never], lengths[never] = np.nanmax(changes), np.nanmax(lengths)
    return changes, lengths


def links_of(names: Sequence[str]) -> Links:
    """Return the lines of a known set; none for a set that is not known."""
    one = known_set(names)
    return () if one is None else _links(one, names)


def _links(one: PointSet, names: Sequence[str]) -> Links:
    places, found = _places(names), list[tuple[int, int]]()
    for chain in one.chains:
        there = [places[name] for name in chain if name in places]
        found += pairwise(there)
    return tuple(dict.fromkeys(found))


def _places(names: Sequence[str]) -> dict[str, int]:
    """Return the place of each plain name, of several alike the first."""
    return {plain_name(name): place for place, name in reversed(list(enumerate(names)))}


def tree_of(positions: Array, seen: Mask, trunk: Places, links: Links) -> list[int]:
    """Return the parent of every point: -1 for those that hang on the frame itself.

    Points follow lines from the trunk outward. Those that no line reaches hang on the point
    whose distance changes least, near ones first.

    Parameters
    ----------
    positions : (F, J, 3) ndarray
    seen : (F, J) ndarray of bool
    trunk : (k,) ndarray of int
    links : tuple of (int, int)
    """
    count = positions.shape[1]
    changes, lengths = _distances(positions, seen)
    parents, costs = np.full(count, -1), changes + FRAME.nearness * lengths
    reached = np.zeros(count, bool)
    reached[trunk] = True
    linked = np.zeros((count, count), bool)
    for a, b in links:
        linked[a, b] = linked[b, a] = a != b
    while not reached.all():
        # A line counts before any nearness.
        open_ = np.where(reached[:, None] & ~reached[None], costs, np.inf)
        lined = np.where(linked, open_, np.inf)
        chosen = lined if np.isfinite(lined).any() else open_
        above, point = divmod(int(np.argmin(chosen)), count)
        parents[point], reached[point] = above, True
    return [int(parent) for parent in parents]


def symmetric_tree(tree: Sequence[int], names: Sequence[str]) -> list[int]:
    """Return a tree in which right points hang as their left partners do, so that it has a mirror.

    Left points hang on the nearest above them that is not on the right, those of the middle on the
    nearest that is of the middle.

    Parameters
    ----------
    tree : sequence of int
        The parent of each point; -1 for the frame.
    names : sequence of str
        Names that tell sides; where one has no partner, the tree stays as it is.
    """
    places = {name: place for place, name in enumerate(names)}
    others = [other_side(name, places) for name in names]
    if any(other is not None and other not in places for other in others):
        return list(tree)
    partner = [place if o is None else places[o] for place, o in enumerate(others)]
    left = [is_left(name, names[other]) for name, other in zip(names, partner, strict=True)]
    middle = [place == other for place, other in enumerate(partner)]

    def above(point: int) -> int:
        parent = tree[point]
        while parent >= 0 and not (middle[parent] or (left[parent] and left[point])):
            parent = tree[parent]
        return parent

    found = [above(point) if left[point] or middle[point] else -1 for point in range(len(tree))]
    for point, other in enumerate(partner):
        if not (left[point] or middle[point]):
            found[point] = -1 if found[other] < 0 else partner[found[other]]
    return found
