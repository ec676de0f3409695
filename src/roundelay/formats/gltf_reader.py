"""Read glTF 2.0: the nodes of a skin as the skeleton, an animation at even times as the motion.

Without a skin the skeleton is made of the nodes that the animation moves and what hangs on them.
The nodes above it move its root. One scale for all axes is multiplied into the lengths below it.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import RoundelayWarning
from roundelay.formats.gltf_document import Document, Part, load
from roundelay.formats.gltf_keys import Clock, Track, common_clock, read_track
from roundelay.formats.moving import leave
from roundelay.formats.sane import LARGEST, MOST_JOINTS, require_memory
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion

__all__ = ["GltfReader"]

Array = NDArray[np.float64]

# Poses of a joint for a byte of the file, and poses that any file may have.
_PROPORTION, _FEW = 2, 1 << 22
# Scales that differ by less, relatively, are one.
_EVEN = 1e-3
# What a writer of motions leaves out.
_BESIDES = ("meshes", "cameras", "materials", "textures", "images")
_MOVING = "an animation that moves the skeleton's nodes"
# Names in a note.
_NAMED = 8


class GltfReader:
    """The reader of glTF files."""

    name = "gltf"
    suffixes = (".glb", ".gltf")

    def read(self, path: Path) -> Motion:
        """Read a ``.glb`` or ``.gltf`` file.

        Parameters
        ----------
        path : Path

        Returns
        -------
        Motion
            The first animation that moves the skeleton; Y is up, lengths are those of the file. A
            loop that ends with its first frame is given as it is.

        Raises
        ------
        FormatError
            If the file is not sound, or holds no animation of nodes.
        OSError
            If it cannot be read.
        """
        document = load(path)
        tree = _read_tree(document)
        skin = _joints_of_skin(document, tree)
        animation = _first_moving(document, tree, skin)
        tracks = _read_tracks(document, animation, tree)
        moving = {node for node, _ in tracks}
        joints = _connected(tree, skin or _with_descendants(tree, moving), document.root)
        above = list(tree.above(joints[0]))
        nodes = {number: _read_node(tree, number) for number in [*above, *joints]}
        joints, ends = _without_ends(tree, nodes, joints, moving)
        used = {key: track for key, track in tracks.items() if key[0] in nodes}
        if not used:
            raise animation.error(_MOVING, "none")
        clock = common_clock(list(used.values()), animation)
        _check_proportion(document, len(clock.times), len(joints))
        placed = _Placed(tree, nodes, _scales(nodes, used), used, clock)
        return _motion(placed, above, joints, ends, path.stem)

    def besides_motion(self, path: Path) -> tuple[str, ...]:
        """Name what a file holds that its motion does not: see `Reader`."""
        root = load(path).root
        named = [kind for kind in _BESIDES if root.entries(kind)]
        animations = len(root.entries("animations"))
        return (*named, *([f"{animations} animations"] if animations > 1 else []))


@dataclass(frozen=True)
class _Node:
    """A node at rest: its place on its parent, its rotation and its scale along three axes."""

    part: Part
    name: str
    place: Array
    turn: Array
    scale: Array


@dataclass(frozen=True)
class _Tree:
    """The nodes, the parent of each (-1 for none), and an order with parents first."""

    nodes: list[Part]
    parents: list[int]
    order: list[int]

    def above(self, node: int) -> Iterator[int]:
        """Return the nodes above one, from the top."""
        chain = []
        while (node := self.parents[node]) >= 0:
            chain.append(node)
        return reversed(chain)


def _read_tree(document: Document) -> _Tree:
    parts = document.root.entries("nodes")
    if not parts:
        raise document.root.error("nodes", "none")
    parents, children = [-1] * len(parts), []
    for number, part in enumerate(parts):
        children.append([x.whole(most=len(parts) - 1) for x in part.entries("children")])
        for child in children[-1]:
            if parents[child] >= 0:
                raise part.error(f"children without another parent, node {child} has one", "two")
            parents[child] = number
    order = [node for node, parent in enumerate(parents) if parent < 0]
    for node in order:  # it grows
        order.extend(children[node])
    if len(order) < len(parts):
        circle = min(set(range(len(parts))) - set(order))
        raise parts[circle].error("a tree of nodes", "a node below itself")
    return _Tree(parts, parents, order)


def _read_node(tree: _Tree, number: int) -> _Node:
    part = tree.nodes[number]
    name = part.get("name", "").text() or f"node{number}"
    if part.has("matrix"):
        return _Node(part, name, *_parts_of_matrix(part.get("matrix")))
    turn = _unit(part.get("rotation", [0, 0, 0, 1]))
    place = part.get("translation", [0, 0, 0]).numbers(3)
    return _Node(part, name, place, turn, part.get("scale", [1, 1, 1]).numbers(3))


def _unit(part: Part) -> Array:
    """Return a rotation of the file, (x, y, z, w), as (w, x, y, z) of length 1."""
    values = np.roll(part.numbers(4), 1)
    if not np.any(values):
        raise part.error("a quaternion of length 1")
    return rot.normalize(values / np.abs(values).max())


def _parts_of_matrix(part: Part) -> tuple[Array, Array, Array]:
    """Return place, rotation and scale of a matrix, which stands column by column."""
    matrix = part.numbers(16).reshape(4, 4).T
    if not np.allclose(matrix[3], (0.0, 0.0, 0.0, 1.0)):
        raise part.error("a matrix whose last row is 0 0 0 1", str(matrix[3].tolist()))
    left, _, right = np.linalg.svd(matrix[:3, :3])
    side = np.sign(np.linalg.det(left @ right))
    turn = rot.from_matrix(left @ np.diag((1.0, 1.0, side)) @ right)
    return matrix[:3, 3], turn, side * np.linalg.norm(matrix[:3, :3], axis=0)


def _joints_of_skin(document: Document, tree: _Tree) -> set[int]:
    """Return the joints of the skin with the most of them; none where there is no skin."""
    skins = document.root.entries("skins")
    most = len(tree.nodes) - 1
    sets = [{joint.whole(most=most) for joint in skin.entries("joints")} for skin in skins]
    for skin, joints in zip(skins, sets, strict=True):
        if not joints:
            raise skin.error("a skin with joints", "none")
    chosen = max(sets, key=len, default=set())
    others = [joints for joints in sets if not joints <= chosen]
    if others:
        _note(document.root, f"the largest of {len(sets)} skins is read, the others left out")
    return chosen


def _first_moving(document: Document, tree: _Tree, skin: set[int]) -> Part:
    """Return the first animation that moves the skeleton, or what is above it."""
    animations = document.root.entries("animations")
    if not animations:
        raise document.root.error("an animation", "none")
    below = _counted(tree, skin)
    for animation in animations:
        moved = {node for node, _, _ in _channels(document, animation)}
        if any(below[node] or not skin for node in moved):
            others = [_called(other) for other in animations if other is not animation]
            if others:
                _note(document.root, f"{_called(animation)} is read, not {_listed(others)}")
            return animation
    raise animations[0].error(_MOVING, "none")


def _called(animation: Part) -> str:
    return f"animation {animation.get('name', '').text() or animation.place!r}"


def _listed(names: list[str]) -> str:
    return ", ".join(names[:_NAMED]) + (", ..." if len(names) > _NAMED else "")


def _channels(document: Document, animation: Part) -> Iterator[tuple[int, str, Part]]:
    """Yield node, path and channel of those that move nodes."""
    most = len(document.root.value["nodes"]) - 1
    for channel in animation.entries("channels"):
        target = channel.get("target")
        kind = target.get("path").text()
        if target.has("node") and kind in ("translation", "rotation", "scale"):
            yield target.get("node").whole(most=most), kind, channel


def _read_tracks(document: Document, animation: Part, tree: _Tree) -> dict[tuple[int, str], Track]:
    samplers = animation.entries("samplers")
    tracks: dict[tuple[int, str], Track] = {}
    rows = 0
    for node, kind, channel in _channels(document, animation):
        if (node, kind) in tracks:
            raise channel.error(f"one channel for the {kind} of node {node}", "two")
        number = channel.get("sampler").whole(most=len(samplers) - 1)
        tracks[node, kind] = read_track(document, samplers[number], kind)
        rows += len(tracks[node, kind].times)
        _check_proportion(document, 1, rows)
    return tracks


def _counted(tree: _Tree, chosen: set[int]) -> list[int]:
    """Count for every node the chosen ones among it and those below it."""
    below = [int(node in chosen) for node in range(len(tree.nodes))]
    for node in reversed(tree.order):
        if tree.parents[node] >= 0:
            below[tree.parents[node]] += below[node]
    return below


def _with_descendants(tree: _Tree, nodes: set[int]) -> set[int]:
    found = set(nodes)
    for node in tree.order:
        if tree.parents[node] in found:
            found.add(node)
    return found


def _connected(tree: _Tree, chosen: set[int], root: Part) -> list[int]:
    """Return chosen nodes and those that join them, parents first, in the file's order if it can.

    Of several trees the one with the most of them is taken.
    """
    below = _counted(tree, chosen)
    tops = [node for node in tree.order if tree.parents[node] < 0 and below[node]]
    top = max(tops, key=lambda node: below[node])
    if len(tops) > 1:
        _note(root, f"of {len(tops)} trees of joints, that below {tree.nodes[top].place} is read")
    joints = [_lowest_above_all(tree, chosen, below, top)]
    inside = set(joints)
    for node in tree.order:
        if tree.parents[node] in inside and below[node]:
            inside.add(node)
            joints.append(node)
    return _in_order(tree, joints, root)


def _lowest_above_all(tree: _Tree, chosen: set[int], below: list[int], top: int) -> int:
    """Return the lowest node that has all chosen ones of a tree at or below it."""
    lowest = top
    for node in tree.order:
        if lowest in chosen:
            break
        if tree.parents[node] == lowest and below[node] == below[top]:
            lowest = node
    return lowest


def _in_order(tree: _Tree, joints: list[int], root: Part) -> list[int]:
    if len(joints) > MOST_JOINTS:
        raise root.error(f"at most {MOST_JOINTS} joints", str(len(joints)))
    by_number = sorted(joints)
    first = by_number[0] == joints[0]
    ordered = first and all(tree.parents[node] < node for node in by_number[1:])
    return by_number if ordered else joints


def _without_ends(
    tree: _Tree, nodes: dict[int, _Node], joints: list[int], moving: set[int]
) -> tuple[list[int], list[tuple[int, int]]]:
    """Part the joints from the ends of limbs: NAME_end below NAME, which never moves.

    Ends come with the joints that they hang on.
    """
    parents = {tree.parents[joint] for joint in joints}
    fixed = [joint for joint in joints[1:] if joint not in parents | moving]
    ends = [
        (tree.parents[joint], joint)
        for joint in fixed
        if nodes[joint].name == f"{nodes[tree.parents[joint]].name}_end"
    ]
    left_out = {end for _, end in ends}
    return [joint for joint in joints if joint not in left_out], ends


def _scales(nodes: dict[int, _Node], tracks: dict[tuple[int, str], Track]) -> dict[int, float]:
    """Return the one scale of every node; 1, with a note, where there is none."""
    scales, odd = {}, []
    for number, node in nodes.items():
        track = tracks.get((number, "scale"))
        shown = node.scale if track is None else track.shown
        largest = float(shown.max())
        even = float(np.ptp(shown)) <= _EVEN * largest and largest > 0.0
        scales[number] = float(shown.mean()) if even else 1.0
        if not even:
            odd.append(node)
    if odd:
        text = "scales that change, or are not one for all axes, are left out"
        _note(odd[0].part, f"{text}: of {_listed([node.name for node in odd])}")
    return scales


def _check_proportion(document: Document, frames: int, joints: int) -> None:
    """Refuse a motion out of proportion to its file."""
    if frames * joints > _PROPORTION * document.loaded + _FEW:
        raise document.root.error(
            "keys on most of the joints",
            f"{frames} frames of {joints} joints in {document.loaded} bytes",
        )
    require_memory(frames, joints)


@dataclass(frozen=True)
class _Placed:
    """Give every node's place and rotation on its parent: at rest, then in every frame."""

    tree: _Tree
    nodes: dict[int, _Node]
    scales: dict[int, float]
    tracks: dict[tuple[int, str], Track]
    clock: Clock

    def places(self, node: int) -> Array:
        return self._rows(node, "translation", self.nodes[node].place)

    def turns(self, node: int) -> Array:
        return self._rows(node, "rotation", self.nodes[node].turn)

    def _rows(self, node: int, kind: str, rest: Array) -> Array:
        track, count = self.tracks.get((node, kind)), len(self.clock.times)
        moved = np.tile(rest, (count, 1)) if track is None else track.at(self.clock)
        return np.vstack([rest, moved])


