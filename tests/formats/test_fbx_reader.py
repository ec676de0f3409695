"""FBX as it is read: our own files in every form, made ones with what animators' programs write,
and broken ones.

Files of Blender's exporter are compared with its importers in `benchmarks.formats`.
"""

from __future__ import annotations

import itertools
import struct
import warnings
from pathlib import Path

import fbx_samples
import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.formats import contents_of
from roundelay.formats.fbx_nodes import Long, Node, encoded, node
from roundelay.formats.fbx_scene import properties
from roundelay.geometry import rotations as rot
from roundelay.testing import check_reader

TICKS = 46_186_158_000
AXES = np.eye(3)
NONE = Long(0)
ORDERS = ("XYZ", "XZY", "YZX", "YXZ", "ZXY", "ZYX")


@pytest.fixture(scope="module")
def walk():
    return synth.gait("walk", repetitions=2, fps=30).motion


@pytest.fixture
def walk_file(walk, tmp_path):
    rl.write(walk, tmp_path / "walk.fbx")
    return tmp_path / "walk.fbx"


@pytest.mark.parametrize("name", fbx_samples.NAMES)
def test_our_own_files_come_back(name, captures, tmp_path):
    motion = fbx_samples.made(name, captures)
    rl.write(motion, tmp_path / "a.fbx")
    again = rl.read(tmp_path / "a.fbx")
    assert (len(again), again.up) == (len(motion), motion.up)
    assert again.fps == pytest.approx(motion.fps, rel=1e-6)
    joints = [again.skeleton.names.index(name) for name in motion.skeleton.names]
    apart = np.abs(again.positions()[:, joints] - motion.positions()).max()
    assert apart < 1e-6 * max(motion.skeleton.size, np.abs(motion.root_path).max())
    assert len(again.skeleton.end_sites) <= len(motion.skeleton.end_sites)


@pytest.mark.parametrize("form", ["7.5", "text"])
def test_every_form_gives_the_same(form, walk, walk_file, tmp_path, monkeypatch):
    if form == "7.5":
        other = fbx_samples.as_wide(walk_file.read_bytes())
    else:
        kept = []
        monkeypatch.setattr(
            "roundelay.formats.fbx_writer.encoded", lambda nodes: kept.extend(nodes) or b""
        )
        rl.write(walk, tmp_path / "unused.fbx")
        other = fbx_samples.as_text(kept)
    (tmp_path / "other.fbx").write_bytes(other)
    again, first = rl.read(tmp_path / "other.fbx"), rl.read(walk_file)
    assert again.skeleton.names == first.skeleton.names
    assert np.allclose(again.positions(), first.positions(), atol=1e-9)


def test_the_conformance_of_readers(walk, tmp_path):
    from roundelay.formats.fbx_reader import FbxReader

    rl.write(walk[:4], tmp_path / "a.fbx")
    check_reader(FbxReader(), [tmp_path / "a.fbx"])


class Scene:
    """Models, takes and curves put together by hand."""

    def __init__(self, version: int = 7400) -> None:
        self.objects: list[Node] = []
        self.links: list[Node] = []
        self.groups: dict[tuple, Long] = {}
        self.settings: list[tuple] = [("TimeMode", "enum", "", "", 6)]

    def add(self, kind: str, subclass: str, name: str, *inside: Node) -> Long:
        identity = Long(1000 + len(self.objects))
        full = f"{name}\0\1{kind.replace('Animation', 'Anim')}"
        self.objects.append(node(kind, identity, full, subclass, inside=inside))
        return identity

    def model(self, name: str, parent: Long = NONE, kind: str = "LimbNode", **known) -> Long:
        rows = [_row(key.replace("Lcl", "Lcl "), value) for key, value in known.items()]
        identity = self.add("Model", kind, name, properties(*rows))
        self.links.append(node("C", "OO", identity, parent))
        return identity

    def take(self, name: str = "take") -> Long:
        stack = self.add("AnimationStack", "", name)
        layer = self.add("AnimationLayer", "", name)
        self.links.append(node("C", "OO", layer, stack))
        return layer

    def curve(self, layer: Long, model: Long, what: str, axis: int, times, values, **more) -> None:
        group = self.groups.get((layer, model, what))
        if group is None:
            group = self.add("AnimationCurveNode", "", what[4], properties())
            self.groups[layer, model, what] = group
            self.links.append(node("C", "OO", group, layer))
            self.links.append(node("C", "OP", group, model, what))
        ticks = np.rint(np.asarray(times, float) * TICKS).astype(np.int64)
        inside = [node("KeyTime", ticks), node("KeyValueFloat", np.asarray(values, np.float32))]
        if more:
            inside += [
                node("KeyAttrFlags", np.asarray(more["flags"], np.int32)),
                node("KeyAttrDataFloat", np.asarray(more["data"], np.float32).ravel()),
                node("KeyAttrRefCount", np.ones(len(ticks), np.int32)),
            ]
        curve = self.add("AnimationCurve", "", "", *inside)
        self.links.append(node("C", "OP", curve, group, f"d|{'XYZ'[axis]}"))

    def nodes(self) -> list[Node]:
        return [
            node("FBXHeaderExtension", inside=[node("FBXVersion", 7400)]),
            node("GlobalSettings", inside=[properties(*self.settings)]),
            node("Objects", inside=self.objects),
            node("Connections", inside=self.links),
        ]

    def saved(self, path: Path) -> Path:
        path.write_bytes(encoded(self.nodes()))
        return path


