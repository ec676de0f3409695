"""Gestures that recur with something else between."""

from __future__ import annotations

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.excitation import Region
from roundelay.gestures import find_gestures, gesture_runs


@pytest.fixture(scope="module")
def made() -> synth.Synthetic:
    """A jumping jack now and again, each time with other things between."""
    jack = synth.gait("jacks", repetitions=1.1, fps=60)
    between = [synth.wander(1.5, fps=60, seed=seed) for seed in range(3)]
    return synth.sequence(between[0], jack, between[1], jack, between[2], jack)


def test_a_gesture_is_found_wherever_it_recurs(made):
    cycle = find_gestures(made.motion)[0]
    assert cycle.period == pytest.approx(1.2, rel=0.15)
    edges = [0, *made.cuts, len(made.motion)]
    shown = list(zip(edges[1::2], edges[2::2], strict=False))
    assert cycle.evidence is not None
    assert len(cycle.evidence.runs) == 3
    for run, (start, stop) in zip(cycle.evidence.runs, shown, strict=True):
        assert abs(run[0] - start) < 30
        assert abs(run[1] - stop) < 30


def test_wandering_holds_no_gesture():
    with pytest.raises(rl.NoPeriod, match="no gesture recurs"):
        find_gestures(synth.wander(20, seed=3).motion)


def test_regions_without_a_gap_are_one(made):
    class Excited:
        regions = (
            Region(0, 100, 1.0, 1.0),
            Region(110, 210, 0.9, 1.0),
            Region(250, 300, 0.4, 0.4),
            Region(400, 500, 1.0, 1.2),
        )

    runs = gesture_runs(Excited(), 505)
    assert runs == [(0, 220), (390, 505)]
    assert np.all(np.diff(runs) > 0)
