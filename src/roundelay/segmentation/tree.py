"""All cuts of a take as one tree: a finer answer holds every cut of a coarser one.

The piecewise Gaussian proposes cuts. Neighbours that predict each other are joined, the most
alike first (average linkage), and the unlikeness at which a cut goes is its height. Finer cuts
are sought within what the proposals leave whole, each time for half the evidence. A height is
the logarithm of the odds that the cut is one that people make, whatever section is asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from roundelay.segmentation.gaussian import search, settled
from roundelay.segmentation.likeness import Stretch, unlikeness
from roundelay.segmentation.model import GaussianModel
from roundelay.segmentation.thresholds import LIKENESS, TREE

__all__ = ["CutTree", "labelled"]

Array = NDArray[np.float64]
Between = Callable[[int, int], float]


@dataclass(eq=False)
class CutTree:
    """The cuts of a take and their heights, as fine as they have been asked for.

    Parameters
    ----------
    model : GaussianModel
    shortest : float
        Seconds a behaviour lasts at least.
    repeating : tuple of (n,) ndarray
        Thinned frames in which something repeats, True where it does, one row a behaviour.
    """

    model: GaussianModel
    shortest: float
    repeating: tuple[NDArray[np.bool_], ...] = ()

    def above(self, height: float) -> dict[int, float]:
        """Return the cuts, thinned frames that grow, at least so high, with their heights."""
        levels = int(np.ceil(max(0.0, -height) / np.log(2.0)))
        found = self._down_to(min(levels, TREE.levels))
        return {cut: found[cut] for cut in sorted(found) if found[cut] >= height}

    def highest(self, count: int) -> dict[int, float]:
        """Return so many of the highest cuts, or all there are, with their heights."""
        found = self._proposed
        for level in range(TREE.levels + 1):
            found = self._down_to(level)
            # What lies deeper is lower than all cuts of this level, but not than all proposals.
            lowest = -level * np.log(2.0)
            if sum(height >= lowest for height in found.values()) >= count:
                break
        kept = sorted(found, key=lambda cut: -found[cut])[:count]
        return {cut: found[cut] for cut in sorted(kept)}

    def stretches(self, cuts: Sequence[int]) -> list[Stretch]:
        """Return the stretches that cuts leave, and what fills each."""
        return [
            replace(
                Stretch.of(self.model.points[start:stop], self.model.fps, self.model.resolution),
                shows=frozenset(
                    number
                    for number, frames in enumerate(self.repeating)
                    if frames[start:stop].mean() >= LIKENESS.filled
                ),
            )
            for start, stop in pairwise([0, *cuts, len(self.model)])
        ]

    @cached_property
    def _proposed(self) -> dict[int, float]:
        """The proposals by their heights."""
        model = self.model
        if model.still or len(model) < 2.0 * self.shortest * model.fps:
            return {}
        cuts = settled(model, search(model, self.shortest, TREE.proposed), self.shortest)
        joined = _joined(self.stretches(cuts))
        return {
            cut: (joined[place] - LIKENESS.cut) / LIKENESS.scale for place, cut in enumerate(cuts)
        }

    def _down_to(self, level: int) -> dict[int, float]:
        """Return the proposals and what is found within them for 2 ** -level of the evidence."""
        found = dict(self._proposed)
        if self.model.still:
            return found
        for deep in range(1, level + 1):
            for bounds in pairwise([0, *sorted(found), len(self.model)]):
                found.update(self._within(bounds, deep))
        return found

    def _within(self, bounds: tuple[int, int], level: int) -> dict[int, float]:
        """Return the finer cuts of one segment; a height says for what evidence it is found."""
        if bounds[1] - bounds[0] < 2.0 * self.shortest * self.model.fps:
            return {}
        cuts = search(self.model, self.shortest, 0.5**level, bounds)
        cuts = settled(self.model, cuts, self.shortest, bounds)
        if not cuts:
            return {}
        around = np.array([bounds[0], *cuts, bounds[1]])
        evidence = self.model.evidence(around[:-2], around[1:-1], around[2:])
        worth = np.log(np.clip(evidence, 0.5**level, 0.5 ** (level - 1)))
        return dict(zip(cuts, worth.tolist(), strict=True))


def _joined(stretches: Sequence[Stretch]) -> Array:
    """Join neighbours, the most alike first, and return at what unlikeness each cut goes."""
    between = _kept(stretches, 0)
    groups = [[place] for place in range(len(stretches))]
    apart = [between(place, place + 1) for place in range(len(stretches) - 1)]
    heights, highest = np.zeros(len(apart)), -np.inf
    while apart:
        place = int(np.argmin(apart))
        highest = max(highest, apart.pop(place))
        heights[groups[place + 1][0] - 1] = highest
        groups[place : place + 2] = [groups[place] + groups[place + 1]]
        for beside in (place - 1, place):
            if 0 <= beside < len(apart):
                apart[beside] = _linked(stretches, groups[beside], groups[beside + 1], between)
    return heights


def _linked(
    stretches: Sequence[Stretch], one: list[int], other: list[int], between: Between
) -> float:
    """Return the mean unlikeness of groups, of which the longest stretches stand for all."""
    longest = [
        sorted(group, key=lambda place: -stretches[place].frames)[: LIKENESS.members]
        for group in (one, other)
    ]
    return float(np.mean([between(a, b) for a in longest[0] for b in longest[1]]))


def _kept(stretches: Sequence[Stretch], which: int) -> Between:
    """Return the unlikeness by places, each found out once."""
    known: dict[tuple[int, int], float] = {}

    def between(one: int, other: int) -> float:
        pair = min(one, other), max(one, other)
        if pair not in known:
            known[pair] = unlikeness(stretches[pair[0]], stretches[pair[1]])[which]
        return known[pair]

    return between


def labelled(stretches: Sequence[Stretch]) -> list[int]:
    """Label stretches so that a behaviour that comes back bears the same label.

    Parameters
    ----------
    stretches : sequence of Stretch

    Returns
    -------
    list of int
        Numbered by first appearance.
    """
    count = len(stretches)
    between, apart = _kept(stretches, 1), np.full((count, count), np.inf)
    for place in range(count):
        for earlier in range(place):
            apart[place, earlier] = apart[earlier, place] = between(place, earlier)
    owner, sizes = np.arange(count), np.ones(count)
    while count > 1 and apart.min() <= LIKENESS.label:
        kept, gone = sorted(np.unravel_index(np.argmin(apart), apart.shape))
        mean = (sizes[kept] * apart[kept] + sizes[gone] * apart[gone]) / (sizes[kept] + sizes[gone])
        apart[kept], apart[:, kept] = mean, mean
        apart[gone], apart[:, gone], apart[kept, kept] = np.inf, np.inf, np.inf
        sizes[kept] += sizes[gone]
        owner[owner == gone] = kept
    number: dict[int, int] = {}
    return [number.setdefault(int(label), len(number)) for label in owner]
