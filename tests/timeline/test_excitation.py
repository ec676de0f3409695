"""Excitation regions: each motion of a sequence turns a coordinate of its own."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.motion.features import point_cloud
from roundelay.timeline.proposals.excitation import excitations, regions_of


@pytest.fixture(scope="module")
def made() -> synth.Synthetic:
    """Three motions, one after the other."""
    return synth.sequence(
        synth.gait("walk", repetitions=3.2, fps=60),
        synth.gait("jacks", repetitions=3.2, fps=60),
        synth.gait("punch", repetitions=3.2, fps=60),
    )


@pytest.mark.parametrize("metric", ["euclidean", "variance"])
def test_every_motion_turns_a_coordinate_of_its_own(made, metric):
    motion = made.motion
    found = excitations(point_cloud(motion), motion.fps, metric=metric)
    edges = [0, *made.cuts, len(motion)]
    turned = np.zeros(3)
    for excited in found.classes:
        net = [excited.turns[b - 10] - excited.turns[a + 20] for a, b in pairwise(edges)]
        here = int(np.argmax(np.abs(net)))
        turned[here] = max(turned[here], abs(net[here]))
        assert np.all(np.diff([r.start for r in excited.regions]) > 0)
        assert all(0 <= r.start < r.stop <= len(motion) for r in excited.regions)
    assert np.all(turned > 2.3), turned


def test_significant_classes_come_least_p_value_first(made):
    found = excitations(point_cloud(made.motion), made.motion.fps)
    chances = [excited.p_value for excited in found.classes]
    assert chances == sorted(chances)
    assert chances[-1] <= 0.05
    assert len(excitations(point_cloud(made.motion), 60, classes=2).classes) == 2


def test_regions_hold_most_of_the_variation():
    turns = np.concatenate([np.zeros(200), np.linspace(0, 3, 300), np.full(400, 3.0)])
    turns = np.concatenate([turns, np.linspace(3, 4, 100), np.full(100, 4.0)])
    regions = regions_of(turns, 60.0)
    assert [round(region.net) for region in regions] == [3, 1]
    assert abs(regions[0].start - 200) < 30
    assert abs(regions[0].stop - 500) < 30
    assert regions_of(np.zeros(50), 60.0) == ()


def test_a_coordinate_is_followed_on_every_frame_of_a_long_capture():
    made = synth.gait("walk", repetitions=12, fps=120)
    found = excitations(point_cloud(made.motion), 120)
    best = found.classes[0]
    assert best.turns.shape == (len(made.motion),)
    assert best.turns[-1] - best.turns[0] == pytest.approx(12, abs=0.3)


def test_adjacent_frames_at_distance_zero_give_the_same_walk():
    motion = synth.gait("walk", repetitions=3, noise=0.02).motion
    best = excitations(point_cloud(motion), motion.fps, metric="adjacent").classes[0]
    assert best.turns[-1] - best.turns[0] == pytest.approx(3, abs=0.2)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"metric": "taxi"}, "expected a metric among"),
        ({"period": -1.0}, "period from 0"),
        ({"classes": 0}, "at least one class"),
    ],
)
def test_bad_options_are_refused(options, message):
    with pytest.raises(ValueError, match=message):
        excitations(np.zeros((10, 2)), 60, **options)


def test_too_few_frames_are_refused():
    with pytest.raises(rl.TooShort, match="at least 4 frames, found 3"):
        excitations(np.zeros((3, 2)), 60)


@pytest.mark.parametrize("metric", ["euclidean", "variance", "adjacent"])
def test_a_still_capture_has_no_shape(metric):
    with pytest.raises(ValueError, match="all 50 poses are equal"):
        excitations(np.ones((50, 3)), 60, metric=metric)
