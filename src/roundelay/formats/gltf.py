"""Write glTF 2.0: the skeleton as nodes and a skin, the motion as one animation.

Format: Khronos glTF 2.0 specification (ISO/IEC 12113). A ``.glb`` holds JSON and data in one
binary file, a ``.gltf`` the same as JSON text with the data in base64.
"""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.files import written_beside
from roundelay.base.version import __version__
from roundelay.formats.gltf_buffer import Buffer
from roundelay.formats.gltf_figure_writer import shown
from roundelay.formats.moving import moving_joints
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.motion.motion import Motion

__all__ = ["GltfWriter"]

Array = NDArray[np.float64]
Json = dict[str, Any]

_MAGIC, _JSON, _BINARY = 0x46546C67, 0x4E4F534A, 0x004E4942


class GltfWriter:
    """The writer of glTF files."""

    name = "gltf"
    suffixes = (".glb", ".gltf")
    # An animation lasts from its first key to its last (glTF 2.0, 3.11), and players repeat that.
    wraps_at_last_key = True

    def write(self, motion: Motion, path: Path) -> None:
        """Write a ``.glb`` or ``.gltf`` file.

        The vertical axis becomes Y, as the format demands; lengths stay in the motion's unit (the
        format thinks of metres: see `Motion.scaled`). Ends of limbs become joints ``NAME_end``.
        Bones that change length move as they do in the motion. The skeleton's figure, if it has
        one, is shown by the joints.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        buffer = Buffer()
        upright = rot.axis_to_y(motion.up)
        document = {
            "asset": {"version": "2.0", "generator": f"roundelay {__version__}"},
            "scene": 0,
            **_body(motion, upright, buffer),
            "animations": [_animation(motion, upright, buffer)],
            "bufferViews": buffer.views,
            "accessors": buffer.accessors,
            "buffers": [{"byteLength": len(buffer.data)}],
        }
        content = _binary if path.suffix.lower() == ".glb" else _text
        with written_beside(path) as part:
            part.write_bytes(content(document, bytes(buffer.data)))


def _body(motion: Motion, upright: Array, buffer: Buffer) -> Json:
    """Make the nodes and what they show: a figure stands as in the first frame."""
    nodes, skin = _nodes(motion, upright), _skin(motion, upright, buffer)
    figure = motion.skeleton.figure
    if figure is None:
        return {"scenes": [{"nodes": [0]}], "nodes": nodes, "skins": [skin]}
    for joint, turn in enumerate(motion.rotations[0]):
        nodes[joint]["rotation"] = _xyzw(rot.multiply(upright, turn) if joint == 0 else turn)
    nodes[0]["translation"] = _turned(upright, motion.root_path[0])
    return shown(figure, motion.skeleton.names, nodes, skin, buffer)


def _nodes(motion: Motion, upright: Array) -> list[Json]:
    """List the joints at rest, then the ends of limbs."""
    skeleton = motion.skeleton
    nodes: list[Json] = [
        {"name": name, "translation": offset.tolist()}
        for name, offset in zip(skeleton.names, skeleton.offsets, strict=True)
    ]
    nodes[0] |= {"translation": _turned(upright, skeleton.offsets[0]), "rotation": _xyzw(upright)}
    parents = [*skeleton.parents[1:], *(joint for joint, _ in skeleton.end_sites)]
    for joint, offset in skeleton.end_sites:
        nodes.append({"name": f"{skeleton.names[joint]}_end", "translation": offset.tolist()})
    for child, parent in enumerate(parents, 1):
        nodes[parent].setdefault("children", []).append(child)
    return nodes


def _skin(motion: Motion, upright: Array, buffer: Buffer) -> Json:
    """Make all nodes joints; the inverse of each one's place at rest is its bind matrix."""
    skeleton = motion.skeleton
    rest = np.tile([1.0, 0.0, 0.0, 0.0], (1, skeleton.n_joints, 1))
    places = forward_kinematics(skeleton, rest, skeleton.offsets[:1])[0][0]
    ends = [places[joint] + offset for joint, offset in skeleton.end_sites]
    places = np.concatenate([places, np.reshape(ends, (-1, 3))])
    matrices = np.tile(np.eye(4), (len(places), 1, 1))
    matrices[:, :3, :3] = rot.to_matrix(rot.conjugate(upright))
    matrices[:, :3, 3] = -places
    bind = buffer.add("MAT4", np.swapaxes(matrices, 1, 2))
    return {"inverseBindMatrices": bind, "skeleton": 0, "joints": list(range(len(places)))}


def _animation(motion: Motion, upright: Array, buffer: Buffer) -> Json:
    """Move the root, turn every joint, and move the joints that leave their offsets."""
    turns = motion.rotations.copy()
    turns[:, 0] = rot.multiply(upright, turns[:, 0])
    times = buffer.add("SCALAR", motion.frame_time * np.arange(float(len(motion))), limits=True)
    tracks = [(0, "translation", buffer.add("VEC3", rot.rotate(upright, motion.root_path)))]
    for joint in range(motion.skeleton.n_joints):
        values = buffer.add("VEC4", np.roll(turns[:, joint], -1, axis=-1))
        tracks.append((joint, "rotation", values))
    for joint, places in moving_joints(motion):
        tracks.append((joint, "translation", buffer.add("VEC3", places)))
    return {
        "name": motion.name or "motion",
        "samplers": [{"input": times, "output": values} for _, _, values in tracks],
        "channels": [
            {"sampler": number, "target": {"node": joint, "path": kind}}
            for number, (joint, kind, _) in enumerate(tracks)
        ],
    }


def _turned(rotation: Array, vector: Array) -> list[float]:
    return [float(value) for value in rot.rotate(rotation, vector)]


def _xyzw(quaternion: Array) -> list[float]:
    return [float(value) for value in np.roll(quaternion, -1)]


def _text(document: Json, data: bytes) -> bytes:
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    buffers = [{"uri": uri, "byteLength": len(data)}]
    return json.dumps(document | {"buffers": buffers}, allow_nan=False).encode()


def _binary(document: Json, data: bytes) -> bytes:
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(data)
    return b"".join(
        [
            struct.pack("<III", _MAGIC, 2, size),
            struct.pack("<II", len(text), _JSON) + text,
            struct.pack("<II", len(data), _BINARY) + data,
        ]
    )
