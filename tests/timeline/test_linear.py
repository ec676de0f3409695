"""What makes the timeline linear in frames: blocks and shares that change nothing."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest

from roundelay import synth
from roundelay.base.numeric import SIX_DIGITS
from roundelay.base.spans import Spans
from roundelay.timeline import limbs
from roundelay.timeline.account import _best_path, _Gain
from roundelay.timeline.agreement import best_lag, margins
from roundelay.timeline.limbs import Body, body_of
from roundelay.timeline.prediction import Predicted, dimension, predict_all, predict_each
from roundelay.timeline.proposals import recurrence
from roundelay.timeline.proposals.paths import best_paths
from roundelay.timeline.proposals.recurrence import Recurrence
from roundelay.timeline.tempo import _medians, refined
from roundelay.timeline.thresholds import ACCOUNT, PREDICTABILITY


@pytest.fixture(scope="module")
def body() -> Body:
    made = synth.sequence(
        synth.gait("walk", repetitions=6, period=1.2, fps=30.0, seed=1),
        synth.gait("run", repetitions=6, period=0.7, fps=30.0, seed=2),
        synth.gait("jacks", repetitions=5, period=1.0, fps=30.0, seed=3),
    )
    return body_of(made.motion)


@pytest.fixture(scope="module")
def walk(body) -> Predicted:
    """The part of it that ends first."""
    found = [one for one in predict_all(body, Recurrence().propose(body)) if one.claimed.any()]
    return min(found, key=lambda one: one.runs[-1][1])


def test_joints_are_placed_alike_in_blocks(body, monkeypatch):
    motion = synth.gait("walk", repetitions=3, fps=30.0, seed=1).motion
    whole = body_of(motion)
    monkeypatch.setattr(limbs, "_BLOCK", 1000)
    parts = body_of(motion)
    assert np.array_equal(parts.signals, whole.signals)
    assert np.array_equal(parts.seen, whole.seen)


def test_frames_far_away_do_not_matter_to_a_period(body, walk):
    last = int(np.ceil(walk.runs[-1][1]))
    assert last < 0.7 * len(body)
    seen = body.seen.copy()
    seen[last:] = np.random.default_rng(1).normal(size=seen[last:].shape)
    elsewhere = replace(body, seen=seen)
    assert refined(elsewhere, walk).period == refined(body, walk).period
    assert refined(elsewhere, walk).agrees == refined(body, walk).agrees > 0.9


def test_a_run_is_seen_from_its_first_frame_to_its_last(body, walk):
    first, second = body.seen_of(walk.claimed, [(0.0, 9.5), (20.2, 30.0)])
    joints = body.joints(walk.claimed)
    assert np.array_equal(first, body.seen[:10, joints].reshape(10, -1))
    assert np.array_equal(second, body.seen[20:30, joints].reshape(10, -1))


def test_figures_of_the_take_are_those_of_some_limbs(body, walk):
    own = body.signals[:, body.columns_of(walk.claimed)]
    columns = body.columns_of(walk.claimed)
    assert np.allclose(body.covariance[np.ix_(columns, columns)], np.cov(own.T, bias=True))
    assert np.allclose(body.changes[columns], np.mean(np.diff(own, axis=0) ** 2, axis=0))
    assert dimension(np.diag([1.0, 1.0, 0.0])) == pytest.approx(2.0)


def test_candidates_together_are_as_one_by_one(body):
    found = Recurrence().propose(body)[:6]
    together = predict_each(body, found)
    for candidate, own in zip(found, together, strict=True):
        alone = predict_all(body, [candidate])
        assert [one.runs for one in own] == [one.runs for one in alone]
        assert [one.nats for one in own] == [one.nats for one in alone]
    assert sum(map(len, together)) == len(predict_all(body, found))


def test_blocks_of_hops_propose_the_same(body, monkeypatch):
    whole = Recurrence().propose(body)
    monkeypatch.setattr(recurrence, "_BLOCK", 40_000)
    parts = Recurrence().propose(body)
    assert [(c.group, c.start, c.stop, c.period) for c in parts] == [
        (c.group, c.start, c.stop, c.period) for c in whole
    ]


@pytest.mark.parametrize("size", [1, 7, 50, 400])
def test_paths_do_not_depend_on_blocks(size):
    rng = np.random.default_rng(2)
    lags = 0.2 * 2.0 ** (np.arange(30) / 10)
    hidden = np.cumsum(rng.integers(-1, 2, size=(400, 2)), axis=0) % 30
    values = rng.normal(0.2, 0.2, size=(400, 2, 30)).astype(np.float32)
    np.put_along_axis(values, hidden[:, :, None], np.float32(0.95), axis=2)
    values[150:200] = -1.0
    whole, clear = best_paths([values], lags)
    assert (whole[:, 150:200] < 0).all()
    assert (whole == hidden.T).mean() > 0.5
    blocks = [values[start : start + size] for start in range(0, 400, size)]
    paths, own = best_paths(blocks, lags)
    assert np.array_equal(paths, whole)
    assert np.array_equal(own, clear)


def test_the_path_is_the_best_of_all():
    rng, lags = np.random.default_rng(3), np.array([0.3, 0.5, 0.8, 1.3])
    least = PREDICTABILITY.explained + PREDICTABILITY.longer * np.log2(lags / lags[0])
    for _ in range(20):
        values = rng.uniform(-1.0, 3.0, size=(5, 1, 4)).astype(np.float32)
        gain = (values[:, 0] - least) * np.sqrt(PREDICTABILITY.hop / lags)
        (path,), _ = best_paths([values], lags)
        best = max(_worth(list(way), gain) for way in product(range(-1, 4), repeat=5))
        assert _worth(path.tolist(), gain) == pytest.approx(best)


def _worth(way: list[int], gain: np.ndarray) -> float:
    switch = PREDICTABILITY.switch
    total = sum(gain[hop, lag] for hop, lag in enumerate(way) if lag >= 0)
    for before, after in pairwise(way):
        if before < 0 or after < 0:
            total -= switch if before != after else 0.0
        else:
            near = abs(after - before) <= PREDICTABILITY.reach
            wobble = PREDICTABILITY.wobble * abs(after - before)
            total -= wobble if near else PREDICTABILITY.other * switch
    return total


def test_the_account_compares_only_what_goes_on():
    rng, samples = np.random.default_rng(4), 300
    for _ in range(10):
        gains = []
        for _ in range(8):
            start, length = rng.integers(0, 250), rng.integers(1, 120)
            values = np.repeat(rng.uniform(-0.5, 1.0, size=length), 9)[: samples - start]
            gains.append(_Gain(int(start), values))
        assert _best_path(gains, samples) == _compared_everywhere(gains, samples)


def _compared_everywhere(gains: list[_Gain], samples: int) -> list[list[tuple[int, int]]]:
    """Viterbi's path over all candidates at every sample, -1 where they are not."""
    gain = np.full((samples, len(gains) + 1), -1.0)
    gain[:, -1] = SIX_DIGITS
    for place, one in enumerate(gains):
        gain[one.start : one.stop, place] = one.values
    total = gain[0] - ACCOUNT.change
    total[-1] = 0.0
    back = np.zeros(gain.shape, int)
    for t in range(1, samples):
        top = int(total.argmax())
        change = total[top] - ACCOUNT.change
        back[t] = np.where(total >= change, np.arange(len(total)), top)
        best = np.maximum(total, change)
        if total[top] > best[-1]:
            best[-1], back[t, -1] = total[top], top
        total = best + gain[t]
    path = [int(total.argmax())]
    for t in range(samples - 1, 0, -1):
        path.append(int(back[t, path[-1]]))
    shown = np.array(path[::-1])
    return [list(Spans.of_mask(shown == place)) for place in range(len(gains))]


