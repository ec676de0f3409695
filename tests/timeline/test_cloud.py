"""The cloud that topology sees, and every choice about it."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.base.spans import Spans
from roundelay.motion.features import point_cloud
from roundelay.timeline.cloud import PoseCloud, joined_in_time, make_cloud
from roundelay.timeline.search import Search


@pytest.fixture(scope="module")
def walk() -> rl.Motion:
    return synth.gait("walk", repetitions=3.2, noise=0.01).motion


def cloud_of(
    points: np.ndarray,
    runs: list[tuple[int, int]],
    period: float,
    step: int,
    topology: rl.TopologyOptions,
) -> PoseCloud:
    options = rl.Options(topology=topology)
    names = tuple(map(str, range(points.shape[1])))
    poses = rl.PoseArray(names, points[:, :, None], 60.0)
    search = Search(points, 60.0, step, options, poses)
    return make_cloud(search, Spans(runs), period)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"delay": 0.0},
        {"delay": 30.0},
        {"delays": 8},
        {"metric": "variance"},
        {"metric": "adjacent"},
        {"metric": "adjacent", "delays": 4},
        {"dimensions": 4},
        {"dimensions": 0.95},
        {"prime": 11},
        {"max_scale": 0.5},
    ],
)
def test_every_choice_finds_the_stride(walk, options):
    chosen = rl.Options(topology=rl.TopologyOptions(**options))
    cycle = rl.find_cycles(walk, chosen)[0]
    assert cycle.period == pytest.approx(1.1, rel=0.02)


def test_a_loop_played_over_and_over_is_periodic(walk):
    """At a steady beat, landmarks would show three of its 24 frames only."""
    loop = rl.find_cycles(walk)[0].sample(24 / 1.1, in_place=True)
    assert len(loop) == 24
    played = rl.concatenate([loop] * 166)
    cycle = rl.find_cycles(played)[0]
    assert cycle.period * played.fps == pytest.approx(24.0, rel=1e-3)
    assert cycle.evidence.net == pytest.approx(166.0, abs=0.2)


@pytest.mark.parametrize("weights", ["none", "length", "mass"])
@pytest.mark.parametrize(
    "features", ["positions", "heading", "quaternions", "angles", "configuration"]
)
def test_every_feature_and_weight_finds_the_stride(walk, features, weights):
    cycle = rl.find_cycles(walk, rl.Options(features=features, weights=weights))[0]
    # Differences from frame to frame, a second, bring the noise of both frames with them.
    near = 0.06 if features == "configuration" else 0.02
    assert cycle.period == pytest.approx(1.1, rel=near)


def test_velocity_keeps_passages_apart(walk):
    """A pendulum passes each pose twice a period: only its velocity tells which way."""
    angle = np.sin(2 * np.pi * np.arange(300) / 100)[:, None]
    still = cloud_of(angle, [(0, 300)], 100.0, 1, rl.TopologyOptions(delay=0.0))
    moving = cloud_of(angle, [(0, 300)], 100.0, 1, rl.TopologyOptions())
    assert np.max(still.barcode.persistence, initial=0.0) < 0.1
    assert moving.barcode.persistence[0] > 1.0


def test_adjacent_frames_are_at_distance_zero(walk):
    points = point_cloud(walk)
    options = rl.TopologyOptions(metric="adjacent")
    cloud = cloud_of(points, [(0, 150), (160, 300)], 130.0, 2, options)
    # All frames of a run merge at scale 0.
    assert np.count_nonzero(cloud.barcode.components == 0.0) >= len(cloud.frames) - 2


def test_joined_in_time_is_one_formula():
    """Against its words: 0 between neighbours in a run, elsewhere at least the median step."""
    points = np.random.default_rng(0).normal(size=(9, 2))
    apart = np.linalg.norm(points[:, None] - points, axis=-1).astype(np.float32)
    runs = [(0, 4), (4, 9)]
    near = [(i, i + 1) for start, stop in runs for i in range(start, stop - 1)]
    floor = np.median([apart[pair] for pair in near])
    found = joined_in_time(apart, runs)
    for i in range(9):
        for j in range(9):
            joined = i == j or (min(i, j), max(i, j)) in near
            assert found[i, j] == (0.0 if joined else max(apart[i, j], floor))


def test_delays_take_half_a_period_from_every_run(walk):
    points = point_cloud(walk)
    cloud = cloud_of(points, [(0, 200), (220, 400)], 132.0, 2, rl.TopologyOptions(delays=6))
    assert [b - a for a, b in cloud.local] == [100 - 33, 90 - 33]
    assert cloud.frames[-1] == 220 + 2 * (90 - 33 - 1)


def test_long_clouds_are_thinned_to_landmarks():
    made = synth.gait("walk", repetitions=14)
    points = point_cloud(made.motion)
    cloud = cloud_of(points, [(0, len(points))], 132.0, 2, rl.TopologyOptions())
    assert cloud.barcode.n_points <= 500 < len(cloud.frames)
    assert cloud.landmark_runs == ((0, cloud.barcode.n_points),)


def test_delays_are_those_of_following_frames():
    points = np.random.default_rng(0).normal(size=(60, 3))
    cloud = cloud_of(points, [(0, 20), (20, 26), (30, 60)], 12.0, 1, rl.TopologyOptions(delays=2))
    assert cloud.runs == ((0, 20), (30, 60))
    assert cloud.local == ((0, 14), (14, 38))
    for place, frame in [(0, 0), (13, 13), (14, 30), (37, 53)]:
        expected = points[[frame, frame + 3, frame + 6]].ravel() / np.sqrt(3)
        assert np.allclose(cloud.data[place], expected)
    with pytest.raises(rl.TooShort):
        cloud_of(points, [(0, 6)], 12.0, 1, rl.TopologyOptions(delays=2))


@pytest.mark.parametrize("options", [{"delays": 4}, {"metric": "adjacent"}])
def test_long_captures_fit_in_memory(options):
    turns = 2 * np.pi * np.arange(6000) / 97.3
    circle = np.column_stack([np.cos(turns), np.sin(turns)])
    tracemalloc.start()
    cloud = cloud_of(circle, [(0, 6000)], 97.3, 1, rl.TopologyOptions(**options))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(cloud.barcode) >= 1
    assert peak < 8 * 6000**2 / 4, "no distances of all frames"


@pytest.mark.parametrize(
    ("made", "options"),
    [
        (rl.Options, {"weights": "height"}),
        (rl.TopologyOptions, {"metric": "taxicab"}),
        (rl.TopologyOptions, {"delays": 0}),
        (rl.TopologyOptions, {"delay": -1.0}),
        (rl.TopologyOptions, {"dimensions": 2.5}),
        (rl.TopologyOptions, {"dimensions": 0}),
    ],
)
def test_unknown_choices_are_refused(made, options):
    with pytest.raises(ValueError, match=f"expected .*{next(iter(options))}"):
        made(**options)
