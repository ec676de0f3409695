from dataclasses import replace

import numpy as np
import pytest

from roundelay import Motion, Skeleton, SkeletonMismatch, concatenate
from roundelay.geometry import rotations as rot

NAMES = ("Hips", "Spine", "Head", "LeftLeg", "RightLeg", "RightFoot", "LeftFoot")
PARENTS = (-1, 0, 1, 0, 0, 4, 3)
OFFSETS = np.array(
    [[0, 0, 0], [0, 3, 0], [0, 2, 0.5], [1, -4, 0], [-1, -4, 0], [0.1, -4, 1], [0.2, -4, 1]]
)
ENDS = ((2, np.array([0.0, 1, 0])), (5, np.array([0.0, 0, 1])), (6, np.array([0.1, 0, 1])))


def make(frames=20, fps=40.0, moved=False):
    rng = np.random.default_rng(frames)
    waves = np.sin(np.linspace(0, 3, frames)[:, None, None] + rng.normal(size=(7, 3)) * 2)
    translations = OFFSETS + 0.1 * waves if moved else None
    skeleton = Skeleton(NAMES, PARENTS, OFFSETS, ENDS)
    path = np.cumsum(rng.normal(size=(frames, 3)), axis=0)
    return Motion(skeleton, rot.from_rotation_vector(waves), path, 1 / fps, translations, "made")


def assert_same(first, second, atol=1e-12):
    np.testing.assert_allclose(rot.angle_between(first.rotations, second.rotations), 0.0, atol=atol)
    np.testing.assert_allclose(first.root_path, second.root_path, atol=atol)
    np.testing.assert_allclose(first.positions(), second.positions(), atol=atol)
    assert first.frame_time == pytest.approx(second.frame_time)


both = pytest.mark.parametrize("moved", [False, True])


def test_basic_figures():
    motion = make()
    assert len(motion) == motion.n_frames == 20
    assert motion.fps == pytest.approx(40)
    assert motion.duration == pytest.approx(0.5)
    np.testing.assert_array_equal(motion.up_vector, [0, 1, 0])


def test_rotations_become_continuous_and_frozen():
    motion = make()
    flipped = motion.rotations * np.where(np.arange(20) % 3, 1.0, -1.0)[:, None, None]
    again = replace(motion, rotations=flipped)
    assert np.all(np.sum(again.rotations[1:] * again.rotations[:-1], axis=-1) >= 0)
    for array in (again.rotations, again.root_path):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0
    flipped[0] = 0.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"rotations": np.ones((20, 6, 4))}, r"rotations of shape \(20, 7, 4\)"),
        ({"root_path": np.ones((20, 2))}, r"root_path of shape \(20, 3\)"),
        ({"translations": np.ones((19, 7, 3))}, r"translations of shape \(20, 7, 3\)"),
        ({"root_path": np.full((20, 3), np.nan)}, "finite root_path"),
        ({"frame_time": 0.0}, "positive frame time"),
        ({"frame_time": np.inf}, "positive frame time"),
    ],
)
def test_what_is_no_motion(change, message):
    with pytest.raises(ValueError, match=message):
        replace(make(), **change)


@both
def test_slices_are_half_open(moved):
    motion = make(moved=moved)
    part = motion[5:9]
    assert len(part) == 4
    np.testing.assert_allclose(part.positions(), motion.positions()[5:9])
    assert len(motion[18:]) == 2
    assert len(motion[:0]) == 0
    for wrong in (3, slice(0, 9, 2)):
        with pytest.raises(TypeError, match="slice of frames"):
            motion[wrong]


@both
def test_resampling_to_the_same_rate_changes_nothing(moved):
    assert_same(make(moved=moved).resample(40.0), make(moved=moved))


@both
def test_resampling_keeps_what_lies_on_both_grids(moved):
    motion = make(moved=moved)
    double = motion.resample(80.0)
    assert len(double) == 39
    np.testing.assert_allclose(double.positions()[::2], motion.positions(), atol=1e-12)
    half = motion.resample(20.0)
    assert len(half) == 10
    np.testing.assert_allclose(half.positions(), motion.positions()[::2], atol=1e-12)


def test_resampling_turns_evenly():
    skeleton = Skeleton(("a",), (-1,), np.zeros((1, 3)))
    turns = rot.from_rotation_vector(np.linspace(0, 6, 7)[:, None, None] * [0, 1.0, 0])
    motion = Motion(skeleton, turns, np.zeros((7, 3)), 1.0).resample(2.5)
    expected = rot.from_rotation_vector(np.arange(len(motion))[:, None, None] * [0, 0.4, 0])
    np.testing.assert_allclose(rot.angle_between(motion.rotations, expected), 0, atol=1e-12)


@pytest.mark.parametrize("fps", [0.0, -1.0, np.nan])
def test_resampling_to_no_rate(fps):
    with pytest.raises(ValueError, match="positive frame rate"):
        make().resample(fps)


def test_one_frame_can_be_resampled():
    assert len(make()[:1].resample(7.0)) == 1


def test_poses_between_and_beyond_frames():
    motion = make()
    poses = motion.at([-3.0, 0.0, 4.5, 99.0])
    np.testing.assert_allclose(poses.root_path[0], motion.root_path[0])
    np.testing.assert_allclose(poses.root_path[2], motion.root_path[4:6].mean(axis=0))
    np.testing.assert_allclose(poses.root_path[3], motion.root_path[-1])