def test_a_candidate_far_away_changes_no_account():
    first, far = _Gain(10, np.full(40, 0.5)), _Gain(900, np.full(50, 2.0))
    assert _best_path([first], 1000) == [[(10, 50)]]
    assert _best_path([first, far], 1000) == [[(10, 50)], [(900, 950)]]


def test_the_best_lag_is_that_of_plain_correlation():
    rng, time = np.random.default_rng(5), np.arange(200)
    wave = np.column_stack([np.sin(time / 3.7), np.cos(time / 3.7), np.sin(2 * time / 3.7)])
    runs = [wave[:120] + 0.1 * rng.normal(size=(120, 3)), wave[130:] + 3.0]
    lag, agrees = best_lag(runs, 23.0)
    assert lag == pytest.approx(2 * np.pi * 3.7, rel=0.02)
    assert agrees == pytest.approx(_correlation(runs, lag))
    assert margins(runs, lag)[0] == pytest.approx(agrees)


def _correlation(runs: list[np.ndarray], lag: float) -> float:
    now, later = [], []
    for run in runs:
        centred, count = run - run.mean(axis=0), len(run) - int(np.ceil(lag))
        where = np.arange(count) + lag
        now.append(centred[:count])
        every = np.arange(len(run))
        later.append(np.column_stack([np.interp(where, every, x) for x in centred.T]))
    first, second = np.concatenate(now).ravel(), np.concatenate(later).ravel()
    return float(first @ second / np.sqrt((first @ first) * (second @ second)))


def test_medians_at_once_are_those_one_by_one():
    values = np.random.default_rng(6).normal(size=101)
    expected = [np.median(values[max(0, i - 12) : i + 13]) for i in range(0, 101, 6)]
    assert _medians(values, 12).tolist() == expected
