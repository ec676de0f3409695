"""Limbs that may pass through each other: capsules along bones ([A] section 7).

Each bone is a capsule, a segment with a radius. Two bones meet where their segments come nearer
than their radii together. Bones near each other in the tree touch always and are left out, and
so are those that meet at rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import SMALLEST, TINY
from roundelay.base.spans import Spans
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.geometry.skeleton import Skeleton
from roundelay.geometry.thresholds import COLLISION

__all__ = ["Capsules", "Collision", "Near", "collisions", "nearest_points"]

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Segments = tuple[Array, Array]

# Frames looked at in one go.
_BLOCK = 256


@dataclass(frozen=True)
class Collision:
    """Two bones that meet during some frames.

    Attributes
    ----------
    bones : (str, str)
        Names of the joints at whose end the bones lie (their lower ends).
    start, stop : int
        Half-open range of frames.
    depth : float
        How far the capsules are into each other at most, in the skeleton's length unit.
    frame : int
        The frame where they are.
    """

    bones: tuple[str, str]
    start: int
    stop: int
    depth: float
    frame: int


@dataclass(frozen=True, eq=False)
class Near:
    """Where pairs of bones come near each other, an entry a pair and frame.

    Attributes
    ----------
    pair, frame : (n,) ndarray of int
        Sorted by pair, then by frame.
    first, second : (n, 3) ndarray
        The nearest points of both bones.
    depth : (n,) ndarray
        How far the capsules are into each other; negative where they are apart.
    """

    pair: Indices
    frame: Indices
    first: Array
    second: Array
    depth: Array


@dataclass(frozen=True, eq=False)
class Capsules:
    """The pairs of a skeleton's bones that can meet.

    Attributes
    ----------
    upper, lower : (P, 2) ndarray of int
        The joints between which the bones of a pair lie.
    reach : (P,) ndarray
        The radii of both bones together.
    """

    upper: Indices
    lower: Indices
    reach: Array

    @classmethod
    def of(cls, skeleton: Skeleton, thickness: float = 1.0) -> Capsules:
        """Choose the pairs; arguments as for `collisions`."""
        if not thickness > 0.0:
            raise ValueError(f"expected a positive thickness, found {thickness:g}")
        bones = _bones(skeleton)
        radii = thickness * _radii(skeleton, bones)
        chosen = np.array(_pairs(skeleton, bones), np.intp).reshape(-1, 2)
        lower = np.array(bones, np.intp)[chosen]
        upper = np.array(skeleton.parents, np.intp)[lower]
        pairs = cls(upper, lower, radii[chosen].sum(axis=1))
        touching = pairs.near(forward_kinematics(skeleton, _still(skeleton))[0]).pair
        keep = np.setdiff1d(np.arange(len(lower)), touching)
        return cls(upper[keep], lower[keep], pairs.reach[keep])

    def near(self, places: Array, margin: float = 0.0) -> Near:
        """Find where bones come nearer than a margin to touching.

        Parameters
        ----------
        places : (F, J, 3) ndarray
            Positions of the joints.
        margin : float
        """
        # By blocks: all pairs of a long capture at once would not fit in memory.
        blocks = [
            self._near(places[start : start + _BLOCK], margin, start)
            for start in range(0, len(places), _BLOCK)
        ]
        pair, frame, first, second, depth = map(np.concatenate, zip(*blocks, strict=True))
        order = np.lexsort((frame, pair))
        return Near(pair[order], frame[order], first[order], second[order], depth[order])

    def _near(
        self, places: Array, margin: float, start: int
    ) -> tuple[Indices, Indices, Array, Array, Array]:
        """Return the fields of `Near` for some frames, counted from `start`."""
        joints = np.moveaxis(places, 1, 0)
        (a, c), (b, d) = joints[self.upper.T], joints[self.lower.T]
        # Spheres about the bones first: most pairs are far apart.
        between = np.linalg.norm(a + b - c - d, axis=-1)
        half = np.linalg.norm(b - a, axis=-1) + np.linalg.norm(d - c, axis=-1)
        pair, frame = np.nonzero(between < half + 2.0 * (self.reach[:, None] + margin))
        at = (pair, frame)
        first, second = nearest_points((a[at], b[at]), (c[at], d[at]))
        depth = self.reach[pair] - np.linalg.norm(first - second, axis=-1)
        close = depth > -margin
        return pair[close], start + frame[close], first[close], second[close], depth[close]


def collisions(
    skeleton: Skeleton,
    rotations: Array,
    *,
    translations: Array | None = None,
    thickness: float = 1.0,
) -> list[Collision]:
    """List the pairs of bones that meet, with the frames in which they do.

    Parameters
    ----------
    skeleton : Skeleton
    rotations : (F, J, 4) ndarray
        Local rotations.
    translations : (F, J, 3) ndarray, optional
        See `roundelay.geometry.kinematics.forward_kinematics`.
    thickness : float
        Factor of the radii, which are an eighth of a bone's length and at most 2 % of the
        body size.

    Returns
    -------
    list of Collision
        In order of time; empty where nothing can meet.

    Raises
    ------
    ValueError
        If the thickness is not positive.
    """
    capsules = Capsules.of(skeleton, thickness)
    places, _ = forward_kinematics(skeleton, rotations, translations=translations)
    near = capsules.near(places)
    found = []
    for pair in np.unique(near.pair):
        depth = np.zeros(len(places))
        depth[near.frame[near.pair == pair]] = near.depth[near.pair == pair]
        first, second = capsules.lower[pair]
        found += _meetings((skeleton.names[first], skeleton.names[second]), depth)
    return sorted(found, key=lambda met: met.start)


def _still(skeleton: Skeleton) -> Array:
    """Return local rotations (1, J, 4) at rest."""
    if skeleton.rest is not None:
        return skeleton.rest[None]
    return np.tile([1.0, 0.0, 0.0, 0.0], (1, skeleton.n_joints, 1))


def _bones(skeleton: Skeleton) -> list[int]:
    """Return the joints at the lower ends of bones that are long enough.

    What lies between the root and the body's first branching is no bone: some files put the
    root on the ground. Lines between free points are none either.
    """
    if skeleton.free:
        return []
    lengths = np.linalg.norm(skeleton.offsets, axis=1)
    least = COLLISION.shortest * skeleton.size
    first = next((j for j in range(skeleton.n_joints) if skeleton.parents.count(j) > 1), 0)
    bones = [j for j in range(first + 1, skeleton.n_joints) if lengths[j] >= least]
    grounded = _lies_below(skeleton)
    return [j for j in bones if not (grounded and skeleton.parents[j] == 0)]


def _lies_below(skeleton: Skeleton) -> bool:
    """Tell a root that lies below all of the body at rest: on the ground, with several children."""
    if skeleton.rest is None:
        return False
    places = forward_kinematics(skeleton, _still(skeleton))[0][0]
    middle = places.mean(axis=0)
    up = (middle - places[0]) / max(float(np.linalg.norm(middle - places[0])), TINY)
    lowest = float(((places - places[0]) @ up).min())
    return lowest > -COLLISION.thickest * skeleton.size


def _radii(skeleton: Skeleton, bones: list[int]) -> Array:
    lengths = np.linalg.norm(skeleton.offsets[bones], axis=1)
    return np.minimum(COLLISION.slender * lengths, COLLISION.thickest * skeleton.size)


def _pairs(skeleton: Skeleton, bones: list[int]) -> list[tuple[int, int]]:
    """List the pairs of bones, as numbers in the list, that are no neighbours in the tree."""
    above = [_ancestors(skeleton, bone) for bone in bones]
    return [
        (a, b)
        for a in range(len(bones))
        for b in range(a + 1, len(bones))
        if _joints_between(above[a], above[b]) >= COLLISION.neighbours
    ]


def _ancestors(skeleton: Skeleton, joint: int) -> list[int]:
    """Return a joint and those above it, the root last."""
    chain = [joint]
    while skeleton.parents[chain[-1]] >= 0:
        chain.append(skeleton.parents[chain[-1]])
    return chain


def _joints_between(first: list[int], second: list[int]) -> int:
    """Count the bones on the way from one bone to another, both left out."""
    shared = len(set(first) & set(second))
    apart = (len(first) - shared) + (len(second) - shared)
    inline = first[0] in second or second[0] in first
    return apart - (1 if inline else 2)


def nearest_points(first: Segments, second: Segments) -> tuple[Array, Array]:
    """Return the points (n, 3) at which segments, each given by its two ends, come nearest.

    The nearest points of both lines, clamped to one segment and then to the other
    (Ericson 2005, "Real-time collision detection", 5.1.9).
    """
    (p, p_end), (q, q_end) = first, second
    u, v, w = p_end - p, q_end - q, p - q
    a, e = np.sum(u * u, axis=-1), np.sum(v * v, axis=-1)
    b, c, f = np.sum(u * v, axis=-1), np.sum(u * w, axis=-1), np.sum(v * w, axis=-1)
    apart = a * e - b * b
    parallel = apart <= TINY * a * e
    s = np.where(parallel, 0.0, np.clip((b * f - c * e) / np.where(parallel, 1.0, apart), 0, 1))
    t = np.clip((b * s + f) / np.maximum(e, SMALLEST), 0.0, 1.0)
    s = np.clip((b * t - c) / np.maximum(a, SMALLEST), 0.0, 1.0)
    return p + s[..., None] * u, q + t[..., None] * v


def _meetings(names: tuple[str, str], depth: Array) -> list[Collision]:
    return [
        Collision(names, a, b, float(depth[a:b].max()), a + int(depth[a:b].argmax()))
        for a, b in Spans.of_mask(depth > 0.0)
    ]
