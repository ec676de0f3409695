"""Steps and strides of made walks whose moments are known."""

from __future__ import annotations

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.gait.spread import mean_interval, spread_of

FEW = rl.StrideOptions(resamples=100)


@pytest.fixture(scope="module")
def walk() -> synth.Stepped:
    return synth.steps(7, rng=4)


@pytest.fixture(scope="module")
def told(walk) -> rl.Strides:
    return rl.strides(walk.motion, FEW)


def errors(found: rl.Strides, made: synth.Stepped) -> np.ndarray:
    """Frames by which the nearest moment is off, of each true one."""
    off = []
    for kind, truth in (("strike", made.strikes), ("off", made.offs)):
        for foot, frames in truth.items():
            times = np.array(found.times(foot, kind)) * found.fps
            off += [float(np.abs(times - frame).min()) for frame in frames]
    return np.array(off)


@pytest.mark.parametrize(
    "how", [{}, {"treadmill": True}, {"backward": True}, {"treadmill": True, "backward": True}]
)
def test_moments_are_those_of_the_walk(how):
    made = synth.steps(6, rng=2, **how)
    found = rl.strides(made.motion, FEW)
    assert found.rule == "velocity"
    assert (found.ground == "belt") is how.get("treadmill", False)
    assert found.backward is how.get("backward", False)
    assert errors(found, made).max() < 2.0
    assert len(found.events) == sum(map(len, (*made.strikes.values(), *made.offs.values())))


def test_the_table_holds_what_was_walked(walk, told):
    for foot in ("left", "right"):
        times = np.diff(walk.strikes[foot]) / walk.motion.fps
        own = [stride.time for stride in told.strides if stride.foot == foot]
        assert np.abs(np.array(own) - times).max() < 0.01
        summary = told.summary[foot]
        assert summary["time"].mean == pytest.approx(times.mean(), rel=0.002)
        assert summary["speed"].mean == pytest.approx(1.1, rel=0.02)
        assert summary["width"].mean == pytest.approx(0.18, abs=0.01)
        assert summary["stance_share"].mean == pytest.approx(0.62, abs=0.02)
        assert summary["time"].low < summary["time"].mean < summary["time"].high
    assert told.unit == "m"
    assert told.notes == ()


def test_a_belt_has_the_lengths_of_the_ground(told):
    belt = rl.strides(synth.steps(7, rng=4, treadmill=True).motion, FEW)
    for one, other in zip(belt.strides, told.strides, strict=True):
        assert one.length == pytest.approx(other.length, abs=0.02)


def test_units_and_axes_do_not_matter(walk, told):
    large = rl.strides(walk.motion.scaled(100.0), FEW)
    assert large.unit == "m"
    assert large.strides[0].length == pytest.approx(told.strides[0].length, rel=1e-6)


def test_markers_tell_steps_too(walk):
    points = synth.as_points(walk.motion)
    feet = {"LeftFoot": "LANK", "RightFoot": "RANK"}
    named = replace(points, names=tuple(feet.get(name, name) for name in points.names))
    found = rl.strides(named, FEW)
    assert found.feet == ("left", "right")
    times = np.diff(walk.strikes["left"]) / 120
    own = [stride.time for stride in found.strides if stride.foot == "left"]
    assert np.abs(np.array(own) - times).max() < 0.02


def test_four_feet():
    found = rl.strides(synth.gait("trot", repetitions=6).motion, FEW)
    assert set(found.feet) == {"left hind", "right hind", "left fore", "right fore"}
    for foot in found.feet:
        assert found.summary[foot]["time"].mean == pytest.approx(0.6, rel=0.01)
    # Feet across each other come down together.
    one, other = (found.times(foot, "strike") for foot in ("left hind", "right fore"))
    assert abs(one[2] - min(other, key=lambda x: abs(x - one[2]))) < 0.1


def test_jumps_in_place_are_told_by_contacts():
    found = rl.strides(synth.gait("jacks", repetitions=6).motion, FEW)
    assert found.rule == "contacts"
    assert "left and right come down together: jumps, not steps" in found.notes


