"""Read glTF 2.0: the nodes of a skin as the skeleton, an animation at even times as the motion.

Without a skin the skeleton is made of the nodes that the animation moves and what hangs on them.
VRM files are glTF with a humanoid skeleton, VRMA files hold an animation of one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roundelay.formats.clock import Clock, common_clock
from roundelay.formats.contents import Contents
from roundelay.formats.gltf_document import Document, Part, load
from roundelay.formats.gltf_figure import read_figure
from roundelay.formats.gltf_keys import Track, read_track
from roundelay.formats.nodes import Tree, called, different, listed, note
from roundelay.formats.options import ReadOptions
from roundelay.formats.posed import Chosen, check_proportion, even_scales, matrix_of, posed
from roundelay.geometry import rotations as rot
from roundelay.motion.motion import Motion

__all__ = ["GltfReader"]

Array = NDArray[np.float64]

# What a writer of motions leaves out.
_BESIDES = ("meshes", "cameras", "materials", "textures", "images")
_MOVING = "an animation that moves the skeleton's nodes"


class GltfReader:
    """The reader of glTF files."""

    name = "gltf"
    suffixes = (".glb", ".gltf", ".vrm", ".vrma")
    choices = frozenset({"animation", "character"})

    def read(self, path: Path, wanted: ReadOptions | None = None) -> Motion:
        """Read a ``.glb``, ``.gltf``, ``.vrm`` or ``.vrma`` file.

        Parameters
        ----------
        path : Path
        wanted : ReadOptions, optional
            Which animation and which skeleton.

        Returns
        -------
        Motion
            The first animation that moves the skeleton, or the one that is wanted; Y is up,
            lengths are those of the file. A loop that ends with its first frame is given as it is.

        Raises
        ------
        FormatError
            If the file is not sound, or holds no animation of nodes, or not what is wanted.
        OSError
            If it cannot be read.
        """
        wanted = wanted or ReadOptions()
        document = load(path)
        tree = _read_tree(document)
        skin = _joints_of_skin(document, tree, wanted.character)
        animation = _animation(document, tree, skin, wanted.animation)
        tracks = _read_tracks(document, animation, tree)
        moving = {node for node, _ in tracks}
        joints = tree.connected(skin or tree.with_descendants(moving))
        inside = {*tree.above(joints[0]), *joints}
        used = {key: track for key, track in tracks.items() if key[0] in inside}
        if not used:
            raise animation.error(_MOVING, "none")
        return _posed(document, tree, joints, used, _clock(tree, list(used.values())))

    def read_still(self, path: Path, wanted: ReadOptions | None = None) -> Motion:
        """Read the skeleton at rest, with its meshes, as a motion of one frame.

        Parameters
        ----------
        path : Path
        wanted : ReadOptions, optional
            Which skeleton.

        Raises
        ------
        FormatError
            If the file is not sound, or holds no skeleton.
        OSError
            If it cannot be read.
        """
        document = load(path)
        tree = _read_tree(document)
        skin = _joints_of_skin(document, tree, (wanted or ReadOptions()).character)
        joints = tree.connected(skin or set(tree.order))
        return _posed(document, tree, joints, {}, Clock(np.zeros(1), 1.0))

    def contents(self, path: Path) -> Contents:
        """List the animations and skeletons of a file."""
        document = load(path)
        tree = _read_tree(document)
        skins = _skins(document, tree)
        roots = tree.roots(set().union(*skins)) if skins else {}
        generator = document.root.get("asset").get("generator", "").text()
        conventions = {"up": "Y", "unit": "1 m"} | ({"program": generator} if generator else {})
        animations = document.root.entries("animations")
        return Contents(_names(animations), tuple(roots), conventions)

    def besides_motion(self, path: Path) -> tuple[str, ...]:
        """Name what a file holds that its motion does not: see `Reader`."""
        root = load(path).root
        named = [kind for kind in _BESIDES if root.entries(kind)]
        animations = len(root.entries("animations"))
        return (*named, *([f"{animations} animations"] if animations > 1 else []))


def _posed(
    document: Document,
    tree: Tree,
    joints: list[int],
    tracks: dict[tuple[int, str], Track],
    clock: Clock,
) -> Motion:
    """Return the motion of some joints, with what moves them and the nodes above."""
    parts = document.root.entries("nodes")
    nodes = {number: _read_node(parts[number]) for number in [*tree.above(joints[0]), *joints]}
    joints, ends = tree.without_ends(joints, {node for node, _ in tracks})
    check_proportion(tree, len(clock.times), len(joints), document.loaded)
    placed = _Placed(parts, nodes, _scales(tree, nodes, tracks), tracks, clock)
    chosen, dresser = Chosen(joints, ends), partial(read_figure, document)
    return posed(tree, placed, chosen, clock.step, document.root.path.stem, dresser)


@dataclass(frozen=True)
class _Node:
    """A node at rest: its place on its parent, its rotation and its scale along three axes."""

    place: Array
    turn: Array
    scale: Array


def _read_tree(document: Document) -> Tree:
    parts = document.root.entries("nodes")
    if not parts:
        raise document.root.error("nodes", "none")
    parents = [-1] * len(parts)
    for number, part in enumerate(parts):
        for child in (x.whole(most=len(parts) - 1) for x in part.entries("children")):
            if parents[child] >= 0:
                raise part.error(f"children without another parent, node {child} has one", "two")
            parents[child] = number
    names = [part.get("name", "").text() or f"node{n}" for n, part in enumerate(parts)]
    return Tree.of(document.root.path, names, parents)


def _read_node(part: Part) -> _Node:
    if part.has("matrix"):
        return _Node(*_parts_of_matrix(part.get("matrix")))
    turn = _unit(part.get("rotation", [0, 0, 0, 1]))
    place = part.get("translation", [0, 0, 0]).numbers(3)
    return _Node(place, turn, part.get("scale", [1, 1, 1]).numbers(3))


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


def _skins(document: Document, tree: Tree) -> list[set[int]]:
    """Return the joints of each skin."""
    skins, most = document.root.entries("skins"), len(tree.parents) - 1
    sets = [{joint.whole(most=most) for joint in skin.entries("joints")} for skin in skins]
    for skin, joints in zip(skins, sets, strict=True):
        if not joints:
            raise skin.error("a skin with joints", "none")
    return sets


def _joints_of_skin(document: Document, tree: Tree, character: str | None) -> set[int]:
    """Return the joints of the largest skin, or of the character; none where there is no skin."""
    sets = _skins(document, tree)
    if character is not None:
        every = set().union(*sets)
        roots = tree.roots(every)
        number = called("a skeleton (--character)", list(roots), character, tree.path)
        below = tree.with_descendants({list(roots.values())[number]})
        return every & below
    chosen = max(sets, key=len, default=set())
    others = [joints for joints in sets if not joints <= chosen]
    joined = _joined(tree, chosen, others) if others else chosen
    if joined is not None:
        return joined
    told = f"the largest of {len(sets)} skins is read, the others left out"
    note(tree.path, f"{told} (--character names another)")
    return chosen


def _joined(tree: Tree, chosen: set[int], others: list[set[int]]) -> set[int] | None:
    """Return the joints of all skins if they are those of one body: of one tree of joints."""
    every = chosen.union(*others)
    return every if len(tree.roots(every)) <= len(tree.roots(chosen)) else None


def _names(animations: list[Part]) -> tuple[str, ...]:
    return different([_called(animation) for animation in animations])


def _called(animation: Part) -> str:
    return animation.get("name", "").text() or animation.place


def _animation(document: Document, tree: Tree, skin: set[int], wanted: str | None) -> Part:
    """Return the animation that is wanted, or the first that moves the skeleton."""
    animations = document.root.entries("animations")
    if not animations:
        raise document.root.error("an animation", "none")
    if wanted is not None:
        names = _names(animations)
        return animations[called("an animation (--animation)", names, wanted, tree.path)]
    below = tree.counted(skin)
    for animation in animations:
        moved = {node for node, _, _ in _channels(document, animation)}
        if any(below[node] or not skin for node in moved):
            others = [repr(_called(other)) for other in animations if other is not animation]
            if others:
                told = f"animation {_called(animation)!r} is read, not {listed(others)}"
                note(tree.path, f"{told} (--animation names another)")
            return animation
    raise animations[0].error(_MOVING, "none")


def _channels(document: Document, animation: Part) -> Iterator[tuple[int, str, Part]]:
    """Yield node, path and channel of those that move nodes."""
    most = len(document.root.value["nodes"]) - 1
    for channel in animation.entries("channels"):
        target = channel.get("target")
        kind = target.get("path").text()
        if target.has("node") and kind in ("translation", "rotation", "scale"):
            yield target.get("node").whole(most=most), kind, channel


def _read_tracks(document: Document, animation: Part, tree: Tree) -> dict[tuple[int, str], Track]:
    samplers = animation.entries("samplers")
    tracks: dict[tuple[int, str], Track] = {}
    rows = 0
    for node, kind, channel in _channels(document, animation):
        if (node, kind) in tracks:
            raise channel.error(f"one channel for the {kind} of node {node}", "two")
        number = channel.get("sampler").whole(most=len(samplers) - 1)
        tracks[node, kind] = read_track(document, samplers[number], kind)
        rows += len(tracks[node, kind].times)
        check_proportion(tree, 1, rows, document.loaded)
    return tracks


def _clock(tree: Tree, tracks: list[Track]) -> Clock:
    straight = all(track.mode == "LINEAR" for track in tracks)
    return common_clock([track.times for track in tracks], tree.path, straight=straight)


def _scales(
    tree: Tree, nodes: dict[int, _Node], tracks: dict[tuple[int, str], Track]
) -> dict[int, float]:
    shown = {}
    for number, node in nodes.items():
        track = tracks.get((number, "scale"))
        shown[number] = node.scale if track is None else track.shown
    return even_scales(tree, shown)


@dataclass(frozen=True)
class _Placed:
    """Give every node's place and rotation on its parent: at rest, then in every frame."""

    parts: list[Part]
    nodes: dict[int, _Node]
    scales: dict[int, float]
    tracks: dict[tuple[int, str], Track]
    clock: Clock

    def places(self, node: int) -> Array:
        return self._rows(node, "translation", self.nodes[node].place)

    def turns(self, node: int) -> Array:
        return self._rows(node, "rotation", self.nodes[node].turn)

    def scale(self, node: int) -> float:
        return self.scales[node]

    def local(self, node: int) -> Array:
        known = self.nodes.get(node) or _read_node(self.parts[node])
        return matrix_of(known.place, known.turn, known.scale)

    def _rows(self, node: int, kind: str, rest: Array) -> Array:
        track, count = self.tracks.get((node, kind)), len(self.clock.times)
        moved = np.tile(rest, (count, 1)) if track is None else track.at(self.clock)
        return np.vstack([rest, moved])
