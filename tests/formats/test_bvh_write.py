"""Written BVH files hold what was read, in the file's own words."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from roundelay import Motion, Skeleton, TooShort, read, write
from roundelay.geometry import rotations as rot


def same(first: Motion, second: Motion) -> None:
    """Check two motions: 1e-6 degrees, 1e-6 of a length unit."""
    assert first.skeleton.names == second.skeleton.names
    assert first.skeleton.parents == second.skeleton.parents
    np.testing.assert_allclose(first.skeleton.offsets, second.skeleton.offsets, atol=1e-6)
    ends = [motion.skeleton.end_sites for motion in (first, second)]
    assert [joint for joint, _ in ends[0]] == [joint for joint, _ in ends[1]]
    np.testing.assert_allclose([e for _, e in ends[0]], [e for _, e in ends[1]], atol=1e-6)
    angles = np.degrees(rot.angle_between(first.rotations, second.rotations))
    assert angles.max() < 1e-6
    np.testing.assert_allclose(first.root_path, second.root_path, atol=1e-6)
    np.testing.assert_allclose(first.positions(), second.positions(), atol=1e-5)
    assert first.frame_time == second.frame_time


def words(path):
    """Return heading and table of a BVH file, numbers as numbers."""
    head, body = path.read_text().split("Frame Time:")
    return [_value(word) for word in head.split()], np.array(body.split()[1:], float)


def _value(word):
    try:
        return float(word)
    except ValueError:
        return word


@pytest.mark.parametrize("name", ["01_01", "01_03", "Boxing_Toes"])
def test_the_text_of_a_capture_survives(captures, tmp_path, name):
    source, copy = captures / f"{name}.bvh", tmp_path / "copy.bvh"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motion = read(source)
    write(motion, copy)
    same(read(copy), motion)
    head, table = words(source)
    copied_head, copied = words(copy)
    assert copied_head == head
    np.testing.assert_allclose(copied, table[: copied.size], atol=5e-7, rtol=0)
    assert table.size - copied.size in (0, motion.skeleton.n_joints * 3 + 3)


CHANGES = {
    "plain": [],
    "spelling": [("End Site", "end site toe"), ("3 Zrotation Xr", "3 zROTATION Xr")],
    "root turns first": [
        (
            "Xposition Yposition Zposition Zrotation Xrotation Yrotation",
            "Zrotation Xposition Xrotation Yposition Yrotation Zposition",
        )
    ],
    "position on a joint": [
        ("3 Zrotation Xrotation Yrotation", "4 Zrotation Xrotation Yrotation Yposition"),
        ("30 1 2 3", "30 1 2 3 11"),
        ("31 2 3 4", "31 2 3 4 12"),
        ("32 3 4 5", "32 3 4 5 13"),
    ],
    "two channels": [
        ("3 Zrotation Xrotation Yrotation", "2 Zrotation Xrotation"),
        ("30 1 2 3", "30 1 120"),
        ("31 2 3 4", "31 2 130"),
        ("32 3 4 5", "32 3 -140"),
    ],
    "one channel": [
        ("3 Zrotation Xrotation Yrotation", "1 Yrotation"),
        ("30 1 2 3", "30 100"),
        ("31 2 3 4", "31 170"),
        ("32 3 4 5", "32 190"),
    ],
    "no channel": [
        ("CHANNELS 3 Zrotation Xrotation Yrotation", "CHANNELS 0"),
        ("30 1 2 3", "30"),
        ("31 2 3 4", "31"),
        ("32 3 4 5", "32"),
    ],
    "full turns": [("30 1 2 3", "30 170 2 3"), ("31 2 3 4", "31 190 3 4"), ("32 3", "32 230")],
    "second past a quarter": [
        ("30 1 2 3", "30 1 89 3"),
        ("31 2 3", "31 2 93"),
        ("2 3 4 5", "2 3 98 5"),
    ],
    "first up to a half": [
        ("30 1 2 3", "30 20 160 3"),
        ("31 2 3 4", "31 10 170 3"),
        ("32 3 4 5", "32 0 165 3"),
    ],
}


@pytest.mark.parametrize("changes", CHANGES.values(), ids=CHANGES)
def test_a_file_comes_back_in_its_own_words(bvh, tmp_path, changes):
    source, copy = bvh(*changes), tmp_path / "copy.bvh"
    motion = read(source)
    write(motion, copy)
    same(read(copy), motion)
    head, table = words(source)
    copied_head, copied = words(copy)
    assert copied_head == head
    np.testing.assert_allclose(copied, table, atol=1e-7)


def test_a_layout_outlives_cutting_and_resampling(bvh, tmp_path):
    motion = read(bvh(("End Site", "end site toe")))
    write(motion[1:].resample(50), tmp_path / "b.bvh")
    text = (tmp_path / "b.bvh").read_text()
    assert "end site toe" in text
    assert "CHANNELS 3 Zrotation Xrotation Yrotation" in text
    assert "Frame Time: 0.02\n" in text


def test_channels_are_added_where_the_motion_needs_them(bvh, tmp_path):
    path = bvh(*CHANGES["one channel"], ("6 Xposition Yposition Zposition", "3"))
    path.write_text(path.read_text().replace("\n1 2 3 10", "\n10").replace("\n2 3 4 11", "\n11"))
    path.write_text(path.read_text().replace("\n3 4 5 12", "\n12"))
    motion = read(path)
    turns = motion.rotations.copy()
    turns[:, 1] = rot.from_rotation_vector([0.1, 0.2, 0.3])
    moved = np.tile(motion.skeleton.offsets, (3, 1, 1))
    moved[1, 2] += 1.0
    changed = replace(motion, rotations=turns, translations=moved, root_path=np.eye(3))
    write(changed, tmp_path / "b.bvh")
    again = read(tmp_path / "b.bvh")
    same(again, changed)
    np.testing.assert_allclose(again.translations[:, 1:], moved[:, 1:], atol=1e-6)


def test_joints_in_another_order_are_written_as_a_tree(tmp_path):
    skeleton = Skeleton(("a", "b", "c", "d"), (-1, 0, 0, 1), np.arange(12.0).reshape(4, 3))
    turns = rot.from_rotation_vector(np.linspace(0, 1, 24).reshape(2, 4, 3))
    motion = Motion(skeleton, turns, np.ones((2, 3)), 0.1)
    write(motion, tmp_path / "a.bvh")
    again = read(tmp_path / "a.bvh")
    assert again.skeleton.names == ("a", "b", "d", "c")
    places = again.positions()[:, [0, 1, 3, 2]]
    np.testing.assert_allclose(places, motion.positions(), atol=1e-6)


def test_names_cannot_break_the_file(tmp_path):
    skeleton = Skeleton(("a{b", "c # d"), (-1, 0), np.ones((2, 3)))
    motion = Motion(skeleton, rot.identity(1, 2), np.zeros((1, 3)), 0.1)
    write(motion, tmp_path / "a.bvh")
    assert read(tmp_path / "a.bvh").skeleton.names == ("a_b", "c___d")


def test_names_stay_words_and_different(tmp_path):
    names = ("a\0b", "a_b", "a{b", " a", "a", " ", "\x1f", "\n", "l\u2028", "c\td")
    skeleton = Skeleton(names, (-1, *range(9)), np.ones((10, 3)))
    motion = Motion(skeleton, rot.identity(1, 10), np.zeros((1, 3)), 0.1)
    write(motion, tmp_path / "a.bvh")
    expected = ("a_b", "a_b_", "a_b__", "a", "a_", "_", "__", "___", "l", "c\td")
    assert read(tmp_path / "a.bvh").skeleton.names == expected


def test_a_motion_without_frames_is_not_written(bvh, tmp_path):
    motion = read(bvh())
    with pytest.raises(TooShort):
        write(motion[1:1], tmp_path / "b.bvh")
    assert not (tmp_path / "b.bvh").exists()


def test_a_failed_write_leaves_what_was_there(bvh, tmp_path, monkeypatch):
    motion, target = read(bvh()), tmp_path / "b.bvh"
    target.write_text("before")
    monkeypatch.setattr("os.replace", lambda *_: (_ for _ in ()).throw(OSError("full")))
    with pytest.raises(OSError, match="full"):
        write(motion, target)
    assert target.read_text() == "before"
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.bvh", "b.bvh"]


@st.composite
def motions(draw):
    joints, frames = draw(st.integers(1, 6)), draw(st.integers(1, 5))
    seed = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    parents = [-1] + [int(seed.integers(joint)) for joint in range(1, joints)]
    offsets = seed.normal(size=(joints, 3)) * 10.0 ** draw(st.integers(-2, 3))
    ends = tuple((joint, seed.normal(size=3)) for joint in range(joints) if seed.random() < 0.5)
    skeleton = Skeleton(tuple(f"j{i}" for i in range(joints)), tuple(parents), offsets, ends)
    turns = rot.normalize(seed.normal(size=(frames, joints, 4)))
    if draw(st.booleans()):
        # Quarter turns meet gimbal lock.
        turns = rot.from_euler(np.radians(90.0 * seed.integers(-3, 4, (frames, joints, 3))), "ZYX")
    moved = None
    if draw(st.booleans()):
        moved = offsets + seed.normal(size=(frames, joints, 3))
    path, time = seed.normal(size=(frames, 3)), draw(st.floats(1e-4, 1.0))
    return Motion(skeleton, turns, path, time, moved)


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(motion=motions())
def test_any_motion_comes_back(motion, tmp_path_factory):
    path = tmp_path_factory.mktemp("any") / "a.bvh"
    write(motion, path)
    again = read(path)
    order = [motion.skeleton.index(name) for name in again.skeleton.names]
    angles = rot.angle_between(again.rotations, motion.rotations[:, order])
    assert np.degrees(angles).max() < 1e-6
    np.testing.assert_allclose(again.positions(), motion.positions()[:, order], atol=1e-5)
    assert again.frame_time == motion.frame_time
    write(again, path)
    same(read(path), again)