def _motion(
    placed: _Placed, above: list[int], joints: list[int], ends: list[tuple[int, int]], name: str
) -> Motion:
    tree, number = placed.tree, {joint: n for n, joint in enumerate(joints)}
    root, turn, factor = _root(placed, [*above, joints[0]])
    factors = {joints[0]: factor}
    rows = [root]
    for joint in joints[1:]:
        parent = tree.parents[joint]
        factors[joint] = _product(placed, joint, factors[parent])
        rows.append(factors[parent] * placed.places(joint))
    places = np.stack(rows, axis=1)
    turns = np.stack([turn, *(placed.turns(joint) for joint in joints[1:])], axis=1)
    parents = (-1, *(number[tree.parents[joint]] for joint in joints[1:]))
    tips = tuple((number[on], factors[on] * placed.nodes[end].place) for on, end in ends)
    names = _different([placed.nodes[joint].name for joint in joints])
    skeleton = Skeleton(names, parents, places[1], tips)
    offsets, moved = _offsets(places, skeleton.size)
    skeleton = Skeleton(names, parents, offsets, tips)
    translations = places[1:] if moved else None
    return Motion(skeleton, turns[1:], places[1:, 0], placed.clock.step, translations, name)


def _root(placed: _Placed, chain: list[int]) -> tuple[Array, Array, float]:
    """Return place and rotation in the world of the last of a chain, and the scale below it."""
    place, turn, factor = np.zeros(3), rot.identity(), 1.0
    for node in chain:
        place = place + rot.rotate(turn, factor * placed.places(node))
        turn = rot.multiply(turn, placed.turns(node))
        factor = _product(placed, node, factor)
    return place, turn, factor


def _product(placed: _Placed, node: int, above: float) -> float:
    # Scales are multiplied down the tree.
    product = above * placed.scales[node]
    if not 1.0 / LARGEST < product < LARGEST:
        raise placed.nodes[node].part.error("a scale that leaves lengths", f"{product:g}")
    return product


def _offsets(places: Array, size: float) -> tuple[Array, bool]:
    """Return the joints' offsets of places (1 + F, J, 3), and whether any moves away from its own.

    A joint that stands still has the place where it stands, another that at rest, if it has one.
    """
    still = ~leave(places[1:], places[1], size) | ~np.any(places[0], axis=1)
    offsets = np.where(still[:, None], places[1], places[0])
    offsets[0] = places[0, 0]
    return offsets, bool(leave(places[1:, 1:], offsets[1:], size).any())


def _different(names: list[str]) -> tuple[str, ...]:
    """Return names, each with a number behind it that an earlier one has already."""
    found: dict[str, None] = {}
    for name in names:
        number, unlike = 1, name
        while unlike in found:
            number += 1
            unlike = f"{name}_{number}"
        found[unlike] = None
    return tuple(found)


def _note(part: Part, text: str) -> None:
    warnings.warn(f"{part.path}: {text}", RoundelayWarning, stacklevel=2)
