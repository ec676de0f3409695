"""All cuts of a take as one tree: a finer answer holds every cut of a coarser one.

The piecewise Gaussian proposes cuts. Neighbours that predict each other are joined, the most
alike first (average linkage), and the unlikeness at which a cut goes is its height. Finer cuts
are sought within what the proposals leave whole, each time for half the evidence. A height is
the logarithm of the odds that the cut is one that people make, whatever section is asked for.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from roundelay.segmentation.gaussian import search, settled
from roundelay.segmentation.likeness import Stretch, unlikeness
from roundelay.segmentation.method import Channels
from roundelay.segmentation.model import GaussianModel
from roundelay.segmentation.thresholds import LIKENESS, TREE

__all__ = ["CutTree"]

Array = NDArray[np.float64]


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

    @classmethod
    def of(cls, channels: Channels, *, shortest: float, resolution: float | None = None) -> CutTree:
        """Take what is to be cut, at a resolution of one's own or that of the channels."""
        model = channels.model(resolution)
        repeating = []
        for spans in channels.repeating:
            frames = np.zeros(len(model), bool)
            for start, stop in spans:
                frames[start // model.step : -(-stop // model.step)] = True
            repeating.append(frames)
        return cls(model, shortest, tuple(repeating))

    def above(self, height: float) -> dict[int, float]:
        """Return the cuts, thinned frames that grow, at least so high, with their heights."""
        levels = int(np.ceil(max(0.0, -height) / (TREE.steep * np.log(2.0))))
        found = self._down_to(min(levels, TREE.levels))
        return {cut: found[cut] for cut in sorted(found) if found[cut] >= height}

    def highest(self, count: int) -> dict[int, float]:
        """Return so many of the highest cuts, or all there are, with their heights."""
        found = self._proposed
        for level in range(TREE.levels + 1):
            found = self._down_to(level)
            # What lies deeper is lower than all cuts of this level, but not than all proposals.
            lowest = -level * TREE.steep * np.log(2.0)
            if sum(height >= lowest for height in found.values()) >= count:
                break
        kept = sorted(found, key=lambda cut: -found[cut])[:count]
        return {cut: found[cut] for cut in sorted(kept)}

    def described(self, cuts: Sequence[int]) -> tuple[list[int], list[bool]]:
        """Label what cuts leave, so that a behaviour that comes back bears the same label.

        Parameters
        ----------
        cuts : sequence of int
            First thinned frame of every segment but the first.

        Returns
        -------
        labels : list of int
            Numbered by first appearance.
        held : list of bool
            Whether nothing moves in it that matters.
        """
        if self.model.still:
            return [0] * (len(cuts) + 1), [True] * (len(cuts) + 1)
        stretches = self._stretches(cuts)
        return _labelled(stretches), [each.still for each in stretches]

    def _stretches(self, cuts: Sequence[int]) -> list[Stretch]:
        """Return the stretches that cuts leave, each of a frame at least, and what fills them."""
        model, found = self.model, []
        for start, stop in itertools.pairwise([0, *cuts, len(model)]):
            frames = slice(start, max(stop, start + 1))
            stretch = Stretch.of(model.points[frames], model.fps, model.resolution)
            filled = [rows[frames].mean() >= LIKENESS.filled for rows in self.repeating]
            found.append(replace(stretch, shows=frozenset(np.flatnonzero(filled).tolist())))
        return found

    @cached_property
    def _proposed(self) -> dict[int, float]:
        """The proposals by their heights."""
        model = self.model
        if model.still or len(model) < 2.0 * self.shortest * model.fps:
            return {}
        cuts = settled(model, search(model, self.shortest, TREE.proposed), self.shortest)
        joined = _joined(self._stretches(cuts))
        return {
            cut: (joined[place] - LIKENESS.cut) / LIKENESS.scale for place, cut in enumerate(cuts)
        }

    def _down_to(self, level: int) -> dict[int, float]:
        """Return the proposals and what is found within them for 2 ** -level of the evidence."""
        found = dict(self._proposed)
        if self.model.still:
            return found
        for deep in range(1, level + 1):
            for bounds in itertools.pairwise([0, *sorted(found), len(self.model)]):
                found.update(self._within(bounds, deep))
        return found

    def _within(self, bounds: tuple[int, int], level: int) -> dict[int, float]:
        """Return the finer cuts of one segment; their odds fall with their evidence."""
        if bounds[1] - bounds[0] < 2.0 * self.shortest * self.model.fps:
            return {}
        cuts = search(self.model, self.shortest, 0.5**level, bounds)
        cuts = settled(self.model, cuts, self.shortest, bounds)
        if not cuts:
            return {}
        around = np.array([bounds[0], *cuts, bounds[1]])
        evidence = self.model.evidence(around[:-2], around[1:-1], around[2:])
        worth = TREE.steep * np.log(np.clip(evidence, 0.5**level, 0.5 ** (level - 1)))
        return dict(zip(cuts, worth.tolist(), strict=True))


def _joined(stretches: Sequence[Stretch]) -> Array:
    """Join neighbours, the most alike first, and return at what unlikeness each cut goes."""
    known: dict[tuple[int, int], float] = {}

    def between(one: int, other: int) -> float:
        if (one, other) not in known:
            known[one, other] = float(unlikeness(stretches[one], [stretches[other]])[0][0])
        return known[one, other]

    groups = [[place] for place in range(len(stretches))]
    apart = [between(place, place + 1) for place in range(len(stretches) - 1)]
    heights, highest = np.zeros(len(apart)), -np.inf
    while apart:
        place = int(np.argmin(apart))
        highest = max(highest, apart.pop(place))
        heights[groups[place + 1][0] - 1] = highest
        groups[place : place + 2] = [_longest(groups[place] + groups[place + 1], stretches)]
        for beside in (place - 1, place):
            if 0 <= beside < len(apart):
                pairs = itertools.product(groups[beside], groups[beside + 1])
                apart[beside] = float(np.mean([between(*pair) for pair in pairs]))
    return heights


def _longest(group: list[int], stretches: Sequence[Stretch]) -> list[int]:
    """Return the first of a group and the longest, which stand for all of it."""
    by_length = sorted(group[1:], key=lambda place: -stretches[place].frames)
    return [group[0], *by_length[: LIKENESS.members - 1]]


def _unlike_before(stretches: Sequence[Stretch], place: int) -> Array:
    """Return how unlike (place,) a stretch is to those before, exactly where they may be alike."""
    before = list(stretches[:place])
    row = unlikeness(stretches[place].sketch, [each.sketch for each in before])[1]
    near = np.flatnonzero(row <= LIKENESS.label + LIKENESS.sketched)
    if len(near):
        row[near] = unlikeness(stretches[place], [before[each] for each in near])[1]
    return row


def _labelled(stretches: Sequence[Stretch]) -> list[int]:
    """Join the most alike, wherever they are (average linkage), and number by first appearance."""
    count = len(stretches)
    apart = np.full((count, count), np.inf)
    for place in range(1, count):
        row = _unlike_before(stretches, place)
        apart[place, :place], apart[:place, place] = row, row
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
