"""glTF read back: our own files, made ones of other kinds, and broken ones."""

from __future__ import annotations

import base64
import json
import struct
import time
import warnings
from pathlib import Path

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.formats import contents_of
from roundelay.geometry import rotations as rot

HALF = np.sqrt(0.5)


class Made:
    """A glTF document put together by hand."""

    def __init__(self, nodes: list[dict], **more) -> None:
        self.data = b""
        self.document = {
            "asset": {"version": "2.0"},
            "nodes": nodes,
            "bufferViews": [],
            "accessors": [],
            "animations": [{"samplers": [], "channels": []}],
            **more,
        }

    def view(self, content: bytes, **more) -> int:
        self.data += b"\0" * (-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(content), **more}
        self.document["bufferViews"].append(view)
        self.data += content
        return len(self.document["bufferViews"]) - 1

    def accessor(self, values, kind: str, dtype: str = "<f4", **more) -> int:
        codes = {"<f4": 5126, "i1": 5120, "u1": 5121, "<i2": 5122, "<u2": 5123}
        rows = np.asarray(values, dtype)
        entry = {"componentType": codes[dtype], "count": len(rows), "type": kind, **more}
        if "bufferView" not in more:
            entry["bufferView"] = self.view(rows.tobytes())
        self.document["accessors"].append(entry)
        return len(self.document["accessors"]) - 1

    def track(self, node: int, path: str, times, values, mode=None, **more) -> None:
        width = {"rotation": "VEC4"}.get(path, "VEC3")
        sampler = {
            "input": self.accessor(times, "SCALAR"),
            "output": values if isinstance(values, int) else self.accessor(values, width, **more),
        }
        animation = self.document["animations"][0]
        animation["samplers"].append(sampler | ({"interpolation": mode} if mode else {}))
        target = {"node": node, "path": path}
        number = len(animation["samplers"]) - 1
        animation["channels"].append({"sampler": number, "target": target})

    def saved(self, path: Path, uri: str | None = None) -> Path:
        if uri is None:
            uri = "data:application/gltf-buffer;base64," + base64.b64encode(self.data).decode()
        self.document["buffers"] = [{"uri": uri, "byteLength": len(self.data)}]
        path.write_text(json.dumps(self.document))
        return path


def two_bones(**more) -> Made:
    """A hip on the ground with a leg of length 1 on it."""
    nodes = [
        {"name": "hip", "children": [1], "translation": [0, 1, 0]},
        {"name": "leg", "translation": [0, -1, 0]},
    ]
    return Made(nodes, skins=[{"joints": [0, 1]}], **more)


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
@pytest.mark.parametrize("name", ["01_01", "01_03", "Boxing_Toes"])
def test_captures_come_back(captures, tmp_path, name, suffix):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rl.RoundelayWarning)
        motion = rl.read(captures / f"{name}.bvh")[100:700]
    rl.write(motion, tmp_path / f"a{suffix}")
    again = rl.read(tmp_path / f"a{suffix}")
    assert len(again) == len(motion)
    assert again.fps == pytest.approx(motion.fps, rel=1e-6)
    assert again.skeleton.names == motion.skeleton.names
    assert again.skeleton.parents == motion.skeleton.parents
    assert np.allclose(again.skeleton.offsets, motion.skeleton.offsets)
    ends = zip(again.skeleton.end_sites, motion.skeleton.end_sites, strict=True)
    assert all(a == b and np.allclose(x, y) for (a, x), (b, y) in ends)
    away = np.abs(again.positions() - motion.positions()).max()
    assert away < 1e-5 * motion.skeleton.size
    assert again.translations is None


def test_a_long_capture_keeps_its_frames(captures, tmp_path):
    jumps = rl.read(captures / "01_03.bvh")
    rl.write(jumps, tmp_path / "a.glb")
    again = rl.read(tmp_path / "a.glb")
    assert len(again) == len(jumps)
    assert again.fps == pytest.approx(jumps.fps, rel=1e-6)
    assert np.abs(again.positions() - jumps.positions()).max() < 1e-5 * jumps.skeleton.size


