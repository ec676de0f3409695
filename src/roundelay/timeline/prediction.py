"""How well each repetition is predicted by the others at the same phase, limb by limb.

One measurement for every candidate, whoever proposed it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import TooShort
from roundelay.base.numeric import ROUNDING, SMALLEST, TINY
from roundelay.base.spans import Spans
from roundelay.phase.period import return_period
from roundelay.timeline.alignment import Aligned, Stretch, align_all, laid_out, taken_at
from roundelay.timeline.limbs import Body
from roundelay.timeline.proposals.proposal import Candidate
from roundelay.timeline.thresholds import ALIGNMENT, PREDICTABILITY, PREDICTION

__all__ = ["Predicted", "dimension", "microscale", "predict_all", "predict_each", "within"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Predicted:
    """A stretch whose repetitions were predicted from each other.

    Attributes
    ----------
    candidate : Candidate
    times : (R, 48) ndarray
        When each repetition passes each phase, in samples; NaN where it does not.
    runs : tuple of (float, float)
        The samples that are explained.
    period : float
        Median time of return, in samples.
    repetitions : float
        Periods passed.
    seen : float
        Periods that others predict.
    again : float
        Periods seen again: all but one showing of every phase.
    explained : float
        Share of the variance that is predicted, R^2, of the group.
    each : (R,) ndarray
        The same of every repetition.
    numbers : float
        Independent numbers that were predicted.
    slowness : float
        Standard deviation over that of the rate of change, in periods: 1 / (2 pi) for a sinusoid.
    limbs : (L,) ndarray
        R^2 of every limb of the body.
    amplitudes : (L,) ndarray
        Root mean square motion of every limb in these frames, in body sizes.
    limb_each : (L, R) ndarray
        R^2 of every limb in every repetition.
    claimed : (L,) ndarray of bool
        The limbs that move and repeat, and that nothing else explains here.
    pauses : tuple of (float, float)
        Samples at which the phase rests.
    agrees : float
        Correlation of poses a period apart, where the period was refined by it.
    """

    candidate: Candidate
    times: Array = field(repr=False)
    runs: tuple[tuple[float, float], ...]
    period: float
    repetitions: float
    seen: float
    again: float
    explained: float
    each: Array = field(repr=False)
    numbers: float
    slowness: float
    limbs: Array = field(repr=False)
    amplitudes: Array = field(repr=False)
    limb_each: Array = field(repr=False)
    claimed: NDArray[np.bool_] = field(repr=False)
    pauses: tuple[tuple[float, float], ...] = ()
    agrees: float = 0.0

    @property
    def nats(self) -> float:
        """Evidence that the prediction is no chance."""
        if self.explained <= 0.0:
            return 0.0
        return (
            0.5 * self.numbers * float(np.log(1.0 / max(1.0 - self.explained, PREDICTION.certain)))
        )

    @property
    def share(self) -> float:
        """Share of the motion in these frames that is that of the claimed limbs."""
        power = self.amplitudes**2
        return float(power[self.claimed].sum() / max(float(power.sum()), SMALLEST))


def predict_all(body: Body, found: Sequence[Candidate]) -> list[Predicted]:
    """Align every candidate and predict its repetitions from each other.

    Parameters
    ----------
    body : Body
    found : sequence of Candidate

    Returns
    -------
    list of Predicted
        Without the candidates that do not go around.
    """
    return [one for _, one in _predicted_all(body, found)]


def predict_each(body: Body, found: Sequence[Candidate]) -> list[list[Predicted]]:
    """Do the same, candidate by candidate."""
    each: list[list[Predicted]] = [[] for _ in found]
    for place, one in _predicted_all(body, found):
        each[place].append(one)
    return each


def _predicted_all(body: Body, found: Sequence[Candidate]) -> list[tuple[int, Predicted]]:
    """Return what goes around, with the place of the candidate that it is of."""
    waiting, predicted = list(enumerate(found)), list[tuple[int, Predicted]]()
    while waiting:
        going = _predicted_from(body, waiting)
        predicted += going
        waiting = [(place, rest) for place, one in going for rest in _unexplained(one)]
    return predicted


def _unexplained(one: Predicted) -> Iterator[Candidate]:
    """Yield what the template leaves of a candidate: another behaviour of a like period, maybe."""
    period, whole = one.candidate.period, one.candidate.stop - one.candidate.start
    if one.candidate.turns is not None:
        return
    first = one.candidate.start
    free = np.ones(whole, bool)
    for start, stop in one.runs:
        free[max(0, int(start) - first) : max(0, int(np.ceil(stop)) - first)] = False
    for start, stop in Spans.of_mask(free).moved(first):
        if PREDICTABILITY.periods * period <= stop - start <= whole - period:
            yield replace(one.candidate, start=start, stop=stop)


def _predicted_from(
    body: Body, found: Sequence[tuple[int, Candidate]]
) -> list[tuple[int, Predicted]]:
    going = []
    for place, candidate in found:
        stretch = _stretch(body.axes_of(candidate.group), candidate)
        if len(stretch.values[stretch.core]) >= ALIGNMENT.samples:
            going.append((place, candidate, stretch))
    aligned = iter(align_all([stretch for _, one, stretch in going if one.turns is None]))
    laid = [
        (place, one, stretch, next(aligned) if one.turns is None else laid_out(stretch, one.turns))
        for place, one, stretch in going
    ]
    return [
        (place, _predicted(body, one, stretch, own))
        for place, one, stretch, own in laid
        if own is not None
    ]


def _stretch(signal: Array, candidate: Candidate) -> Stretch:
    """Sample a candidate and what lies around it at 32 samples a period."""
    period = candidate.period
    first = max(0.0, candidate.start - PREDICTION.beyond * period)
    last = min(float(len(signal)), np.ceil(candidate.stop + PREDICTION.beyond * period))
    step = period / ALIGNMENT.samples
    where = np.arange(first, last - ROUNDING, step)
    if step > PREDICTION.coarse:
        # An average over the step, so that nothing faster is mistaken for something slower.
        width = round(step)
        begin = np.clip(np.round(where - width / 2).astype(np.intp), 0, len(signal) - width)
        own = signal[begin[0] : begin[-1] + width]
        sums = np.concatenate([np.zeros((1, signal.shape[1])), np.cumsum(own, axis=0)])
        begin -= begin[0]
        values = (sums[begin + width] - sums[begin]) / width
    else:
        values = taken_at(signal, where)
    inside = np.flatnonzero((where >= candidate.start) & (where < candidate.stop))
    core = slice(int(inside[0]), int(inside[-1]) + 1) if len(inside) else slice(0, 0)
    return Stretch(values, first, step, core, PREDICTABILITY.least**2)


def _predicted(body: Body, candidate: Candidate, stretch: Stretch, aligned: Aligned) -> Predicted:
    own = stretch.values
    values = taken_at(own, (aligned.times - stretch.first) / stretch.step)
    left = _left_out(values, [slice(None)])
    explained, each = left.scores([0])
    inside = np.concatenate([own[run] for run in aligned.runs.slices()])
    centred = inside - inside.mean(axis=0)
    steps = np.concatenate([np.diff(own[run], axis=0) for run in aligned.runs.slices()])
    change = float(np.sum(np.mean(steps**2, axis=0))) if len(steps) else 0.0
    scale = microscale(float(np.sum(np.var(inside, axis=0))), change)
    slowness = max(scale / ALIGNMENT.samples, PREDICTION.certain)
    turns = [aligned.phase[b - 1] - aligned.phase[a] for a, b in aligned.runs]
    ends = [
        (stretch.first + stretch.step * a, stretch.first + stretch.step * b)
        for a, b in aligned.runs
    ]
    taken = taken_at(body.signals, aligned.times)
    limbs, amplitudes, limb_each = _by_limb(body, taken, _limbs_left_out(body, taken))
    return Predicted(
        candidate,
        aligned.times,
        tuple(ends),
        stretch.step * _return_time(aligned),
        float(sum(turns)),
        left.seen,
        left.again,
        explained,
        each,
        left.again * dimension(centred.T @ centred) / (np.pi * slowness),
        slowness,
        limbs,
        amplitudes,
        limb_each,
        _repeating(limbs, amplitudes),
    )


def _repeating(limbs: Array, amplitudes: Array) -> NDArray[np.bool_]:
    return (limbs >= PREDICTION.repeats) & (amplitudes >= PREDICTABILITY.least)


@dataclass(frozen=True, eq=False)
class _LeftOut:
    """What the other repetitions leave of each at the same phase, part by part of the signals.

    Attributes
    ----------
    seen : float
        Periods that could be predicted.
    again : float
        Periods seen again.
    error, spread : (P, R) ndarray
        Squared differences of every part in every repetition from the mean of the others, and
        from that of all.
    floor : (R,) ndarray
        Those that count as none.
    """

    seen: float
    again: float
    error: Array
    spread: Array
    floor: Array

    def scores(self, parts: Sequence[int]) -> tuple[float, Array]:
        """Return R^2 of some parts together, and of every repetition (R,).

        It is -1 if nothing could be predicted, and then 0 of each.
        """
        if not self.seen:
            return -1.0, np.zeros(len(self.floor))
        rows = list(parts)
        error, spread = (own[rows].sum(axis=0) + self.floor for own in (self.error, self.spread))
        total = max(float(spread.sum()), TINY)
        return 1.0 - float(error.sum()) / total, 1.0 - error / np.maximum(spread, TINY)


def _left_out(values: Array, parts: Sequence[slice]) -> _LeftOut:
    """Predict every repetition by the mean of the others at the same phase.

    Parameters
    ----------
    values : (R, 48, d) ndarray
        NaN where a repetition does not pass a phase.
    parts : sequence of slice
        Columns.
    """
    passed = np.isfinite(values[:, :, 0])
    x = np.where(passed[:, :, None], values, 0.0)
    count = passed.sum(axis=0)
    used = passed & (count >= 2)
    others = (x.sum(axis=0) - x) / np.maximum(count - 1, 1)[:, None]
    mean = np.sum(x * used[:, :, None], axis=(0, 1)) / max(used.sum(), 1)
    error, spread = (
        np.array([np.sum(np.sum(apart[:, :, own], axis=2) * used, axis=1) for own in parts])
        for apart in ((x - others) ** 2, (x - mean) ** 2)
    )
    again = float(np.maximum(count - 1, 0).sum() / ALIGNMENT.grid)
    floor = PREDICTABILITY.least**2 * used.sum(axis=1)
    return _LeftOut(float(used.sum() / ALIGNMENT.grid), again, error, spread, floor)


def _limbs_left_out(body: Body, values: Array) -> _LeftOut:
    return _left_out(values, [slice(*limb.columns) for limb in body.limbs])


def _by_limb(body: Body, values: Array, left: _LeftOut) -> tuple[Array, Array, Array]:
    """Return R^2 (L,), amplitude (L,) and R^2 of every repetition (L, R) of every limb."""
    explained, each = zip(*(left.scores([place]) for place in range(len(body.limbs))), strict=True)
    power = np.var(values[np.isfinite(values[:, :, 0])], axis=0)
    amplitudes = [np.sqrt(np.nansum(power[slice(*limb.columns)])) for limb in body.limbs]
    return np.array(explained), np.array(amplitudes), np.array(each)


def dimension(covariance: Array) -> float:
    """Return the participation ratio of the variances of signals along principal axes.

    Parameters
    ----------
    covariance : (d, d) ndarray
        Of the signals, at any scale.
    """
    return float(np.trace(covariance) ** 2 / max(float(np.sum(covariance**2)), SMALLEST))


def microscale(variance: float, change: float) -> float:
    """Return sigma / sigma' (Taylor's microscale) of signals, in samples.

    Parameters
    ----------
    variance, change : float
        Their variance, and the mean square of their change from sample to sample.
    """
    return float(np.sqrt(variance / max(change, SMALLEST)))


def _return_time(aligned: Aligned) -> float:
    """Return the median time in which the phase gains a turn, in samples of the stretch."""
    try:
        return return_period(aligned.phase, aligned.runs)
    except TooShort:
        turns = sum(aligned.phase[b - 1] - aligned.phase[a] for a, b in aligned.runs)
        return float(aligned.runs.total / max(turns, ROUNDING))


def within(body: Body, one: Predicted, runs: Sequence[tuple[float, float]]) -> Predicted | None:
    """Measure the same within some of its samples only; None if no repetition is left."""
    times, inside = one.times, np.zeros(one.times.shape, bool)
    for start, stop in runs:
        inside |= (times >= start - 0.5) & (times <= stop + 0.5)
    times = np.where(inside, times, np.nan)
    times = times[np.isfinite(times).sum(axis=1) >= ALIGNMENT.fewest]
    if not len(times):
        return None
    members = body.groups()[one.candidate.group]
    values = taken_at(body.signals, times)
    left = _limbs_left_out(body, values)
    explained, each = left.scores(members)
    limbs, amplitudes, limb_each = _by_limb(body, values, left)
    return replace(
        one,
        times=times,
        runs=tuple(runs),
        repetitions=float(np.isfinite(times).sum() / ALIGNMENT.grid),
        seen=left.seen,
        again=left.again,
        explained=explained,
        each=each,
        numbers=one.numbers * left.again / max(one.again, ROUNDING),
        limbs=limbs,
        amplitudes=amplitudes,
        limb_each=limb_each,
        claimed=one.claimed & _repeating(limbs, amplitudes),
    )
