"""FBX as written, read by programs of others, where they are there: ufbx and assimp.

Blender's two importers read it in `blender/tests/test_fbx.py`.
"""

from __future__ import annotations

import json
import shutil
import struct
import subprocess
from pathlib import Path

import fbx_samples
import numpy as np
import pytest

import roundelay as rl
from roundelay.geometry import rotations as rot

# Body sizes by which a joint may be elsewhere.
CLOSE = 1e-5
POSES = 40


@pytest.fixture(scope="module", params=fbx_samples.NAMES)
def written(request, captures, tmp_path_factory):
    motion = fbx_samples.made(request.param, captures)
    path = tmp_path_factory.mktemp("fbx") / "a.fbx"
    rl.write(motion, path)
    return motion, path


def some_frames(motion: rl.Motion) -> np.ndarray:
    return np.unique(np.linspace(0, len(motion) - 1, POSES).astype(int))


def check(motion: rl.Motion, frames: np.ndarray, turns: np.ndarray, places: np.ndarray) -> None:
    """Compare local rotations (n, J, 4), w first, and places (n, J, 3) with a motion's poses."""
    found = rl.Motion(motion.skeleton, turns, places[:, 0], motion.frame_time, places)
    apart = np.abs(found.positions() - motion.positions()[frames])
    assert apart.max() < CLOSE * max(motion.skeleton.size, np.abs(motion.root_path).max())


def test_ufbx(written):
    ufbx = pytest.importorskip("ufbx")
    motion, path = written
    kept = [ufbx.load_file(str(path))]  # it crashes on what outlives its parent

    def keep(one):
        kept.append(one)
        return one

    scene, axes = kept[0], keep(keep(kept[0].settings).axes)
    assert axes.up == 2 * motion.up  # signs lie between
    assert keep(scene.settings).unit_meters == pytest.approx(0.01)
    assert keep(scene.settings).frames_per_second == pytest.approx(motion.fps)
    (stack,) = keep(list(keep(scene.anim_stacks)))
    assert (stack.name, stack.time_begin) == (motion.name, 0.0)
    assert stack.time_end == pytest.approx((len(motion) - 1) * motion.frame_time)
    (pose,) = keep(list(keep(scene.poses)))
    bones = motion.skeleton.n_joints + len(motion.skeleton.end_sites)
    assert pose.is_bind_pose
    assert (len(keep(pose.bone_poses)), len(keep(scene.bones))) == (bones, bones)
    assert not len(keep(keep(scene.metadata).warnings))
    nodes = {node.name: node for node in keep(list(keep(scene.nodes)))}
    anim, frames = keep(scene.anim), some_frames(motion)
    turns = np.empty((len(frames), motion.skeleton.n_joints, 4))
    places = np.empty((*turns.shape[:2], 3))
    for row, frame in enumerate(frames):
        for joint, name in enumerate(motion.skeleton.names):
            time = float(frame * motion.frame_time)
            pose = keep(ufbx.evaluate_transform(anim, nodes[name], time))
            turn, place = keep(pose.rotation), keep(pose.translation)
            turns[row, joint] = turn.w, turn.x, turn.y, turn.z
            places[row, joint] = place.x, place.y, place.z
    check(motion, frames, turns, places)


@pytest.mark.skipif(not shutil.which("assimp"), reason="assimp is not there")
def test_assimp(written):
    """What assimp reads, it writes as glTF, key for key."""
    motion, path = written
    told = subprocess.run(["assimp", "info", path], capture_output=True, text=True, check=True)
    rows = dict(line.split(":", 1) for line in told.stdout.splitlines() if line.count(":") == 1)
    assert int(rows["Animations"]) == 1
    bones = motion.skeleton.n_joints + len(motion.skeleton.end_sites)
    assert int(rows["Nodes"]) == bones + 1
    again = path.with_suffix(".glb")
    subprocess.run(["assimp", "export", path, again], capture_output=True, check=True)
    turns, places = from_glb(again, motion)
    check(motion, np.arange(len(motion)), turns, places)


def from_glb(path: Path, motion: rl.Motion) -> tuple[np.ndarray, np.ndarray]:
    raw = path.read_bytes()
    (length,) = struct.unpack_from("<I", raw, 12)
    document, data = json.loads(raw[20 : 20 + length]), raw[28 + length :]
    turns = rot.identity(len(motion), motion.skeleton.n_joints)
    places = np.tile(motion.skeleton.offsets, (len(motion), 1, 1))
    names = [node.get("name") for node in document["nodes"]]
    (animation,) = document["animations"]
    for channel in animation["channels"]:
        name, kind = names[channel["target"]["node"]], channel["target"]["path"]
        if name not in motion.skeleton.names or kind == "scale":
            continue
        accessor = document["accessors"][animation["samplers"][channel["sampler"]]["output"]]
        view = document["bufferViews"][accessor["bufferView"]]
        start = view["byteOffset"] + accessor.get("byteOffset", 0)
        width = 4 if kind == "rotation" else 3
        rows = np.frombuffer(data, "<f4", accessor["count"] * width, start).reshape(-1, width)
        joint = motion.skeleton.index(name)
        if kind == "rotation":
            turns[:, joint] = np.roll(rows, 1, axis=-1)
        else:
            places[:, joint] = rows
    return turns, places
