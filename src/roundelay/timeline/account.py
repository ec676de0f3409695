"""The best account of every frame of every limb: which candidate explains it.

First the body as a whole, by dynamic programming over time: a candidate gains, sample by sample,
the evidence of the repetition it is in. Then limbs that this leaves unexplained, the best first.
T/2, T and 2T need no rule: 2T loses a repetition's numbers, T/2 loses what is predicted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import ROUNDING, SIX_DIGITS, SMALLEST, TINY
from roundelay.base.spans import Spans
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
    gain = np.full((len(body), len(found) + 1), -1.0)
    gain[:, -1] = SIX_DIGITS
    for place, one in enumerate(found):
        _add_gain(gain[:, place], one)
    path = _best_path(gain)
    kept = []
    for place, one in enumerate(found):
        runs = [(float(a), float(b)) for a, b in Spans.of_mask(path == place)]
        trimmed = _trimmed(body, one, runs)
        if trimmed is not None:
            kept.append(trimmed)
    return kept


def _add_gain(gain: Array, one: Predicted) -> None:
    """Write the evidence a sample, in nats, of the repetition that each sample is in."""
    power = one.amplitudes**2 / max(float(np.sum(one.amplitudes**2)), SMALLEST)
    clear = np.minimum(1.0 / np.maximum(1.0 - one.limb_each, TINY), ACCOUNT.clearest)
    bits = power @ np.where(one.limb_each > ACCOUNT.counts, np.log(clear), 0.0)
    # One of the repetitions seen pays for the template.
    density = one.numbers / max(one.seen, ROUNDING) / one.period
    for value, times in zip(0.5 * density * bits, one.times, strict=True):
        known = times[np.isfinite(times)]
        if len(known) < 2 or value <= 0.0:
            continue
        half = 0.5 * (known[-1] - known[0]) / (len(known) - 1)
        own = slice(max(0, int(known[0] - half)), int(np.ceil(known[-1] + half)))
        gain[own] = np.maximum(gain[own], value)


def _best_path(gain: Array) -> NDArray[np.intp]:
    """Return the column (n,) that explains each sample: Viterbi's path; leaving is free."""
    samples, columns = gain.shape
    nothing = columns - 1
    total = gain[0] - ACCOUNT.change
    total[nothing] = 0.0
    back = np.zeros((samples, columns), np.int32)
    own = np.arange(columns)
    for t in range(1, samples):
        top = int(total.argmax())
        change = total[top] - ACCOUNT.change
        back[t] = np.where(total >= change, own, top)
        best = np.maximum(total, change)
        if total[top] > best[nothing]:
            best[nothing], back[t, nothing] = total[top], top
        total = best + gain[t]
    path = np.zeros(samples, np.intp)
    path[-1] = int(total.argmax())
    for t in range(samples - 1, 0, -1):
        path[t - 1] = back[t, path[t]]
    return path


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
    pool, kept = list(found), list[Predicted]()
    while pool:
        rated = [(own, runs) for own, runs in (_new(body, one, taken) for one in pool) if runs]
        if not rated:
            break
        place = max(range(len(rated)), key=lambda i: _evidence(*rated[i]))
        best, runs = rated.pop(place)
        pool = [own for own, _ in rated]
        trimmed = _trimmed(body, best, runs)
        if trimmed is not None:
            kept.append(trimmed)
            _take(taken, trimmed)
    return kept


def _evidence(one: Predicted, runs: list[tuple[float, float]]) -> float:
    """Return a candidate's evidence in some of its samples."""
    left, whole = sum(b - a for a, b in runs), sum(b - a for a, b in one.runs)
    return one.nats * one.share * left / max(whole, ROUNDING)


def _new(body: Body, one: Predicted, taken: Mask) -> tuple[Predicted, list[tuple[float, float]]]:
    """Return a candidate with the limbs that nothing explains yet, and where they are free."""
    spans = Spans.union(sorted((int(a), min(len(body), int(np.ceil(b)))) for a, b in one.runs))
    claimed = one.claimed & (taken[:, spans.frames].mean(axis=1) < 1.0 - ACCOUNT.fresh)
    gesture, power = one.candidate.turns is not None, one.amplitudes**2
    # A gesture is one of the limbs that make it: what others leave of it is none.
    left = not gesture or power[claimed].sum() >= MERGING.limbs * power[one.claimed].sum()
    one = replace(one, claimed=claimed)
    if not claimed.any() or not left:
        return one, []
    free = np.zeros(len(body), bool)
    free[spans.frames] = True
    free &= ~taken[claimed].any(axis=0)
    runs = [(float(a), float(b)) for a, b in Spans.of_mask(free)]
    runs = [(a, b) for a, b in runs if b - a >= ACCOUNT.run * one.period]
    return one, runs if sum(b - a for a, b in runs) >= ACCOUNT.fewest * one.period else []
