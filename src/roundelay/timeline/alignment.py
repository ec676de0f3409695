"""Alignment of a stretch to its own repeating template: phase with varying tempo, and pauses.

A hidden Markov model around the circle: the state is the phase, a sample at each costs its
squared distance to the template over the variance, advancing at twice, half or none of the usual
tempo costs a little, and a sample that no phase explains costs a fixed share of the variance. The
template is the mean over the repetitions of the last round. Many stretches are aligned at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from roundelay.base.spans import Spans
from roundelay.phase.period import rising
from roundelay.timeline.thresholds import ALIGNMENT

__all__ = ["Aligned", "Stretch", "align_all", "laid_out", "taken_at"]

Array = NDArray[np.float64]
Costs = NDArray[np.float32]

# At most so many numbers are held at once.
_BLOCK = 8_000_000


@dataclass(frozen=True, eq=False)
class Stretch:
    """Samples of one group of limbs at a period's own clock, 32 samples a period.

    Attributes
    ----------
    values : (m, d) ndarray
    first : float
        Where the first lies on the body's clock.
    step : float
        Samples of the body's clock from one to the next.
    core : slice
        The samples that were proposed; the others lie around them.
    least : float
        Least amplitude that counts, squared.
    """

    values: Array
    first: float
    step: float
    core: slice
    least: float

    @property
    def variance(self) -> float:
        """Of the samples proposed, with the least amplitude."""
        own = self.values[self.core]
        return float(np.sum(np.var(own, axis=0))) + self.least


@dataclass(frozen=True, eq=False)
class Aligned:
    """A stretch laid around its template.

    Attributes
    ----------
    runs : Spans
        Of the stretch's samples that the template explains.
    phase : (m,) ndarray
        In turns, never falling; NaN where unexplained.
    times : (R, 48) ndarray
        When each repetition passes each phase, on the body's clock; NaN where it does not.
    """

    runs: Spans
    phase: Array
    times: Array


def taken_at(values: Array, where: Array) -> Array:
    """Return values (..., d) at fractional places (...) of samples (n, d), NaN at NaN."""
    known = np.isfinite(where)
    place = np.clip(np.where(known, where, 0.0), 0.0, len(values) - 1)
    before = np.minimum(place.astype(np.intp), max(len(values) - 2, 0))
    part = (place - before)[..., None]
    after = np.minimum(before + 1, len(values) - 1)
    found = values[before] * (1.0 - part) + values[after] * part
    return np.where(known[..., None], found, np.nan)


def align_all(stretches: Sequence[Stretch]) -> list[Aligned | None]:
    """Align each stretch to a template of its own; None where none goes around.

    Parameters
    ----------
    stretches : sequence of Stretch
        Each with at least a period proposed.
    """
    templates: list[Array | None] = [_first_template(stretch) for stretch in stretches]
    found: list[Aligned | None] = [None] * len(stretches)
    for _ in range(ALIGNMENT.rounds):
        going = [i for i, template in enumerate(templates) if template is not None]
        states = _states(stretches, templates, going)
        for i in going:
            found[i] = _laid(stretches[i], states[i])
            templates[i] = _template(stretches[i], found[i])
    return [
        one if template is not None else None
        for one, template in zip(found, templates, strict=True)
    ]


def laid_out(stretch: Stretch, turns: Array) -> Aligned | None:
    """Lay a stretch around a phase that is known; None where it makes no turn.

    Parameters
    ----------
    stretch : Stretch
    turns : (n,) ndarray
        Unwrapped phase on the body's clock, NaN where unknown.
    """
    where = stretch.first + stretch.step * np.arange(len(stretch.values))
    phase, runs = np.full(len(where), np.nan), []
    for start, stop in Spans.of_mask(np.isfinite(turns)):
        inside = np.flatnonzero((where >= start) & (where <= stop - 1))
        if len(inside) > 1:
            own = np.interp(where[inside], np.arange(start, stop), turns[start:stop])
            phase[inside] = np.maximum.accumulate(own)
            runs.append((int(inside[0]), int(inside[-1]) + 1))
    if not runs:
        return None
    times = _passages(Spans(runs), phase)
    return Aligned(Spans(runs), phase, stretch.first + stretch.step * times)


def _first_template(stretch: Stretch) -> Array:
    """Return the period that the one after it repeats best, averaged with that one."""
    own = stretch.values[stretch.core]
    if len(own) >= 2 * ALIGNMENT.samples:
        apart = np.sum((own[: -ALIGNMENT.samples] - own[ALIGNMENT.samples :]) ** 2, axis=1)
        sums = np.concatenate([[0.0], np.cumsum(apart)])
        start = int(np.argmin(sums[ALIGNMENT.samples :] - sums[: -ALIGNMENT.samples]))
        period = 0.5 * (
            own[start : start + ALIGNMENT.samples]
            + own[start + ALIGNMENT.samples : start + 2 * ALIGNMENT.samples]
        )
    else:
        period = own[: ALIGNMENT.samples]
    ring = np.concatenate([period, period[:1]])
    return taken_at(ring, np.arange(ALIGNMENT.states) * ALIGNMENT.samples / ALIGNMENT.states)


def _states(
    stretches: Sequence[Stretch], templates: Sequence[Array | None], going: list[int]
) -> dict[int, NDArray[np.intp]]:
    """Return the phase state (m,) of every sample of stretches, -1 where unexplained.

    Long stretches are decoded in pieces, many at once; each piece is trusted up to the middle of
    what it shares with the next, by where paths have met.
    """
    states = {i: np.full(len(stretches[i].values), -1) for i in going}
    half = ALIGNMENT.shared * ALIGNMENT.samples // 2
    for batch in _batches([(i, *piece) for i in going for piece in _pieces(len(states[i]))]):
        costs = [_costs(stretches[i], cast(Array, templates[i]), a, b) for i, a, b in batch]
        for (i, a, b), own in zip(batch, _decoded(costs), strict=True):
            first, last = half if a else 0, half if b < len(states[i]) else 0
            states[i][a + first : b - last] = own[first : len(own) - last]
    return states


def _pieces(length: int) -> list[tuple[int, int]]:
    """Cut so many samples into pieces that overlap."""
    size, step = (
        periods * ALIGNMENT.samples
        for periods in (ALIGNMENT.piece, ALIGNMENT.piece - ALIGNMENT.shared)
    )
    starts = range(0, max(1, length - size + step), step)
    return [(start, length if start == starts[-1] else start + size) for start in starts]


def _batches(pieces: list[tuple[int, int, int]]) -> list[list[tuple[int, int, int]]]:
    """Put pieces (stretch, start, stop) of like length together, as many as memory allows."""
    batches: list[list[tuple[int, int, int]]] = []
    longest = 0
    for piece in sorted(pieces, key=lambda piece: piece[1] - piece[2]):
        if batches and (len(batches[-1]) + 1) * longest * ALIGNMENT.states <= _BLOCK:
            batches[-1].append(piece)
        else:
            batches.append([piece])
            longest = piece[2] - piece[1]
    return batches


def _decoded(costs: list[Costs]) -> list[NDArray[np.intp]]:
    """Return the phase state (m,) of every sample, -1 where unexplained: Viterbi's paths.

    Costs (m, 64) are in order of falling length.
    """
    lengths = np.array([len(one) for one in costs])
    best = np.zeros((lengths[0], len(costs), ALIGNMENT.states), np.float32)
    for i, one in enumerate(costs):
        best[: len(one), i] = one
    none = np.full(best.shape[:2], ALIGNMENT.unexplained, np.float32)
    left, enter = np.zeros(best.shape[:2], bool), _enter()
    for t, alive in enumerate(np.searchsorted(-lengths, -np.arange(1, lengths[0])).tolist(), 1):
        before, off = best[t - 1, :alive], none[t - 1, :alive]
        best[t, :alive] += _reached(before, off + enter)
        leave = before.min(axis=1) + enter
        left[t, :alive] = leave < off
        none[t, :alive] += np.minimum(off, leave)
    states = _traced(best, none, left, lengths)
    return [states[:length, i] for i, length in enumerate(lengths)]


def _costs(stretch: Stretch, template: Array, start: int, stop: int) -> Costs:
    """Return what each phase costs (m, 64) of some samples, in variances."""
    x = stretch.values[start:stop]
    inner = (
        np.sum(x * x, axis=1)[:, None] + np.sum(template * template, axis=1) - 2 * x @ template.T
    )
    return np.minimum(inner / stretch.variance, ALIGNMENT.farthest).astype(np.float32)


def _reached(before: Costs, enter: Costs) -> Costs:
    """Return the least cost (n, 64) of coming to each phase, from the sample before or anew."""
    most = len(ALIGNMENT.tempo) - 1
    around = np.concatenate([before[:, -most:], before], axis=1)
    least = np.minimum(around[:, most - 2 : -2], enter[:, None])
    for step in (1, 3, 0, 4):
        own = around[:, most - step : most - step + ALIGNMENT.states]
        np.minimum(least, own + np.float32(ALIGNMENT.tempo[step]), out=least)
    return least


def _enter() -> np.float32:
    """Return the cost of entering or leaving: that of a quarter of a period unexplained."""
    return np.float32(ALIGNMENT.unexplained * ALIGNMENT.samples / 4)


def _traced(
    best: Costs, none: Costs, left: NDArray[np.bool_], lengths: NDArray[np.intp]
) -> NDArray[np.intp]:
    """Follow the least costs back from the last samples, all paths at once."""
    every = np.arange(len(lengths))
    last, enter = best[lengths - 1, every], none + _enter()
    state = np.where(last.min(axis=1) < none[lengths - 1, every], last.argmin(axis=1), -1)
    # Of equal ways, the usual tempo, then the nearest to it.
    steps = np.array([2, 1, 3, 0, 4])
    tempo = np.array(ALIGNMENT.tempo, np.float32)[steps]
    # The states before each; before none, which is the last, they do not count.
    sources = (np.arange(ALIGNMENT.states + 1)[:, None] - steps) % ALIGNMENT.states
    states = np.full(best.shape[:2], -1)
    going = np.searchsorted(-lengths, -np.arange(lengths[0])).tolist()
    for t in range(lengths[0] - 1, 0, -1):
        alive = going[t]
        states[t, :alive] = own = state[:alive]
        source, before = sources[own], best[t - 1, :alive]
        costs = before.ravel().take(source + ALIGNMENT.states * every[:alive, None])
        costs += tempo
        found = source[every[:alive], costs.argmin(axis=1)]
        found[enter[t - 1, :alive] < costs.min(axis=1)] = -1
        off = np.flatnonzero(own < 0)
        if len(off):
            found[off] = np.where(left[t, off], before[off].argmin(axis=1), -1)
        state[:alive] = found
    states[0] = state
    return states


def _laid(stretch: Stretch, states: NDArray[np.intp]) -> Aligned | None:
    """Turn states into runs, phases and the times of the repetitions."""
    known = states >= 0
    advance = np.diff(states) % ALIGNMENT.states
    runs, phase = [], np.full(len(states), np.nan)
    for start, stop in Spans.of_mask(known):
        cuts = start + 1 + np.flatnonzero(advance[start : stop - 1] >= len(ALIGNMENT.tempo))
        for a, b in zip([start, *cuts.tolist()], [*cuts.tolist(), stop], strict=True):
            turns = (
                states[a] + np.concatenate([[0], np.cumsum(advance[a : b - 1])])
            ) / ALIGNMENT.states
            turns = _smoothed(turns)
            if turns[-1] - turns[0] >= ALIGNMENT.turns:
                phase[a:b] = turns
                runs.append((a, b))
    if not runs:
        return None
    times = _passages(Spans(runs), phase)
    return Aligned(Spans(runs), phase, stretch.first + stretch.step * times)


def _smoothed(turns: Array) -> Array:
    """Average a rising phase over an eighth of a period to either side."""
    width = ALIGNMENT.samples // 8
    if len(turns) <= 2 * width + 1:
        return turns
    before = 2 * turns[0] - turns[width:0:-1]
    beyond = 2 * turns[-1] - turns[-2 : -width - 2 : -1]
    sums = np.concatenate([[0.0], np.cumsum(np.concatenate([before, turns, beyond]))])
    return np.maximum.accumulate((sums[2 * width + 1 :] - sums[: -2 * width - 1]) / (2 * width + 1))


def _passages(runs: Spans, phase: Array) -> Array:
    """Return when (R, 48) each repetition passes each phase, in samples of the stretch."""
    grid, rows = (np.arange(ALIGNMENT.grid) + 0.5) / ALIGNMENT.grid, []
    for start, stop in runs:
        risen = rising(phase[start:stop])
        turns = np.arange(np.floor(risen[0]), np.ceil(risen[-1]))[:, None] + grid
        frames = np.arange(start, stop, dtype=float)
        times = np.interp(turns, risen, frames, left=np.nan, right=np.nan)
        rows.append(times[np.isfinite(times).sum(axis=1) >= ALIGNMENT.fewest])
    return np.concatenate(rows)


def _template(stretch: Stretch, aligned: Aligned | None) -> Array | None:
    """Return the mean of the repetitions by phase; None if too little of the circle is passed."""
    if aligned is None or not len(aligned.times):
        return None
    passed = np.isfinite(aligned.times)
    count = passed.sum(axis=0)
    if np.mean(count == 0) > 1.0 - ALIGNMENT.passed:
        return None
    values = taken_at(stretch.values, (aligned.times - stretch.first) / stretch.step)
    seen = count > 0
    mean = np.nansum(values, axis=0)[seen] / count[seen, None]
    grid = ((np.arange(ALIGNMENT.grid) + 0.5) / ALIGNMENT.grid)[seen]
    around = np.concatenate([grid - 1.0, grid, grid + 1.0])
    states = np.arange(ALIGNMENT.states) / ALIGNMENT.states
    return np.column_stack(
        [np.interp(states, around, column) for column in np.tile(mean, (3, 1)).T]
    )
