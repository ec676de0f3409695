"""Stretches in which a period predicts the next one, limb group by limb group.

For a stretch from s to s + 2 tau, how well its first half predicts the second is

    S(s, tau) = 1 - (D + 2 f^2) / (2 (V + f^2)),

with D the mean squared distance of samples tau apart, V the variance over both halves, and f the
least amplitude that counts. A path through the lags follows the tempo; a stretch without a path
repeats nothing. Cost grows linearly with the take: long lags are looked at on a coarser clock.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from roundelay.timeline.limbs import Body
from roundelay.timeline.proposals.proposal import Candidate
from roundelay.timeline.thresholds import PREDICTABILITY

__all__ = ["Recurrence"]

Array = NDArray[np.float64]
Paths = NDArray[np.intp]


@dataclass(frozen=True)
class _Rated:
    """A candidate, and the mean of S over it."""

    candidate: Candidate
    predictability: float


class Recurrence:
    """Propose stretches in which a period predicts the next, the clearest first."""

    name = "recurrence"

    def propose(self, body: Body) -> list[Candidate]:
        """Propose for every group of limbs."""
        groups = body.groups()
        lags = _lags(len(body), body.rate)
        if not len(lags) or not groups:
            return []
        values = _predictability(body, groups, lags)
        paths = _paths(values, lags)
        found = []
        for name, path, own in zip(groups, paths, values, strict=True):
            found += [
                rated
                for start, stop in _runs(path)
                for rated in _steady(name, path, own, start, stop, lags, body)
            ]
        return _distinct(found)


def _lags(samples: int, rate: float) -> Array:
    """Return the lags in seconds, evenly spaced in their logarithm."""
    longest = min(PREDICTABILITY.longest, PREDICTABILITY.fills * samples / rate)
    if longest <= PREDICTABILITY.shortest:
        return np.zeros(0)
    count = int(np.log2(longest / PREDICTABILITY.shortest) * PREDICTABILITY.octave) + 1
    return np.asarray(PREDICTABILITY.shortest * 2.0 ** (np.arange(count) / PREDICTABILITY.octave))


@dataclass(frozen=True, eq=False)
class _Clock:
    """Signals on a coarser clock, with running sums."""

    values: NDArray[np.float32]
    sums: Array
    squares: Array
    seconds: float

    @classmethod
    def of(cls, body: Body, begins: Paths, times: int) -> _Clock:
        """Average so many samples into one."""
        count = len(body) // times
        x = body.signals[: count * times].reshape(count, times, -1).mean(axis=1)
        return cls(
            x.astype(np.float32),
            _running(x),
            _running(np.add.reduceat(x * x, begins, axis=1)),
            times / body.rate,
        )


def _running(values: Array) -> Array:
    return np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values, axis=0, dtype=float)])


def _predictability(
    body: Body, groups: dict[str, tuple[int, ...]], lags: Array
) -> NDArray[np.float32]:
    """Return S (groups, hops, lags): the best over the windows of two periods that hold a hop."""
    begins = np.array([limb.columns[0] for limb in body.limbs])
    member = np.array(
        [[float(place in inside) for place in range(len(body.limbs))] for inside in groups.values()]
    )
    hops = (
        np.arange(max(1, int(np.ceil(len(body) / body.rate / PREDICTABILITY.hop))))
        * PREDICTABILITY.hop
    )
    result = np.full((len(groups), len(hops), len(lags)), -1.0, np.float32)
    clocks: dict[int, _Clock] = {}
    for number, lag in enumerate(lags):
        times = 1 << (max(1, int(lag * body.rate / PREDICTABILITY.samples)).bit_length() - 1)
        if times not in clocks:
            clocks[times] = _Clock.of(body, begins, times)
        clock = clocks[times]
        windows = _windows(clock, begins, lag / clock.seconds)
        if windows is None:
            continue
        apart, variance, length = windows
        own = variance @ member.T
        values = 1.0 - (apart @ member.T + 2 * PREDICTABILITY.least**2) / (
            2.0 * (own + PREDICTABILITY.least**2)
        )
        best = _running_max(values, length)
        at = np.minimum((hops / clock.seconds).astype(np.intp), len(best) - 1)
        result[:, :, number] = best[at].T
    return result


def _windows(clock: _Clock, begins: Paths, lag: float) -> tuple[Array, Array, int] | None:
    """Return D and V (windows, limbs) of every window of two periods, and its length.

    A take of less than two periods is one window, in which less than a period is compared.
    """
    x, whole, part = clock.values, int(lag), np.float32(lag % 1.0)
    count = len(x)
    width = min(round(lag), count - whole - 1)
    if width < max(3, int(np.ceil(PREDICTABILITY.again * lag))):
        return None
    moved = x[whole : count - 1] * (1 - part) + x[whole + 1 :] * part
    difference = x[: count - whole - 1] - moved
    sums = _running(np.add.reduceat(difference * difference, begins, axis=1))
    apart = (sums[width:] - sums[:-width]) / width
    mean = _both(clock.sums, len(apart), whole, width)
    squares = _both(clock.squares, len(apart), whole, width)
    variance = squares - np.add.reduceat(mean * mean, begins, axis=1)
    return apart, np.maximum(variance, 0.0), min(width + whole + 1, count)


def _both(sums: Array, count: int, whole: int, width: int) -> Array:
    """Return the means over both halves of so many windows, from running sums."""
    later = sums[whole + 1 :]
    early = sums[width : width + count] - sums[:count]
    late = later[width : width + count] - later[:count]
    return np.asarray((early + late) / (2.0 * width))


def _running_max(values: Array, width: int) -> Array:
    """Return the largest (n + width - 1, g) of the values (n, g) whose windows hold a sample."""
    result = np.full((len(values) + width - 1, values.shape[1]), -np.inf)
    result[: len(values)] = values
    reached = 1
    while reached < width:
        step = min(reached, width - reached)
        np.maximum(result[step:], result[:-step].copy(), out=result[step:])
        reached += step
    return result


def _paths(values: NDArray[np.float32], lags: Array) -> Paths:
    """Return the lag (groups, hops) that explains each hop best, -1 for none: Viterbi's path."""
    groups, hops, count = values.shape
    least = PREDICTABILITY.explained + PREDICTABILITY.longer * np.log2(lags / lags[0])
    periods = np.sqrt(PREDICTABILITY.hop / lags)
    back = np.zeros((hops, groups, count + 1), np.int16)
    none, best, rows = np.zeros(groups), (values[:, 0] - least) * periods, np.arange(groups)
    for hop in range(1, hops):
        top = best.argmax(axis=1)
        highest = best[rows, top]
        stay, source = _kept_or_near(best)
        other = highest - PREDICTABILITY.other * PREDICTABILITY.switch
        enter = np.maximum(none - PREDICTABILITY.switch, other)
        entered = np.where(none - PREDICTABILITY.switch >= other, -1, top)
        fresh = enter[:, None] > stay
        back[hop, :, 1:] = np.where(fresh, entered[:, None], source)
        leave = highest - PREDICTABILITY.switch
        back[hop, :, 0] = np.where(leave > none, top, -1)
        none = np.maximum(none, leave)
        best = np.where(fresh, enter[:, None], stay) + (values[:, hop] - least) * periods
    paths = np.zeros((groups, hops), np.intp)
    top = best.argmax(axis=1)
    paths[:, -1] = np.where(best[rows, top] > none, top, -1)
    for hop in range(hops - 1, 0, -1):
        paths[:, hop - 1] = back[hop, rows, paths[:, hop] + 1]
    return paths


