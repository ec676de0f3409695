"""The figure of a character: meshes that hang on the joints of a skeleton, and how they look."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

__all__ = ["MOST_BONES", "Figure", "Image", "Material", "Mesh", "image_of", "strongest"]

Array = NDArray[np.float64]

MOST_BONES = 4
"""Joints that move a point, at most: what programs that show a character take."""
_KINDS = (b"\x89PNG", "image/png"), (b"\xff\xd8", "image/jpeg"), (b"RIFF", "image/webp")


@dataclass(frozen=True)
class Image:
    """A picture as it stands in a file.

    Parameters
    ----------
    kind : str
        As in "image/png".
    content : bytes
    """

    kind: str
    content: bytes


@dataclass(frozen=True)
class Material:
    """How a surface looks.

    Parameters
    ----------
    name : str
    colour : (4,) tuple of float
        Red, green, blue and opacity, linear, from 0 to 1.
    picture : Image or None
        Multiplied with the colour.
    roughness, metallic : float
    double_sided : bool
    alpha : {"OPAQUE", "MASK", "BLEND"}
    """

    name: str = ""
    colour: tuple[float, float, float, float] = (0.8, 0.8, 0.8, 1.0)
    picture: Image | None = None
    roughness: float = 0.9
    metallic: float = 0.0
    double_sided: bool = True
    alpha: str = "OPAQUE"


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles that joints move.

    Parameters
    ----------
    name : str
    points : (V, 3) ndarray
    faces : (T, 3) ndarray of int
        Corners of triangles, against the clock as seen from outside.
    bones : tuple of str
        The joints that move the mesh, by their names.
    binds : (B, 4, 4) ndarray
        For each of them, what takes the points to the joint's own axes, in the skeleton's unit.
    joints : (V, 4) ndarray of int
        The numbers of bones that move each point.
    weights : (V, 4) ndarray
        Their shares; each row adds up to 1.
    normals : (V, 3) ndarray, optional
    places : (V, 2) ndarray, optional
        Of the points in the material's picture.
    material : int
        A number in the figure's list; -1 for none.
    """

    name: str
    points: Array
    faces: NDArray[np.int64]
    bones: tuple[str, ...]
    binds: Array
    joints: NDArray[np.int64]
    weights: Array
    normals: Array | None = None
    places: Array | None = None
    material: int = -1

    def posed(self, places: Array, turns: Array, names: tuple[str, ...]) -> Array:
        """Return the points (V, 3) in a pose.

        Parameters
        ----------
        places : (J, 3) ndarray
            Of the joints in the world.
        turns : (J, 3, 3) ndarray
            Their axes in the world, as columns.
        names : tuple of J str
        """
        at = [names.index(bone) for bone in self.bones]
        moved = turns[at] @ self.binds[:, :3]
        moved[..., 3] += places[at]
        ahead = np.concatenate([self.points, np.ones((len(self.points), 1))], axis=1)
        shown = np.einsum("vkij,vj->vki", moved[self.joints], ahead)
        return np.asarray(np.einsum("vk,vki->vi", self.weights, shown))


@dataclass(frozen=True, eq=False)
class Figure:
    """Hold the meshes of a character.

    Parameters
    ----------
    meshes : tuple of Mesh
    materials : tuple of Material
    """

    meshes: tuple[Mesh, ...]
    materials: tuple[Material, ...] = ()

    def scaled(self, factor: float) -> Figure:
        """Return the figure of a skeleton whose lengths are multiplied by a factor."""
        return self._bound(np.diag([factor] * 3))

    def rebased(self, axes: Array) -> Figure:
        """Return the figure of a skeleton whose joints have other axes (3, 3): A R A^-1 for R."""
        return self._bound(axes)

    def mirrored(self, partners: Mapping[str, str], reflection: Array) -> Figure:
        """Return the figure in a mirror.

        Parameters
        ----------
        partners : mapping of str to str
            The joint on the other side of each.
        reflection : (3,) ndarray
            The diagonal of the reflection of the body.
        """
        meshes = [
            replace(
                mesh,
                bones=tuple(partners.get(bone, bone) for bone in mesh.bones),
                faces=mesh.faces[:, ::-1],
            )
            for mesh in self._bound(np.diag(reflection)).meshes
        ]
        return replace(self, meshes=tuple(meshes))

    def _bound(self, change: Array) -> Figure:
        """Return the figure with a change (3, 3) of all joints' own axes."""
        meshes = []
        for mesh in self.meshes:
            binds = mesh.binds.copy()
            binds[:, :3] = change @ binds[:, :3]
            meshes.append(replace(mesh, binds=binds))
        return replace(self, meshes=tuple(meshes))


def strongest(joints: NDArray[np.int64], weights: Array) -> tuple[NDArray[np.int64], Array]:
    """Return the largest weights of each point, adding up to 1, and their joints.

    Parameters
    ----------
    joints : (V, n) ndarray of int
    weights : (V, n) ndarray

    Returns
    -------
    joints : (V, 4) ndarray of int
    weights : (V, 4) ndarray
    """
    kept = np.argsort(-weights, axis=1, kind="stable")[:, :MOST_BONES]
    weights = np.maximum(np.take_along_axis(weights, kept, axis=1), 0.0)
    joints = np.where(weights > 0.0, np.take_along_axis(joints, kept, axis=1), 0)
    total = weights.sum(axis=1, keepdims=True)
    weights[:, :1] += total <= 0.0
    return joints, weights / np.where(total > 0.0, total, 1.0)


def image_of(content: bytes) -> Image | None:
    """Return a picture by its first bytes; None if it is of no kind that is known."""
    kind = next((kind for start, kind in _KINDS if content.startswith(start)), None)
    return None if kind is None else Image(kind, content)
