"""Tempo over time, and the pieces in which it is steady."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from roundelay.base.spans import Spans
from roundelay.timeline.agreement import best_lag
from roundelay.timeline.limbs import Body
from roundelay.timeline.prediction import Predicted, predict_each, within
from roundelay.timeline.proposals.proposal import Candidate
from roundelay.timeline.thresholds import ACCOUNT, ALIGNMENT, TEMPO

__all__ = ["local_periods", "refined", "steady_pieces", "without_pauses"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def local_periods(one: Predicted) -> tuple[Array, Array]:
    """Return when (n,) and how long (n,) each passage took until the next, in samples.

    Parameters
    ----------
    one : Predicted
    """
    before, after = one.times[:-1], one.times[1:]
    lasted = after - before
    # The next passage of the same run only: not the way across a gap.
    known = np.isfinite(lasted) & (lasted < TEMPO.gap * one.period)
    when, lasted = before[known], lasted[known]
    order = np.argsort(when)
    return when[order], lasted[order]


def steady_pieces(body: Body, found: Sequence[Predicted]) -> list[list[Predicted]]:
    """Cut stretches where their tempo changes for good; each piece is measured by itself.

    Parameters
    ----------
    body : Body
    found : sequence of Predicted

    Returns
    -------
    list of list of Predicted
        The pieces of each; none where its tempo is steady.
    """
    cut = [
        [(place, piece) for piece in _measured(body, one, _pieces_by_tempo(one))]
        for place, one in enumerate(found)
    ]
    pieces = [own for each in cut for own in each]
    result: list[list[Predicted]] = [[] for _ in found]
    free = [found[place].claimed for place, _ in pieces]
    again = _aligned_again(body, [piece for _, piece in pieces], free)
    for (place, _), piece in zip(pieces, again, strict=True):
        if piece.claimed.any():
            result[place].append(refined(body, piece))
    return result


def _pieces_by_tempo(one: Predicted) -> list[tuple[float, float, float]]:
    """List from where to where which period lasts; nothing where the tempo is steady."""
    when, lasted = local_periods(one)
    if len(when) < ALIGNMENT.grid // 2 or one.candidate.turns is not None:
        return []
    width = ALIGNMENT.grid // 4
    smooth = _medians(lasted, width)
    # A passage tells of the time until the next: half of it lies behind its middle.
    middles = when[:: width // 2] + 0.5 * smooth
    cuts, found = _pieces(np.log(smooth)), []
    for number, (first, last) in enumerate(cuts):
        period = float(np.exp(np.median(np.log(smooth[first:last]))))
        begin = -np.inf if number == 0 else float(middles[first])
        end = np.inf if last == len(smooth) else float(middles[last])
        found.append((begin, end, period))
    return found if len(cuts) > 1 else []


def _medians(values: Array, width: int) -> Array:
    """Return the medians within so many values to either side, at every half width."""
    padded = np.pad(values, width, constant_values=np.inf)
    around = np.sort(sliding_window_view(padded, 2 * width + 1)[:: width // 2], axis=1)
    every, seen = np.arange(len(around)), np.isfinite(around).sum(axis=1)
    return np.asarray(0.5 * (around[every, (seen - 1) // 2] + around[every, seen // 2]))


def _measured(
    body: Body, one: Predicted, pieces: Sequence[tuple[float, float, float]]
) -> Iterator[Predicted]:
    """Yield the pieces that are long enough, each measured in its own runs."""
    for begin, end, period in pieces:
        runs = [(max(a, begin), min(b, end)) for a, b in one.runs]
        runs = [(a, b) for a, b in runs if b - a >= ACCOUNT.run * period]
        if sum(b - a for a, b in runs) < TEMPO.periods * period:
            continue
        piece = within(body, replace(one, period=period), runs)
        if piece is not None:
            yield piece


def _aligned_again(
    body: Body, pieces: Sequence[Predicted], free: Sequence[Mask]
) -> list[Predicted]:
    """Lay pieces of one run around templates of their own, if more free limbs repeat by them."""
    single = [place for place, piece in enumerate(pieces) if len(piece.runs) == 1]
    found = list(pieces)
    for place, own in zip(
        single, predict_each(body, [_by_itself(pieces[place]) for place in single]), strict=True
    ):
        piece = pieces[place]
        measured = (within(body, again, piece.runs) for again in own)
        claimed = (
            replace(inside, claimed=inside.claimed & free[place])
            for inside in measured
            if inside is not None
        )
        found[place] = next((one for one in claimed if one.share > piece.share), piece)
    return found


def _by_itself(piece: Predicted) -> Candidate:
    """Return the candidate of a piece of one run."""
    ((start, stop),) = piece.runs
    own = piece.candidate
    return replace(own, start=int(start), stop=int(np.ceil(stop)), period=piece.period)


def without_pauses(one: Predicted) -> Predicted:
    """Cut the runs where the phase rests, twice as long as usual there and a good part of a period.

    A person stands, or turns around, before going on. The usual time of a phase is the median of
    the repetitions, or the shorter of two: what pauses whenever it passes does not pause.

    Parameters
    ----------
    one : Predicted
    """
    if one.candidate.turns is not None:
        return one
    flat = one.times.ravel()
    known = np.flatnonzero(np.isfinite(flat))
    if len(one.times) < 2 or len(known) < 2:
        return one
    lasted = np.full(len(flat), np.nan)
    follows = np.diff(known) == 1
    lasted[known[:-1][follows]] = np.diff(flat[known])[follows]
    by_phase = np.sort(lasted.reshape(one.times.shape), axis=0)
    seen = np.isfinite(by_phase).sum(axis=0)
    usual = by_phase[np.maximum((seen - 1) // 2, 0), np.arange(len(seen))]
    excess = lasted - np.tile(np.nan_to_num(usual, nan=np.inf), len(one.times))
    slow = np.nan_to_num(excess, nan=-1.0) > TEMPO.slower * np.tile(usual, len(one.times))
    pauses = []
    for first, last in Spans.of_mask(slow):
        if excess[first:last].sum() > TEMPO.pause * one.period:
            half = 0.5 * usual[first % len(usual)]
            pauses.append((flat[first] + half, flat[last - 1] + lasted[last - 1] - half))
    return replace(one, runs=_cut(one, pauses), pauses=tuple(pauses)) if pauses else one


def _cut(one: Predicted, pauses: list[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """Return the runs without some pauses, and without what is too short then."""
    kept = []
    for start, stop in one.runs:
        here = start
        for first, last in pauses:
            if start < last and first < stop:
                kept.append((here, max(here, first)))
                here = max(here, last)
        kept.append((here, stop))
    kept = [(a, b) for a, b in kept if b - a >= ACCOUNT.run * one.period]
    return tuple(kept) or one.runs


def refined(body: Body, one: Predicted) -> Predicted:
    """Take the lag at which the poses themselves agree best for the period.

    Parameters
    ----------
    body : Body
    one : Predicted
    """
    lag, agrees = best_lag(body.seen_of(one.claimed, one.runs), one.period)
    return replace(one, period=lag, agrees=agrees) if agrees > 0.0 else one


def _pieces(values: Array) -> list[tuple[int, int]]:
    """Cut a series into pieces that lie near their medians."""
    whole = _deviation(values)
    if len(values) < 4 or np.abs(values - np.median(values)).max() <= np.log1p(TEMPO.steady):
        return [(0, len(values))]
    cut = min(
        range(2, len(values) - 1), key=lambda c: _deviation(values[:c]) + _deviation(values[c:])
    )
    left = _deviation(values[:cut]) + _deviation(values[cut:])
    if left > (1.0 - TEMPO.worth) * whole:
        return [(0, len(values))]
    return _pieces(values[:cut]) + [(a + cut, b + cut) for a, b in _pieces(values[cut:])]


def _deviation(values: Array) -> float:
    return float(np.abs(values - np.median(values)).sum())
