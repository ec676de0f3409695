"""Stretches of one behaviour are one: those whose templates predict each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import SMALLEST
from roundelay.timeline.alignment import taken_at
from roundelay.timeline.limbs import Body
from roundelay.timeline.prediction import Predicted, within
from roundelay.timeline.tempo import refined
from roundelay.timeline.thresholds import MERGING

__all__ = ["merged"]

Array = NDArray[np.float64]


def merged(body: Body, found: Sequence[Predicted]) -> list[Predicted]:
    """Join stretches in which the same limbs do the same thing at about the same tempo.

    Parameters
    ----------
    body : Body
    found : sequence of Predicted
        Without overlap, limb by limb.

    Returns
    -------
    list of Predicted
        Those that were joined are measured again.
    """
    kept: list[_Piece] = []
    for one in sorted(found, key=lambda each: each.repetitions, reverse=True):
        piece = _piece(body, one)
        for place, home in enumerate(kept):
            joined = _joined(body, home, piece)
            if joined is not None:
                kept[place] = _piece(body, joined)
                break
        else:
            kept.append(piece)
    return [piece.own for piece in kept]


@dataclass(frozen=True, eq=False)
class _Piece:
    """A stretch with its template: Fourier coefficients and power of every column."""

    own: Predicted
    spectrum: NDArray[np.complex128]
    power: Array


def _piece(body: Body, one: Predicted) -> _Piece:
    template = _template(body.signals, one)
    return _Piece(one, np.fft.rfft(template, axis=0), np.sum(template**2, axis=0))


def _joined(body: Body, home: _Piece, other: _Piece) -> Predicted | None:
    """Return two stretches as one, or None if they are two behaviours."""
    first, second = home.own, other.own
    if abs(np.log(first.period / second.period)) > np.log1p(MERGING.tempo):
        return None
    claimed = first.claimed & second.claimed
    if not _mostly(first, claimed) or not _mostly(second, claimed):
        return None
    shift, agrees = _best_shift(home, other, body.columns_of(claimed), first.times.shape[1])
    if agrees < MERGING.alike:
        return None
    times = np.concatenate([first.times, _shifted(second, shift)])
    times = times[np.argsort(np.nanmean(times, axis=1))]
    runs = sorted((*first.runs, *second.runs))
    both = replace(
        first, times=times, runs=tuple(runs), claimed=claimed, pauses=first.pauses + second.pauses
    )
    again = within(body, both, runs)
    return None if again is None or not again.claimed.any() else refined(body, again)


def _mostly(one: Predicted, claimed: NDArray[np.bool_]) -> bool:
    """Tell whether some limbs hold most of the motion of all that are claimed."""
    power = one.amplitudes**2
    return bool(power[claimed].sum() >= MERGING.limbs * power[one.claimed].sum() > 0.0)


def _template(signal: Array, one: Predicted) -> Array:
    """Return the mean repetition (n, d), centred: where the body leans does not matter."""
    values = taken_at(signal, one.times)
    seen = np.isfinite(values[..., 0]).sum(axis=0)
    mean = np.nansum(values, axis=0) / np.maximum(seen, 1)[:, None]
    return np.asarray(mean - mean.mean(axis=0))


def _best_shift(
    first: _Piece, second: _Piece, columns: NDArray[np.intp], phases: int
) -> tuple[int, float]:
    """Return by how many phases the second comes earlier, and how alike they are then, up to 1."""
    crossed = first.spectrum[:, columns] * np.conj(second.spectrum[:, columns])
    inner = np.fft.irfft(np.sum(crossed, axis=1), phases)
    power = float(first.power[columns].sum() + second.power[columns].sum())
    shift = int(np.argmax(inner))
    return shift, 2.0 * float(inner[shift]) / max(power, SMALLEST)


def _shifted(one: Predicted, shift: int) -> Array:
    """Return the passages (R', n) of a stretch with its phases a few cells later."""
    count = one.times.shape[1]
    rows = []
    middle = np.nanmean(one.times, axis=1)
    for start, stop in one.runs:
        own = one.times[(middle >= start - one.period) & (middle < stop + one.period)]
        own = np.where((own >= start - 0.5) & (own <= stop + 0.5), own, np.nan)
        flat = np.concatenate([np.full(shift, np.nan), own.ravel(), np.full(count - shift, np.nan)])
        rows.append(flat.reshape(-1, count))
    times = np.concatenate(rows)
    return times[np.isfinite(times).any(axis=1)]
