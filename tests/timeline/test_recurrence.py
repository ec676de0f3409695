"""Stretches in which a period predicts the next."""

from __future__ import annotations

import pytest

import roundelay as rl
from roundelay import synth
from roundelay.base.spans import Spans
from roundelay.timeline.limbs import body_of
from roundelay.timeline.proposals.recurrence import Recurrence


@pytest.mark.parametrize("kind", ["walk", "run", "jacks", "punch", "spin"])
@pytest.mark.parametrize("repetitions", [1.4, 3.0, 6.0])
def test_a_gait_is_proposed_with_its_period(kind, repetitions):
    made = synth.gait(kind, repetitions=repetitions)
    body = body_of(made.motion)
    first = Recurrence().propose(body)[0]
    assert first.period / body.rate == pytest.approx(made.period, rel=0.05)
    assert first.stop - first.start >= 0.9 * len(body)


def test_standing_still_proposes_nothing():
    walk = synth.gait("walk", repetitions=2).motion
    still = rl.concatenate([walk[3:4]] * 200)
    assert Recurrence().propose(body_of(still)) == []


def test_two_tempos_are_two_candidates():
    slow, fast = (synth.gait("walk", repetitions=6, period=p, fps=30) for p in (1.3, 0.75))
    made = synth.sequence(slow, fast)
    body = body_of(made.motion)
    found = Recurrence().propose(body)
    for period, (start, stop) in zip((1.3, 0.75), Spans([(0, 234), (234, 369)]), strict=True):
        near = [c for c in found if abs(c.period / body.rate / period - 1.0) < 0.05]
        assert any(c.start < start + 20 and c.stop > stop - 20 for c in near)
