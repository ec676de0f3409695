"""A figure in a glTF file that is written: meshes with skins of all joints, and their materials."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from roundelay.formats.gltf_buffer import Buffer
from roundelay.geometry.figure import Figure, Image, Material, Mesh

__all__ = ["shown"]

Json = dict[str, Any]


def shown(
    figure: Figure, names: Sequence[str], nodes: list[Json], skin: Json, buffer: Buffer
) -> Json:
    """Return scenes, nodes, skins, meshes and materials of a file with a figure.

    Parameters
    ----------
    figure : Figure
    names : sequence of str
        Of the joints, which are the first nodes.
    nodes : list of dict
        Joints and ends of limbs; nodes of meshes are added.
    skin : dict
        The skin of all joints.
    buffer : Buffer
    """
    skins: list[Json] = []
    meshes: list[Json] = []
    at_top = [0]
    for mesh in figure.meshes:
        at_top.append(len(nodes))
        nodes.append({"name": mesh.name, "mesh": len(meshes), "skin": len(skins)})
        skins.append(skin | {"inverseBindMatrices": _binds(mesh, names, skin, buffer)})
        meshes.append({"name": mesh.name, "primitives": [_primitive(mesh, names, buffer)]})
    document: Json = {
        "scenes": [{"nodes": at_top}],
        "nodes": nodes,
        "skins": skins,
        "meshes": meshes,
    }
    return document | _materials(figure.materials, buffer)


def _binds(mesh: Mesh, names: Sequence[str], skin: Json, buffer: Buffer) -> int:
    """Return the accessor of the bind matrices of all joints of a skin."""
    matrices = np.tile(np.eye(4), (len(skin["joints"]), 1, 1))
    for bone, bind in zip(mesh.bones, mesh.binds, strict=True):
        matrices[names.index(bone)] = bind
    return buffer.add("MAT4", np.swapaxes(matrices, 1, 2))


def _primitive(mesh: Mesh, names: Sequence[str], buffer: Buffer) -> Json:
    number = np.array([names.index(bone) for bone in mesh.bones])
    attributes = {
        "POSITION": buffer.add("VEC3", mesh.points, limits=True),
        "JOINTS_0": buffer.add("VEC4", number[mesh.joints], dtype="<u2"),
        "WEIGHTS_0": buffer.add("VEC4", mesh.weights),
    }
    if mesh.normals is not None:
        length = np.linalg.norm(mesh.normals, axis=1, keepdims=True)
        up = np.where(length > 0.0, mesh.normals / np.where(length > 0.0, length, 1.0), (0, 1, 0))
        attributes["NORMAL"] = buffer.add("VEC3", up)
    if mesh.places is not None:
        attributes["TEXCOORD_0"] = buffer.add("VEC2", mesh.places)
    indices = buffer.add("SCALAR", mesh.faces.reshape(-1, 1), dtype="<u4")
    primitive: Json = {"attributes": attributes, "indices": indices}
    return primitive | ({"material": mesh.material} if mesh.material >= 0 else {})


def _materials(materials: Sequence[Material], buffer: Buffer) -> Json:
    """Return the materials and their pictures, each once."""
    pictures: dict[Image, int] = {}
    for one in materials:
        if one.picture is not None:
            pictures.setdefault(one.picture, len(pictures))
    told: Json = {"materials": [_material(one, pictures) for one in materials]}
    if pictures:
        told["images"] = [
            {"bufferView": buffer.view(picture.content), "mimeType": picture.kind}
            for picture in pictures
        ]
        told["textures"] = [{"source": number} for number in range(len(pictures))]
    return told if materials else {}


def _material(one: Material, pictures: dict[Image, int]) -> Json:
    rough: Json = {
        "baseColorFactor": list(one.colour),
        "roughnessFactor": one.roughness,
        "metallicFactor": one.metallic,
    }
    if one.picture is not None:
        rough["baseColorTexture"] = {"index": pictures[one.picture]}
    told: Json = {"name": one.name, "pbrMetallicRoughness": rough, "alphaMode": one.alpha}
    return told | ({"doubleSided": True} if one.double_sided else {})
