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
    values = taken_at(body.signals, times)[:, :, body.columns_of(beat.claimed)]
    alone = _unexplained(values, 1)
    longest = PREDICTABILITY.longest * body.rate / beat.period
    for count in range(2, int(min(len(times) / NESTING.fewest, longest)) + 1):
        if _unexplained(values, count) <= NESTING.left * alone:
            return _made_of(body, beat, times, count, (start, stop))
    return None


def _unexplained(values: Array, count: int) -> float:
    """Return 1 - R^2 of beats (R, n, d), each predicted by the others at its place in a phrase.

    What x differs from the mean of the n - 1 others is (n x - S) / (n - 1), S being the sum.
    """
    missing = np.full((-len(values) % count, *values.shape[1:]), np.nan)
    x = np.concatenate([values, missing]).reshape(-1, count, *values.shape[1:])
    shown = np.isfinite(x[..., 0])
    x = np.where(shown[..., None], x, 0.0)
    times, total = shown.sum(axis=0), x.sum(axis=0)
    twice = times >= 2
    squares, middle = np.sum(x**2, axis=(0, 3)), x.sum(axis=(0, 1, 2)) / max(shown.sum(), 1)
    left = times**2 * squares - times * np.sum(total**2, axis=2)
    error = float(np.sum(left[twice] / (times[twice] - 1) ** 2))
    around = squares - 2.0 * total @ middle + times * float(middle @ middle)
    floor = PREDICTABILITY.least**2 * float(times[twice].sum())
    return (error + floor) / max(float(around[twice].sum()) + floor, SMALLEST)


def _made_of(
    body: Body, beat: Predicted, times: Array, count: int, run: tuple[float, float]
) -> Predicted | None:
    """Return a phrase of so many beats; None if chance makes as good ones."""
    phases = times.shape[1]
    missing = np.full((-len(times) % count, phases), np.nan)
    rows = np.concatenate([times, missing]).reshape(-1, count * phases)[:, ::count]
    long = replace(beat, times=rows, period=count * beat.period, slowness=beat.slowness / count)
    inside = within(body, long, [run])
    if inside is None or not inside.claimed.any():
        return None
    phrase = refined(body, inside)
    return phrase if excess(body, phrase) > CHANCE.least else None
