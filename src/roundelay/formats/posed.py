"""From moving nodes to a motion: what lies above the root moves it, scales go into lengths."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError
from roundelay.formats.moving import leave
from roundelay.formats.nodes import Tree, different, listed, note
from roundelay.formats.sane import LARGEST, require_memory
from roundelay.geometry import rotations as rot
from roundelay.geometry.figure import Figure
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion

__all__ = [
    "Bound",
    "Chosen",
    "Dresser",
    "Placed",
    "check_proportion",
    "even_scales",
    "matrix_of",
    "posed",
]

Array = NDArray[np.float64]

# Poses of a joint for a byte of the file, and poses that any file may have.
_PROPORTION, _FEW = 2, 1 << 19
# Scales that differ by less, relatively, are one.
_EVEN = 1e-3


class Placed(Protocol):
    """The nodes of a scene in time: first at rest, then in every frame."""

    def places(self, node: int) -> Array:
        """Return the place (1 + F, 3) of a node on its parent."""
        ...

    def turns(self, node: int) -> Array:
        """Return the rotation (1 + F, 4) of a node on its parent."""
        ...

    def scale(self, node: int) -> float:
        """Return the one scale of a node, by which all below it is larger."""
        ...

    def local(self, node: int) -> Array:
        """Return the matrix (4, 4) of a node on its parent at rest."""
        ...


@dataclass(frozen=True)
class Chosen:
    """The nodes that become a skeleton.

    Parameters
    ----------
    joints : list of int
        Parents first.
    ends : list of (int, int)
        Joints and the ends of limbs on them.
    """

    joints: list[int]
    ends: list[tuple[int, int]]


Dresser = Callable[["Bound"], Figure | None]
"""Reads the figure that hangs on a skeleton."""


@dataclass(frozen=True)
class Bound:
    """Tell what a mesh on a node hangs on, and how it stands to that joint.

    Parameters
    ----------
    tree : Tree
    names : dict of int to str
        Of the joints.
    scales : dict of int to float
        Of the axes of each joint, which a motion does not have.
    locals : callable
        Returns the matrix (4, 4) of a node on its parent at rest.
    """

    tree: Tree
    names: dict[int, str]
    scales: dict[int, float]
    locals: Callable[[int], Array]

    def holds(self, node: int) -> bool:
        """Tell whether a node is a joint, or hangs on one."""
        return node in self.names or any(up in self.names for up in self.tree.above(node))

    def to(self, node: int) -> tuple[str, Array]:
        """Return the joint that a node hangs on, and the matrix (4, 4) from the node to it.

        What hangs on none stands still to the root, as it does at rest.
        """
        matrix, at = np.eye(4), node
        while at >= 0 and at not in self.names:
            matrix, at = self.locals(at) @ matrix, self.tree.parents[at]
        if at < 0:
            at = next(iter(self.names))
            for step in [*self.tree.above(at), at]:
                matrix = np.linalg.pinv(self.locals(step)) @ matrix
        return self.names[at], np.diag([*[self.scales[at]] * 3, 1.0]) @ matrix


def posed(
    tree: Tree,
    placed: Placed,
    chosen: Chosen,
    step: float,
    name: str,
    dresser: Dresser | None = None,
) -> Motion:
    """Return the motion of the chosen nodes.

    The nodes above the root move it. One scale for all axes is multiplied into the lengths
    below it.

    Parameters
    ----------
    tree : Tree
    placed : Placed
    chosen : Chosen
    step : float
        Seconds from one frame to the next.
    name : str
        Of the motion.
    dresser : callable, optional
        Reads the figure; one that is not sound is left out, with a note.

    Raises
    ------
    FormatError
        If scales leave no lengths, or numbers grow beyond all bounds.
    """
    joints, number = chosen.joints, {joint: n for n, joint in enumerate(chosen.joints)}
    root, turn, factor = _root(tree, placed, [*tree.above(joints[0]), joints[0]])
    factors = {joints[0]: factor}
    rows = [root]
    for joint in joints[1:]:
        parent = tree.parents[joint]
        factors[joint] = _product(tree, placed, joint, factors[parent])
        rows.append(factors[parent] * placed.places(joint))
    places = np.stack(rows, axis=1)
    turns = np.stack([turn, *(placed.turns(joint) for joint in joints[1:])], axis=1)
    parents = (-1, *(number[tree.parents[joint]] for joint in joints[1:]))
    tips = tuple((number[on], factors[on] * placed.places(end)[0]) for on, end in chosen.ends)
    names = different([tree.names[joint] for joint in joints])
    skeleton = Skeleton(names, parents, places[1], tips)
    offsets, moved = _offsets(places, skeleton.size)
    figure = None
    if dresser is not None:
        named = dict(zip(joints, names, strict=True))
        figure = _figure(dresser, Bound(tree, named, factors, placed.local))
    turned = bool(np.any(np.abs(turns[0, :, 0]) < 1.0))
    rest = rot.normalize(turns[0]) if turned else None
    skeleton = Skeleton(names, parents, offsets, tips, figure=figure, rest=rest)
    translations = places[1:] if moved else None
    return Motion(skeleton, turns[1:], places[1:, 0], step, translations, name)


def _figure(dresser: Dresser, bound: Bound) -> Figure | None:
    try:
        return dresser(bound)
    except FormatError as error:
        note(bound.tree.path, f"its meshes are left out: {error.message}")
        return None


def _root(tree: Tree, placed: Placed, chain: Sequence[int]) -> tuple[Array, Array, float]:
    """Return place and rotation in the world of the last of a chain, and the scale below it."""
    place, turn, factor = np.zeros(3), rot.identity(), 1.0
    for node in chain:
        place = place + rot.rotate(turn, factor * placed.places(node))
        turn = rot.multiply(turn, placed.turns(node))
        factor = _product(tree, placed, node, factor)
    return place, turn, factor


def _product(tree: Tree, placed: Placed, node: int, above: float) -> float:
    # Scales are multiplied down the tree.
    product = above * placed.scale(node)
    if not 1.0 / LARGEST < product < LARGEST:
        told = f"expected a scale that leaves lengths, found {product:g}"
        raise FormatError(f"{told} at node {tree.names[node]!r}", path=tree.path)
    return product


def _offsets(places: Array, size: float) -> tuple[Array, bool]:
    """Return the joints' offsets of places (1 + F, J, 3), and whether any moves away from its own.

    A joint that stands still has the place where it stands, another that at rest, if it has one.
    """
    still = ~leave(places[1:], places[1], size) | ~np.any(places[0], axis=1)
    offsets = np.where(still[:, None], places[1], places[0])
    offsets[0] = places[0, 0]
    return offsets, bool(leave(places[1:, 1:], offsets[1:], size).any())


def even_scales(tree: Tree, shown: dict[int, Array]) -> dict[int, float]:
    """Return the one scale of every node; 1, with a note, where there is none.

    Parameters
    ----------
    tree : Tree
    shown : dict of int to (n, 3) or (3,) ndarray
        The scales of each node along its axes, at rest or at its keys.
    """
    scales, odd = {}, []
    for number, each in shown.items():
        largest = float(each.max())
        even = float(np.ptp(each)) <= _EVEN * largest and largest > 0.0
        scales[number] = float(each.mean()) if even else 1.0
        if not even:
            odd.append(tree.names[number])
    if odd:
        text = "scales that change, or are not one for all axes, are left out"
        note(tree.path, f"{text}: of {listed(odd)}")
    return scales


def check_proportion(tree: Tree, frames: int, joints: int, loaded: int) -> None:
    """Refuse a motion out of proportion to its file.

    Parameters
    ----------
    tree : Tree
    frames, joints : int
    loaded : int
        Bytes of the file.

    Raises
    ------
    FormatError
        If there are more poses of a joint than the file could hold.
    TooLarge
        If there is no memory for them.
    """
    if frames * joints > _PROPORTION * loaded + _FEW:
        told = f"expected keys on most of the joints, found {frames} frames of {joints} joints"
        raise FormatError(f"{told} in {loaded} bytes", path=tree.path)
    require_memory(frames, joints)


def matrix_of(place: Array, turn: Array, scale: Array) -> Array:
    """Return the matrix (4, 4) of a place (3,), a rotation (4,) and scales (3,)."""
    matrix = np.eye(4)
    matrix[:3, :3] = rot.to_matrix(turn) * scale
    matrix[:3, 3] = place
    return matrix
