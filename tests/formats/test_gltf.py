"""glTF as written: read back from its JSON and binary chunks."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.geometry import rotations as rot

WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def parsed(path: Path) -> tuple[dict, bytes]:
    raw = path.read_bytes()
    if path.suffix == ".gltf":
        document = json.loads(raw)
        return document, base64.b64decode(document["buffers"][0]["uri"].split(",")[1])
    magic, version, size = struct.unpack_from("<4sII", raw)
    assert (magic, version, size) == (b"glTF", 2, len(raw))
    length, kind = struct.unpack_from("<I4s", raw, 12)
    assert kind == b"JSON"
    assert length % 4 == 0
    after, kind = struct.unpack_from("<I4s", raw, 20 + length)
    assert kind == b"BIN\0"
    return json.loads(raw[20 : 20 + length]), raw[28 + length : 28 + length + after]


def values(document: dict, data: bytes, number: int) -> np.ndarray:
    accessor = document["accessors"][number]
    view = document["bufferViews"][accessor["bufferView"]]
    width = WIDTHS[accessor["type"]]
    rows = np.frombuffer(data, "<f4", accessor["count"] * width, view["byteOffset"])
    assert view["byteLength"] == rows.nbytes
    return rows.reshape(-1, width)


def matrix(rotation: np.ndarray, translation: np.ndarray) -> np.ndarray:
    result = np.eye(4)
    result[:3, :3] = rot.to_matrix(np.roll(rotation, 1))
    result[:3, 3] = translation
    return result


def places(document: dict, data: bytes, frame: int | None) -> np.ndarray:
    """Global matrices of all nodes in a frame, or at rest."""
    nodes, animation = document["nodes"], document["animations"][0]
    local = [
        {
            "rotation": np.array(node.get("rotation", [0, 0, 0, 1])),
            "translation": np.array(node["translation"]),
        }
        for node in nodes
    ]
    if frame is not None:
        for channel in animation["channels"]:
            output = animation["samplers"][channel["sampler"]]["output"]
            target = channel["target"]
            local[target["node"]][target["path"]] = values(document, data, output)[frame]
    result = np.tile(np.eye(4), (len(nodes), 1, 1))
    result[0] = matrix(**local[0])
    for number, node in enumerate(nodes):
        for child in node.get("children", []):
            result[child] = result[number] @ matrix(**local[child])
    return result


@pytest.fixture(scope="module", params=[".glb", ".gltf"])
def written(request, tmp_path_factory):
    motion = synth.gait("run", repetitions=1, fps=30).motion
    path = tmp_path_factory.mktemp("gltf") / f"run{request.param}"
    rl.write(motion, path)
    return motion, *parsed(path)


def test_joints_are_where_they_were(written):
    motion, document, data = written
    for frame in (0, 7, len(motion) - 1):
        found = places(document, data, frame)[: motion.skeleton.n_joints, :3, 3]
        assert np.allclose(found, motion.positions()[frame], atol=1e-5)


def test_names_times_and_ends(written):
    motion, document, data = written
    names = [node["name"] for node in document["nodes"]]
    ends = [f"{motion.skeleton.names[joint]}_end" for joint, _ in motion.skeleton.end_sites]
    assert names == [*motion.skeleton.names, *ends]
    sampler = document["animations"][0]["samplers"][0]
    times = values(document, data, sampler["input"])[:, 0]
    assert np.allclose(times, np.arange(len(motion)) / 30)
    accessor = document["accessors"][sampler["input"]]
    assert accessor["min"] == [0.0]
    assert accessor["max"] == [pytest.approx(times[-1])]


def test_bind_matrices_undo_the_rest_pose(written):
    _, document, data = written
    skin = document["skins"][0]
    inverse = values(document, data, skin["inverseBindMatrices"]).reshape(-1, 4, 4)
    rest = places(document, data, None)[skin["joints"]]
    assert np.allclose(rest @ np.swapaxes(inverse, 1, 2), np.eye(4), atol=1e-5)


@pytest.mark.parametrize("up", [0, 2])
def test_up_becomes_y(tmp_path, up):
    made = synth.gait("walk", repetitions=1, fps=30).motion
    turn = rot.from_rotation_vector(np.array([[0, 0, -1], [], [1, 0, 0]][up]) * np.pi / 2)
    rotations = made.rotations.copy()
    rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
    path = rot.rotate(turn, made.root_path)
    motion = rl.Motion(made.skeleton, rotations, path, made.frame_time, up=up)
    rl.write(motion, tmp_path / "a.glb")
    document, data = parsed(tmp_path / "a.glb")
    found = places(document, data, 5)[: made.skeleton.n_joints, :3, 3]
    assert np.allclose(found, made.positions()[5], atol=1e-5)
    skin = document["skins"][0]
    inverse = values(document, data, skin["inverseBindMatrices"]).reshape(-1, 4, 4)
    rest = places(document, data, None)[skin["joints"]]
    assert np.allclose(rest @ np.swapaxes(inverse, 1, 2), np.eye(4), atol=1e-5)


def test_bones_that_change_length_move(tmp_path):
    made = synth.gait("walk", repetitions=1, fps=30).motion
    moved = np.tile(made.skeleton.offsets, (len(made), 1, 1))
    moved[:, 3, 1] += 0.1 * np.sin(np.arange(len(made)))
    motion = rl.Motion(made.skeleton, made.rotations, made.root_path, made.frame_time, moved)
    rl.write(motion, tmp_path / "a.glb")
    document, data = parsed(tmp_path / "a.glb")
    channels = document["animations"][0]["channels"]
    assert [c["target"]["node"] for c in channels if c["target"]["path"] == "translation"] == [0, 3]
    found = places(document, data, 8)[: made.skeleton.n_joints, :3, 3]
    assert np.allclose(found, motion.positions()[8], atol=1e-5)
