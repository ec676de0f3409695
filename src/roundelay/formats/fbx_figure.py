"""The meshes of an FBX file that hang on a skeleton: skins, or what is fixed to a bone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import PureWindowsPath

import numpy as np
from numpy.typing import NDArray

from roundelay.formats.fbx_document import Fbx, Object, Properties
from roundelay.formats.fbx_elements import Element
from roundelay.formats.fbx_models import Models
from roundelay.formats.posed import Bound, matrix_of
from roundelay.geometry import rotations as rot
from roundelay.geometry.figure import MOST_BONES, Figure, Image, Material, Mesh, image_of, strongest

__all__ = ["read_figure"]

Array = NDArray[np.float64]
Places = NDArray[np.int64]

_LARGEST_PICTURE = 1 << 28
# Decimals by which corners of two faces are one.
_SAME = 5


def read_figure(models: Models, bound: Bound) -> Figure | None:
    """Read the meshes that hang on a skeleton; None where there are none.

    Raises
    ------
    FormatError
        If one is not sound.
    """
    meshes: list[Mesh] = []
    materials: list[Material] = []
    for number, model in enumerate(models.objects):
        shapes = [one for one, _ in models.fbx.below(model.identity, "Geometry")]
        shapes += [model] if model.element.first("Vertices") is not None else []
        for shape in shapes:
            own = [one for one, _ in models.fbx.below(model.identity, "Material")]
            found = _meshes(models, number, shape, bound, len(materials))
            if found:
                meshes += found
                materials += [_material(models.fbx, one) for one in own]
    known = [_known(mesh, len(materials)) for mesh in meshes]
    return Figure(tuple(known), tuple(materials)) if known else None


def _known(mesh: Mesh, materials: int) -> Mesh:
    return mesh if mesh.material < materials else replace(mesh, material=-1)


def _meshes(
    models: Models, number: int, shape: Object, bound: Bound, first_material: int
) -> list[Mesh]:
    """Return a shape as one mesh for each material."""
    vertices = shape.element.first("Vertices")
    ends = shape.element.first("PolygonVertexIndex")
    if vertices is None or ends is None:
        return []
    points = vertices.numbers()
    if len(points) % 3:
        raise vertices.error("three numbers for each point", f"{len(points)}")
    points = points.reshape(-1, 3)
    corners, faces, polygons = _faces(ends, len(points))
    moved = _moved(models, number, shape, bound, len(points))
    if moved is None:
        return []
    bones, binds, joints, weights = moved
    normals = _layer(shape.element, "Normal", 3, corners, polygons)
    places = _layer(shape.element, "UV", 2, corners, polygons)
    if places is not None:
        places = places * (1.0, -1.0) + (0.0, 1.0)
    material = _materials(shape.element, polygons)
    result = []
    for which in np.unique(material[polygons[faces[:, 0]]]) if len(faces) else ():
        chosen = faces[material[polygons[faces[:, 0]]] == which]
        kept, own = _merged(chosen, corners, normals, places)
        at = corners[kept]
        result.append(
            Mesh(
                models.tree.names[number],
                points[at],
                own,
                bones,
                binds,
                joints[at],
                weights[at],
                None if normals is None else normals[kept],
                None if places is None else places[kept],
                first_material + int(which),
            )
        )
    return result


def _faces(ends: Element, points: int) -> tuple[Places, Places, Places]:
    """Return the point of each corner, triangles (T, 3) of corners, and the polygon of each."""
    listed = ends.array().astype(np.int64)
    last = listed < 0
    corners = np.where(last, ~listed, listed)
    if corners.size and corners.max() >= points:
        raise ends.error(f"points below {points}", str(corners.max()))
    polygons = np.concatenate([[0], np.cumsum(last)[:-1]]) if len(listed) else last.astype(int)
    stops = np.flatnonzero(last) + 1
    starts = np.concatenate([[0], stops[:-1]]) if len(stops) else stops
    counts = np.maximum(stops - starts - 2, 0)
    first = np.repeat(starts, counts)
    step = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    faces = np.stack([first, first + step + 1, first + step + 2], axis=1)
    return corners, faces, polygons


def _layer(
    shape: Element, name: str, width: int, corners: Places, polygons: Places
) -> Array | None:
    """Return rows (C, width) of a layer for every corner; None where it has none of them."""
    layer = shape.first(f"LayerElement{name}")
    values = None if layer is None else layer.first("Normals" if name == "Normal" else name)
    if layer is None or values is None:
        return None
    rows = values.numbers()
    rows = rows[: len(rows) // width * width].reshape(-1, width)
    kind, stored = layer.first("MappingInformationType"), layer.first("ReferenceInformationType")
    told = "" if kind is None else kind.text(0, "")
    at = {
        "ByPolygonVertex": np.arange(len(corners)),
        "ByVertice": corners,
        "ByVertex": corners,
        "ByPolygon": polygons,
        "AllSame": np.zeros(len(corners), np.int64),
    }.get(told)
    index = layer.first(f"{name}sIndex" if name == "Normal" else f"{name}Index")
    if at is None:
        return None
    if stored is not None and stored.text(0, "") != "Direct" and index is not None:
        listed = index.array().astype(np.int64)
        if at.size and at.max() >= len(listed):
            return None
        at = listed[at]
    if at.size and (at.max() >= len(rows) or at.min() < 0):
        return None
    return rows[at]


def _materials(shape: Element, polygons: Places) -> Places:
    """Return the number of the material of each polygon."""
    count = int(polygons[-1]) + 1 if len(polygons) else 0
    layer = shape.first("LayerElementMaterial")
    listed = None if layer is None else layer.first("Materials")
    if listed is None:
        return np.zeros(count, np.int64)
    numbers = np.maximum(listed.array().astype(np.int64), 0)
    if len(numbers) >= count:
        return numbers[:count]
    return np.full(count, numbers[0] if len(numbers) else 0)


def _merged(
    faces: Places, corners: Places, normals: Array | None, places: Array | None
) -> tuple[Places, Places]:
    """Return the corners that are kept and faces of them: alike corners of a point are one."""
    used = np.unique(faces)
    rows = [corners[used][:, None].astype(float)]
    rows += [np.round(one[used], _SAME) for one in (normals, places) if one is not None]
    _, first, group = np.unique(np.hstack(rows), axis=0, return_index=True, return_inverse=True)
    number = np.zeros(int(faces.max()) + 1, np.int64)
    number[used] = group.ravel()
    return used[first], number[faces]


def _moved(
    models: Models, number: int, shape: Object, bound: Bound, points: int
) -> tuple[tuple[str, ...], Array, Places, Array] | None:
    """Return bones, binds, and the joints and weights of every point; None if none moves it."""
    inner = _geometric(models.known[number])
    owners = {shape.identity, models.objects[number].identity}
    clusters = [
        cluster
        for owner in owners
        for skin, _ in models.fbx.below(owner, "Deformer")
        for cluster, _ in models.fbx.below(skin.identity, "Deformer")
        if cluster.subclass == "Cluster"
    ]
    if not clusters:
        if not bound.holds(number):
            return None
        name, matrix = bound.to(number)
        first = np.tile(np.eye(1, MOST_BONES), (points, 1))
        return (name,), (matrix @ inner)[None], np.zeros((points, MOST_BONES), np.int64), first
    bones, binds, rows = [], [], []
    for cluster in clusters:
        link = next((bone for bone, _ in models.fbx.below(cluster.identity, "Model")), None)
        listed, shares = cluster.element.first("Indexes"), cluster.element.first("Weights")
        bind = cluster.element.first("Transform")
        if link is None or bind is None:
            continue
        name, matrix = bound.to(models.number[link.identity])
        bones.append(name)
        binds.append(matrix @ bind.numbers(0, 16).reshape(4, 4).T @ inner)
        if listed is not None and shares is not None:
            rows.append(_influence(listed, shares, len(bones) - 1, points))
    return _weighed(bones, binds, rows, points)


def _influence(listed: Element, shares: Element, bone: int, points: int) -> Array:
    """Return rows of point, bone and weight."""
    at, weights = listed.array().astype(np.int64), shares.numbers()
    if len(at) != len(weights) or (at.size and (at.max() >= points or at.min() < 0)):
        raise listed.error(f"{len(weights)} points below {points}", "others")
    return np.stack([at.astype(float), np.full(len(at), float(bone)), weights], axis=1)


def _weighed(
    bones: list[str], binds: list[Array], rows: list[Array], points: int
) -> tuple[tuple[str, ...], Array, Places, Array] | None:
    table = np.concatenate(rows) if rows else np.zeros((0, 3))
    if not len(table):
        return None
    table = table[np.lexsort((-table[:, 2], table[:, 0]))]
    at = table[:, 0].astype(np.int64)
    starts = np.searchsorted(at, at)
    rank = np.arange(len(at)) - starts
    table, at, rank = table[rank < MOST_BONES], at[rank < MOST_BONES], rank[rank < MOST_BONES]
    joints, weights = np.zeros((points, MOST_BONES), np.int64), np.zeros((points, MOST_BONES))
    joints[at, rank] = table[:, 1].astype(np.int64)
    weights[at, rank] = table[:, 2]
    return tuple(bones), np.array(binds), *strongest(joints, weights)


def _geometric(known: Properties) -> Array:
    """Return the matrix of a shape on its model, which nothing below inherits."""
    turn = np.radians(known.vector("GeometricRotation"))[::-1]
    return matrix_of(
        np.array(known.vector("GeometricTranslation")),
        rot.from_euler(turn, "ZYX"),
        np.array(known.vector("GeometricScaling", 1.0)),
    )


def _material(fbx: Fbx, one: Object) -> Material:
    known = Properties.of(one.element, fbx.template("Material"))
    name = "DiffuseColor" if "DiffuseColor" in known.rows else "Diffuse"
    red, green, blue = np.clip(known.vector(name, 0.8), 0.0, 1.0).tolist()
    picture = None
    for texture, of in fbx.below(one.identity, "Texture"):
        if of in ("DiffuseColor", "Maya|baseColor", "3dsMax|Parameters|base_color_map", ""):
            picture = picture or _picture(fbx, texture)
    colour = (1.0, 1.0, 1.0, 1.0) if picture else (red, green, blue, 1.0)
    return Material(one.name, colour, picture)


def _picture(fbx: Fbx, texture: Object) -> Image | None:
    """Return the picture of a texture: inside the file, or beside it by its name."""
    for video, _ in fbx.below(texture.identity, "Video"):
        held = video.element.first("Content")
        if held is not None and held.values and isinstance(held.values[0], bytes):
            image = image_of(held.values[0])
            if image is not None:
                return image
    for element in (texture.element.first("RelativeFilename"), texture.element.first("FileName")):
        name = "" if element is None else PureWindowsPath(element.text(0, "")).name
        beside = fbx.path.parent / name
        try:
            if name and beside.is_file() and beside.stat().st_size < _LARGEST_PICTURE:
                return image_of(beside.read_bytes())
        except (OSError, ValueError):
            continue
    return None
