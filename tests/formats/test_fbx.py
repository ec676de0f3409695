"""FBX as written: read back from its tree of nodes by a reader of its own."""

from __future__ import annotations

import struct
from dataclasses import replace
from pathlib import Path

import fbx_samples
import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.geometry import rotations as rot

TICKS = 46_186_158_000
SIZES = {"C": 1, "I": 4, "D": 8, "L": 8}
TYPES = {"C": "<?", "I": "<i", "D": "<d", "L": "<q"}


class Node:
    """A node of the tree: its name, values and children."""

    def __init__(self, data: bytes, start: int) -> None:
        end, count, size, length = struct.unpack_from("<IIIB", data, start)
        self.name = data[start + 13 : start + 13 + length].decode("ascii")
        at = start + 13 + length
        stop = at + size
        self.values = []
        for _ in range(count):
            value, at = read_value(data, at)
            self.values.append(value)
        assert at == stop
        self.children = []
        while at < end and data[at : at + 13] != bytes(13):
            self.children.append(Node(data, at))
            at = self.children[-1].end
        closed = at == end - 13
        assert closed or (at == end and not self.children and self.values), self.name
        self.end = end

    def all(self, name: str) -> list[Node]:
        return [child for child in self.children if child.name == name]

    def one(self, name: str) -> Node:
        (found,) = self.all(name)
        return found

    def property(self, name: str) -> list:
        (row,) = (p for p in self.one("Properties70").all("P") if p.values[0] == name)
        return row.values[4:]


def read_value(data: bytes, at: int) -> tuple[object, int]:
    kind = chr(data[at])
    at += 1
    if kind in TYPES:
        return struct.unpack_from(TYPES[kind], data, at)[0], at + SIZES[kind]
    if kind in "SR":
        (length,) = struct.unpack_from("<I", data, at)
        raw = data[at + 4 : at + 4 + length]
        return raw.decode("utf-8") if kind == "S" else raw, at + 4 + length
    count, packed, size = struct.unpack_from("<III", data, at)
    assert packed == 0
    dtype = {"f": "<f4", "d": "<f8", "i": "<i4", "l": "<i8"}[kind]
    return np.frombuffer(data, dtype, count, at + 12), at + 12 + size


class Scene:
    """The objects of a file and what is connected to what."""

    def __init__(self, path: Path) -> None:
        data = path.read_bytes()
        assert data[:27] == b"Kaydara FBX Binary  \x00\x1a\x00" + struct.pack("<I", 7400)
        self.nodes, at = {}, 27
        while data[at : at + 13] != bytes(13):
            node = Node(data, at)
            self.nodes[node.name] = node
            at = node.end
        self.foot = data[at + 13 :]
        self.size = len(data)
        self.objects = {one.values[0]: one for one in self.nodes["Objects"].children}
        self.links = [tuple(one.values) for one in self.nodes["Connections"].children]
        self.models = {i: one for i, one in self.objects.items() if one.name == "Model"}

    def children(self, parent: int, kind: str, of: str | None = None) -> list[int]:
        """Objects of a kind that are connected to another, or to one of its properties."""
        return [
            child
            for _, child, above, *rest in self.links
            if above == parent
            and rest == ([] if of is None else [of])
            and self.objects[child].name == kind
        ]

    def curves(self, model: int, of: str) -> tuple[np.ndarray, np.ndarray] | None:
        """Key times (F,) and values (F, 3) of a property of a model."""
        groups = self.children(model, "AnimationCurveNode", of)
        if not groups:
            return None
        columns = []
        for axis in "XYZ":
            (curve,) = self.children(groups[0], "AnimationCurve", f"d|{axis}")
            columns.append(self.objects[curve])
        times = [column.one("KeyTime").values[0] for column in columns]
        assert np.array_equal(times[0], times[1])
        assert np.array_equal(times[0], times[2])
        return times[0], np.stack([c.one("KeyValueFloat").values[0] for c in columns], axis=1)

    def local(self, model: int, of: str, frames: int) -> np.ndarray:
        found = self.curves(model, of)
        default = self.models[model].property(of)
        return np.tile(default, (frames, 1)) if found is None else np.float64(found[1])

    def places(self, frames: int) -> dict[str, np.ndarray]:
        """Global positions (F, 3) of all models by name, in every frame."""
        found: dict[str, np.ndarray] = {}

        def go(model: int, turn: np.ndarray, place: np.ndarray) -> None:
            moved = self.local(model, "Lcl Translation", frames)
            place = place + np.einsum("fij,fj->fi", turn, moved)
            turn = turn @ matrices(self.local(model, "Lcl Rotation", frames))
            name = self.models[model].values[1].split("\0\1")[0]
            assert name not in found
            found[name] = place
            for child in self.children(model, "Model"):
                go(child, turn, place)

        (root,) = self.children(0, "Model")
        go(root, np.tile(np.eye(3), (frames, 1, 1)), np.zeros((frames, 3)))
        return found