@pytest.mark.parametrize("fps", [1.0, 10.0, 23.976, 30.0, 240.0, 960.0])
def test_rates_come_back_and_a_loop_keeps_its_last_frame(tmp_path, fps):
    cycle = rl.find_cycles(synth.gait("walk").motion)[0]
    loop = cycle.sample(fps, repeat_first=True)
    rl.write(loop, tmp_path / "a.glb")
    again = rl.read(tmp_path / "a.glb")
    assert len(again) == len(loop)
    assert again.fps == pytest.approx(fps, rel=1e-6)
    assert np.allclose(again.rotations, rot.continuous(loop.rotations), atol=1e-6)


def test_bones_that_change_length_and_z_up_come_back(tmp_path):
    made = synth.gait("walk", repetitions=1, fps=30).motion
    moved = np.tile(made.skeleton.offsets, (len(made), 1, 1))
    moved[:, 3, 1] += 0.1 * np.sin(np.arange(len(made)))
    turn = rot.from_rotation_vector([np.pi / 2, 0.0, 0.0])
    rotations = made.rotations.copy()
    rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
    path = rot.rotate(turn, made.root_path)
    motion = rl.Motion(made.skeleton, rotations, path, made.frame_time, moved, up=2)
    rl.write(motion, tmp_path / "a.glb")
    again = rl.read(tmp_path / "a.glb")
    assert again.up == 1
    assert again.translations is not None
    there = rot.rotate(rot.conjugate(turn), motion.positions())
    assert np.abs(again.positions() - there).max() < 1e-5 * motion.skeleton.size


def test_nodes_with_matrices(tmp_path):
    """A quarter turn about X above, lengths in centimetres, as exporters put it there."""
    armature = [0.01, 0, 0, 0, 0, 0, -0.01, 0, 0, 0.01, 0, 0, 0, 0, 5, 1]
    hip = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0, 100, 1]
    nodes = [
        {"name": "armature", "children": [1], "matrix": armature},
        {"name": "hip", "children": [2], "matrix": hip},
        {"name": "leg", "translation": [0, 0, -100]},
    ]
    made = Made(nodes, skins=[{"joints": [1, 2]}])
    made.track(2, "rotation", [0, 1 / 30], [[0, 0, 0, 1], [0, 0, 0, 1]])
    motion = rl.read(made.saved(tmp_path / "a.gltf"))
    assert motion.skeleton.names == ("hip", "leg")
    assert np.allclose(motion.positions()[1], [[0.1, 1, 5], [0.1, 0, 5]])
    assert np.allclose(motion.skeleton.offsets[1], [0, 0, -1])


def test_a_matrix_that_is_none(tmp_path):
    made = two_bones()
    made.document["nodes"][1] = {"matrix": [1.0] * 16}
    made.track(0, "translation", [0, 1], np.zeros((2, 3)))
    with pytest.raises(rl.FormatError, match=r"expected a matrix .* at nodes\[1\]\.matrix"):
        rl.read(made.saved(tmp_path / "a.gltf"))


def test_steps_hold_and_come_in_their_frame(tmp_path):
    made = two_bones()
    times = (np.arange(4) / 30).astype("<f4")
    made.track(0, "translation", times, np.outer(np.arange(4), [1, 0, 0]))
    later = np.nextafter(times[[0, 2, 3]], np.float32(1))
    made.track(1, "translation", later, [[0, 0, 0], [0, 2, 0], [0, 3, 0]], "STEP")
    motion = rl.read(made.saved(tmp_path / "a.gltf"))
    assert motion.fps == 30.0
    assert np.allclose(
        motion.positions()[:, 1] - motion.positions()[:, 0], [[0, y, 0] for y in (0, 0, 2, 3)]
    )


