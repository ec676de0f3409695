"""Stretches in which a period predicts the next one, limb group by limb group.

For a stretch from s to s + 2 tau, how well its first half predicts the second is

    S(s, tau) = 1 - (D + 2 f^2) / (2 (V + f^2)),

with D the mean squared distance of samples tau apart, V the variance over both halves, and f the
least amplitude that counts. A path through the lags follows the tempo; a stretch without a path
repeats nothing. Cost grows linearly with the take: long lags are looked at on a coarser clock.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from roundelay.timeline.limbs import Body
from roundelay.timeline.proposals.paths import best_paths
from roundelay.timeline.proposals.proposal import Candidate
from roundelay.timeline.thresholds import PREDICTABILITY

__all__ = ["Recurrence"]

Array = NDArray[np.float64]
Paths = NDArray[np.intp]

# At most so many numbers are held at once.
_BLOCK = 8_000_000


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
        paths, values = best_paths(_predictability(body, groups, lags), lags)
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
    """Signals (d, n) on a coarser clock, with running sums."""

    values: NDArray[np.float32]
    sums: Array
    squares: Array
    seconds: float
    begins: Paths

    @classmethod
    def of(cls, body: Body, times: int) -> _Clock:
        """Average so many samples into one."""
        begins = np.array([limb.columns[0] for limb in body.limbs])
        count = len(body) // times
        x = body.signals[: count * times].reshape(count, times, -1).mean(axis=1)
        x = np.ascontiguousarray(x.T)
        return cls(
            x.astype(np.float32),
            _running(x),
            _running(_limb_sums(x * x, begins)),
            times / body.rate,
            begins,
        )


def _running(values: NDArray[np.floating]) -> Array:
    sums = np.zeros((len(values), values.shape[1] + 1))
    np.cumsum(values, axis=1, dtype=float, out=sums[:, 1:])
    return sums


def _limb_sums(values: NDArray[np.floating], begins: Paths) -> NDArray[np.floating]:
    """Return the sums (limbs, n) over the columns of each limb, of values (d, n)."""
    found = np.empty((len(begins), values.shape[1]), values.dtype)
    for own, (start, stop) in zip(found, pairwise([*begins, len(values)]), strict=True):
        own[:] = values[start]
        if stop > start + 1:
            own += values[start + 1 : stop].sum(axis=0)
    return found


def _predictability(
    body: Body, groups: dict[str, tuple[int, ...]], lags: Array
) -> Iterator[NDArray[np.float32]]:
    """Yield S (hops, groups, lags): the best over the windows of two periods that hold a hop.

    In blocks of hops, so that memory does not grow with the take.
    """
    member = np.array(
        [[float(place in inside) for place in range(len(body.limbs))] for inside in groups.values()]
    )
    hops = (
        np.arange(max(1, int(np.ceil(len(body) / body.rate / PREDICTABILITY.hop))), dtype=float)
        * PREDICTABILITY.hop
    )
    clocks = {times: _Clock.of(body, times) for times in {_times(lag, body.rate) for lag in lags}}
    size = max(1, _BLOCK // (len(groups) * len(lags)))
    for start in range(0, len(hops), size):
        own = hops[start : start + size]
        result = np.full((len(lags), len(groups), len(own)), -1.0, np.float32)
        for lag, values in zip(lags, result, strict=True):
            clock = clocks[_times(lag, body.rate)]
            best = _best_of_windows(clock, member, lag / clock.seconds, own / clock.seconds)
            if best is not None:
                values[:] = best
        yield np.ascontiguousarray(result.T)


def _times(lag: float, rate: float) -> int:
    """Return how many samples of the body are one of the clock on which a lag is looked at."""
    return 1 << (max(1, int(lag * rate / PREDICTABILITY.samples)).bit_length() - 1)


def _best_of_windows(clock: _Clock, member: Array, lag: float, hops: Array) -> Array | None:
    """Return S (groups, hops) of a lag, both in samples of the clock; None if it is too long.

    A take of less than two periods is one window, in which less than a period is compared.
    """
    count, whole = clock.values.shape[1], int(lag)
    width = min(round(lag), count - whole - 1)
    if width < max(3, int(np.ceil(PREDICTABILITY.again * lag))):
        return None
    length, windows = min(width + whole + 1, count), count - whole - width
    at = np.minimum(hops.astype(np.intp), windows + length - 2)
    first, last = max(0, int(at[0]) - length + 1), min(windows, int(at[-1]) + 1)
    apart, variance = _windows(clock, lag, width, first, last)
    values = member @ apart + 2 * PREDICTABILITY.least**2
    values /= 2.0 * (member @ variance + PREDICTABILITY.least**2)
    return _running_max(1.0 - values, length)[:, at - first]


def _windows(clock: _Clock, lag: float, width: int, first: int, last: int) -> tuple[Array, Array]:
    """Return D and V (limbs, windows) of windows of two periods, by their first samples."""
    x, whole, part = clock.values, int(lag), np.float32(lag % 1.0)
    count, end = last - first, last + width - 1
    moved = x[:, whole + first : whole + end + 1]
    difference = x[:, first:end] - (moved[:, :-1] * (1 - part) + moved[:, 1:] * part)
    difference *= difference
    sums = _running(_limb_sums(difference, clock.begins))
    apart = (sums[:, width:] - sums[:, :-width]) / width
    mean = _both(clock.sums[:, first:], count, whole, width)
    mean *= mean
    variance = _both(clock.squares[:, first:], count, whole, width)
    variance -= _limb_sums(mean, clock.begins)
    return apart, np.maximum(variance, 0.0, out=variance)


def _both(sums: Array, count: int, whole: int, width: int) -> Array:
    """Return the means over both halves of so many windows, from running sums."""
    later = sums[:, whole + 1 :]
    both = sums[:, width : width + count] - sums[:, :count]
    both += later[:, width : width + count] - later[:, :count]
    both /= 2.0 * width
    return both


def _running_max(values: Array, width: int) -> Array:
    """Return the largest (g, n + width - 1) of the values (g, n) whose windows hold a sample."""
    result = np.full((len(values), values.shape[1] + width - 1), -np.inf)
    result[:, : values.shape[1]] = values
    reached = 1
    while reached < width:
        step = min(reached, width - reached)
        np.maximum(result[:, step:], result[:, :-step].copy(), out=result[:, step:])
        reached += step
    return result


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
            clear = float(own[a:b].mean())
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
    """Return how far lags lie from their median, together: the upper half less the lower."""
    ordered, half = np.sort(lags), len(lags) // 2
    return float(ordered[len(lags) - half :].sum() - ordered[:half].sum())


def _distinct(found: list[_Rated]) -> list[Candidate]:
    """Keep the clearest of those that are nearly the same."""
    ranked = [rated.candidate for rated in sorted(found, key=_clearness, reverse=True)]
    bounds = np.array([(one.start, one.stop, one.period) for one in ranked]).reshape(-1, 3)
    kept = np.zeros(len(ranked), bool)
    for place, own in enumerate(bounds):
        kept[place] = not _alike(own, bounds[:place][kept[:place]]).any()
    return [one for one, own in zip(ranked, kept, strict=True) if own]


def _clearness(rated: _Rated) -> float:
    length = rated.candidate.stop - rated.candidate.start
    return rated.predictability + PREDICTABILITY.clearer * float(np.log(length))


def _alike(own: Array, others: Array) -> NDArray[np.bool_]:
    """Tell which others (n, 3) are nearly one of the same start, stop and period (3,)."""
    shared = np.minimum(own[1], others[:, 1]) - np.maximum(own[0], others[:, 0])
    covered = np.maximum(own[1], others[:, 1]) - np.minimum(own[0], others[:, 0])
    near = np.abs(np.log(own[2] / others[:, 2])) < PREDICTABILITY.near
    return np.asarray(near & (shared > PREDICTABILITY.same * covered))