def matrices(degrees: np.ndarray) -> np.ndarray:
    """Rz Ry Rx (F, 3, 3) of angles (F, 3) about X, Y, Z."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(np.radians(degrees)).T, np.sin(np.radians(degrees)).T
    rows = [
        [cy * cz, sx * sy * cz - cx * sz, cx * sy * cz + sx * sz],
        [cy * sz, sx * sy * sz + cx * cz, cx * sy * sz - sx * cz],
        [-sy, sx * cy, cx * cy],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


@pytest.fixture(scope="module", params=fbx_samples.NAMES)
def written(request, captures, tmp_path_factory):
    motion = fbx_samples.made(request.param, captures)
    path = tmp_path_factory.mktemp("fbx") / "a.fbx"
    rl.write(motion, path)
    return motion, Scene(path)


def test_joints_are_where_they_were(written):
    motion, scene = written
    found = scene.places(len(motion))
    places = np.stack([found[name] for name in motion.skeleton.names], axis=1)
    assert np.abs(places - motion.positions()).max() < 1e-5 * motion.skeleton.size


def test_keys_stand_at_the_frames(written):
    motion, scene = written
    times = np.rint(np.arange(len(motion)) * motion.frame_time * TICKS)
    for model in scene.models:
        for of in ("Lcl Translation", "Lcl Rotation"):
            curves = scene.curves(model, of)
            assert curves is None or np.array_equal(curves[0], times)
    settings = scene.nodes["GlobalSettings"]
    assert settings.property("TimeMode") == [14]
    assert settings.property("CustomFrameRate") == [motion.fps]
    (stack,) = (one for one in scene.objects.values() if one.name == "AnimationStack")
    for node, stop in ((settings, "TimeSpanStop"), (stack, "LocalStop"), (stack, "ReferenceStop")):
        assert node.property(stop) == [times[-1]]
    take = scene.nodes["Takes"].one("Take")
    assert take.one("LocalTime").values == take.one("ReferenceTime").values == [0, times[-1]]


def test_angles_do_not_jump(written):
    _, scene = written
    for model in scene.models:
        curves = scene.curves(model, "Lcl Rotation")
        assert curves is None or np.all(np.abs(np.diff(curves[1], axis=0)) < 180.001)


def test_curves_are_straight_lines(written):
    _, scene = written
    for curve in (one for one in scene.objects.values() if one.name == "AnimationCurve"):
        flags, data = (curve.one(f"KeyAttr{what}").values[0] for what in ("Flags", "DataFloat"))
        assert flags[0] & 0b1110 == 0b0100
        assert len(data) == 4 * len(flags)
        assert curve.one("KeyAttrRefCount").values[0] == [len(curve.one("KeyTime").values[0])]


def test_the_bind_pose_is_the_rest_pose(written):
    motion, scene = written
    (pose,) = (one for one in scene.objects.values() if one.name == "Pose")
    assert pose.values[2] == "BindPose"
    matrix = {n.one("Node").values[0]: n.one("Matrix").values[0] for n in pose.all("PoseNode")}
    assert set(matrix) == set(scene.models)
    assert pose.one("NbPoseNodes").values == [len(matrix)]
    for model, node in scene.models.items():
        assert node.property("Lcl Rotation") == [0.0, 0.0, 0.0]
        parent = next(above for _, child, above, *_ in scene.links if child == model)
        above = matrix[parent][12:15] if parent else np.zeros(3)
        assert np.allclose(matrix[model][12:15] - above, node.property("Lcl Translation"))
        assert np.array_equal(matrix[model].reshape(4, 4)[:3, :3], np.eye(3))
    assert motion.skeleton.n_joints + len(motion.skeleton.end_sites) == len(scene.models)


def test_objects_are_known_counted_and_connected(written):
    motion, scene = written
    assert len(scene.objects) == len(scene.nodes["Objects"].children)
    assert all(child in scene.objects for _, child, *_ in scene.links)
    assert all(above in scene.objects or above == 0 for _, _, above, *_ in scene.links)
    definitions = scene.nodes["Definitions"]
    counts = {k.values[0]: k.one("Count").values[0] for k in definitions.all("ObjectType")}
    assert counts.pop("GlobalSettings") == 1
    kinds = [one.name for one in scene.objects.values()]
    assert counts == {kind: kinds.count(kind) for kind in kinds}
    assert definitions.one("Count").values == [len(kinds) + 1]
    for model in scene.models:
        (attribute,) = scene.children(model, "NodeAttribute")
        assert scene.objects[attribute].one("TypeFlags").values == ["Skeleton"]
    (stack,) = (i for i, one in scene.objects.items() if one.name == "AnimationStack")
    (layer,) = scene.children(stack, "AnimationLayer")
    for one in (stack, layer):
        assert scene.objects[one].values[1].split("\0\1")[0] == motion.name
    curves = kinds.count("AnimationCurveNode")
    assert len(scene.children(layer, "AnimationCurveNode")) == curves


def test_the_file_ends_as_it_must(written):
    _, scene = written
    assert scene.foot[:16].hex() == "fabcab09d0c8d466b176fb831cf7267e"
    assert scene.foot[-140:] == struct.pack("<I", 7400) + bytes(120) + scene.foot[-16:]
    assert scene.foot[-16:].hex() == "f85a8c6adef5d97eece90ce3758f290b"
    assert (scene.size - 140) % 16 == 0
    padding = scene.foot[20:-140]
    assert len(padding) in range(1, 17)
    assert not any(padding)


@pytest.mark.parametrize("up", [0, 1, 2])
def test_the_settings_tell_which_axis_points_up(tmp_path, up):
    made = synth.gait("walk", repetitions=1, fps=30).motion
    rl.write(fbx_samples.turned(made, up), tmp_path / "a.fbx")
    scene = Scene(tmp_path / "a.fbx")
    axes = np.zeros((3, 3))
    for row, which in enumerate(("Coord", "Up", "Front")):
        (axis,), (sign,) = (
            scene.nodes["GlobalSettings"].property(f"{which}Axis{part}") for part in ("", "Sign")
        )
        axes[row, axis] = sign
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert np.argmax(np.abs(axes[1])) == up
    places = scene.places(len(made))
    heights = places[made.skeleton.names[0]] @ axes[1]
    assert np.allclose(heights, made.positions()[:, 0, 1], atol=1e-5)


def test_only_what_moves_has_curves(tmp_path):
    made = synth.gait("walk", repetitions=1, fps=30).motion
    still = made.rotations.copy()
    still[:, 2] = (1.0, 0.0, 0.0, 0.0)
    moved = np.tile(made.skeleton.offsets, (len(made), 1, 1))
    moved[:, 3, 1] += 0.1 * np.sin(np.arange(len(made)))
    rl.write(replace(made, rotations=still, translations=moved), tmp_path / "a.fbx")
    scene = Scene(tmp_path / "a.fbx")
    models = list(scene.models)[: made.skeleton.n_joints]
    found = {
        of: [joint for joint, model in enumerate(models) if scene.curves(model, f"Lcl {of}")]
        for of in ("Translation", "Rotation")
    }
    assert found["Translation"] == [0, 3]
    assert 2 not in found["Rotation"]
    assert 0 in found["Rotation"]


def test_a_turn_that_jumps_stays_within_half_turns(tmp_path):
    made = synth.gait("walk", repetitions=1, fps=30).motion
    turns = rot.normalize(np.random.default_rng(3).normal(size=made.rotations.shape))
    rl.write(replace(made, rotations=turns), tmp_path / "a.fbx")
    scene = Scene(tmp_path / "a.fbx")
    for model in list(scene.models)[: made.skeleton.n_joints]:
        values = scene.local(model, "Lcl Rotation", len(made))
        assert np.all(np.abs(np.diff(values, axis=0)) < 180.001)


def test_ends_of_limbs_have_names_of_their_own(captures, tmp_path):
    motion = fbx_samples.made("names", captures)
    rl.write(motion, tmp_path / "a.fbx")
    names = list(Scene(tmp_path / "a.fbx").places(len(motion)))
    assert len(set(names)) == len(names)
    assert {"Neck_end", "Neck_end_", "Rücken 背中"} <= set(names)


def test_a_name_that_is_no_text(tmp_path):
    motion = replace(synth.gait("walk", repetitions=1, fps=30).motion, name="caf\udce9")
    rl.write(motion, tmp_path / "a.fbx")
    assert Scene(tmp_path / "a.fbx").nodes["Takes"].one("Current").values == ["caf\\xe9"]


def test_a_joint_that_moves_lies_aside_of_its_parents_axis(tmp_path):
    """Blender joins a child at its parent's tip, along Y, and leaves out its movement."""
    made = synth.gait("walk", repetitions=2, fps=30).motion
    above = np.array([0.0, 2.0, 0.0])
    offsets = made.skeleton.offsets.copy()
    offsets[1] = above
    skeleton = replace(made.skeleton, offsets=offsets)
    moved = np.tile(offsets, (len(made), 1, 1))
    moved[:, 1, 1] += 0.1 * np.sin(np.arange(len(made)))
    rl.write(replace(made, skeleton=skeleton, translations=moved), tmp_path / "moves.fbx")
    scene = Scene(tmp_path / "moves.fbx")
    model = list(scene.models.values())[1]
    rest = model.property("Lcl Translation")[-3:]
    assert abs(rest[0]) > 1e-5
    assert np.allclose(rest, above, atol=1e-3)
