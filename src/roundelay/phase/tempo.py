"""From a structural coordinate to a phase that grows with time: tempo and period."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from roundelay.base.spans import Span, Spans
from roundelay.motion.poses import principal_components
from roundelay.phase.harmonic import crossfade_weights, fit_harmonic, highest_harmonic
from roundelay.phase.period import line_period
from roundelay.phase.phase_map import phase_map
from roundelay.phase.thresholds import TEMPO
from roundelay.phase.unwrap import smooth_turns

__all__ = ["agreement_period", "lowest_between", "time_phase"]

Array = NDArray[np.float64]


def time_phase(points: Array, turns: Array, runs: Sequence[Span], *, frame_time: float) -> Array:
    """Turn a structural coordinate into a phase that grows with time.

    The coordinate is mapped to mean time (`roundelay.phase.phase_map`) and steadied as far as the
    poses allow: to one tempo, at which the repetitions agree best, unless that leaves
    another hundredth of their variance unexplained; else smoothed over time, as widely.

    Parameters
    ----------
    points : (F, d) ndarray
        Poses.
    turns : (F,) ndarray
        Unwrapped circular coordinate.
    runs : sequence of (start, stop)
    frame_time : float
        Seconds.

    Returns
    -------
    (F,) ndarray
        Unwrapped phase; NaN outside the runs.
    """
    mapping = phase_map(turns, runs)
    raw = np.where(np.isfinite(turns), mapping(np.nan_to_num(turns)), np.nan)
    inside = Spans(runs).frames
    reduced = principal_components(points[inside], TEMPO.variance)
    poses = np.zeros((len(points), reduced.shape[1]))
    poses[inside] = reduced
    period = agreement_period(poses, runs, line_period(raw, runs))
    count = min(highest_harmonic(period * frame_time), TEMPO.harmonics)

    def misfit(phase: Array) -> float:
        weights = crossfade_weights(phase, list(runs))[inside]
        curve = fit_harmonic(phase[inside], reduced, count, weights=weights)
        squares = np.sum((curve(phase[inside]) - reduced) ** 2, axis=1)
        return float(weights @ squares / weights.sum())

    loosest = smooth_turns(raw, runs, TEMPO.widths[-1] * period)
    limit = misfit(loosest) + TEMPO.tolerance * float(np.sum(np.var(reduced, axis=0)))
    steady = _one_tempo(raw, runs, period)
    if misfit(steady) <= limit:
        return steady
    for width in TEMPO.widths[:-1]:
        phase = smooth_turns(raw, runs, width * period)
        if misfit(phase) <= limit:
            return phase
    return loosest


def agreement_period(poses: Array, runs: Sequence[Span], period: float) -> float:
    """Return the lag at which poses agree best with those of all earlier repetitions.

    Parameters
    ----------
    poses : (F, d) ndarray
    runs : sequence of (start, stop)
    period : float
        First estimate in frames; the result lies within a sixteenth of it.

    Returns
    -------
    float
        In frames; between whole lags by the parabola through three.
    """
    reach = max(2, round(TEMPO.reach * period))
    lags = np.arange(max(2, round(period) - reach), round(period) + reach + 1)
    apart = _disagreement([_squares_apart(poses[slice(*run)]) for run in runs], lags)
    if not np.isfinite(apart).all():
        return period
    best = int(np.clip(np.argmin(apart), 1, len(lags) - 2))
    return float(lags[best]) + lowest_between(apart[best - 1 : best + 2])


def lowest_between(values: Array) -> float:
    """Return where between -1 and 1 the parabola through three values, at -1, 0, 1, is least."""
    before, here, after = values
    bend = before - 2.0 * here + after
    return float(np.clip(0.5 * (before - after) / bend, -1.0, 1.0)) if bend > 0.0 else 0.0


def _disagreement(squares: Sequence[Array], lags: NDArray[np.intp]) -> Array:
    """Return the mean squared distance of poses any number of lags apart; NaN without any.

    Parameters
    ----------
    squares : sequence of (n,) ndarray
        Of each run, as from `_squares_apart`.
    lags : (m,) ndarray of int
    """
    total = np.array([sum(run[lag::lag].sum() for run in squares) for lag in lags])
    pairs = np.array(
        [sum(np.arange(len(run) - lag, 0.0, -lag).sum() for run in squares) for lag in lags]
    )
    return np.where(pairs > 0, total / np.maximum(pairs, 1), np.nan)


def _squares_apart(poses: Array) -> Array:
    """Sum |x(t + lag) - x(t)|^2 over t for all lags (n,) at once, by the correlation theorem."""
    count = len(poses)
    spectrum = np.fft.rfft(poses, 2 * count, axis=0)
    product = np.fft.irfft(np.sum(np.abs(spectrum) ** 2, axis=1), 2 * count)[:count]
    sums = np.concatenate([[0.0], np.cumsum(np.einsum("ij,ij->i", poses, poses))])
    return np.maximum(sums[count:0:-1] + sums[-1] - sums[:count] - 2.0 * product, 0.0)


def _one_tempo(raw: Array, runs: Sequence[Span], period: float) -> Array:
    """Advance by one turn a period in every run, from where it is on average."""
    phase = np.full(len(raw), np.nan)
    for start, stop in runs:
        even = np.arange(start, stop) / period
        phase[start:stop] = even + np.mean(raw[start:stop] - even)
    return phase