def test_cubic_splines_are_followed_between_their_keys(tmp_path):
    """Two keys of a second and tangents that make x = t^3, sampled finer than its keys."""
    made = two_bones()
    x = np.zeros((6, 3))
    x[:, 0] = [0, 0, 0, 3, 1, 0]
    made.track(0, "translation", [0, 1], x, "CUBICSPLINE")
    quarter = [[0, 0, 0, 0], [0, 0, 0, 1], [0] * 4, [0] * 4, [0, 0, HALF, HALF], [0] * 4]
    made.track(1, "rotation", [0, 1], quarter, "CUBICSPLINE")
    motion = rl.read(made.saved(tmp_path / "a.gltf"))
    assert (len(motion), motion.fps) == (25, 24.0)
    assert np.allclose(motion.root_path[:, 0], (np.arange(25) / 24) ** 3, atol=1e-6)
    assert np.allclose(motion.rotations[12, 1], rot.normalize([1 + HALF, 0, 0, HALF]), atol=1e-6)


def test_keys_left_out_are_filled_in(tmp_path):
    made = two_bones()
    made.track(0, "translation", np.array([0, 3, 7]) / 60, [[0, 0, 0], [3, 0, 0], [7, 0, 0]])
    made.track(1, "rotation", [0, 7 / 60], [[0, 0, 0, 1], [0, 0, 0, 1]])
    motion = rl.read(made.saved(tmp_path / "a.gltf"))
    assert (len(motion), motion.fps) == (8, 60.0)
    assert np.allclose(motion.root_path[:, 0], np.arange(8), atol=1e-5)


def test_uneven_keys_are_sampled_at_30(tmp_path):
    made = two_bones()
    times = [0, 0.123, np.sqrt(0.5), 1.0]
    made.track(0, "translation", times, np.outer(times, [1, 0, 0]))
    with pytest.warns(rl.RoundelayWarning, match="uneven times are sampled at 30 frames a second"):
        motion = rl.read(made.saved(tmp_path / "a.gltf"))
    assert (len(motion), motion.fps) == (31, 30.0)
    assert np.allclose(motion.root_path[:, 0], np.arange(31) / 30, atol=1e-6)


