"""The models of an FBX scene: a tree of nodes, each with a transform of many parts.

A model is placed on its parent by T Roff Rp Rpre R Rpost^-1 Rp^-1 Soff Sp S Sp^-1: translation,
rotation offset and pivot, rotations before and after the animated one, scaling offset and pivot
(Autodesk FBX SDK, "Computing transformation matrices").
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from roundelay.formats.clock import Clock
from roundelay.formats.fbx_document import Fbx, Object, Properties
from roundelay.formats.fbx_takes import Channel
from roundelay.formats.nodes import Tree
from roundelay.formats.posed import matrix_of
from roundelay.geometry import rotations as rot

__all__ = ["Models", "PlacedModels", "models_of"]

Array = NDArray[np.float64]

# Axes in the order in which they turn, by the number of the rotation order; 6 is spheric, read as
# the first.
_ORDERS = ("XYZ", "XZY", "YZX", "YXZ", "ZXY", "ZYX", "XYZ")
_DEGREE = float(np.pi / 180.0)
# The parent's own scale is not inherited.
_WITHOUT_PARENT = 2
_BONES = ("LimbNode", "Limb", "Root")


@dataclass(frozen=True, eq=False)
class Models:
    """The models of a scene.

    Parameters
    ----------
    fbx : Fbx
    objects : list of Object
    known : list of Properties
    number : dict
        Of each model by its identity.
    tree : Tree
    """

    fbx: Fbx
    objects: list[Object]
    known: list[Properties]
    number: dict[Hashable, int]
    tree: Tree

    def bones(self) -> set[int]:
        """Return the models that are bones, by what they say or because a mesh hangs on them."""
        found = {n for n, one in enumerate(self.objects) if one.subclass in _BONES}
        for cluster in self.fbx.of_kind("Deformer"):
            for bone, _ in self.fbx.below(cluster.identity, "Model"):
                if cluster.subclass == "Cluster":
                    found.add(self.number[bone.identity])
        return found


def models_of(fbx: Fbx) -> Models:
    """Read the tree of models.

    Raises
    ------
    FormatError
        If there is none, or a model lies below itself.
    """
    objects = fbx.of_kind("Model")
    if not objects:
        raise fbx.error("models", "none")
    number: dict[Hashable, int] = {one.identity: n for n, one in enumerate(objects)}
    parents = [-1] * len(objects)
    for child, parent, of in fbx.links:
        if not of and child in number and parent in number:
            parents[number[child]] = number[parent]
    names = [one.name or f"model{n}" for n, one in enumerate(objects)]
    template = fbx.template("Model")
    known = [Properties.of(one.element, template) for one in objects]
    return Models(fbx, objects, known, number, Tree.of(fbx.path, names, parents))


@dataclass(frozen=True, eq=False)
class PlacedModels:
    """Give every model's place and rotation on its parent: at rest, then in every frame.

    Parameters
    ----------
    models : Models
    channels : dict
        By the model's identity and "T", "R" or "S".
    clock : Clock
    scales : dict of int to float
        Of each model.
    """

    models: Models
    channels: dict[tuple[Hashable, str], Channel]
    clock: Clock
    scales: dict[int, float] = field(default_factory=dict)

    def places(self, node: int) -> Array:
        """Return the place (1 + F, 3) of a model on its parent."""
        known = self.models.known[node]
        moved = self.values(node, "T") + known.vector("RotationOffset")
        pivot, shift = np.array(known.vector("RotationPivot")), known.vector("ScalingOffset")
        centre = np.array(known.vector("ScalingPivot"))
        inner = shift + centre - self.scales.get(node, 1.0) * centre - pivot
        if not np.any(inner) and not np.any(pivot):
            return moved
        return np.asarray(moved + pivot + rot.rotate(self.turns(node), inner))

    def turns(self, node: int) -> Array:
        """Return the rotation (1 + F, 4) of a model on its parent."""
        known = self.models.known[node]
        active = bool(known.whole("RotationActive", 0))
        order = _ORDERS[min(max(known.whole("RotationOrder", 0), 0), 6)] if active else "XYZ"
        turn = _euler(self.values(node, "R"), order)
        if not active:
            return turn
        before, after = known.vector("PreRotation"), known.vector("PostRotation")
        turn = rot.multiply(_euler(np.array(before), "XYZ"), turn) if any(before) else turn
        if any(after):
            turn = rot.multiply(turn, rot.conjugate(_euler(np.array(after), "XYZ")))
        return turn

    def scale(self, node: int) -> float:
        """Return the one scale of a model, without its parent's where it inherits none."""
        own, parent = self.scales[node], self.models.tree.parents[node]
        alone = self.models.known[node].whole("InheritType", 0) == _WITHOUT_PARENT
        return own / self.scales.get(parent, 1.0) if alone else own

    def local(self, node: int) -> Array:
        """Return the matrix (4, 4) of a model on its parent at rest."""
        scale = np.array(self.models.known[node].vector("Lcl Scaling", 1.0))
        return matrix_of(self.places(node)[0], self.turns(node)[0], scale)

    def values(self, node: int, kind: str) -> Array:
        """Return translation, angles or scales (1 + F, 3): at rest, then in every frame."""
        name = {"T": "Lcl Translation", "R": "Lcl Rotation", "S": "Lcl Scaling"}[kind]
        rest = self.models.known[node].vector(name, 1.0 if kind == "S" else 0.0)
        channel = self.channels.get((self.models.objects[node].identity, kind))
        rows = np.tile(rest, (1 + len(self.clock.times), 1))
        if channel is not None:
            for axis, (curve, default) in enumerate(
                zip(channel.curves, channel.defaults, strict=True)
            ):
                if curve is not None:
                    rows[1:, axis] = curve.at(self.clock)
                elif default is not None:
                    rows[1:, axis] = default
        return rows


def _euler(degrees: Array, order: str) -> Array:
    """Return rotations about axes in an order; the first one turns first."""
    columns = ["XYZ".index(axis) for axis in reversed(order)]
    return rot.from_euler(degrees[..., columns] * _DEGREE, order[::-1])