def _row(name: str, value) -> tuple:
    if isinstance(value, int):
        return (name, "enum", "", "", value)
    return (name, "Vector3D", "Vector", "", *map(float, value))


def matrix(degrees, order: str = "XYZ") -> np.ndarray:
    """Turn about axes, the first one first."""
    result = np.eye(3)
    for axis in order:
        number = "XYZ".index(axis)
        turn = rot.from_rotation_vector(np.radians(degrees[number]) * AXES[number])
        result = rot.to_matrix(turn) @ result
    return result


@pytest.mark.parametrize(("number", "order"), list(enumerate(ORDERS)))
def test_rotation_orders_and_the_turns_around_them(number, order, tmp_path):
    scene, angles = Scene(), [(10, 20, 30), (40, -50, 60)]
    before, after = (15, 25, 35), (5, -10, 80)
    known = {"RotationActive": 1, "RotationOrder": number}
    hip = scene.model("hip", PreRotation=before, PostRotation=after, **known)
    scene.model("leg", hip, LclTranslation=(0, -1, 0))
    layer = scene.take()
    for axis in range(3):
        scene.curve(layer, hip, "Lcl Rotation", axis, [0, 1 / 30], [a[axis] for a in angles])
    motion = rl.read(scene.saved(tmp_path / "a.fbx"))
    for frame, each in enumerate(angles):
        wanted = matrix(before) @ matrix(each, order) @ matrix(after).T
        assert np.allclose(rot.to_matrix(motion.rotations[frame, 0]), wanted, atol=1e-6)


def test_orders_count_only_where_they_are_active(tmp_path):
    scene = Scene()
    hip = scene.model("hip", RotationOrder=5, PreRotation=(90, 0, 0))
    scene.model("leg", hip, LclTranslation=(0, -1, 0))
    layer = scene.take()
    for axis in range(3):
        scene.curve(layer, hip, "Lcl Rotation", axis, [0, 1 / 30], [0, 30])
    motion = rl.read(scene.saved(tmp_path / "a.fbx"))
    assert np.allclose(rot.to_matrix(motion.rotations[1, 0]), matrix((30, 30, 30)), atol=1e-6)


def test_pivots_and_offsets(tmp_path):
    """T Roff Rp R Rp^-1 Soff Sp S Sp^-1, as the SDK's documentation writes it."""
    scene = Scene()
    known = {
        "LclTranslation": (1, 2, 3),
        "RotationOffset": (0.1, 0.2, 0.3),
        "RotationPivot": (1, 0, 0),
        "ScalingOffset": (0, 0.5, 0),
        "ScalingPivot": (0, 0, 2),
        "LclScaling": (3, 3, 3),
    }
    hip = scene.model("hip", **known)
    scene.model("leg", hip, LclTranslation=(0, -1, 0))
    layer = scene.take()
    scene.curve(layer, hip, "Lcl Rotation", 2, [0, 1 / 30], [0, 90])
    motion = rl.read(scene.saved(tmp_path / "a.fbx"))

    def moved(by) -> np.ndarray:
        result = np.eye(4)
        result[:3, 3] = by
        return result

    for frame, degrees in enumerate((0, 90)):
        turn, size = np.eye(4), np.diag([3.0, 3.0, 3.0, 1.0])
        turn[:3, :3] = matrix((0, 0, degrees))
        whole = moved((1, 2, 3)) @ moved((0.1, 0.2, 0.3)) @ moved((1, 0, 0)) @ turn
        whole = whole @ moved((-1, 0, 0)) @ moved((0, 0.5, 0)) @ moved((0, 0, 2)) @ size
        whole = whole @ moved((0, 0, -2))
        wanted = [whole[:3, 3], (whole @ [0, -1, 0, 1])[:3]]
        assert np.allclose(motion.positions()[frame], wanted, atol=1e-6)


