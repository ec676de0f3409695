"""The search needs no skeleton: whatever has the attributes of `Poses` can be searched."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.motion.features import MotionPoses, point_cloud
from roundelay.motion.poses import PoseArray, Poses, point_indices, points_of


@pytest.fixture(scope="module")
def walk() -> rl.Motion:
    return synth.gait("walk", repetitions=4, period=1.1, fps=60.0, seed=2).motion


def plain(walk: rl.Motion, **others: object) -> PoseArray:
    """The walk as bare arrays."""
    shown = MotionPoses(walk)
    return PoseArray(shown.names, shown.values, shown.fps, **others)


def test_a_motion_shows_its_joints_without_the_root(walk):
    shown = MotionPoses(walk)
    assert isinstance(shown, Poses)
    assert shown.names == walk.skeleton.names[1:]
    assert np.array_equal(points_of(shown), point_cloud(walk))
    arms = {shown.names[point] for point in shown.groups["arms"]}
    assert "LeftForeArm" in arms
    assert "LeftLeg" not in arms
    assert "LeftLeg" in {shown.names[point] for point in shown.groups["legs"]}


def test_bare_arrays_give_what_their_motion_gives(walk):
    (here,), (there,) = rl.find_periodic(walk), rl.find_periodic(plain(walk))
    assert there.period == here.period
    assert there.runs == here.runs
    assert np.array_equal(there.turns, here.turns, equal_nan=True)


def test_anything_with_the_attributes_can_be_searched(walk):
    shown = MotionPoses(walk)
    legs = [name for name in shown.names if "Leg" in name or "Foot" in name]
    markers = SimpleNamespace(
        names=tuple(legs),
        values=shown.values[:, point_indices(shown, legs)],
        groups={},
        missing=None,
        fps=60.0,
        size=1.0,
    )
    assert rl.find_periodic(markers)[0].period / 60.0 == pytest.approx(1.1, rel=0.02)
    chosen = rl.Options(joints=tuple(legs[:2]))
    assert rl.find_periodic(markers, chosen)[0].period / 60.0 == pytest.approx(1.1, rel=0.02)
    with pytest.raises(rl.SkeletonMismatch, match="no point 'Tail'"):
        rl.find_periodic(markers, rl.Options(joints=("Tail",)))


def test_what_is_missing_is_bridged_and_never_read(walk):
    values = MotionPoses(walk).values.copy()
    missing = np.zeros(values.shape[:2], bool)
    missing[20:26, 4] = missing[:5, 7] = missing[:, 9] = True
    shown = plain(walk, missing=missing)
    holes = PoseArray(
        shown.names, np.where(missing[..., None], np.nan, values), 60.0, 1.0, {}, missing
    )
    points = points_of(holes)
    assert np.isfinite(points).all()
    assert points.shape[1] == 3 * (len(shown.names) - 1)
    assert np.array_equal(points, points_of(shown))
    four = points_of(holes, [4])
    assert np.allclose(np.diff(four[19:27], axis=0), (four[26] - four[19]) / 7)
    assert np.array_equal(points_of(holes, [7])[:5], np.repeat(values[5:6, 7], 5, axis=0))
    assert rl.find_periodic(holes)[0].period / 60.0 == pytest.approx(1.1, rel=0.02)
    with pytest.raises(rl.SkeletonMismatch):
        points_of(holes, [9])


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"names": ("a",)}, "expected values of shape"),
        ({"values": np.full((30, 2, 3), np.nan)}, "expected finite values"),
        ({"fps": 0.0}, "expected a positive frame rate"),
        ({"size": -1.0}, "expected a positive size"),
        ({"missing": np.zeros((30, 3), bool)}, "expected a mask of shape"),
    ],
)
def test_wrong_arrays_are_refused(wrong, message):
    sound = {"names": ("a", "b"), "values": np.zeros((30, 2, 3)), "fps": 30.0}
    with pytest.raises(ValueError, match=message):
        PoseArray(**(sound | wrong))


def test_an_array_may_be_given_as_lists(walk):
    shown = plain(walk)
    nothing = np.zeros(shown.values.shape[:2], bool)
    lists = PoseArray(shown.names, shown.values.tolist(), 60.0, missing=nothing.tolist())
    assert np.array_equal(points_of(lists), points_of(shown))
