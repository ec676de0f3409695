"""The best account of every frame of every limb: which candidate explains it.

First the body as a whole, by dynamic programming over time: a candidate gains, sample by sample,
the evidence of the repetition it is in. Then limbs that this leaves unexplained, the best first.
T/2, T and 2T need no rule: 2T loses a repetition's numbers, T/2 loses what is predicted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import ROUNDING, SIX_DIGITS, SMALLEST, TINY
from roundelay.base.spans import Span, Spans
from roundelay.timeline.limbs import Body
from roundelay.timeline.prediction import Predicted, within
from roundelay.timeline.thresholds import ACCOUNT, MERGING

__all__ = ["account"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def account(body: Body, found: Sequence[Predicted]) -> list[Predicted]:
    """Choose the candidates that explain the take, without overlap limb by limb.

    Parameters
    ----------
    body : Body
    found : sequence of Predicted

    Returns
    -------
    list of Predicted
        Measured again within the samples that each explains.
    """
    usable = [one for one in found if _usable(one)]
    chosen = _of_body(body, usable)
    taken = np.zeros((len(body.limbs), len(body)), bool)
    for one in chosen:
        _take(taken, one)
    return chosen + _of_limbs(body, usable, taken)


def _usable(one: Predicted) -> bool:
    return one.repetitions >= ACCOUNT.fewest and one.nats > 0.0 and bool(one.claimed.any())


def _take(taken: Mask, one: Predicted) -> None:
    for start, stop in one.runs:
        taken[one.claimed, int(start) : int(np.ceil(stop))] = True


def _of_body(body: Body, found: Sequence[Predicted]) -> list[Predicted]:
    """Account for the body as a whole."""
    if not found:
        return []
    path = _best_path([_gain(body, one) for one in found], len(body))
    kept = []
    for one, own in zip(found, path, strict=True):
        trimmed = _trimmed(body, one, [(float(a), float(b)) for a, b in own])
        if trimmed is not None:
            kept.append(trimmed)
    return kept


@dataclass(frozen=True, eq=False)
class _Gain:
    """The evidence a sample, in nats, of the repetition that each sample is in.

    That of the samples from `start` on; around them it loses one nat a sample.
    """

    start: int
    values: Array

    @property
    def stop(self) -> int:
        return self.start + len(self.values)


def _gain(body: Body, one: Predicted) -> _Gain:
    power = one.amplitudes**2 / max(float(np.sum(one.amplitudes**2)), SMALLEST)
    clear = np.minimum(1.0 / np.maximum(1.0 - one.limb_each, TINY), ACCOUNT.clearest)
    bits = power @ np.where(one.limb_each > ACCOUNT.counts, np.log(clear), 0.0)
    # One of the repetitions seen pays for the template.
    density = one.numbers / max(one.seen, ROUNDING) / one.period
    parts = []
    for value, times in zip(0.5 * density * bits, one.times, strict=True):
        known = times[np.isfinite(times)]
        if len(known) < 2 or value <= 0.0:
            continue
        half = 0.5 * (known[-1] - known[0]) / (len(known) - 1)
        last = min(len(body), int(np.ceil(known[-1] + half)))
        parts.append((max(0, int(known[0] - half)), last, value))
    start = min((first for first, _, _ in parts), default=0)
    values = np.full(max((last for _, last, _ in parts), default=0) - start, -1.0)
    for first, last, value in parts:
        own = slice(first - start, last - start)
        values[own] = np.maximum(values[own], value)
    return _Gain(start, values)


def _best_path(gains: Sequence[_Gain], samples: int) -> list[list[Span]]:
    """Return the ranges that each candidate explains: Viterbi's path; leaving is free.

    Only those that have begun and not ended are compared: no way is better by one that gains
    nothing yet, or no longer.
    """
    ends = {end for gain in gains for end in (gain.start, gain.stop) if 0 < end < samples}
    waiting = sorted(range(len(gains)), key=lambda place: gains[place].start, reverse=True)
    ways, going = _Ways(len(gains)), list[int]()
    for start, stop in pairwise([0, *sorted(ends), samples]):
        while waiting and gains[waiting[-1]].start <= start:
            going.append(waiting.pop())
        going = sorted(place for place in going if gains[place].stop > start)
        own = [gains[place].values[start - gains[place].start :][: stop - start] for place in going]
        ways.go_on(going, np.column_stack([*own, np.full(stop - start, SIX_DIGITS)]))
    found: list[list[Span]] = [[] for _ in range(len(gains) + 1)]
    path = ways.best()
    for start, stop in pairwise([0, *(np.flatnonzero(np.diff(path)) + 1).tolist(), samples]):
        found[path[start]].append((start, stop))
    return found[:-1]


class _Ways:
    """The best ways to each of the candidates that go on, and to nothing, the last."""

    def __init__(self, nothing: int) -> None:
        self._names = np.array([nothing])
        self._total = np.zeros(0)
        self._back: list[tuple[NDArray[np.intp], NDArray[np.int32]]] = []

    def go_on(self, going: list[int], gain: Array) -> None:
        """Go on by some samples (n, columns)."""
        names = np.array([*going, self._names[-1]])
        back = np.empty(gain.shape, np.int32)
        for t, own in enumerate(gain):
            if t:
                best, back[t] = self._step()
            else:
                best, back[t] = self._changed(names)
            self._total = best + own
        self._back.append((names, back))

    def _step(self) -> tuple[Array, NDArray[np.intp]]:
        """Return the best until here, and from where it came."""
        total, names = self._total, self._names
        top = int(total.argmax())
        change = total[top] - ACCOUNT.change
        back = np.where(total >= change, names, names[top])
        best = np.maximum(total, change)
        if total[top] > best[-1]:
            best[-1], back[-1] = total[top], names[top]
        return best, back

    def _changed(self, names: NDArray[np.intp]) -> tuple[Array, NDArray[np.intp]]:
        """Return the same with columns of other names; those that are new are entered."""
        before, total = self._names, self._total
        if not len(total):
            best = np.full(len(names), -ACCOUNT.change)
            best[-1] = -SIX_DIGITS
            self._names = names
            return best, names
        best, back = self._step()
        place = np.searchsorted(before, names)
        known, top = before[place] == names, int(total.argmax())
        self._names = names
        return (
            np.where(known, best[place], total[top] - ACCOUNT.change),
            np.where(known, back[place], before[top]),
        )

    def best(self) -> NDArray[np.intp]:
        """Return the name (n,) of what explains each sample."""
        name, path = int(self._names[self._total.argmax()]), list[int]()
        for names, back in reversed(self._back):
            column = {int(own): place for place, own in enumerate(names)}
            for own in back[::-1].tolist():
                path.append(name)
                name = own[column[name]]
        return np.array(path[::-1])


def _trimmed(body: Body, one: Predicted, runs: list[tuple[float, float]]) -> Predicted | None:
    """Return a candidate within some of its samples; None if too little of it is left."""
    if one.candidate.turns is not None:
        # A gesture with something else around it is shown as a whole, or not.
        runs = [own for own in one.runs if _shared(own, runs) >= ACCOUNT.run * (own[1] - own[0])]
    runs = [(a, b) for a, b in runs if b - a >= ACCOUNT.run * one.period]
    left = sum(b - a for a, b in runs)
    if left < ACCOUNT.fewest * one.period:
        return None
    if left >= ACCOUNT.whole * sum(b - a for a, b in one.runs):
        return replace(one, runs=tuple(runs))
    again = within(body, one, runs)
    return again if again is not None and _usable(again) else None


def _shared(own: tuple[float, float], runs: list[tuple[float, float]]) -> float:
    return sum(max(0.0, min(own[1], b) - max(own[0], a)) for a, b in runs)


def _of_limbs(body: Body, found: Sequence[Predicted], taken: Mask) -> list[Predicted]:
    """Account for limbs that are left, by the candidate with most new evidence, again and again."""
    pool = [new for new in (_new(body, one, taken) for one in found) if new.runs]
    kept = list[Predicted]()
    while pool:
        best = pool.pop(max(range(len(pool)), key=lambda place: pool[place].evidence))
        trimmed = _trimmed(body, best.own, list(best.runs))
        if trimmed is None:
            continue
        kept.append(trimmed)
        _take(taken, trimmed)
        again = (_new(body, new.own, taken) if new.meets(trimmed) else new for new in pool)
        pool = [new for new in again if new.runs]
    return kept


@dataclass(frozen=True, eq=False)
class _New:
    """A candidate with the limbs that nothing explains yet, and where they are free."""

    own: Predicted
    span: Span
    runs: tuple[tuple[float, float], ...] = ()

    @cached_property
    def evidence(self) -> float:
        """Of the candidate, in some of its samples."""
        return _evidence(self.own, self.runs)

    def meets(self, other: Predicted) -> bool:
        """Tell whether another may explain what is free here."""
        start, stop = self.span
        shared = any(a < stop and start < np.ceil(b) for a, b in other.runs)
        return shared and bool((self.own.claimed & other.claimed).any())


def _evidence(one: Predicted, runs: Sequence[tuple[float, float]]) -> float:
    """Return a candidate's evidence in some of its samples."""
    left, whole = sum(b - a for a, b in runs), sum(b - a for a, b in one.runs)
    return one.nats * one.share * left / max(whole, ROUNDING)