def test_strides_outside_of_gait_only_when_asked():
    walk = synth.gait("walk", repetitions=5, fps=60)
    both = synth.sequence(walk, synth.wander(4.0, fps=60)).motion
    found = rl.strides(both, FEW)
    assert max(one.frame for one in found.events) < len(walk.motion) + 60
    with pytest.raises(rl.NoPeriod, match=r"no gait found: .*--everywhere"):
        rl.strides(synth.wander(4.0, fps=60).motion, FEW)
    rl.strides(walk.motion, replace(FEW, everywhere=True))


def test_bad_input_is_told_in_a_sentence(walk):
    bones = walk.motion.skeleton
    names = tuple(name.replace("Left", "Port") for name in bones.names)
    with pytest.raises(rl.SkeletonMismatch, match="expected a left and a right foot"):
        rl.strides(replace(walk.motion, skeleton=replace(bones, names=names)))
    with pytest.raises(rl.TooShort, match="expected 8 frames"):
        rl.strides(walk.motion[:5])
    still = replace(walk.motion, rotations=np.tile(walk.motion.rotations[:1], (300, 1, 1)),
                    root_path=np.tile(walk.motion.root_path[:1], (300, 1)))  # fmt: skip
    with pytest.raises(rl.NoPeriod, match="no foot comes down"):
        rl.strides(still, replace(FEW, everywhere=True))
    with pytest.raises(TypeError, match="expected a StrideOptions"):
        rl.strides(walk.motion, "zeni")


def test_a_wheel_is_no_heel(walk):
    points = synth.as_points(walk.motion)
    names = {"LeftFoot": "WheelL", "RightFoot": "WheelR"}
    wheeled = replace(points, names=tuple(names.get(name, name) for name in points.names))
    with pytest.raises(rl.SkeletonMismatch, match="expected a left and a right foot"):
        rl.strides(wheeled)


def test_one_stride_has_no_spread():
    walk = synth.steps(3, rng=1).motion[:230]
    found = rl.strides(walk, replace(FEW, everywhere=True))
    (foot,) = {one.foot for one in found.strides} - {
        foot for foot in found.feet if found.summary[foot]["time"].count != 1
    } or {None}
    assert foot is not None
    assert any("one stride, no spread" in note for note in found.notes)
    assert found.to_dict()["summary"][foot]["time"]["sd"] is None


@pytest.mark.filterwarnings("ignore::roundelay.base.errors.GapsFilled")
def test_a_marker_that_is_hardly_seen_is_told(walk):
    points = synth.as_points(walk.motion)
    missing = np.zeros(points.positions.shape[:2], bool)
    place = points.names.index("LeftFoot")
    for start in range(0, len(points), 40):
        missing[start : start + 24, place] = True
    found = rl.strides(replace(points, missing=missing), replace(FEW, everywhere=True))
    assert any("LeftFoot missing in" in note for note in found.notes)


def test_plain_data_and_table(told):
    data = json.loads(json.dumps(told.to_dict(), allow_nan=False))
    rows = list(csv.DictReader(told.to_csv().splitlines()))
    assert len(rows) == len(data["strides"]) == len(told.strides)
    assert float(rows[0]["time"]) == pytest.approx(told.strides[0].time, abs=1e-4)
    assert data["events"][0]["seconds"] == pytest.approx(data["events"][0]["frame"] / 120)


def test_the_bootstrap_is_seeded(walk, told):
    again = rl.strides(walk.motion, FEW, rng=np.random.default_rng(0))
    other = rl.strides(walk.motion, FEW, rng=7)
    assert again.to_dict() == told.to_dict()
    assert other.to_dict()["summary"] != told.to_dict()["summary"]


def test_spread_of_few():
    nothing = spread_of(np.array([np.nan]), level=0.95, resamples=100)
    assert nothing.count == 0
    assert np.isnan(nothing.mean)
    one = spread_of(np.array([2.0, np.nan]), level=0.95, resamples=100)
    assert (one.count, one.mean) == (1, 2.0)
    assert np.isnan(one.sd)
    same = spread_of(np.full(9, 1.1), level=0.95, resamples=100)
    assert same.low == pytest.approx(same.high)


def test_intervals_hold_the_mean_about_as_often_as_they_say():
    draw, held = np.random.default_rng(5), 0
    for _ in range(200):
        values = draw.normal(size=21)
        values = values[1:] + 0.4 * values[:-1]
        low, high = mean_interval(values, level=0.9, resamples=200, rng=draw)
        held += low < 0.0 < high
    assert 0.83 < held / 200 < 0.96