def test_without_a_skin_what_moves_is_the_skeleton(tmp_path):
    nodes = [
        {"name": "scene", "children": [1, 4], "translation": [1, 0, 0]},
        {"name": "hip", "children": [2]},
        {"name": "leg", "children": [3], "translation": [0, -1, 0]},
        {"name": "leg_end", "translation": [0, -0.5, 0]},
        {"name": "lamp"},
    ]
    made = Made(nodes)
    made.track(1, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    made.track(2, "rotation", [0, 1 / 30], [[0, 0, 0, 1], [0, 0, HALF, HALF]])
    motion = rl.read(made.saved(tmp_path / "a.gltf"))
    assert motion.skeleton.names == ("hip", "leg")
    assert [joint for joint, _ in motion.skeleton.end_sites] == [1]
    assert np.allclose(motion.root_path, [[1, 1, 0], [1, 2, 0]])


def test_a_moving_node_above_moves_the_root(tmp_path):
    nodes = [
        {"name": "armature", "children": [1]},
        {"name": "hip", "children": [2], "translation": [0, 1, 0]},
        {"name": "leg", "translation": [0, -1, 0]},
    ]
    made = Made(nodes, skins=[{"joints": [2, 1]}])
    made.track(0, "translation", [0, 1 / 30], [[0, 0, 0], [0, 0, 3]])
    made.track(0, "scale", [0, 1 / 30], [[2, 2, 2], [2, 2, 2]])
    motion = rl.read(made.saved(tmp_path / "a.gltf"))
    assert np.allclose(motion.positions()[1], [[0, 2, 3], [0, 0, 3]])


def test_scales_that_change_are_left_out(tmp_path):
    made = two_bones()
    made.track(0, "scale", [0, 1 / 30], [[1, 1, 1], [2, 2, 2]])
    made.document["nodes"][1]["scale"] = [1, 2, 1]
    with pytest.warns(rl.RoundelayWarning, match="left out: of hip, leg"):
        motion = rl.read(made.saved(tmp_path / "a.gltf"))
    assert np.allclose(motion.positions()[1], [[0, 1, 0], [0, 0, 0]])


def test_the_first_animation_is_read_and_the_others_named(tmp_path):
    made = two_bones()
    made.track(0, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    first = made.document["animations"][0] | {"name": "walk"}
    made.document["animations"] = [{"channels": []}, first, first | {"name": "run"}]
    path = made.saved(tmp_path / "a.gltf")
    with pytest.warns(rl.RoundelayWarning, match="animation 'walk' is read, not .*'run'"):
        assert len(rl.read(path)) == 2


def test_joints_of_two_trees(tmp_path):
    made = two_bones()
    made.document["nodes"].append({"name": "hat"})
    made.document["skins"] = [{"joints": [0, 1]}, {"joints": [0, 1, 2]}]
    made.track(0, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    with pytest.warns(rl.RoundelayWarning, match="of 2 trees of joints, that below 'hip' is read"):
        assert rl.read(made.saved(tmp_path / "a.gltf")).skeleton.names == ("hip", "leg")


def test_an_animation_of_another_tree(tmp_path):
    made = two_bones()
    made.document["nodes"].append({"name": "hat"})
    made.document["skins"] = [{"joints": [0, 1, 2]}]
    made.track(2, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    path = made.saved(tmp_path / "a.gltf")
    with (
        pytest.warns(rl.RoundelayWarning, match="of 2 trees"),
        pytest.raises(rl.FormatError, match="an animation that moves the skeleton's nodes"),
    ):
        rl.read(path)


def test_names_that_are_alike_or_missing(tmp_path):
    nodes = [{"children": [1, 2]}, {"name": "leg"}, {"name": "leg"}]
    made = Made(nodes, skins=[{"joints": [0, 1, 2]}])
    made.track(0, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    assert rl.read(made.saved(tmp_path / "a.gltf")).skeleton.names == ("node0", "leg", "leg_2")


@pytest.mark.parametrize("name", ["a.bvh", "a.amc", "a.glb", "a.fbx"])
def test_any_name_that_is_read_can_be_written(tmp_path, name):
    """With every character that a name can be made of, and none."""
    signs = [chr(n) for n in (*range(33), 127, 133, 160, 0x2028, 0xFFFF, 0x1F600)]
    names = ["hip", *signs, *(f"a{sign}b" for sign in signs), "{", "#", "//", "root", ":x"]
    nodes = [{"name": name, "translation": [0, 0.1, 0]} for name in names]
    nodes[0]["children"] = list(range(1, len(nodes)))
    made = Made(nodes, skins=[{"joints": list(range(len(nodes)))}])
    made.track(0, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    motion = rl.read(made.saved(tmp_path / "in.gltf"))
    rl.write(motion, tmp_path / name)
    if name != "a.fbx":
        again = rl.read(tmp_path / name)
        assert again.skeleton.n_joints >= motion.skeleton.n_joints == len(names)


def test_whole_numbers_strides_and_sparse_values(tmp_path):
    made = two_bones()
    wide = np.zeros((3, 5), "<f4")
    wide[:, 1:4] = [[0, 1, 0], [0, 2, 0], [0, 3, 0]]
    view = made.view(wide.tobytes(), byteStride=20)
    strided = made.accessor(wide, "VEC3", bufferView=view, byteOffset=4)
    made.track(0, "translation", np.arange(3) / 30, strided)
    turns = np.array([[0, 0, 0, 127], [0, 0, 90, 90], [0, 0, -128, 0]], "i1")
    packed = made.accessor(turns, "VEC4", dtype="i1", normalized=True)
    made.track(1, "rotation", np.arange(3) / 30, packed)
    sparse = {
        "count": 1,
        "indices": {"bufferView": made.view(b"\2"), "componentType": 5121},
        "values": {"bufferView": made.view(np.array([0, -2, 0], "<f4").tobytes())},
    }
    made.document["accessors"].append(
        {"componentType": 5126, "count": 3, "type": "VEC3", "sparse": sparse}
    )
    made.track(1, "translation", np.arange(3) / 30, len(made.document["accessors"]) - 1)
    motion = rl.read(made.saved(tmp_path / "a.gltf"))
    assert np.allclose(motion.root_path[:, 1], [1, 2, 3])
    assert np.allclose(
        np.abs(motion.rotations[:, 1]), [[1, 0, 0, 0], [HALF, 0, 0, HALF], [0, 0, 0, 1]]
    )
    assert np.allclose(motion.positions()[:, 1, 1], [1, 2, 1])


def test_a_buffer_beside_the_file_and_further_down(tmp_path):
    made = two_bones()
    made.track(0, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    (tmp_path / "deep").mkdir()
    for name, uri in (("a b.bin", "a%20b.bin"), ("deep/c.bin", "deep/../deep/c.bin")):
        (tmp_path / name).write_bytes(made.data)
        assert len(rl.read(made.saved(tmp_path / "a.gltf", uri))) == 2


@pytest.mark.parametrize(
    "uri",
    [
        "../secret.bin",
        "%2e%2e/secret.bin",
        "link.bin",
        "{there}/secret.bin",
        "file://{there}/secret.bin",
        "http://localhost/secret.bin",
        "..",
        "none.bin",
        "a\0b",
        "x" * 5000,
        "short.bin",
        "data:;base64,@@@@",
        "data:text/plain,aaaa",
    ],
)
def test_buffers_that_are_not_read(tmp_path, uri):
    made, folder = two_bones(), tmp_path / "here"
    made.track(0, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    folder.mkdir()
    (tmp_path / "secret.bin").write_bytes(made.data)
    (folder / "link.bin").symlink_to(tmp_path / "secret.bin")
    (folder / "short.bin").write_bytes(made.data[:-1])
    path = made.saved(folder / "a.gltf", uri.format(there=tmp_path))
    with pytest.raises(rl.FormatError, match=r"at buffers\[0\]"):
        rl.read(path)


def changed(where: str, value) -> Made:
    """A good file in which one value is another."""
    made = two_bones()
    made.track(0, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    made.track(1, "rotation", [0, 1 / 30], [[0, 0, 0, 1], [0, 0, 0, 1]])
    *steps, last = where.split(".")
    part = made.document
    for step in steps:
        part = part[int(step) if step.isdigit() else step]
    part[int(last) if last.isdigit() else last] = value
    return made


@pytest.mark.parametrize(
    ("where", "value", "message"),
    [
        ("asset.version", "1.0", r"expected version 2\.x, found '1.0' at asset.version"),
        ("nodes", [], "expected nodes, found none"),
        ("nodes", {}, "expected a list, found {} at nodes"),
        ("nodes.1.children", [0], r"expected a tree of nodes, found node 'hip' below itself"),
        ("nodes.1.children", [1], r"expected children without another parent"),
        ("nodes.0.children", [7], r"at most 1, found 7 at nodes\[0\]\.children\[0\]"),
        ("nodes.0.translation", [0, 0], r"expected 3 numbers, found \[0, 0\] at nodes\[0\]"),
        ("nodes.0.translation", [0, 0, 1e300], "expected 3 numbers of at most 1e"),
        ("nodes.0.translation", [0, 0, 10**400], "expected 3 numbers of at most 1e"),
        ("nodes.0.rotation", [0, 0, 0, 0], "expected a quaternion of length 1"),
        ("skins.0.joints", [], "expected a skin with joints, found none"),
        ("skins.0.joints", [2], r"at skins\[0\]\.joints\[0\]"),
        ("animations", [], "expected an animation, found none"),
        ("animations.0.channels", [], "an animation that moves the skeleton's nodes"),
        ("animations.0.channels.0.target.node", -1, r"whole number .* found -1"),
        ("animations.0.channels.0.target.node", True, r"whole number .* found True"),
        ("animations.0.channels.1.target", {"node": 0, "path": "translation"}, "one channel"),
        ("animations.0.samplers.0.interpolation", "CUBIC", "'LINEAR', 'STEP' or 'CUBICSPLINE'"),
        ("animations.0.samplers.0.interpolation", "CUBICSPLINE", "expected 6 values for 2 keys"),
        ("animations.0.samplers.0.input", 1, "expected an accessor of type 'SCALAR', found 'VEC3'"),
        ("animations.0.samplers.0.output", 99, r"at most 3, found 99"),
        ("accessors.0.count", 10**15, r"expected rows within 8 bytes, found 10+ that need"),
        ("accessors.0.count", 0, "at least 1, found 0"),
        ("accessors.0.componentType", 5130, "expected a component type among"),
        ("accessors.0.componentType", [], "expected a component type among"),
        ("accessors.0", {"componentType": 5126, "count": 10**9, "type": "SCALAR"}, "count of at"),
        ("accessors.0.byteOffset", 4, "expected rows within 8 bytes, found 2 that need 12"),
        ("bufferViews.0.byteStride", 2, "at least 4, found 2"),
        ("bufferViews.0.byteLength", 10**9, "expected bytes within a buffer of"),
        ("bufferViews.0.buffer", 1, "at most 0, found 1"),
        ("bufferViews.0.extensions", {"EXT_meshopt_compression": {}}, "expected plain data"),
        ("bufferViews.0.extensions", {"\ud800compression": 1}, r"found '\\ud800compression'"),
        ("bufferViews.0.extensions", None, "expected an object, found None at bufferViews"),
        ("bufferViews.0.extensions", 5, "expected an object, found 5 at bufferViews"),
        ("bufferViews.0.extensions", [5], r"expected an object, found \[5\] at bufferViews"),
        ("bufferViews.0.extensions", True, "expected an object, found True at bufferViews"),
        ("nodes.1.name", "leg\ud800", r"text that UTF-8 can hold, found 'leg\\ud800' at nodes"),
    ],
)
def test_what_is_wrong_is_said(tmp_path, where, value, message):
    with pytest.raises(rl.FormatError, match=message):
        rl.read(changed(where, value).saved(tmp_path / "a.gltf"))


@pytest.mark.parametrize(
    ("times", "values", "message"),
    [
        ([0, 0], [[0, 1, 0]] * 2, "expected times that rise"),
        ([0, 1e9], [[0, 1, 0]] * 2, "to 10000 frames a second, found 1e-09"),
        ([0, 9e3], [[0, 1, 0]] * 2, None),
        ([0, 1, 1e9 / 3, 2e9], [[0, 1, 0]] * 4, "expected fewer than 4194304 frames"),
        ([0, np.nan], [[0, 1, 0]] * 2, "expected finite numbers"),
        ([0, 1], [[0, 1, np.inf]] * 2, "expected finite numbers"),
        ([0, 1], [[0, 1, 1e30]] * 2, "expected finite numbers of at most"),
    ],
)
def test_keys_that_are_wrong(tmp_path, times, values, message):
    made = two_bones()
    made.track(0, "translation", times, values)
    path = made.saved(tmp_path / "a.gltf")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rl.RoundelayWarning)
        if message is None:
            assert len(rl.read(path)) == 2
        else:
            with pytest.raises(rl.FormatError, match=message):
                rl.read(path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"[" * 100_000, "lists within lists too deep"),
        (b'{"asset": {"version": NaN}}', "expected JSON, found NaN for a number"),
        (b'{"asset": ' + b"1" * 5000 + b"}", "expected JSON"),
        (b"\xff\xfe", "expected JSON"),
        (b"[]", "expected an object"),
        (b"glTF\2\0\0\0\xff\0\0\0", "expected 255 bytes, found 12"),
        (b"glTF\1\0\0\0\x0c\0\0\0", "expected GLB of version 2, found 1"),
        (b"glTF\2\0", "expected a header"),
        (struct.pack("<4sIIII", b"glTF", 2, 20, 9999, 0x4E4F534A), "a chunk of 9999 bytes"),
        (struct.pack("<4sIIII", b"glTF", 2, 20, 0, 0x004E4942), "expected a JSON chunk first"),
    ],
)
def test_what_is_no_gltf(tmp_path, content, message):
    path = tmp_path / "a.glb"
    path.write_bytes(content)
    with pytest.raises(rl.FormatError, match=message):
        rl.read(path)


def test_deep_trees_end_soon(tmp_path):
    count = 30_000
    nodes = [{"children": [n + 1]} for n in range(count - 1)] + [{}]
    made = Made(nodes, skins=[{"joints": list(range(count))}])
    made.track(0, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    path = made.saved(tmp_path / "a.gltf")
    started = time.perf_counter()
    with pytest.raises(rl.FormatError, match="at most 4096 joints"):
        rl.read(path)
    assert time.perf_counter() - started < 10.0


def test_a_huge_scale_down_the_tree_is_refused(tmp_path):
    nodes = [{"children": [n + 1], "scale": [1e9] * 3} for n in range(40)] + [{}]
    made = Made(nodes, skins=[{"joints": list(range(41))}])
    made.track(0, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    with pytest.raises(rl.FormatError, match="expected a scale that leaves lengths"):
        rl.read(made.saved(tmp_path / "a.gltf"))


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_mutated_files_give_a_motion_or_a_format_error(tmp_path, suffix):
    """Bytes exchanged, left out and doubled, half of them in the JSON."""
    motion = synth.gait("walk", repetitions=0.3, fps=30).motion
    path = tmp_path / f"a{suffix}"
    rl.write(motion, path)
    whole = path.read_bytes()
    rng, told = np.random.default_rng(20261127), []
    for _ in range(400):
        content = bytearray(whole)
        for _ in range(rng.integers(1, 4)):
            at = int(rng.integers(len(content) if rng.random() < 0.5 else min(9000, len(content))))
            match rng.integers(4):
                case 0:
                    content[at] = int(rng.integers(256))
                case 1:
                    content[at] = content[int(rng.integers(len(content)))]
                case 2:
                    del content[at : at + int(rng.integers(1, 40))]
                case _:
                    content[at:at] = content[at : at + int(rng.integers(1, 40))]
        path.write_bytes(content)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", rl.RoundelayWarning)
            try:
                assert len(rl.read(path)) > 0
            except rl.FormatError as error:
                told.append(str(error))
    assert len(told) > 100
    assert all(text.startswith(f"{path}:") for text in told)


def walk_and_run() -> Made:
    """Two animations of one skeleton, of two and of three frames."""
    made = two_bones()
    made.track(0, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    made.document["animations"][0]["name"] = "walk"
    made.document["animations"].append({"name": "run", "samplers": [], "channels": []})
    made.document["animations"].reverse()
    made.track(0, "translation", [0, 0.1, 0.2], [[0, 1, 0], [0, 2, 0], [0, 3, 0]])
    return made


def test_an_animation_by_its_name(tmp_path):
    path = walk_and_run().saved(tmp_path / "a.gltf")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(rl.read(path, animation="walk")) == 2
        assert len(rl.read(path, animation="run")) == 3
    with pytest.raises(rl.FormatError, match=r"animation \(--animation\) among 'run', 'walk'"):
        rl.read(path, animation="swim")


def test_a_skeleton_by_its_name(tmp_path):
    made = two_bones()
    made.document["nodes"] += [{"name": "rider", "children": [3]}, {"name": "arm"}]
    made.document["skins"] += [{"joints": [2, 3]}]
    for node in (0, 2):
        made.track(node, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    path = made.saved(tmp_path / "a.gltf")
    assert contents_of(path).characters == ("hip", "rider")
    assert rl.read(path, character="rider").skeleton.names == ("rider", "arm")
    with pytest.warns(rl.RoundelayWarning, match="--character"):
        assert rl.read(path).skeleton.names == ("hip", "leg")
    with pytest.raises(rl.FormatError, match="among 'hip', 'rider', found 'dog'"):
        rl.read(path, character="dog")


def test_several_skins_of_one_body_are_one_skeleton(tmp_path):
    """As VRoid writes them: one for the face, one for the body, one for the hair."""
    made = two_bones()
    made.document["nodes"][1]["children"] = [2]
    made.document["nodes"].append({"name": "toe"})
    made.document["skins"] = [{"joints": [0, 1]}, {"joints": [1, 2]}]
    made.track(0, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    assert rl.read(made.saved(tmp_path / "a.vrm")).skeleton.names == ("hip", "leg", "toe")


def test_a_data_uri_without_base64(tmp_path):
    made = two_bones()
    made.track(0, "translation", [0, 1 / 30], [[0, 1, 0], [0, 2, 0]])
    uri = "data:application/octet-stream," + "".join(f"%{byte:02x}" for byte in made.data)
    assert len(rl.read(made.saved(tmp_path / "a.gltf", uri))) == 2


def test_a_bvh_has_one_animation(bvh):
    with pytest.raises(ValueError, match="no --animation"):
        rl.read(bvh(), animation="walk")
