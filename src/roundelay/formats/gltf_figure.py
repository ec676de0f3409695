"""The meshes of a glTF file that hang on a skeleton: skins, or what is fixed to a joint."""

from __future__ import annotations

from dataclasses import replace
from itertools import count
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.formats.gltf_document import Document, Part
from roundelay.formats.nodes import note
from roundelay.formats.posed import Bound
from roundelay.geometry.figure import MOST_BONES, Figure, Image, Material, Mesh, image_of, strongest

__all__ = ["read_figure"]

Array = NDArray[np.float64]

# Of a primitive: triangles, each by itself, in a strip, or in a fan.
_TRIANGLES, _STRIP, _FAN = 4, 5, 6


def read_figure(document: Document, bound: Bound) -> Figure | None:
    """Read the meshes that hang on a skeleton; None where there are none.

    Raises
    ------
    FormatError
        If one is not sound, or compressed.
    """
    meshes: list[Mesh] = []
    for number, node in enumerate(document.root.entries("nodes")):
        if not node.has("mesh"):
            continue
        skinned = node.has("skin")
        if not skinned and not bound.holds(number):
            continue
        bones = _skin(document, node, bound) if skinned else [bound.to(number)]
        mesh = document.entry("meshes", node.get("mesh"))
        for primitive in mesh.entries("primitives"):
            name = mesh.get("name", "").text() or node.get("name", "").text() or mesh.place
            meshes += _primitive(document, primitive, name, bones, skinned=skinned)
    if not meshes:
        return None
    materials = [_material(document, one) for one in document.root.entries("materials")]
    return Figure(tuple(_known(mesh, len(materials)) for mesh in meshes), tuple(materials))


def _known(mesh: Mesh, materials: int) -> Mesh:
    return mesh if mesh.material < materials else replace(mesh, material=-1)


def _skin(document: Document, node: Part, bound: Bound) -> list[tuple[str, Array]]:
    """Return the joint of our skeleton for every joint of a skin, with the matrix to it."""
    skin = document.entry("skins", node.get("skin"))
    joints = [part.whole(most=len(bound.tree.parents) - 1) for part in skin.entries("joints")]
    binds = np.tile(np.eye(4), (len(joints), 1, 1))
    if skin.has("inverseBindMatrices"):
        rows = document.accessor(skin.get("inverseBindMatrices"), "MAT4")
        if len(rows) < len(joints):
            raise skin.error(f"{len(joints)} matrices", str(len(rows)))
        binds = rows[: len(joints)].reshape(-1, 4, 4).swapaxes(1, 2)
    found = []
    for joint, bind in zip(joints, binds, strict=True):
        name, matrix = bound.to(joint)
        found.append((name, matrix @ bind))
    return found


def _primitive(
    document: Document,
    part: Part,
    name: str,
    bones: list[tuple[str, Array]],
    *,
    skinned: bool,
) -> list[Mesh]:
    """Return a primitive of triangles as a mesh; lines and points are none."""
    mode = part.get("mode", _TRIANGLES).whole()
    if mode not in (_TRIANGLES, _STRIP, _FAN):
        return []
    packed = [one for one in part.get("extensions", {}).value if "compression" in one]
    if packed:
        raise part.error("a mesh that is not compressed", repr(packed[0]))
    if part.entries("targets"):
        note(part.path, f"shapes that {name!r} can take are left out")
    attributes = part.get("attributes")
    points = document.accessor(attributes.get("POSITION"), "VEC3")
    corners = np.arange(len(points))
    if part.has("indices"):
        corners = document.accessor(part.get("indices"), "SCALAR")[:, 0].astype(np.int64)
    if corners.size and corners.max() >= len(points):
        raise part.get("indices").error(f"indices below {len(points)}", str(corners.max()))
    joints, weights = _moved(document, attributes, len(points), len(bones), skinned=skinned)
    mesh = Mesh(
        name,
        points,
        _triangles(corners, mode),
        tuple(bone for bone, _ in bones),
        np.array([matrix for _, matrix in bones]),
        joints,
        weights,
        _optional(document, attributes, "NORMAL", "VEC3", len(points)),
        _optional(document, attributes, "TEXCOORD_0", "VEC2", len(points)),
        part.get("material", -1).whole(least=-1),
    )
    return [mesh]


def _triangles(corners: NDArray[np.int64], mode: int) -> NDArray[np.int64]:
    """Return the corners (T, 3) of triangles."""
    if mode == _TRIANGLES:
        return corners[: len(corners) // 3 * 3].reshape(-1, 3)
    if mode == _FAN:
        others = np.stack([corners[1:-1], corners[2:]], axis=1)
        return np.concatenate([np.full((len(others), 1), corners[0]), others], axis=1)
    faces = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=1)
    faces[1::2] = faces[1::2, ::-1]
    return faces


def _optional(
    document: Document, attributes: Part, name: str, kind: str, points: int
) -> Array | None:
    if not attributes.has(name):
        return None
    rows = document.accessor(attributes.get(name), kind)
    if len(rows) != points:
        raise attributes.get(name).error(f"{points} rows", str(len(rows)))
    return rows


def _moved(
    document: Document, attributes: Part, points: int, bones: int, *, skinned: bool
) -> tuple[NDArray[np.int64], Array]:
    """Return the four joints (V, 4) that move each point most, and their shares."""
    if not skinned:
        first = np.eye(1, MOST_BONES)
        return np.zeros((points, MOST_BONES), np.int64), np.tile(first, (points, 1))
    joints, weights = [], []
    for number in count():
        moving = _optional(document, attributes, f"JOINTS_{number}", "VEC4", points)
        shares = _optional(document, attributes, f"WEIGHTS_{number}", "VEC4", points)
        if moving is None or shares is None:
            break
        joints.append(moving)
        weights.append(shares)
    if not joints:
        raise attributes.error("JOINTS_0 and WEIGHTS_0", "none")
    told = np.where(np.hstack(weights) > 0.0, np.hstack(joints).astype(np.int64), 0)
    if told.size and told.max() >= bones:
        raise attributes.error(f"joints below {bones}", str(told.max()))
    return strongest(told, np.hstack(weights))


def _material(document: Document, part: Part) -> Material:
    rough = part.get("pbrMetallicRoughness", {})
    picture = None
    if rough.has("baseColorTexture"):
        texture = document.entry("textures", rough.get("baseColorTexture").get("index"))
        if texture.has("source"):
            picture = _picture(document, document.entry("images", texture.get("source")))
    red, green, blue, opacity = rough.get("baseColorFactor", [1, 1, 1, 1]).numbers(4).tolist()
    alpha = part.get("alphaMode", "OPAQUE").text()
    return Material(
        part.get("name", "").text(),
        (red, green, blue, opacity),
        picture,
        _number(rough.get("roughnessFactor", 1.0)),
        _number(rough.get("metallicFactor", 1.0)),
        part.get("doubleSided", False).value is True,
        alpha if alpha in ("MASK", "BLEND") else "OPAQUE",
    )


def _number(part: Part) -> float:
    value: Any = part.value
    if type(value) not in (int, float) or not 0.0 <= value <= 1.0:
        raise part.error("a number from 0 to 1")
    return float(value)


def _picture(document: Document, image: Part) -> Image | None:
    return image_of(document.picture(image))