def test_a_scale_that_is_not_inherited(tmp_path):
    """Maya's segment scale compensate: the arm moves out, and does not grow itself."""
    scene = Scene()
    hip = scene.model("hip", LclScaling=(2, 2, 2))
    arm = scene.model("arm", hip, LclTranslation=(0, 1, 0), InheritType=2)
    scene.model("hand", arm, LclTranslation=(0, 1, 0))
    scene.curve(scene.take(), hip, "Lcl Translation", 0, [0, 1 / 30], [0, 1])
    places = rl.read(scene.saved(tmp_path / "a.fbx")).positions()[0]
    assert np.allclose(places[:, 1], [0, 2, 3])


@pytest.mark.parametrize("unit", [1.0, 100.0, 2.54])
def test_lengths_become_centimetres(unit, tmp_path):
    scene = Scene()
    scene.settings.append(("UnitScaleFactor", "double", "Number", "", unit))
    hip = scene.model("hip")
    scene.model("leg", hip, LclTranslation=(0, -1, 0))
    scene.curve(scene.take(), hip, "Lcl Translation", 1, [0, 1 / 30], [1, 2])
    motion = rl.read(scene.saved(tmp_path / "a.fbx"))
    assert np.allclose(motion.skeleton.offsets[1], [0, -unit, 0])
    assert np.allclose(motion.root_path[1], [0, 2 * unit, 0])
    assert contents_of(tmp_path / "a.fbx").conventions["unit"] == f"{unit:g} cm"


# Flags and the three tangents: next key, user's slopes; with weights; held; held at the next.
CUBIC, CONSTANT, NEXT, WEIGHTS = 0x408, 0x2, 0x100, 0x3000000


def moved_by(scene_flags, data, times, values, tmp_path) -> np.ndarray:
    scene = Scene()
    scene.settings[0] = ("TimeMode", "enum", "", "", 2)
    hip = scene.model("hip")
    scene.model("leg", hip, LclTranslation=(0, -1, 0))
    layer = scene.take()
    scene.curve(layer, hip, "Lcl Translation", 0, times, values, flags=scene_flags, data=data)
    return rl.read(scene.saved(tmp_path / "a.fbx")).root_path[:, 0]


def test_slopes_bend_a_curve(tmp_path):
    data = [[3.0, -6.0, 0, 0]] * 2
    found = moved_by([CUBIC] * 2, data, [0, 1], [1, 2], tmp_path)
    t = np.linspace(0, 1, len(found))
    wanted = (2 * t**3 - 3 * t**2 + 1) + (t**3 - 2 * t**2 + t) * 3
    wanted += (-2 * t**3 + 3 * t**2) * 2 + (t**3 - t**2) * -6
    assert np.allclose(found, wanted, atol=1e-6)


def test_weights_bend_time(tmp_path):
    weights = struct.unpack("<f", struct.pack("<HH", 8000, 1000))[0]
    data = [[1.0, 1.0, weights, 0]] * 2
    found = moved_by([CUBIC | WEIGHTS] * 2, data, [0, 1], [0, 4], tmp_path)
    u = np.linspace(0, 1, 20001)
    time = 3 * (1 - u) ** 2 * u * 0.8 + 3 * (1 - u) * u**2 * 0.9 + u**3
    value = 3 * (1 - u) ** 2 * u * 0.8 + 3 * (1 - u) * u**2 * (4 - 0.1) + 4 * u**3
    wanted = np.interp(np.linspace(0, 1, len(found)), time, value)
    assert np.allclose(found, wanted, atol=1e-3)


def test_steps(tmp_path):
    found = moved_by(
        [CONSTANT, CONSTANT | NEXT, 0x4], np.zeros((3, 4)), [0, 0.1, 0.2], [1, 2, 3], tmp_path
    )
    assert np.allclose(found, [1] * 10 + [2] + [3] * 10)


def test_slopes_that_are_found_do_not_overshoot(tmp_path):
    flags = [0x6108] * 4
    found = moved_by(flags, np.zeros((4, 4)), [0, 0.1, 0.2, 0.3], [0, 0, 1, 1], tmp_path)
    assert found.min() >= -1e-6
    assert found.max() <= 1 + 1e-6
    assert np.all(np.diff(found) >= -1e-6)