def _kept_or_near(best: Array) -> tuple[Array, Paths]:
    """Return the best (groups, lags) of the same lag and those near it, and which lag that was."""
    reach, count = PREDICTABILITY.reach, best.shape[1]
    padded = np.pad(best, ((0, 0), (reach, reach)), constant_values=-np.inf)
    around = np.stack(
        [
            padded[:, reach + shift : reach + shift + count] - PREDICTABILITY.wobble * abs(shift)
            for shift in range(-reach, reach + 1)
        ]
    )
    choice = around.argmax(axis=0)
    stay = np.take_along_axis(around, choice[None], axis=0)[0]
    return stay, np.arange(count) + choice - reach


def _runs(path: Paths) -> list[tuple[int, int]]:
    """List the ranges of hops in which a path goes on without a jump of the lag."""
    jumps = np.abs(np.diff(path)) > PREDICTABILITY.reach
    ends = np.flatnonzero(jumps | (path[1:] < 0) | (path[:-1] < 0)) + 1
    bounds = [0, *ends.tolist(), len(path)]
    ranges = pairwise(bounds)
    return [(start, stop) for start, stop in ranges if path[start] >= 0]


def _steady(
    group: str,
    path: Paths,
    own: NDArray[np.float32],
    start: int,
    stop: int,
    lags: Array,
    body: Body,
) -> list[_Rated]:
    """Cut a run of hops into candidates of steady lag."""
    found = []
    for first, last in _pieces(path[start:stop]):
        a, b = start + first, start + last
        lag = float(lags[round(float(np.median(path[a:b])))])
        begin = int(a * PREDICTABILITY.hop * body.rate)
        end = min(len(body), int(np.ceil(b * PREDICTABILITY.hop * body.rate)))
        if end - begin >= PREDICTABILITY.periods * lag * body.rate:
            clear = float(own[np.arange(a, b), path[a:b]].mean())
            found.append(_Rated(Candidate(group, begin, end, lag * body.rate), clear))
    return found


def _pieces(lags: Paths) -> list[tuple[int, int]]:
    """Cut a path of lags into pieces within some steps of their median."""
    if np.abs(lags - np.median(lags)).max() <= PREDICTABILITY.steady or len(lags) < 4:
        return [(0, len(lags))]
    cuts = range(2, len(lags) - 1, max(1, len(lags) // 40))
    if not cuts:
        return [(0, len(lags))]
    cut = min(cuts, key=lambda c: _deviation(lags[:c]) + _deviation(lags[c:]))
    return _pieces(lags[:cut]) + [(a + cut, b + cut) for a, b in _pieces(lags[cut:])]


def _deviation(lags: Paths) -> float:
    return float(np.abs(lags - np.median(lags)).sum())


def _distinct(found: list[_Rated]) -> list[Candidate]:
    """Keep the clearest of those that are nearly the same."""
    kept: list[Candidate] = []
    for rated in sorted(found, key=_clearness, reverse=True):
        if not any(_alike(rated.candidate, other) for other in kept):
            kept.append(rated.candidate)
    return kept


def _clearness(rated: _Rated) -> float:
    length = rated.candidate.stop - rated.candidate.start
    return rated.predictability + PREDICTABILITY.clearer * float(np.log(length))


def _alike(first: Candidate, second: Candidate) -> bool:
    shared = min(first.stop, second.stop) - max(first.start, second.start)
    covered = max(first.stop, second.stop) - min(first.start, second.start)
    near = abs(np.log(first.period / second.period)) < PREDICTABILITY.near
    return bool(near and shared > PREDICTABILITY.same * covered)
