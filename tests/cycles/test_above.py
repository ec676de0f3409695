"""What came on a joint above the hips goes back to it; where the body goes stays as it was."""

from __future__ import annotations

from dataclasses import asdict, replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.cycles.edit.align import mirrored, shifted
from roundelay.cycles.edit.separate import repaired_motion
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics, heading
from roundelay.loops.profiles import limb_record

UP = np.array([0.0, 1.0, 0.0])
TILT = rot.from_rotation_vector([-np.pi / 2, 0.0, 0.0])


def hung(motion: rl.Motion, *above: tuple[np.ndarray, np.ndarray]) -> rl.Motion:
    """Hang a motion below joints with given places (F, 3) and rotations (F, 4) in the world."""
    old, count, frames = motion.skeleton, len(above), len(motion)
    skeleton = rl.Skeleton(
        (*(f"Above{i}" for i in range(count)), *old.names),
        (*range(-1, count), *(parent + count for parent in old.parents[1:])),
        np.vstack([np.zeros((count, 3)), [[0.0, 0.9, 0.0]], old.offsets[1:]]),
        tuple((joint + count, offset) for joint, offset in old.end_sites),
    )
    places = np.stack([*(place for place, _ in above), motion.root_path], axis=1)
    turns = np.stack([*(turn for _, turn in above), motion.rotations[:, 0]], axis=1)
    back = rot.conjugate(turns[:, :-1])
    moved = np.tile(skeleton.offsets, (frames, 1, 1))
    moved[:, 1 : count + 1] = rot.rotate(back, np.diff(places, axis=1))
    if motion.translations is not None:
        moved[:, count + 1 :] = motion.translations[:, 1:]
    rotations = [turns[:, :1], rot.multiply(back, turns[:, 1:]), motion.rotations[:, 1:]]
    return rl.Motion(
        skeleton, np.concatenate(rotations, axis=1), places[:, 0], motion.frame_time, moved
    )