def two_takes() -> Scene:
    scene = Scene()
    hip = scene.model("hip")
    scene.model("leg", hip, LclTranslation=(0, -1, 0))
    scene.curve(scene.take("walk"), hip, "Lcl Translation", 0, [0, 1 / 30], [0, 1])
    scene.curve(scene.take("run"), hip, "Lcl Translation", 0, [0, 1 / 30, 2 / 30], [0, 1, 2])
    return scene


def test_a_take_by_its_name(tmp_path):
    path = two_takes().saved(tmp_path / "a.fbx")
    assert contents_of(path).animations == ("walk", "run")
    with pytest.warns(rl.RoundelayWarning, match="'walk' is read, not 'run'"):
        assert len(rl.read(path)) == 2
    assert len(rl.read(path, animation="run")) == 3
    with pytest.raises(rl.FormatError, match=r"\(--animation\) among 'walk', 'run', found 'fly'"):
        rl.read(path, animation="fly")


def test_a_skeleton_by_its_name(tmp_path):
    scene = Scene()
    first, second = scene.model("hip"), scene.model("other")
    scene.model("leg", first, LclTranslation=(0, -1, 0))
    scene.model("arm", second, LclTranslation=(0, -2, 0))
    layer = scene.take()
    for model in (first, second):
        scene.curve(layer, model, "Lcl Translation", 0, [0, 1 / 30], [0, 1])
    path = scene.saved(tmp_path / "a.fbx")
    assert contents_of(path).characters == ("hip", "other")
    with pytest.warns(rl.RoundelayWarning, match="'hip' is read, not 'other'"):
        assert rl.read(path).skeleton.names == ("hip", "leg")
    assert rl.read(path, character="other").skeleton.names == ("other", "arm")


def test_models_that_are_no_bones(tmp_path):
    """Some programs move empty objects instead."""
    scene = Scene()
    top = scene.model("body", kind="Null")
    scene.model("limb", top, kind="Null", LclTranslation=(0, -1, 0))
    scene.curve(scene.take(), top, "Lcl Translation", 0, [0, 1 / 30], [0, 1])
    assert rl.read(scene.saved(tmp_path / "a.fbx")).skeleton.names == ("body", "limb")


OLD = """; FBX 6.1.0 project file
FBXHeaderExtension:  {
    FBXVersion: 6100
}
Objects:  {
    Model: "Model::Hips", "LimbNode" {
        Version: 232
        Properties60:  {
            Property: "Lcl Translation", "Lcl Translation", "A+",0,90,0
        }
    }
    Model: "Model::Leg", "LimbNode" {
        Properties60:  {
            Property: "Lcl Translation", "Lcl Translation", "A+",0,-45,0
        }
    }
    GlobalSettings:  {
        Properties60:  {
            Property: "TimeMode", "enum", "",6
        }
    }
}
Connections:  {
    Connect: "OO", "Model::Hips", "Model::Scene"
    Connect: "OO", "Model::Leg", "Model::Hips"
}
Takes:  {
    Current: "Take 001"
    Take: "Take 001" {
        Model: "Model::Hips" {
            Channel: "Transform" {
                Channel: "T" {
                    Channel: "X" {
                        Default: 5
                    }
                    Channel: "Y" {
                        Default: 90
                        KeyVer: 4005
                        KeyCount: 3
                        Key: 0,90,L,
                         1539538600,92,U,s,0,0,n,3079077200,94,C,s
                    }
                }
                Channel: "R" {
                    Channel: "Z" {
                        KeyVer: 4005
                        Key: 0,0,U,a,n,3079077200,90,U,a,n
                    }
                }
            }
        }
    }
}
"""


def test_a_file_of_version_6_names_its_objects(tmp_path):
    path = tmp_path / "old.fbx"
    path.write_text(OLD)
    motion = rl.read(path)
    assert motion.skeleton.names == ("Hips", "Leg")
    assert np.allclose(motion.root_path, [[5, 90, 0], [5, 92, 0], [5, 94, 0]])
    assert np.allclose(motion.positions()[2, 1], [50, 94, 0])
    assert contents_of(path).animations == ("Take 001",)


def test_an_encrypted_file_is_told(tmp_path):
    nodes = two_takes().nodes()
    nodes[0] = node("FBXHeaderExtension", inside=[node("EncryptionType", 1)])
    (tmp_path / "a.fbx").write_bytes(encoded(nodes))
    with pytest.raises(rl.FormatError, match="expected a file that is not encrypted"):
        rl.read(tmp_path / "a.fbx")


def test_models_in_a_circle(tmp_path):
    scene = two_takes()
    scene.links.append(node("C", "OO", Long(1000), Long(1001)))
    with pytest.raises(rl.FormatError, match="a tree of nodes, found node 'hip' below itself"):
        rl.read(scene.saved(tmp_path / "a.fbx"))


