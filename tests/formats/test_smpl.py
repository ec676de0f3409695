"""Poses of SMPL bodies, as AMASS keeps them."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import roundelay as rl
from roundelay.formats import is_capture
from roundelay.formats.smpl import SmplReader
from roundelay.geometry import rotations as rot
from roundelay.testing import check_reader

JOINTS = {66: 22, 72: 24, 156: 52, 165: 55}


def saved(path, width=156, frames=6, **more):
    rng = np.random.default_rng(0)
    arrays = {
        "poses": 0.3 * rng.normal(size=(frames, width)),
        "trans": rng.normal(size=(frames, 3)),
        "mocap_framerate": np.array(120.0),
        "betas": np.zeros(16),
    }
    np.savez(path, **{k: v for k, v in (arrays | more).items() if v is not None})
    return path, arrays


@pytest.mark.parametrize(("width", "joints"), JOINTS.items())
def test_each_model_by_its_numbers(tmp_path, width, joints):
    path, arrays = saved(tmp_path / "a.npz", width)
    motion = rl.read(path)
    assert (len(motion), motion.skeleton.n_joints) == (6, joints)
    assert motion.fps == pytest.approx(120)
    assert np.allclose(motion.root_path, arrays["trans"])
    turns = rot.from_rotation_vector(arrays["poses"].reshape(6, -1, 3))
    assert np.allclose(rot.angle_between(motion.rotations, turns), 0, atol=1e-6)
    assert motion.skeleton.names[:3] == ("pelvis", "left_hip", "right_hip")


def test_parts_of_poses(tmp_path):
    widths = {"root_orient": 3, "pose_body": 63, "pose_jaw": 3, "pose_eye": 6, "pose_hand": 90}
    parts = {name: np.full((4, width), 0.1) for name, width in widths.items()}
    path, _ = saved(
        tmp_path / "a.npz", frames=4, poses=None, mocap_frame_rate=np.array(60), **parts
    )
    assert rl.read(path).skeleton.n_joints == 55
    parts["pose_body"] = parts["pose_body"][:2]
    path, _ = saved(tmp_path / "b.npz", frames=4, poses=None, **parts)
    with pytest.raises(rl.FormatError, match=r"one number of frames, found \[2, 4\]"):
        rl.read(path)


def test_the_body_is_a_person_that_stands(tmp_path):
    path, _ = saved(tmp_path / "a.npz", poses=np.zeros((6, 156)), trans=np.zeros((6, 3)))
    places = rl.read(path).positions()[0]
    height = np.ptp(places[:, 1])
    assert 1.4 < height < 1.7
    assert np.abs(places.sum(axis=0)[0]) < 1e-9  # as wide to both sides


def test_nothing_is_unpickled(tmp_path):
    class Bomb:
        def __reduce__(self):
            return (exec, ("raise SystemExit",))

    path, _ = saved(tmp_path / "a.npz", poses=np.array([Bomb()], object))
    with pytest.raises(rl.FormatError, match="expected 'poses' of numbers, found object"):
        rl.read(path)
    (tmp_path / "b.npz").write_bytes(pickle.dumps({"poses": 1}))
    with pytest.raises(rl.FormatError):
        rl.read(tmp_path / "b.npz")


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"poses": np.zeros((6, 100))}, "expected 66, 72, 156, 165 numbers in a pose, found 100"),
        ({"poses": np.zeros(6)}, r"'poses' of shape \(F, n\), found \(6,\)"),
        ({"trans": np.zeros((5, 3))}, r"'trans' of shape \(6, 3\), found \(5, 3\)"),
        ({"poses": np.full((6, 156), np.nan)}, "finite numbers .* in 'poses'"),
        ({"mocap_framerate": np.array(-1.0)}, "positive 'mocap_framerate', found -1"),
    ],
)
def test_what_is_wrong_is_said(tmp_path, more, message):
    path, _ = saved(tmp_path / "a.npz", **more)
    with pytest.raises(rl.FormatError, match=message):
        rl.read(path)


def test_other_npz_are_points_or_no_captures(tmp_path):
    np.savez(tmp_path / "other.npz", weights=np.zeros(3))
    assert not is_capture(tmp_path / "other.npz")
    path, _ = saved(tmp_path / "a.npz")
    assert is_capture(path)
    with pytest.raises(rl.FormatError, match="expected an array 'positions'"):
        rl.read(tmp_path / "other.npz")


def test_the_conformance_of_readers(tmp_path):
    path, _ = saved(tmp_path / "a.npz", 66, 2)
    check_reader(SmplReader(), [path])
