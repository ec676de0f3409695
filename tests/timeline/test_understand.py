"""What a take shows, limb by limb: known motions, alone and mixed."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.cli import app
from roundelay.geometry import rotations as rot


def cyclic(motion: rl.Motion) -> list[rl.Behaviour]:
    return list(rl.understand(motion).cyclic)


@pytest.fixture(scope="module")
def walk() -> rl.Motion:
    return synth.gait("walk", repetitions=6, period=1.1, fps=30.0, seed=1).motion


@pytest.fixture(scope="module")
def taken(walk) -> rl.Timeline:
    return rl.understand(walk)


def test_a_walk_is_one_behaviour_of_all_limbs(walk, taken):
    (found,) = taken.behaviours
    assert found.kind == "cyclic"
    assert found.period == pytest.approx(1.1, rel=0.02)
    assert found.repetitions == pytest.approx(6.0, abs=0.2)
    assert found.spans == ((0, len(walk)),)
    assert {"left leg", "right leg", "left arm", "right arm"} <= set(found.limbs)
    assert {"LeftLeg", "RightForeArm"} <= set(found.joints)
    assert found.probability > 0.8
    assert np.allclose(found.tempo[:, 1], 1.1, rtol=0.05)
    assert all(test.passed for test in found.tests)


def test_walk_and_run_are_told_apart():
    made = synth.sequence(
        synth.gait("walk", repetitions=5, period=1.2, fps=60.0, seed=1),
        synth.gait("run", repetitions=6, period=0.8, fps=60.0, seed=1),
    )
    found = cyclic(made.motion)
    assert sorted(each.period for each in found) == pytest.approx([0.8, 1.2], rel=0.03)
    for each in found:
        start, stop = each.spans[0][0], each.spans[-1][1]
        cut = made.cuts[0]
        assert abs((stop if each.period > 1.0 else start) - cut) < 60


def test_limbs_may_repeat_by_themselves(walk):
    rng = np.random.default_rng(3)
    rotations = walk.rotations.copy()
    for joint, name in enumerate(walk.skeleton.names):
        if "Arm" in name or "Hand" in name:
            drive = np.cumsum(rng.normal(size=(len(walk), 3)), axis=0) * 0.05
            rotations[:, joint] = rot.from_rotation_vector(drive)
    found = cyclic(replace(walk, rotations=rotations))
    assert found[0].period == pytest.approx(1.1, rel=0.02)
    assert {"left leg", "right leg"} <= set(found[0].limbs)
    assert not {"left arm", "right arm"} & set(found[0].limbs)
    assert not found[0].whole


def test_no_limb_is_in_two_behaviours_at_once():
    made = synth.sequence(
        synth.gait("walk", repetitions=4, fps=30.0, seed=1),
        synth.gait("jacks", repetitions=4, fps=30.0, seed=2),
        synth.gait("walk", repetitions=4, fps=30.0, seed=3),
    )
    told = rl.understand(made.motion)
    for limb in told.limbs:
        taken = np.zeros(len(made.motion), int)
        for each in told.behaviours:
            if limb in each.limbs:
                taken[each.spans.frames] += 1
        assert taken.max() <= 1


@pytest.mark.parametrize("fps", [120, 60, 30, 24, 15])
@pytest.mark.parametrize("extra", [0, 1, 2])
def test_one_closed_pass_is_found_at_every_rate(fps, extra):
    made = synth.gait("walk", fps=fps, repetitions=3)
    length = round(made.period * fps)
    told = rl.understand(made.motion[: length + extra])
    (found,) = told.behaviours
    assert found.kind == "closed"
    assert found.probability is None
    assert found.period * fps == pytest.approx(length, abs=0.5)


def test_noise_costs_the_period_nothing(walk):
    rng = np.random.default_rng(0)
    shaken = rot.from_rotation_vector(rng.normal(scale=np.radians(2.0), size=(len(walk), 19, 3)))
    found = cyclic(replace(walk, rotations=rot.multiply(walk.rotations, shaken)))
    assert found[0].period == pytest.approx(1.1, rel=0.03)


def test_slow_periods_need_no_option():
    made = synth.gait("walk", period=10.0, repetitions=3.5, fps=30.0, seed=4)
    assert cyclic(made.motion)[0].period == pytest.approx(10.0, rel=0.02)


def test_wandering_and_standing_repeat_nothing():
    assert cyclic(synth.wander(12.0, seed=3).motion) == []
    still = synth.gait("walk", fps=30.0).motion[:40]
    rest = np.repeat(still.rotations[:1], 90, axis=0)
    standing = rl.Motion(still.skeleton, rest, np.zeros((90, 3)), 1 / 30)
    assert rl.understand(standing).behaviours == ()


def test_a_still_root_and_the_unit_change_nothing(walk, taken):
    skeleton = walk.skeleton
    ends = tuple((joint + 1, offset) for joint, offset in skeleton.end_sites)
    below = rl.Skeleton(
        ("world", *skeleton.names),
        (-1, 0, *(parent + 1 for parent in skeleton.parents[1:])),
        np.vstack([np.zeros((1, 3)), skeleton.offsets]),
        ends,
    )
    identity = np.broadcast_to([1.0, 0.0, 0.0, 0.0], (len(walk), 1, 4))
    moved = np.broadcast_to(below.offsets, (len(walk), below.n_joints, 3)).copy()
    moved[:, 1] = walk.root_path
    rotations = np.concatenate([identity, walk.rotations], axis=1)
    other = rl.Motion(below, rotations, np.zeros((len(walk), 3)), walk.frame_time, moved)
    for changed in (other, walk.scaled(100.0)):
        (found,) = rl.understand(changed).behaviours
        (before,) = taken.behaviours
        assert found.limbs == before.limbs
        assert found.period == pytest.approx(before.period, rel=1e-3)
        assert found.probability == pytest.approx(before.probability, abs=1e-3)


def test_too_few_frames_are_refused(walk):
    with pytest.raises(rl.TooShort, match="at least 8 frames, found 7"):
        rl.understand(walk[:7])


def test_it_can_be_cancelled(walk):
    with pytest.raises(rl.Cancelled):
        rl.understand(walk, progress=lambda fraction, stage: fraction < 0.4)


def test_what_is_told_is_plain_data(taken):
    told = json.loads(json.dumps(taken.to_dict()))
    assert told["behaviours"][0]["period_seconds"] == pytest.approx(1.1, rel=0.02)
    rows = list(csv.DictReader(io.StringIO(taken.to_csv())))
    assert rows[0]["kind"] == "cyclic"
    assert float(rows[0]["end"]) == pytest.approx(6.6, abs=0.1)
    assert taken.passing("left leg") == ()
    with pytest.raises(ValueError, match="expected a limb among"):
        taken.passing("tail")


def test_the_command_tells_and_writes(walk, tmp_path):
    path = tmp_path / "walk.bvh"
    rl.write(walk, path)
    shown = CliRunner().invoke(app, ["timeline", str(path), "-o", str(tmp_path)])
    assert shown.exit_code == 0, shown.output
    assert "cyclic" in shown.stdout
    assert "1.10 s" in shown.stdout
    record = json.loads((tmp_path / "walk_timeline.json").read_text())
    assert record["behaviours"][0]["kind"] == "cyclic"
    assert (tmp_path / "walk_timeline.csv").read_text().startswith("start,end,kind")
