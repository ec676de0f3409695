"""Phrases: longer periods of what repeats already, as a dance is made of beats."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import SMALLEST
from roundelay.timeline.alignment import taken_at
from roundelay.timeline.chance import excess
from roundelay.timeline.limbs import Body
from roundelay.timeline.prediction import Predicted, within
from roundelay.timeline.tempo import refined
from roundelay.timeline.thresholds import CHANCE, NESTING, PREDICTABILITY

__all__ = ["phrase_of"]

Array = NDArray[np.float64]


def phrase_of(body: Body, beat: Predicted) -> Predicted | None:
    """Return the fewest beats that predict themselves clearly better than each beat does, or None.

    Parameters
    ----------
    body : Body
    beat : Predicted
    """
    start, stop = max(beat.runs, key=lambda run: run[1] - run[0])
    middle = np.nanmean(beat.times, axis=1)
    times = beat.times[(middle >= start) & (middle < stop)]
    columns = body.columns(tuple(np.flatnonzero(beat.claimed).tolist()))
    values = taken_at(body.signals[:, columns], times)
    alone = _unexplained(values, 1)
    for count in range(2, int(len(times) / NESTING.fewest) + 1):
        if _unexplained(values, count) <= NESTING.left * alone:
            return _made_of(body, beat, times, count, (start, stop))
    return None


def _unexplained(values: Array, count: int) -> float:
    """Return 1 - R^2 of beats (R, n, d), each predicted by the others at its place in a phrase."""
    error = spread = 0.0
    middle = np.nanmean(values, axis=(0, 1))
    for place in range(count):
        own = values[place::count]
        seen = np.isfinite(own[..., :1]).sum(axis=0)
        others = (np.nansum(own, axis=0) - own) / np.maximum(seen - 1, 1)
        used = np.isfinite(own[..., 0]) & (seen[..., 0] >= 2)
        floor = PREDICTABILITY.least**2 * float(used.sum())
        error += float(np.sum((own - others)[used] ** 2)) + floor
        spread += float(np.sum((own - middle)[used] ** 2)) + floor
    return error / max(spread, SMALLEST)


def _made_of(
    body: Body, beat: Predicted, times: Array, count: int, run: tuple[float, float]
) -> Predicted | None:
    """Return a phrase of so many beats; None if chance makes as good ones."""
    phases = times.shape[1]
    missing = np.full((-len(times) % count, phases), np.nan)
    rows = np.concatenate([times, missing]).reshape(-1, count * phases)[:, ::count]
    long = replace(beat, times=rows, period=count * beat.period, slowness=beat.slowness / count)
    inside = within(body, long, [run])
    if inside is None or not inside.claimed.any() or excess(body, inside) <= CHANCE.least:
        return None
    return refined(body, inside)
