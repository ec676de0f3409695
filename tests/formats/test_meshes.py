"""Meshes that hang on skeletons: read from glTF and FBX, carried to the loop, written to glTF."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_fbx_reader import Scene
from test_gltf_reader import Made

import roundelay as rl
from roundelay import synth
from roundelay.formats.fbx_nodes import node
from roundelay.geometry import rotations as rot
from roundelay.geometry.figure import Figure, Image, Material, Mesh
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.loops.exported import exported
from roundelay.loops.options import LoopOptions

PNG = b"\x89PNG and more"
TRIANGLE = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]


def points(motion: rl.Motion, frame: int) -> np.ndarray:
    """Return the points of the figure in a frame."""
    places, turns = forward_kinematics(
        motion.skeleton, motion.rotations, motion.root_path, translations=motion.translations
    )
    names, axes = motion.skeleton.names, rot.to_matrix(turns[frame])
    return np.concatenate(
        [mesh.posed(places[frame], axes, names) for mesh in motion.skeleton.figure.meshes]
    )


@pytest.fixture(scope="module")
def walk():
    """A walk of a body with a few points on each joint, between two joints."""
    motion = synth.gait("walk", repetitions=5, fps=30).motion
    rng = np.random.default_rng(0)
    names, count = motion.skeleton.names, 40
    joints = rng.integers(0, len(names), (count, 4))
    weights = rng.dirichlet(np.ones(4), count)
    binds = np.tile(np.eye(4), (len(names), 1, 1))
    binds[:, :3] += 0.3 * rng.normal(size=(len(names), 3, 4))
    faces = np.arange(39).reshape(-1, 3)
    spots = rng.normal(size=(count, 3))
    mesh = Mesh("body", spots, faces, names, binds, joints, weights, spots, spots[:, :2], 0)
    material = Material("skin", (0.1, 0.2, 0.3, 1.0), Image("image/png", PNG))
    skeleton = replace(motion.skeleton, figure=Figure((mesh,), (material,)))
    return replace(motion, skeleton=skeleton)


def test_a_figure_comes_back(walk, tmp_path):
    rl.write(walk, tmp_path / "a.glb")
    again = rl.read(tmp_path / "a.glb")
    for frame in (0, 50):
        assert np.allclose(points(again, frame), points(walk, frame), atol=1e-5)
    (mesh,), (material,) = again.skeleton.figure.meshes, again.skeleton.figure.materials
    (old,) = walk.skeleton.figure.meshes
    assert np.array_equal(mesh.faces, old.faces)
    assert np.allclose(mesh.places, old.places, atol=1e-6)
    assert material == replace(walk.skeleton.figure.materials[0])
    assert again.skeleton.names == walk.skeleton.names


def test_a_figure_grows_with_its_skeleton(walk):
    assert np.allclose(points(walk.scaled(3.0), 7), 3.0 * points(walk, 7))


def test_a_figure_in_a_mirror(walk):
    seen = points(walk.mirror(), 7)
    assert np.allclose(seen, points(walk, 7) * (-1, 1, 1))
    # Faces are still against the clock as seen from outside.
    old, new = (m.skeleton.figure.meshes[0].faces for m in (walk, walk.mirror()))
    assert np.array_equal(new, old[:, ::-1])


@pytest.mark.parametrize("how", [{"up": "z"}, {"root_bone": True}, {"face_forward": True}])
def test_a_figure_is_where_its_loop_is(walk, how):
    cycle = rl.find_cycles(walk)[0]
    plain, other = exported(cycle, LoopOptions()), exported(cycle, LoopOptions(**how))
    for frame in (0, 9):
        ours = [
            np.concatenate([m.positions()[frame][-18:], points(m, frame)]) for m in (plain, other)
        ]
        # Points lie among the joints as they did: all distances are the same.
        apart = [np.linalg.norm(one[:, None] - one[None], axis=-1) for one in ours]
        assert np.allclose(*apart, atol=1e-6)


def test_the_loop_shows_the_character(walk, tmp_path):
    loop = rl.make_loops(walk)[0]
    loop.write(tmp_path / "loop.glb")
    again = rl.read(tmp_path / "loop.glb")
    first, last = (points(again, frame) for frame in (0, len(again) - 1))
    assert np.allclose(first - first.mean(axis=0), last - last.mean(axis=0), atol=1e-4)
    loop.write(tmp_path / "loop.bvh")
    assert rl.read(tmp_path / "loop.bvh").skeleton.figure is None


def skinned(**more) -> Made:
    """A leg whose triangle hangs on the knee, which turns a quarter."""
    nodes = [
        {"name": "hip", "children": [1], "scale": [2, 2, 2]},
        {"name": "knee", "translation": [0, -1, 0]},
        {"name": "skin", "mesh": 0, "skin": 0},
    ]
    made = Made(nodes)
    bind = np.eye(4)
    bind[:3, 3] = (0, 1, 0)
    both = np.stack([np.eye(4), bind]).swapaxes(1, 2).reshape(2, 16)
    attributes = {
        "POSITION": made.accessor(TRIANGLE, "VEC3"),
        "JOINTS_0": made.accessor([[1, 0, 0, 0]] * 3, "VEC4", "u1"),
        "WEIGHTS_0": made.accessor([[255, 0, 0, 0]] * 3, "VEC4", "u1", normalized=True),
    }
    made.document["meshes"] = [{"primitives": [{"attributes": attributes, **more}]}]
    matrices = made.accessor(both, "MAT4")
    made.document["skins"] = [{"joints": [0, 1], "inverseBindMatrices": matrices}]
    turns = [[0, 0, 0, 1], [0, 0, np.sqrt(0.5), np.sqrt(0.5)]]
    made.track(1, "rotation", [0, 1 / 30], turns)
    return made


def test_a_skin_of_a_scaled_skeleton(tmp_path):
    motion = rl.read(skinned().saved(tmp_path / "a.gltf"))
    assert np.allclose(points(motion, 0), [[0, 0, 0], [2, 0, 0], [0, 2, 0]], atol=1e-6)
    # About the knee at (0, -2, 0), by a quarter.
    assert np.allclose(points(motion, 1), [[-2, -2, 0], [-2, 0, 0], [-4, -2, 0]], atol=1e-6)


def test_a_mesh_that_is_fixed_to_a_joint(tmp_path):
    made = skinned()
    made.document["nodes"][2] = {"name": "hat", "mesh": 0, "translation": [0, 0, 1]}
    made.document["nodes"][1]["children"] = [2]
    motion = rl.read(made.saved(tmp_path / "a.gltf"))
    assert np.allclose(points(motion, 0), [[0, -2, 2], [2, -2, 2], [0, 0, 2]], atol=1e-6)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"extensions": {"KHR_draco_mesh_compression": {}}}, "not compressed, found 'KHR_draco"),
        ({"indices": 1}, "SCALAR"),
        ({"attributes": {"POSITION": 0}}, "JOINTS_0 and WEIGHTS_0, found none"),
    ],
)
def test_a_mesh_that_is_not_sound_is_left_out(tmp_path, more, message):
    with pytest.warns(rl.RoundelayWarning, match=f"its meshes are left out: .*{message}"):
        motion = rl.read(skinned(**more).saved(tmp_path / "a.gltf"))
    assert motion.skeleton.figure is None


def test_scenery_is_no_part_of_a_figure(tmp_path):
    made = skinned()
    made.document["nodes"][2] = {"name": "floor", "mesh": 0}
    assert rl.read(made.saved(tmp_path / "a.gltf")).skeleton.figure is None


def test_a_skin_of_fbx(tmp_path):
    """A square of two materials on the knee, bound where it stands, and its picture."""
    scene = Scene()
    hip = scene.model("hip")
    knee = scene.model("knee", hip, LclTranslation=(0, -1, 0))
    shown = scene.model("shown", kind="Mesh", GeometricTranslation=(0, 0, 5))
    square = np.array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0], float)
    corners = np.array([0, 1, 2, -4], np.int32)
    layer = [
        node("MappingInformationType", "ByPolygonVertex"),
        node("ReferenceInformationType", "Direct"),
        node("UV", np.array([0, 0, 1, 0, 1, 1, 0, 1], float)),
    ]
    shape = scene.add(
        "Geometry",
        "Mesh",
        "square",
        node("Vertices", square),
        node("PolygonVertexIndex", corners),
        node("LayerElementUV", 0, inside=layer),
    )
    skin = scene.add("Deformer", "Skin", "skin")
    bind = np.eye(4)
    bind[3, :3] = (0, 1, 0)  # from the square to the knee, the place in the last row
    cluster = scene.add(
        "Deformer",
        "Cluster",
        "cluster",
        node("Indexes", np.arange(4, dtype=np.int32)),
        node("Weights", np.ones(4)),
        node("Transform", bind.ravel()),
    )
    material, texture = scene.add("Material", "", "cloth"), scene.add("Texture", "", "cloth")
    video = scene.add("Video", "Clip", "cloth", node("Content", PNG))
    for one, other in ((shape, shown), (skin, shape), (cluster, skin), (knee, cluster)):
        scene.links.append(node("C", "OO", one, other))
    scene.links.append(node("C", "OO", material, shown))
    scene.links.append(node("C", "OP", texture, material, "DiffuseColor"))
    scene.links.append(node("C", "OO", video, texture))
    scene.curve(scene.take(), knee, "Lcl Rotation", 2, [0, 1 / 30], [0, 90])
    motion = rl.read(scene.saved(tmp_path / "a.fbx"))
    (mesh,), (cloth,) = motion.skeleton.figure.meshes, motion.skeleton.figure.materials
    assert (len(mesh.points), len(mesh.faces)) == (4, 2)
    assert cloth.picture == Image("image/png", PNG)
    found = sorted(points(motion, 0).round(6).tolist())
    assert found == [[0, 0, 5], [0, 1, 5], [1, 0, 5], [1, 1, 5]]
    assert np.allclose(sorted(points(motion, 1).round(6).tolist())[0], [-2, -1, 5])


def test_corners_that_do_not_exist_are_told(tmp_path):
    scene = Scene()
    hip = scene.model("hip")
    shown = scene.model("shown", hip, kind="Mesh")
    shape = scene.add(
        "Geometry",
        "Mesh",
        "square",
        node("Vertices", np.zeros(9)),
        node("PolygonVertexIndex", np.array([0, 1, -9], np.int32)),
    )
    scene.links.append(node("C", "OO", shape, shown))
    scene.curve(scene.take(), hip, "Lcl Rotation", 2, [0, 1 / 30], [0, 90])
    with pytest.warns(rl.RoundelayWarning, match="meshes are left out: expected points below 3"):
        rl.read(scene.saved(tmp_path / "a.fbx"))