def _new(body: Body, one: Predicted, taken: Mask) -> _New:
    """Look for the limbs of a candidate that nothing explains yet, and where they are free."""
    spans = Spans.union(sorted((int(a), min(len(body), int(np.ceil(b)))) for a, b in one.runs))
    start, stop = whole = spans[0][0], spans[-1][1]
    inside, here = spans.moved(-start).frames, taken[:, start:stop]
    claimed = one.claimed & (here[:, inside].mean(axis=1) < 1.0 - ACCOUNT.fresh)
    gesture, power = one.candidate.turns is not None, one.amplitudes**2
    # A gesture is one of the limbs that make it: what others leave of it is none.
    left = not gesture or power[claimed].sum() >= MERGING.limbs * power[one.claimed].sum()
    one = replace(one, claimed=claimed)
    if not claimed.any() or not left:
        return _New(one, whole)
    free = np.zeros(stop - start, bool)
    free[inside] = True
    free &= ~here[claimed].any(axis=0)
    runs = [(float(a), float(b)) for a, b in Spans.of_mask(free).moved(start)]
    runs = [(a, b) for a, b in runs if b - a >= ACCOUNT.run * one.period]
    enough = sum(b - a for a, b in runs) >= ACCOUNT.fewest * one.period
    return _New(one, whole, tuple(runs) if enough else ())
