"""Tempo over time, and the pieces in which it is steady."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from roundelay.timeline.agreement import best_lag
from roundelay.timeline.limbs import Body
from roundelay.timeline.prediction import Predicted, within
from roundelay.timeline.thresholds import ACCOUNT, ALIGNMENT, TEMPO

__all__ = ["local_periods", "steady_pieces"]

Array = NDArray[np.float64]


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


def steady_pieces(body: Body, one: Predicted) -> list[Predicted]:
    """Cut a stretch where its tempo changes for good; each piece is measured by itself."""
    when, lasted = local_periods(one)
    if len(when) < ALIGNMENT.grid // 2:
        return [_refined(body, one)]
    width = ALIGNMENT.grid // 4
    smooth = np.array(
        [
            np.median(lasted[max(0, i - width) : i + width + 1])
            for i in range(0, len(lasted), width // 2)
        ]
    )
    # A passage tells of the time until the next: half of it lies behind its middle.
    middles = when[:: width // 2] + 0.5 * smooth
    cuts = _pieces(np.log(smooth))
    if len(cuts) == 1:
        return [_refined(body, one)]
    found = []
    for number, (first, last) in enumerate(cuts):
        period = float(np.exp(np.median(np.log(smooth[first:last]))))
        begin = -np.inf if number == 0 else middles[first]
        end = np.inf if last == len(smooth) else middles[last]
        runs = [(max(a, begin), min(b, end)) for a, b in one.runs]
        runs = [(a, b) for a, b in runs if b - a >= ACCOUNT.run * period]
        if sum(b - a for a, b in runs) < TEMPO.periods * period:
            continue
        piece = within(body, replace(one, period=period), runs)
        if piece is not None and piece.claimed.any():
            found.append(_refined(body, piece))
    return found or [_refined(body, one)]


def _refined(body: Body, one: Predicted) -> Predicted:
    """Take the lag at which the poses themselves agree best for the period."""
    signal = body.seen[:, body.joints(one.claimed)].reshape(len(body), -1).astype(float)
    lag, agrees = best_lag(signal, one.runs, one.period)
    return replace(one, period=lag) if agrees > 0.0 else one


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