def test_an_array_that_lies_takes_no_memory(walk_file):
    data = bytearray(walk_file.read_bytes())
    at = data.index(b"KeyTime") + len("KeyTime")
    struct.pack_into("<II", data, at + 1, 0xFFFFFFF0, 1)
    walk_file.write_bytes(data)
    with pytest.raises(rl.FormatError, match=r"expected an array, found .* bytes"):
        rl.read(walk_file)


def test_curves_out_of_proportion(tmp_path):
    scene = Scene()
    hip = scene.model("hip")
    scene.curve(scene.take(), hip, "Lcl Translation", 0, [0, 1e7], [0, 1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rl.RoundelayWarning)
        with pytest.raises(rl.FormatError, match="frames"):
            rl.read(scene.saved(tmp_path / "a.fbx"))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda data: data[:20], "expected an FBX file|header"),
        (lambda data: data[: len(data) // 2], "at byte"),
        (lambda data: data[:23] + struct.pack("<I", 5000) + data[27:], "version 6.1 to 7.7"),
        (lambda data: b"PK" + data, "expected an FBX file, found b'PK"),
        (lambda data: data[:27] + struct.pack("<I", 1 << 31) + data[31:], "ends before byte"),
    ],
)
def test_what_is_broken_is_told(change, message, walk_file):
    walk_file.write_bytes(change(walk_file.read_bytes()))
    with pytest.raises(rl.FormatError, match=message):
        rl.read(walk_file)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (OLD.replace("KeyVer: 4005", "KeyVer: 4005\n}", 1), "found }|expected"),
        (OLD[:-10], "expected }, found the end of the file"),
        (OLD.replace("3079077200,94,C,s", "3079077200,94,Q"), "kinds C, L and U, found 'Q'"),
        (OLD.replace("1539538600,92", "1539538600,x"), "a time, a value and a letter"),
        (OLD.replace("FBXVersion: 6100", "FBXVersion: 5800"), "found version 5.8"),
        (OLD.replace('"A+",0,90,0', '"A+",0,90'), "3 numbers, found 2"),
        (OLD.replace('"A+",0,90,0', '"A+",0,1e99,0'), "finite numbers of at most 1e"),
    ],
)
def test_what_is_broken_in_a_text_is_told(text, message, tmp_path):
    (tmp_path / "a.fbx").write_text(text)
    with pytest.raises(rl.FormatError, match=message):
        rl.read(tmp_path / "a.fbx")


def test_no_animation(tmp_path):
    scene = Scene()
    scene.model("hip")
    with pytest.raises(rl.FormatError, match="expected an animation, found none"):
        rl.read(scene.saved(tmp_path / "a.fbx"))


def test_ufbx_finds_the_same(tmp_path):
    """Curves of all kinds, judged by another reader, where it is installed."""
    ufbx = pytest.importorskip("ufbx")
    scene = Scene()
    hip = scene.model("hip", RotationActive=1, RotationOrder=3, PreRotation=(10, 20, 30))
    scene.model("leg", hip, LclTranslation=(0, -1, 0))
    layer = scene.take()
    rng = np.random.default_rng(0)
    times = np.arange(6) / 6
    kinds = itertools.cycle([CUBIC, 0x108, 0x4108, 0x6108, 0x208, CONSTANT])
    for what, axis in itertools.product(("Lcl Rotation", "Lcl Translation"), range(3)):
        flags, data = [next(kinds)] * 6, np.zeros((6, 4))
        data[:, :3] = rng.uniform(-1, 1, size=(6, 3))
        values = rng.normal(size=6) * 40
        scene.curve(layer, hip, what, axis, times, values, flags=flags, data=data)
    path = scene.saved(tmp_path / "a.fbx")
    motion, kept = rl.read(path), [ufbx.load_file(str(path))]
    kept += list(kept[0].nodes)
    model = next(one for one in kept[1:] if one.name == "hip")
    animation = kept[0].anim
    kept.append(animation)
    for frame in range(len(motion)):
        kept.append(
            ufbx.evaluate_transform(
                kept[-1 - frame * 2] if False else kept[0].anim, model, frame / motion.fps
            )
        )
        place, turn = kept[-1].translation, kept[-1].rotation
        kept += [place, turn]
        assert np.allclose(motion.root_path[frame], [place.x, place.y, place.z], atol=1e-3)
        found = motion.rotations[frame, 0]
        assert abs(np.dot(found, [turn.w, turn.x, turn.y, turn.z])) > 1 - 1e-6
