"""Write binary FBX 7.4: the skeleton as limb nodes with a bind pose, the motion as one take."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roundelay.base.files import written_beside
from roundelay.formats.euler import decompose
from roundelay.formats.fbx_nodes import Long, Node, encoded, node
from roundelay.formats.fbx_scene import Scene, Take, properties
from roundelay.formats.moving import moving_joints
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion

__all__ = ["FbxWriter"]

Array = NDArray[np.float64]
Row = tuple[str, str, str, str, float, float, float]

_TICKS = 46_186_158_000  # a second
# Straight lines from key to key, in the bits that the format's own library writes.
_LINEAR = 24836
# Body sizes by which a joint that moves on its parent is set aside at rest.
_ASIDE = 1e-4


class FbxWriter:
    """The writer of FBX files."""

    name = "fbx"
    suffixes = (".fbx",)
    # Keys stand at times, and a clip lasts from the first to the last.
    wraps_at_last_key = True

    def write(self, motion: Motion, path: Path) -> None:
        """Write an FBX file.

        Every number stays as it is: the file says which axis points up, and lengths keep the
        motion's unit, which readers take for centimetres (see `Motion.scaled`). Each frame is a
        key of each curve. Rotations are Euler angles in the order XYZ, X first, and no step is
        longer than half a turn. At rest, in the bind pose and outside of the take, no joint is
        turned. Ends of limbs become limb nodes ``NAME_end``. Bones that change length move as
        they do in the motion.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        times = np.rint(motion.frame_time * _TICKS * np.arange(len(motion))).astype(np.int64)
        take = Take(motion.name or "motion", Long(times[-1]), motion.fps, motion.up)
        scene = Scene()
        models = _add_skeleton(scene, _bones(_loosened(motion)))
        _add_animation(scene, motion, models, take, times)
        content = encoded(scene.nodes(take))
        with written_beside(path) as part:
            part.write_bytes(content)


class _Bone(NamedTuple):
    """A joint or the end of a limb: its offset from its parent, its place at rest."""

    name: str
    parent: int
    offset: Array
    place: Array


def _loosened(motion: Motion) -> Skeleton:
    """Set joints that move on their parents aside at rest, along X, by a part of the body's size.

    Those, that is, that lie on their parent's Y axis: above it, below it or at the parent itself.
    Blender lets bones point along Y, joins a child at the tip, and then leaves out its movement.
    """
    skeleton = motion.skeleton
    offsets, aside = skeleton.offsets.copy(), _ASIDE * skeleton.size
    for joint, _ in moving_joints(motion):
        if np.abs(offsets[joint, [0, 2]]).max() < aside:
            offsets[joint, 0] += aside
    return replace(skeleton, offsets=offsets)


def _bones(skeleton: Skeleton) -> list[_Bone]:
    """List the joints, then the ends of limbs, all with different names."""
    bones: list[_Bone] = []
    taken = set(skeleton.names)

    def add(name: str, parent: int, offset: Array) -> None:
        origin = bones[parent].place if parent >= 0 else np.zeros(3)
        bones.append(_Bone(name, parent, offset, origin + offset))

    for one in zip(skeleton.names, skeleton.parents, skeleton.offsets, strict=True):
        add(*one)
    for joint, offset in skeleton.end_sites:
        name = f"{skeleton.names[joint]}_end"
        while name in taken:
            name += "_"
        taken.add(name)
        add(name, joint, offset)
    return bones


def _add_skeleton(scene: Scene, bones: list[_Bone]) -> list[Long]:
    """Add limb nodes and their bind pose; return the identities of the nodes."""
    models: list[Long] = []
    for bone in bones:
        kind = node("TypeFlags", "Skeleton")
        attribute = scene.add("NodeAttribute", "LimbNode", bone.name, kind)
        models.append(scene.add("Model", "LimbNode", bone.name, *_model(bone.offset)))
        scene.connect(attribute, models[-1])
        if bone.parent < 0:
            scene.connect(models[-1])
        else:
            scene.connect(models[-1], models[bone.parent])
    scene.add("Pose", "BindPose", bones[0].name, *_pose(bones, models))
    return models