@both
def test_select_keeps_every_place(moved):
    motion = make(moved=moved)
    part = motion.select(["Spine", "LeftLeg", "LeftFoot"])
    assert part.skeleton.names == ("Hips", "Spine", "LeftLeg", "LeftFoot")
    kept = motion.skeleton.indices(part.skeleton.names)
    np.testing.assert_allclose(part.positions(), motion.positions()[:, kept], atol=1e-12)


def test_select_folds_in_what_lies_between():
    motion = make()
    part = motion.select(["Head", "RightFoot"])
    assert part.skeleton.parents == (-1, 0, 0)
    kept = motion.skeleton.indices(part.skeleton.names)
    np.testing.assert_allclose(part.positions(), motion.positions()[:, kept], atol=1e-12)
    assert [joint for joint, _ in part.skeleton.end_sites] == [1, 2]


def test_select_unknown():
    with pytest.raises(SkeletonMismatch, match="no joint 'Tail'"):
        make().select(["Tail"])


@both
def test_turned(moved):
    motion, turn = make(moved=moved), rot.from_rotation_vector([0.1, 2.0, -0.3])
    again = motion.turned(turn)
    np.testing.assert_allclose(again.positions(), rot.rotate(turn, motion.positions()), atol=1e-12)
    assert again.skeleton is motion.skeleton
    assert_same(again.turned(rot.conjugate(turn)), motion, atol=1e-7)


@both
def test_scaled(moved):
    motion = make(moved=moved)
    np.testing.assert_allclose(motion.scaled(0.1).positions(), 0.1 * motion.positions())
    with pytest.raises(ValueError, match="positive scale"):
        motion.scaled(0.0)


@both
def test_concatenate_undoes_slicing(moved):
    motion = make(moved=moved)
    assert_same(concatenate([motion[:7], motion[7:8], motion[8:]]), motion)


def test_concatenate_fills_in_translations():
    still, moving = make(), make(moved=True)
    joined = concatenate([still, moving])
    np.testing.assert_allclose(joined.positions()[:20], still.positions())
    np.testing.assert_allclose(joined.positions()[20:], moving.positions())


def test_what_cannot_be_joined():
    with pytest.raises(ValueError, match="at least one motion"):
        concatenate([])
    with pytest.raises(ValueError, match="40 and 30 fps"):
        concatenate([make(), make(fps=30)])
    with pytest.raises(SkeletonMismatch):
        concatenate([make(), make().select(["Spine"])])


MIRRORED = [0, 1, 2, 4, 3, 6, 5]


@both
def test_mirror_reflects_every_joint_onto_its_partner(moved):
    motion = make(moved=moved)
    places = motion.positions()[:, MIRRORED] * [-1, 1, 1]
    np.testing.assert_allclose(motion.mirror().positions(), places, atol=1e-12)


@both
def test_mirror_twice_is_the_motion(moved):
    motion = make(moved=moved)
    again = motion.mirror().mirror()
    assert_same(again, motion)
    np.testing.assert_array_equal(again.skeleton.offsets, motion.skeleton.offsets)
    for (joint, end), (other, other_end) in zip(again.skeleton.end_sites, ENDS, strict=True):
        assert joint == other
        np.testing.assert_array_equal(end, other_end)


@pytest.mark.parametrize("up", [0, 1, 2])
@pytest.mark.parametrize("body", [[0, 1, 2], [1, 2, 0], [2, 0, 1]])
def test_mirror_keeps_what_is_up_up(up, body):
    """Whatever axes the skeleton's own frames have, heights do not change."""
    motion = make()
    turned = replace(motion.skeleton, offsets=OFFSETS[:, body])
    motion = replace(motion, skeleton=turned, up=up)
    mirrored = motion.mirror()
    heights = motion.positions()[:, MIRRORED, up]
    np.testing.assert_allclose(mirrored.positions()[..., up], heights, atol=1e-12)
    assert_same(mirrored.mirror(), motion)


def test_a_symmetric_skeleton_stays_itself():
    offsets = OFFSETS.copy()
    offsets[5] = offsets[6] * [-1, 1, 1]
    motion = make()
    motion = replace(motion, skeleton=replace(motion.skeleton, offsets=offsets))
    np.testing.assert_array_equal(motion.mirror().skeleton.offsets, offsets)


def test_mirror_without_partner():
    with pytest.raises(SkeletonMismatch, match="no partner"):
        make().select(["LeftLeg"]).mirror()


def test_root_motion_moves_up_into_the_root():
    skeleton = Skeleton(
        ("world", "Hips", "a", "b"), (-1, 0, 1, 1), [[0, 0, 0], [0, 9, 0], [1, 0, 0], [-1, 0, 0]]
    )
    rng = np.random.default_rng(0)
    turns = rot.from_rotation_vector(rng.normal(size=(6, 4, 3)))
    turns[:, 0] = rot.identity()
    moved = np.tile(skeleton.offsets, (6, 1, 1))
    moved[:, 1] += rng.normal(size=(6, 3))
    motion = Motion(skeleton, turns, np.zeros((6, 3)), 0.1, moved)
    lifted = motion.with_root_motion()
    np.testing.assert_allclose(lifted.positions()[:, 1:], motion.positions()[:, 1:], atol=1e-12)
    np.testing.assert_allclose(lifted.rotations[:, 1], rot.identity(6))
    assert make().with_root_motion().rotations.shape == (20, 7, 4)