def still(motion: rl.Motion, place: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> np.ndarray:
    return np.tile(place, (len(motion), 1)).astype(float)


def along(made: synth.Synthetic) -> np.ndarray:
    """The path of a gait without the hips' height."""
    return made.motion.root_path * [1.0, 0.0, 1.0]


def facing(made: synth.Synthetic, turning: float) -> np.ndarray:
    return rot.from_rotation_vector(turning * made.phase[:, None] * UP)


def looped(capture: rl.Motion, **options: object) -> tuple[rl.Cycle, rl.Motion]:
    (cycle,) = rl.find_cycles(capture, rl.Options(**options))
    return cycle, cycle.sample()


def assert_body_stays(cycle: rl.Cycle, first: int = 1) -> None:
    """All joints from the one that carried the body on are where they were in the old form."""
    assert cycle.above is not None
    old = replace(cycle, above=None)
    for choice in (
        {},
        {"in_place": True},
        {"periods": 3, "start": 0.3, "repeat_first": True},
        {"heading": 1.0, "foot_lock": False},
    ):
        now, before = cycle.sample(**choice), old.sample(**choice)
        np.testing.assert_allclose(
            now.positions()[:, first:], before.positions()[:, first:], atol=1e-9
        )
        ours, theirs = (
            forward_kinematics(one.skeleton, one.rotations)[1][:, first:] for one in (now, before)
        )
        assert rot.angle_between(ours, theirs).max() < 1e-7


@pytest.fixture(scope="module")
def ground() -> rl.Motion:
    """A walk above a bone for root motion that glides on the ground."""
    made = synth.gait("walk", repetitions=4, fps=60)
    return hung(made.motion, (along(made), rot.identity(len(made.motion))))


@pytest.fixture(scope="module")
def walk(ground: rl.Motion) -> rl.Cycle:
    return rl.find_cycles(ground)[0]


def test_a_bone_for_root_motion_glides_and_the_hips_bob(ground, walk):
    loop = walk.sample()
    places = loop.positions()
    assert np.ptp(places[:, 0, 1]) < 1e-9
    assert np.abs(places[:, 0, 1]).max() < 1e-9
    assert np.ptp(places[:, 1, 1]) == pytest.approx(np.ptp(ground.positions()[:, 1, 1]), rel=0.02)
    steps = np.diff(loop.root_path, axis=0)
    np.testing.assert_allclose(steps, np.tile(walk.travel / len(loop), (len(steps), 1)), atol=1e-6)
    assert rot.angle_between(loop.rotations[:, 0], rot.identity(len(loop))).max() < 1e-6
    # Along the way the bone stays where it was below the hips.
    between = (places[:, 0] - places[:, 1]).mean(axis=0)
    np.testing.assert_allclose(between[[0, 2]], 0.0, atol=0.01)
    assert_body_stays(walk)


def test_in_place_the_bone_stands(walk):
    loop = walk.sample(in_place=True)
    assert np.ptp(loop.root_path, axis=0).max() < 1e-9
    assert rot.angle_between(loop.rotations[:, 0], loop.rotations[0, 0]).max() < 1e-9


def test_two_still_joints_above_the_hips_stand_still():
    made = synth.gait("walk", repetitions=4, fps=60).motion
    count = len(made)
    tilted = np.tile(TILT, (count, 1))
    capture = hung(made, (still(made), tilted), (still(made, (0.0, 0.2, 0.0)), rot.identity(count)))
    cycle, loop = looped(capture)
    places, turns = forward_kinematics(
        loop.skeleton, loop.rotations, loop.root_path, translations=loop.translations
    )
    assert np.ptp(places[:, :2], axis=0).max() < 1e-9
    np.testing.assert_allclose(places[0, :2, 1], [0.0, 0.2], atol=1e-9)
    assert rot.angle_between(turns[:, 0], TILT).max() < 1e-6
    assert rot.angle_between(turns[:, 1], rot.identity()).max() < 1e-6
    assert_body_stays(cycle, 2)
    moved = cycle.sample(repeat_first=True).translations[:, 2]
    assert np.linalg.norm(moved[-1] - moved[0]) == pytest.approx(np.linalg.norm(cycle.travel))


def test_a_still_joint_above_a_bone_for_root_motion():
    made = synth.gait("walk", repetitions=4, fps=60)
    count = len(made.motion)
    upright = rot.identity(count)
    cycle, loop = looped(hung(made.motion, (still(made.motion), upright), (along(made), upright)))
    places = loop.positions()
    assert np.ptp(places[:, 0], axis=0).max() < 1e-9
    assert np.ptp(places[:, 1, 1]) < 1e-9
    assert np.ptp(places[:, 1, 2]) > 0.9 * np.linalg.norm(cycle.travel)
    assert_body_stays(cycle, 2)


@pytest.mark.parametrize("turns", [False, True])
def test_a_bone_turns_with_the_body_if_it_did(turns):
    made = synth.gait("walk", repetitions=4, fps=60, turning=0.5)
    turn = facing(made, 0.5) if turns else rot.identity(len(made.motion))
    cycle, loop = looped(hung(made.motion, (along(made), rot.multiply(turn, TILT))))
    assert abs(cycle.turning) == pytest.approx(0.5, rel=0.02)
    upright = rot.multiply(loop.rotations[:, 0], rot.conjugate(TILT))
    turned = np.unwrap(heading(upright))
    expected = cycle.turning * (len(loop) - 1) / len(loop) if turns else 0.0
    assert turned[-1] - turned[0] == pytest.approx(expected, abs=1e-6)
    assert np.abs(rot.rotate(upright, UP) - UP).max() < 1e-6
    places = loop.positions()
    assert np.ptp(places[:, 0, 1]) < 1e-9
    away = places[:, 0] - places[:, 1]
    assert np.linalg.norm(away[:, [0, 2]], axis=1).max() < 0.05
    assert_body_stays(cycle)


def test_a_bone_beside_the_hips_goes_round_with_them():
    made = synth.gait("walk", repetitions=4, fps=60, turning=0.5)
    turn = facing(made, 0.5)
    beside = along(made) + rot.rotate(turn, [0.3, 0.0, 0.0])
    cycle, loop = looped(hung(made.motion, (beside, turn)))
    places = loop.positions()
    away = rot.rotate(rot.conjugate(loop.rotations[:, 0]), places[:, 0] - places[:, 1])
    np.testing.assert_allclose(away[:, 0], 0.3, atol=0.05)
    np.testing.assert_allclose(away[:, 2], 0.0, atol=0.05)
    assert_body_stays(cycle)


def test_stairs_are_climbed_by_the_bone_as_well():
    made = synth.gait("walk", repetitions=4, fps=60)
    climb = 0.4 * made.phase[:, None] * UP
    motion = replace(made.motion, root_path=made.motion.root_path + climb)
    cycle, loop = looped(hung(motion, (along(made) + climb, rot.identity(len(motion)))))
    rises = np.diff(loop.positions()[:, 0, 1])
    np.testing.assert_allclose(rises, cycle.travel[1] / len(loop), atol=1e-6)
    away = loop.positions()[:, 1, 1] - loop.positions()[:, 0, 1]
    assert away.mean() == pytest.approx(0.92, abs=0.01)
    assert_body_stays(cycle)


def test_a_root_that_carries_the_body_keeps_it():
    made = synth.gait("walk", repetitions=4, fps=60).motion
    capture = hung(made, (made.root_path - [0.0, 0.5, 0.0], made.rotations[:, 0]))
    cycle, _ = looped(capture)
    assert cycle.above is None


def test_bones_that_change_length_do_so_still():
    made = synth.gait("walk", repetitions=4, fps=60)
    moved = np.tile(made.motion.skeleton.offsets, (len(made.motion), 1, 1))
    moved[:, 4, 1] += 0.02 * np.sin(2 * np.pi * made.phase)
    motion = replace(made.motion, translations=moved)
    cycle, loop = looped(hung(motion, (along(made), rot.identity(len(motion)))))
    assert np.ptp(loop.translations[:, 5, 1]) == pytest.approx(0.04, rel=0.05)
    assert_body_stays(cycle)


@pytest.mark.parametrize("method", ["harmonic", "centroid", "paper"])
def test_every_model_gives_back(ground, method):
    cycle, loop = looped(ground, method=method)
    assert np.ptp(loop.root_path[:, 1]) < 1e-9
    assert_body_stays(cycle)


def test_what_is_measured_does_not_depend_on_the_form(ground, walk):
    old = replace(walk, above=None)
    now, before = (asdict(rl.quality(cycle, ground)) for cycle in (walk, old))
    assert now == pytest.approx(before, rel=1e-6, abs=1e-9)
    assert limb_record(walk.sample()) == limb_record(old.sample())


def test_the_file_tells_the_same(tmp_path, walk):
    loop = walk.sample()
    rl.write(loop, tmp_path / "loop.bvh")
    again = rl.read(tmp_path / "loop.bvh")
    np.testing.assert_allclose(again.positions(), loop.positions(), atol=1e-6)
    rl.write(loop, tmp_path / "loop.amc")
    again = rl.read(tmp_path / "loop.amc")
    for name in ("Hips", "LeftHand", "RightFoot"):
        places = (one.positions()[:, one.skeleton.index(name)] for one in (again, loop))
        np.testing.assert_allclose(*places, atol=1e-6)


def test_shifting_turning_and_mirroring_keep_it(walk):
    phase = np.linspace(0.0, 1.5, 20)
    there = mirrored(walk).at(phase, frame_time=0.01)
    back = walk.at(phase, frame_time=0.01).mirror()
    np.testing.assert_allclose(there.positions(), back.positions(), atol=1e-9)
    moved = shifted(walk, 0.37).at(phase, frame_time=0.01).positions()[:, 0]
    assert np.ptp(moved[:, 1]) < 1e-9


def test_blends_and_transitions_keep_it(ground, walk):
    made = synth.gait("run", repetitions=4, fps=60, turning=0.2)
    run = rl.find_cycles(hung(made.motion, (along(made), facing(made, 0.2))))[0]
    blended = rl.blend([walk, run], [0.5, 0.5])
    assert np.ptp(blended.sample().root_path[:, 1]) < 1e-9
    assert_body_stays(blended)
    motion = rl.transition(walk, run)
    before = rl.transition(replace(walk, above=None), run)
    assert np.ptp(motion.root_path[:, 1]) < 1e-9
    np.testing.assert_allclose(motion.positions()[:, 1:], before.positions()[:, 1:], atol=1e-9)
    away = motion.positions()[:, 0] - motion.positions()[:, 1]
    assert np.linalg.norm(away[:, [0, 2]], axis=1).max() < 0.1
    parted, _ = repaired_motion(motion, [ground])
    assert np.ptp(parted.root_path[:, 1]) < 1e-9


def test_a_loop_is_found_again_as_it_was_made(walk):
    again, loop = looped(walk.sample(periods=4))
    assert again.period == pytest.approx(walk.period, rel=0.02)
    assert np.ptp(loop.root_path[:, 1]) < 1e-9
