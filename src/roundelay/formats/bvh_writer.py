"""Write Biovision hierarchy files (BVH)."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roundelay.formats import text
from roundelay.formats.bvh_hierarchy import BvhLayout
from roundelay.formats.euler import DEGREE, Winding, compose, decompose
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion

__all__ = ["BvhWriter"]

Array = NDArray[np.float64]

_ROTATION = ("Zrotation", "Yrotation", "Xrotation")
_POSITION = ("Xposition", "Yposition", "Zposition")
# Radians, and parts of the skeleton's size, by which channels may miss what they stand for.
_CLOSE = 1e-9


class BvhWriter:
    """The writer of BVH files."""

    name = "bvh"
    suffixes = (".bvh",)

    def write(self, motion: Motion, path: Path) -> None:
        """Write a BVH file.

        The channels are those of the file the skeleton came from, and more where they cannot
        express the motion; otherwise "Zrotation Yrotation Xrotation" on every joint, after
        "Xposition Yposition Zposition" on the root and on joints that move on their parents.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        motion = _in_file_order(motion)
        layout = _fitted_layout(motion)
        table = _table(motion, layout)
        row = " ".join(["%s"] * layout.width) + "\n"
        head = [*_hierarchy(motion.skeleton, layout), "MOTION\n", f"Frames: {len(motion)}\n"]
        head.append(f"Frame Time: {motion.frame_time!r}\n")
        text.save(path, (piece for part in (head, text.rows(table, row)) for piece in part))


def _in_file_order(motion: Motion) -> Motion:
    """Return the motion with its joints in the order of a walk down the tree."""
    skeleton = motion.skeleton
    order = [joint for joint, _ in _walk(skeleton)]
    if order == sorted(order):
        return motion
    place = {joint: new for new, joint in enumerate(order)}
    moved = motion.translations
    walked = Skeleton(
        tuple(skeleton.names[joint] for joint in order),
        tuple(place.get(skeleton.parents[joint], -1) for joint in order),
        skeleton.offsets[order],
        tuple((place[joint], offset) for joint, offset in skeleton.end_sites),
    )
    return replace(
        motion,
        skeleton=walked,
        rotations=motion.rotations[:, order],
        translations=None if moved is None else moved[:, order],
    )


def _walk(skeleton: Skeleton) -> Iterator[tuple[int, int]]:
    """Yield joints and their depths, each before its children."""
    children: list[list[int]] = [[] for _ in skeleton.names]
    for joint, parent in enumerate(skeleton.parents[1:], 1):
        children[parent].append(joint)
    waiting = [(0, 0)]
    while waiting:
        joint, depth = waiting.pop()
        yield joint, depth
        waiting.extend((child, depth + 1) for child in reversed(children[joint]))


def _fitted_layout(motion: Motion) -> BvhLayout:
    layout = _own_layout(motion.skeleton)
    places = _places(motion)
    channels = tuple(
        _fitted(names, motion.rotations[:, joint], places[:, joint], motion.skeleton.offsets[joint])
        for joint, names in enumerate(layout.channels)
    )
    return replace(layout, channels=channels)


def _own_layout(skeleton: Skeleton) -> BvhLayout:
    layout = skeleton.layout
    ends = len(skeleton.end_sites)
    if (
        isinstance(layout, BvhLayout)
        and len(layout.channels) == len(layout.windings) == skeleton.n_joints
        and len(layout.end_sites) == ends
    ):
        return layout
    joints = skeleton.n_joints - 1
    channels = (_POSITION + _ROTATION, *[_ROTATION] * joints)
    windings: list[Winding] = ["continuous"] * (joints + 1)
    return BvhLayout(channels, ("End Site",) * ends, tuple(windings))


def _places(motion: Motion) -> Array:
    """Return the joints' positions (F, J, 3) on their parents, the root's path included."""
    moved = motion.translations
    shape = (*motion.rotations.shape[:2], 3)
    places = np.array(np.broadcast_to(motion.skeleton.offsets if moved is None else moved, shape))
    places[:, 0] = motion.root_path
    return places


def _fitted(names: tuple[str, ...], turns: Array, places: Array, offset: Array) -> tuple[str, ...]:
    """Return a joint's channels, completed where they cannot express its motion."""
    single = BvhLayout((names,))
    order, fixed = single.orders[0], [i for i in range(3) if "XYZ"[i] not in single.placed[0]]
    if not _can_turn(turns, order):
        names = tuple(name for name in names if name.lower().endswith("position")) + _ROTATION
    if np.any(places[:, fixed] != offset[fixed]):
        names = _POSITION + tuple(name for name in names if name.lower().endswith("rotation"))
    return names


def _can_turn(turns: Array, order: str) -> bool:
    if len(order) == 3:
        return True
    angles = decompose(turns[:, None], order, "principal")
    again = compose(angles[:, 0], [order], [range(len(order))], unit=DEGREE)
    return bool(np.all(rot.angle_between(again[:, 0], turns) < _CLOSE))


def _table(motion: Motion, layout: BvhLayout) -> Array:
    table = np.empty((len(motion), layout.width))
    places = _places(motion)
    columns = layout.columns("position")
    for joint, own in enumerate(columns):
        table[:, own] = places[:, joint, ["XYZ".index(axis) for axis in layout.placed[joint]]]
    columns = layout.columns("rotation")
    kinds = list(zip(layout.orders, layout.windings, strict=True))
    for order, written in sorted({kind for kind in kinds if kind[0]}):
        joints = [joint for joint, kind in enumerate(kinds) if kind == (order, written)]
        angles = decompose(motion.rotations[:, joints], order, written)
        table[:, [columns[joint] for joint in joints]] = angles
    return table


def _hierarchy(skeleton: Skeleton, layout: BvhLayout) -> Iterator[str]:
    yield "HIERARCHY\n"
    ends: list[list[tuple[str, Array]]] = [[] for _ in skeleton.names]
    for (joint, offset), heading in zip(skeleton.end_sites, layout.end_sites, strict=True):
        ends[joint].append((heading, offset))
    depth, plain = 0, _names(skeleton)
    for joint, level in _walk(skeleton):
        yield from _closing(depth, level)
        depth = level + 1
        tabs = "\t" * level
        yield f"{tabs}{'JOINT' if level else 'ROOT'} {plain[joint]}\n{tabs}{{\n"
        yield f"{tabs}\tOFFSET {_vector(skeleton.offsets[joint])}\n"
        channels = layout.channels[joint]
        yield f"{tabs}\t{' '.join(['CHANNELS', str(len(channels)), *channels])}\n"
        for heading, offset in ends[joint]:
            yield f"{tabs}\t{heading}\n{tabs}\t{{\n{tabs}\t\tOFFSET {_vector(offset)}\n{tabs}\t}}\n"
    yield from _closing(depth, 0)


def _names(skeleton: Skeleton) -> list[str]:
    """Return names a BVH can hold, all different."""
    names: dict[str, None] = {}
    for name in skeleton.names:
        word = _plain(name)
        while word in names:
            word += "_"
        names[word] = None
    return list(names)


def _plain(name: str) -> str:
    """Return a name without what would end it, start a comment or make the file a binary one."""
    if re.search(r"[{}#\x00-\x08\n-\x1f]|//", name):
        name = re.sub(r"[{}\s\x00-\x1f]+|#|//", "_", name)
    return name.strip() or "_"


def _closing(depth: int, level: int) -> Iterator[str]:
    for tabs in range(depth - 1, level - 1, -1):
        yield "\t" * tabs + "}\n"


def _vector(values: Array) -> str:
    return " ".join(f"{value:.10g}" for value in values)