def _model(offset: Array) -> list[Node]:
    return [
        node("Version", 232),
        properties(
            ("RotationOrder", "enum", "", "", 0),
            ("InheritType", "enum", "", "", 1),
            ("DefaultAttributeIndex", "int", "Integer", "", 0),
            _local("Lcl Translation", offset),
            _local("Lcl Rotation", np.zeros(3)),
            _local("Lcl Scaling", np.ones(3)),
        ),
        node("Shading", True),
        node("Culling", "CullingOff"),
    ]


def _local(name: str, values: Array) -> Row:
    x, y, z = map(float, values)
    return (name, name, "", "A", x, y, z)


def _pose(bones: list[_Bone], models: list[Long]) -> list[Node]:
    """List the places of all bones at rest, as matrices with the place in the last row."""
    nodes = []
    for bone, model in zip(bones, models, strict=True):
        matrix = np.eye(4)
        matrix[3, :3] = bone.place
        inside = [node("Node", model), node("Matrix", matrix.ravel())]
        nodes.append(node("PoseNode", inside=inside))
    head = [node("Type", "BindPose"), node("Version", 100), node("NbPoseNodes", len(nodes))]
    return [*head, *nodes]


def _add_animation(
    scene: Scene, motion: Motion, models: list[Long], take: Take, times: NDArray[np.int64]
) -> None:
    """Add the take, with curves of the root's path and of all joints that turn or move."""
    span = properties(
        *(
            (f"{part}{end}", "KTime", "Time", "", time)
            for part in ("Local", "Reference")
            for end, time in (("Start", Long(0)), ("Stop", take.stop))
        )
    )
    stack = scene.add("AnimationStack", "", take.name, span)
    layer = scene.add("AnimationLayer", "", take.name, properties())
    scene.connect(layer, stack)
    curves = _Curves(scene, layer, times)
    curves.add("T", motion.root_path, models[0])
    for joint, places in moving_joints(motion):
        curves.add("T", places, models[joint])
    angles = _angles(motion)
    for joint in np.flatnonzero(np.any(angles != 0.0, axis=(0, 2))).tolist():
        curves.add("R", angles[:, joint], models[joint])


def _angles(motion: Motion) -> Array:
    """Return degrees (F, J, 3) about X, Y and Z, none more than half a turn from frame to frame.

    What turns about X first is the product Rz Ry Rx.
    """
    angles = decompose(motion.rotations, "ZYX", "continuous")[..., ::-1]
    return np.unwrap(angles, axis=0, period=360.0)


class _Curves:
    """Curves of one layer, all with the same keys in time."""

    def __init__(self, scene: Scene, layer: Long, times: NDArray[np.int64]) -> None:
        self._scene = scene
        self._layer = layer
        self._times = times

    def add(self, kind: str, values: Array, model: Long) -> None:
        """Add the curves (F, 3) of a model's translation ("T") or rotation ("R")."""
        scene = self._scene
        names = ("d|X", "d|Y", "d|Z")
        first = zip(names, values[0].tolist(), strict=True)
        rows = properties(*((name, "Number", "", "A", value) for name, value in first))
        group = scene.add("AnimationCurveNode", "", kind, rows)
        scene.connect(group, self._layer)
        scene.connect(group, model, "Lcl Translation" if kind == "T" else "Lcl Rotation")
        for name, column in zip(names, values.T, strict=True):
            scene.connect(scene.add("AnimationCurve", "", "", *self._curve(column)), group, name)

    def _curve(self, values: Array) -> list[Node]:
        return [
            node("Default", float(values[0])),
            node("KeyVer", 4008),
            node("KeyTime", self._times),
            node("KeyValueFloat", values.astype(np.float32)),
            node("KeyAttrFlags", np.array([_LINEAR], np.int32)),
            node("KeyAttrDataFloat", np.zeros(4, np.float32)),
            node("KeyAttrRefCount", np.array([len(values)], np.int32)),
        ]
