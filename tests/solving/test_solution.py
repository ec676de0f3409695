"""Skeletons solved from points: a walk with known joints comes back from its markers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from benchmarks._marker_takes import (
    bone_markers,
    joint_angles,
    joint_errors,
    keypoints,
    markers,
    slides,
    standing_walk,
    with_gaps,
)

import roundelay as rl
from roundelay import synth
from roundelay.geometry import rotations as rot
from roundelay.motion.points import Points
from roundelay.solving import solve

pytestmark = pytest.mark.filterwarnings("ignore::roundelay.RoundelayWarning")

LIMBS = ("UpLeg", "Leg", "Foot", "Arm", "ForeArm")


@pytest.fixture(scope="module")
def walk():
    return standing_walk(strides=3, fps=60)


def noisy(names, places, spread, *, fps=60.0, units="m", seed=0, **others):
    rng = np.random.default_rng(seed)
    return Points(
        names, places + rng.normal(scale=spread, size=places.shape), fps, units=units, **others
    )


@pytest.fixture(scope="module")
def solved(walk):
    return solve(noisy(*markers(walk[0]), 0.001))


def test_joints_come_back_from_markers(walk, solved):
    errors = joint_errors(walk[0], solved)
    assert max(errors[f"{side}{limb}"] for side in ("Left", "Right") for limb in LIMBS) < 0.012
    angles = joint_angles(walk[0], solved)
    assert angles["knee"] < 1.0
    assert angles["elbow"] < 5.0


def test_markers_are_carried_by_the_bones_of_the_motion(walk, solved):
    """What is told of the residuals holds for the motion that is returned."""
    names, places = markers(walk[0])
    assert solved.rms < 0.0025
    motion = solved.motion
    joints, turns = motion.positions(), _world_turns(motion)
    for name, joint in (("LKNE", "LeftUpLeg"), ("RANK", "RightLeg"), ("SACR", "Hips")):
        place = solved.joints[solved.markers.index(name)]
        assert place == joint
        number = motion.skeleton.index(joint)
        inside = rot.rotate(
            rot.conjugate(turns[:, number]), places[:, names.index(name)] - joints[:, number]
        )
        assert np.abs(inside - inside.mean(axis=0)).max() < 0.006


def _world_turns(motion):
    from roundelay.geometry.kinematics import forward_kinematics

    return forward_kinematics(motion.skeleton, motion.rotations, motion.root_path)[1]


def test_bones_keep_their_lengths_and_both_sides_are_alike(solved):
    skeleton = solved.motion.skeleton
    assert solved.motion.translations is None
    for part, true in (("Leg", 0.42), ("Foot", 0.40), ("ForeArm", 0.28), ("Hand", 0.25)):
        left, right = (
            np.linalg.norm(skeleton.offsets[skeleton.index(f"{side}{part}")])
            for side in ("Left", "Right")
        )
        assert left == pytest.approx(true, abs=0.012)
        assert left == pytest.approx(right, abs=0.006)


def test_gaps_are_bridged_by_the_body(walk):
    whole = noisy(*markers(walk[0]), 0.003)
    points = with_gaps(whole, 0.2, np.random.default_rng(1))
    assert 0.15 < (~points.seen).mean() < 0.3
    solved = solve(points)
    errors = joint_errors(walk[0], solved)
    assert max(errors[f"{side}{limb}"] for side in ("Left", "Right") for limb in LIMBS) < 0.025
    assert joint_angles(walk[0], solved)["knee"] < 2.5
    steps = rot.vector_between(solved.motion.rotations[:-1], solved.motion.rotations[1:])
    assert np.degrees(np.linalg.norm(steps, axis=2)).max() < 15.0


def test_what_was_not_seen_does_not_count(walk):
    points = with_gaps(noisy(*markers(walk[0]), 0.001), 0.1, np.random.default_rng(1))
    moved = points.positions.copy()
    moved[~points.seen] = 1e3
    other = replace(points, positions=moved, missing=~points.seen)
    first, second = solve(points).motion, solve(other).motion
    np.testing.assert_array_equal(first.rotations, second.rotations)


@pytest.mark.parametrize(
    ("units", "factor", "turned", "up"),
    [
        ("mm", 1000.0, None, 1),
        ("", 1000.0, None, 1),
        ("in", 1.0 / 0.0254, None, 1),
        ("m", 1.0, (np.pi / 2, 0.0, 0.0), 2),
    ],
)
def test_any_unit_and_vertical(walk, solved, units, factor, turned, up):
    names, places = markers(walk[0])
    turn = rot.identity() if turned is None else rot.from_rotation_vector(turned)
    points = noisy(names, places, 0.001)
    points = replace(points, positions=rot.rotate(turn, points.positions) * factor, units=units)
    other = solve(points)
    assert other.motion.up == up
    assert other.rms / factor == pytest.approx(solved.rms, rel=0.05)
    there = rot.rotate(turn, solved.motion.positions()) * factor
    # Regressions hold in metres; a unit that is not told is off by a tenth perhaps.
    assert np.abs(other.motion.positions() - there).max() < (0.02 if units == "" else 2e-3) * factor


def test_pictures_are_turned_upward(walk, solved):
    names, places = markers(walk[0])
    points = noisy(names, places, 0.001)
    down = replace(points, positions=points.positions * [1.0, -1.0, -1.0], image=True)
    assert np.abs(solve(down).motion.positions() - solved.motion.positions()).max() < 1e-3


def test_lower_bodies_have_legs_alone(walk):
    names, places = markers(walk[0])
    kept = [
        n
        for n in names
        if n[1:] in ("ASI", "THI", "KNE", "TIB", "ANK", "HEE", "TOE") or n == "SACR"
    ]
    solved = solve(noisy(names, places, 0.001).select(kept))
    assert set(solved.motion.skeleton.names) == {"Hips"} | {
        f"{side}{part}" for side in ("Left", "Right") for part in ("UpLeg", "Leg", "Foot")
    }
    assert joint_angles(walk[0], solved)["knee"] < 1.0


@pytest.mark.parametrize("style", ["Anna:{}", "{} ", "{}.", "_{}"])
def test_names_are_known_however_they_are_written(walk, style):
    names, places = markers(walk[0])
    styled = tuple(style.format(name.lower()) for name in names)
    assert solve(noisy(styled, places, 0.001)).joints == solve(noisy(names, places, 0.001)).joints


def test_noisy_keypoints_give_a_walk_whose_feet_stand():
    motion, standing = standing_walk(strides=6, fps=30)
    names, places = keypoints(motion)
    solved = solve(noisy(names, places, 0.02, fps=30.0))
    assert solved.noise == pytest.approx(0.02, rel=0.15)
    held = slides(solved, standing)
    assert np.median(held) < 0.003
    raw = replace(solved, motion=solved.motion, residuals=solved.residuals)
    assert raw.rms < 0.04
    angles = joint_angles(motion, solved)
    assert angles["knee"] < 4.0
    assert angles["elbow"] < 6.0
    steps = rot.vector_between(solved.motion.rotations[:-1], solved.motion.rotations[1:])
    assert np.degrees(np.linalg.norm(steps, axis=2)).max() < 30.0


def test_clean_keypoints_are_not_smoothed_away():
    motion, _ = standing_walk(strides=3, fps=60)
    names, places = keypoints(motion)
    solved = solve(Points(names, places, 60.0, units="m"))
    assert solved.rms < 0.002
    assert joint_angles(motion, solved)["knee"] < 0.6


def test_knees_and_elbows_bend_one_way(walk, solved):
    motion = solved.motion
    for side in ("Left", "Right"):
        knee = motion.rotations[:, motion.skeleton.index(f"{side}Leg")]
        angle = rot.to_rotation_vector(knee)[:, 0]
        assert angle.min() > -0.05
        assert angle.max() > 0.5
        elbow = motion.rotations[:, motion.skeleton.index(f"{side}ForeArm")]
        assert rot.to_rotation_vector(elbow)[:, 0].max() < 0.1


def test_markers_without_names_make_bones():
    made = synth.gait("jacks", repetitions=3, fps=60)
    names, places = bone_markers(made.motion, ("Hips", "LeftUpLeg", "LeftLeg", "RightUpLeg"))
    rng = np.random.default_rng(0)
    points = Points(
        names, 1000 * (places + rng.normal(scale=5e-4, size=places.shape)), 60.0, units="mm"
    )
    solved = solve(points)
    assert solved.rms < 4.0
    assert solved.motion.skeleton.n_joints == 4
    true = 1000 * made.motion.positions()
    for joint in ("LeftUpLeg", "RightUpLeg"):
        apart = true[:, made.motion.skeleton.index(joint), None] - solved.motion.positions()
        assert np.sqrt(np.mean(np.sum(apart**2, axis=2), axis=0)).min() < 25.0


def test_the_skeleton_goes_into_files(walk, solved, tmp_path):
    rl.write(solved.motion, tmp_path / "walk.bvh")
    again = rl.read(tmp_path / "walk.bvh")
    assert np.abs(again.positions() - solved.motion.positions()).max() < 1e-4


def test_strays_are_left_out_and_told(walk):
    names, places = markers(walk[0])
    still = np.broadcast_to([1.0, 0.4, 0.2], (len(places), 1, 3))
    points = noisy((*names, "box"), np.concatenate([places, still], axis=1), 0.001)
    assert solve(points).left_out == ("box",)
    with pytest.warns(rl.RoundelayWarning, match="left out, points on no bone or hardly seen: box"):
        rl.solve_skeleton(points)


def test_frames_without_the_body_are_left_out_and_told(walk):
    points = noisy(*markers(walk[0]), 0.001)
    missing = np.zeros((len(points), len(points.names)), bool)
    missing[:20] = missing[-5:] = True
    points = replace(points, missing=missing)
    solved = solve(points)
    assert solved.frames == (20, len(points) - 5)
    assert len(solved.motion) == len(points) - 25
    with pytest.warns(rl.RoundelayWarning, match=f"all but 21-{len(points) - 5}"):
        rl.solve_skeleton(points)


def nothing_seen(points):
    return replace(points, missing=np.ones((len(points), len(points.names)), bool))


@pytest.mark.parametrize(
    ("change", "error", "said"),
    [
        (
            lambda p: replace(p, positions=p.positions[..., :2]),
            rl.Unsolvable,
            "3 dimensions, found 2",
        ),
        (nothing_seen, rl.TooShort, "found none"),
        (lambda p: p[:5], rl.TooShort, "at least 8 frames in which the body is seen, found 5"),
        (lambda p: p[:0], rl.TooShort, "found none"),
        (lambda p: p.select(["LKNE", "RKNE"]), rl.Unsolvable, "found 2"),
        (
            lambda p: p.select(["LKNE", "RKNE", "LANK", "RANK", "LASI"]),
            rl.Unsolvable,
            "both ASIS and the sacrum or both PSIS",
        ),
        (
            lambda p: replace(p, names=tuple(f"m{i}" for i, _ in enumerate(p.names))).select(
                ["m0", "m9", "m20", "m30"]
            ),
            rl.Unsolvable,
            "named markers of hips and legs, any other body two bones",
        ),
    ],
)
def test_what_cannot_be_solved_is_said(walk, change, error, said):
    points = noisy(*markers(walk[0]), 0.001)
    with pytest.raises(error, match=said):
        rl.solve_skeleton(change(points))


def test_noise_alone_is_no_body():
    rng = np.random.default_rng(0)
    names, _ = markers(standing_walk(strides=1, fps=30)[0])
    points = Points(names, rng.normal(size=(60, len(names), 3)), 30.0, units="m")
    with pytest.raises(rl.Unsolvable):
        rl.solve_skeleton(points)


def test_points_at_one_place_are_no_body():
    names, _ = markers(standing_walk(strides=1, fps=30)[0])
    with pytest.raises(rl.Unsolvable):
        rl.solve_skeleton(Points(names, np.zeros((60, len(names), 3)), 30.0, units="m"))


def test_work_can_be_cancelled(walk):
    with pytest.raises(rl.Cancelled):
        rl.solve_skeleton(noisy(*markers(walk[0]), 0.001), progress=lambda *_: False)


def test_no_points_are_refused():
    with pytest.raises(TypeError, match="Points"):
        rl.solve_skeleton(np.zeros((10, 4, 3)))
