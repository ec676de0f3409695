"""Curves of two groups along the phase, and where they differ."""

import json

import numpy as np
import pytest
from scipy import stats
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.cli import app


def smooth(draw, count, phases=60):
    kernel = np.exp(-0.5 * (np.arange(-12, 13) / 4) ** 2)
    rows = draw.normal(size=(count, phases + 24))
    return np.array([np.convolve(row, kernel / np.linalg.norm(kernel), "valid") for row in rows])


BUMP = np.exp(-0.5 * ((np.arange(60) - 30) / 4) ** 2)


def test_t_is_that_of_the_textbook():
    draw = np.random.default_rng(0)
    one, other = smooth(draw, 6), smooth(draw, 9)
    found = rl.compare_curves(one, other)
    assert np.allclose(found.t[0], stats.ttest_ind(one, other).statistic)
    assert np.allclose(found.difference[0], one.mean(axis=0) - other.mean(axis=0))
    assert found.count == 5000  # 5005 there are, so 5000 are drawn


def test_a_difference_is_found_where_it_is():
    draw = np.random.default_rng(1)
    found = rl.compare_curves(smooth(draw, 10) + 4.0 * BUMP, smooth(draw, 10))
    assert found.p[0] < 0.01
    ((start, stop),) = found.differing("curve")
    assert start < 0.5 < stop
    assert start > 0.3
    assert stop < 0.7
    inside = (found.phase >= start) & (found.phase < stop)
    assert np.all(found.low[0][inside] > 0.0)


def test_chance_is_told_as_often_as_the_level_says():
    draw, told = np.random.default_rng(2), 0
    options = rl.CompareOptions(permutations=200, level=0.9)
    for _ in range(200):
        curves = smooth(draw, 14).reshape(14, 2, 30)
        found = rl.compare_curves(curves[:7], curves[7:], options, names=("a", "b"), rng=draw)
        told += bool(found.p.min() <= 0.1)
    assert 8 <= told <= 34


def test_few_permutations_are_all_tried_and_told():
    draw = np.random.default_rng(3)
    found = rl.compare_curves(smooth(draw, 3) + 100.0, smooth(draw, 3))
    assert found.count == 20
    assert found.p[0] == pytest.approx(2 / 20)  # itself, and the groups exchanged
    assert not found.notes
    few = rl.compare_curves(smooth(draw, 2), smooth(draw, 3))
    assert few.notes == (
        "2 and 3 repetitions: their 10 permutations are too few for a level of 0.95",
    )


def test_curves_all_alike_do_not_differ():
    found = rl.compare_curves(np.ones((4, 10)), np.ones((5, 10)))
    assert found.p[0] == 1.0
    assert found.differing("curve") == []


def test_what_does_not_go_together_is_refused():
    curves = np.zeros((4, 10))
    with pytest.raises(ValueError, match=r"expected curves of one shape, found \(4, 1, 10\) and"):
        rl.compare_curves(curves, np.zeros((4, 9)))
    with pytest.raises(rl.TooShort, match="expected two repetitions or more of second, found 1"):
        rl.compare_curves(curves, curves[:1])
    with pytest.raises(ValueError, match="expected finite curves"):
        rl.compare_curves(curves, curves * np.nan)
    with pytest.raises(ValueError, match="expected a curve among curve, found 'knee'"):
        rl.compare_curves(curves, curves).differing("knee")


def recording(seed, **choices):
    made = synth.varied(8, rng=seed, **choices)
    cycle = rl.find_cycles(made.motion)[0]
    return cycle, made.motion, rl.repetitions(cycle, made.motion)


def test_two_persons_differ_and_one_does_not_from_itself():
    _, _, one = recording(1)
    _, _, other = recording(2)
    joints = ["LeftLeg", "RightLeg"]
    far = rl.compare_repetitions(one, other, joints=joints)
    assert far.names == tuple(joints)
    assert far.p.max() < 0.05
    near = rl.compare_repetitions(one, one, joints=joints)
    assert near.p.min() > 0.9
    assert far.to_csv().count("\n") == 1 + 2 * len(far.phase)


def test_left_and_right_of_a_body():
    cycle, motion, _ = recording(1)
    found = rl.compare_sides(cycle, motion)
    assert not found.movement
    row = {row["name"]: row for row in found.rows()}
    # One way in which repetitions differ lifts both arms, and bends the left one alone.
    assert abs(row["LeftLeg"]["largest_difference"]) < 8.0
    both = synth.gait("walk", repetitions=6, rng=4, fps=60.0).motion
    cycle = rl.find_cycles(both)[0]
    same = rl.compare_sides(cycle, both)
    assert set(same.names) <= {name for name in both.skeleton.names if "Left" in name}


def test_other_bodies_are_refused():
    _, _, one = recording(1)
    dog = synth.gait("trot", repetitions=5).motion
    other = rl.repetitions(rl.find_cycles(dog)[0], dog)
    with pytest.raises(rl.SkeletonMismatch, match="joints only in the first"):
        rl.compare_repetitions(one, other)
    with pytest.raises(rl.SkeletonMismatch, match="no joint 'Knee'"):
        rl.compare_repetitions(one, one, joints=["Knee"])


def test_the_command_writes_table_record_and_picture(tmp_path):
    for seed in (1, 2):
        rl.write(synth.varied(6, rng=seed).motion, tmp_path / f"take{seed}.bvh")
    one, other = (str(tmp_path / f"take{seed}.bvh") for seed in (1, 2))
    out = ["-o", str(tmp_path / "out")]
    result = CliRunner().invoke(app, ["compare", one, other, *out])
    assert result.exit_code == 0, result.output
    assert "LeftLeg" in result.output
    record = json.loads((tmp_path / "out" / "take1_compared.json").read_text())
    assert record["labels"] == ["take1", "take2"]
    assert (tmp_path / "out" / "take1_compared.csv").stat().st_size > 1000
    assert (tmp_path / "out" / "take1_compared.png").stat().st_size > 5000
    result = CliRunner().invoke(app, ["compare", one, "--no-picture", *out])
    assert result.exit_code == 0, result.output
    assert result.output.startswith("left (")
