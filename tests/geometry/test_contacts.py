"""Feet found, contacts told, legs moved, skating less."""

import dataclasses

import numpy as np
import pytest

from roundelay import find_cycles, synth
from roundelay.base.spans import closed_spans
from roundelay.cycles.edit.footlock import lock_feet, lock_offsets, move_foot
from roundelay.geometry import rotations as rot
from roundelay.geometry.contacts import contacts, find_feet, foot_points, shoulders, skate
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.motion.motion import Motion


@pytest.fixture(scope="module")
def walk() -> Motion:
    return synth.gait("walk", repetitions=2.5, noise=0.005).motion


def placed(motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    return forward_kinematics(motion.skeleton, motion.rotations, motion.root_path)


def test_feet_are_found_by_name_and_by_height(walk: Motion) -> None:
    names = walk.skeleton.names
    nameless = dataclasses.replace(walk.skeleton, names=tuple(f"j{i}" for i in range(len(names))))
    for skeleton in (walk.skeleton, nameless):
        feet = find_feet(skeleton, walk.positions(), walk.up)
        found = {(names[f.hip], names[f.knee], names[f.ankle]) for f in feet}
        assert found == {(f"{s}UpLeg", f"{s}Leg", f"{s}Foot") for s in ("Left", "Right")}
        assert all(f.offset == (0.0, -0.06, 0.18) for f in feet)


def test_hands_on_the_ground_are_feet(walk: Motion) -> None:
    upside_down = walk.positions() * np.array([1.0, -1.0, 1.0])
    names = tuple(f"j{i}" for i in range(walk.skeleton.n_joints))
    skeleton = dataclasses.replace(walk.skeleton, names=names)
    feet = find_feet(skeleton, upside_down, walk.up)
    assert walk.skeleton.index("LeftFoot") not in {foot.ankle for foot in feet}


def test_shoulders_are_above_the_upper_arms(walk: Motion, jumps: Motion) -> None:
    for motion in (walk, jumps):
        found = shoulders(motion.skeleton, motion.positions(), motion.up)
        assert [motion.skeleton.names[joint] for joint in found] == ["LeftArm", "RightArm"]


def test_contacts_are_low_and_slow() -> None:
    time = np.arange(240)
    points = np.zeros((240, 2, 3))
    stands = (time // 60) % 2 == 0
    points[:, 0, 1] = np.where(stands, 0.0, 0.2)
    points[:, 0, 2] = 0.02 * np.cumsum(~stands)
    # The second point slides along the ground all the time.
    points[:, 1, 2] = 0.01 * time
    told = contacts(points, fps=120.0, size=2.0, up=1)
    assert np.mean(told[:, 0] == stands) > 0.95
    assert not told[:, 1].any()


def test_skate_counts_slides_on_the_ground_only() -> None:
    slide = np.zeros((101, 1, 3))
    slide[:, 0, 0] = np.linspace(0.0, 0.5, 101)
    assert skate(slide, fps=50.0, size=2.0, up=1) == pytest.approx(0.25)
    slide[1:, 0, 1] = 1.0
    assert skate(slide, fps=50.0, size=2.0, up=1) < 0.01


def test_offsets_hold_feet_and_go_over_smoothly() -> None:
    points = np.zeros((100, 1, 3))
    points[:, 0, 2] = np.linspace(0.0, 0.1, 100)
    standing = np.zeros((100, 1), bool)
    standing[20:40] = standing[60:80] = True
    offsets = lock_offsets(points, standing, 1)
    held = (points + offsets)[:, 0, 2]
    assert np.ptp(held[20:40]) < 1e-12
    assert np.ptp(held[60:80]) < 1e-12
    assert np.abs(np.diff(offsets, axis=0)).max() < 0.0015


def test_a_bent_leg_reaches_and_the_foot_keeps_its_attitude(walk: Motion) -> None:
    positions, orientations = placed(walk)
    foot = find_feet(walk.skeleton, positions, walk.up)[0]
    rotations = walk.rotations.copy()
    bend = rot.from_rotation_vector(np.array([1.2, 0.0, 0.0]))
    rotations[:, foot.knee] = rot.multiply(bend, rotations[:, foot.knee])
    bent = dataclasses.replace(walk, rotations=rotations)
    positions, orientations = placed(bent)
    offset = np.tile([0.01, 0.015, -0.02], (len(walk), 1))
    moved = bent.rotations.copy()
    move_foot(walk.skeleton, moved, foot, offset, positions, orientations)
    there, turned = placed(dataclasses.replace(bent, rotations=moved))
    apart = there[:, foot.ankle] - positions[:, foot.ankle] - offset
    assert np.linalg.norm(apart, axis=-1).max() < 0.5 * np.linalg.norm(offset[0])
    assert rot.angle_between(turned[:, foot.ankle], orientations[:, foot.ankle]).max() < 1e-6
    untouched = [j for j in range(19) if j not in walk.skeleton.descendants(foot.hip)]
    assert np.array_equal(there[:, untouched], positions[:, untouched])


def test_a_locked_loop_skates_less_than_its_source(walk: Motion) -> None:
    cycle = find_cycles(walk)[0]
    feet = find_feet(walk.skeleton, walk.positions(), walk.up)

    def slid(motion: Motion) -> float:
        points = foot_points(feet, *placed(motion))
        return skate(points, fps=motion.fps, size=motion.skeleton.size, up=motion.up)

    loose, locked = (cycle.sample(periods=2, foot_lock=lock) for lock in (False, True))
    assert slid(locked) < slid(loose)
    first, again = np.split(locked.rotations[:, 1:], 2)
    assert rot.angle_between(first, again).max() < 1e-6


def test_no_feet_no_change() -> None:
    made = synth.gait("walk")
    arms = made.motion.select(["Spine", "Chest", "LeftArm"])
    joints, rotations = lock_feet(arms, 100)
    assert np.array_equal(rotations, arms.rotations[:, joints])


@pytest.mark.parametrize(
    ("mask", "expected"),
    [
        ([0, 1, 1, 0], [(1, 3)]),
        ([1, 0, 0, 1], [(3, 5)]),
        ([1, 0, 1, 0], [(0, 1), (2, 3)]),
        ([1, 1, 1, 1], [(0, 4)]),
        ([0, 0, 0, 0], []),
    ],
)
def test_ranges_across_the_seam_are_told_once(
    mask: list[int], expected: list[tuple[int, int]]
) -> None:
    assert closed_spans(np.array(mask, bool)) == expected
