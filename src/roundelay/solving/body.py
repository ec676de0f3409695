"""A body to be solved for: a tree of joints with markers on its bones, and what is known of them.

Lengths are in metres, or in the like of a person of 1.75 m; Y points up, Z forward, X to the left.
At rest a person stands with hanging arms, so that bones of limbs lie along Y.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton

__all__ = ["Body", "Poses", "below", "chained"]

Array = NDArray[np.float64]
Places = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Body:
    """Describe a tree of joints with markers.

    Attributes
    ----------
    names, parents : tuple
        As of a `Skeleton`.
    offsets : (J, 3) ndarray
        Joints relative to their parents, at rest.
    offset_spread : (J, 3) ndarray
        Standard deviation of the offsets as they are known beforehand.
    joints : (M,) ndarray of int
        The joint whose bone carries each marker.
    places : (M, 3) ndarray
        Markers relative to their joints, at rest.
    place_spread : (M, 3) ndarray
        Standard deviation of the places as they are known beforehand.
    bend : (J, 3) ndarray
        Standard deviation in radians of each joint's swing about X, twist about Y, swing about Z.
    one_way : (J,) ndarray
        The sign of the swing about X of a joint that bends one way; 0 where it bends both ways.
    pairs : tuple of (int, int)
        Joints of both sides.
    alike : float
        Standard deviation of the difference of their offsets.
    anchors : tuple of (int, int)
        Markers that are put where the joint at the other end of their bone is, and that joint.
    near : float
        Standard deviation of where they are from there.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Array
    offset_spread: Array
    joints: Places
    places: Array
    place_spread: Array
    bend: Array
    one_way: Array
    pairs: tuple[tuple[int, int], ...] = ()
    alike: float = 1.0
    anchors: tuple[tuple[int, int], ...] = ()
    near: float = 1.0

    @property
    def skeleton(self) -> Skeleton:
        """The tree alone."""
        return Skeleton(self.names, self.parents, self.offsets)

    @property
    def carried(self) -> NDArray[np.bool_]:
        """Whether a joint (row) moves a marker (column), (J, M)."""
        return below(self.parents)[:, self.joints]

    def ends(self) -> tuple[tuple[int, Array], ...]:
        """Return where bones without a joint below end: at the middle of their markers.

        A foot ends where its foremost marker is.
        """
        ends = []
        for joint in sorted(set(range(len(self.names))) - set(self.parents)):
            own = self.places[self.joints == joint]
            if len(own) and "Foot" in self.names[joint]:
                ends.append((joint, own[np.argmax(own[:, 2])]))
            elif len(own):
                ends.append((joint, own.mean(axis=0)))
        return tuple(ends)

    def shaped(self, shape: Array) -> Body:
        """Return the body with another shape (G,): offsets without the root's, then places."""
        count = 3 * (len(self.parents) - 1)
        offsets = self.offsets.copy()
        offsets[1:] = shape[:count].reshape(-1, 3)
        return replace(self, offsets=offsets, places=shape[count:].reshape(-1, 3))

    @property
    def shape(self) -> Array:
        """All lengths (G,): offsets without the root's, then places."""
        return np.concatenate([self.offsets[1:].ravel(), self.places.ravel()])

    def certainty(self) -> Array:
        """Return how sure the shape is beforehand: the inverse of its covariance, (G, G).

        Bones of both sides are nearly alike.
        """
        spread = np.concatenate([self.offset_spread[1:].ravel(), self.place_spread.ravel()])
        result = np.diag(spread**-2)
        for joint, other in self.pairs:
            for axis, mirror in enumerate((-1.0, 1.0, 1.0)):
                slope = np.zeros(len(result))
                slope[3 * (joint - 1) + axis], slope[3 * (other - 1) + axis] = 1.0, -mirror
                result += np.outer(slope, slope) / self.alike**2
        bones = 3 * (len(self.parents) - 1)
        for marker, joint in self.anchors:
            for axis in range(3):
                slope = np.zeros(len(result))
                slope[bones + 3 * marker + axis], slope[3 * (joint - 1) + axis] = 1.0, -1.0
                result += np.outer(slope, slope) / self.near**2
        return np.asarray(result)


def below(parents: tuple[int, ...]) -> NDArray[np.bool_]:
    """Tell whether a joint (column) is another (row) or hangs below it, (J, J)."""
    result = np.eye(len(parents), dtype=bool)
    for joint, parent in enumerate(parents[1:], 1):
        result[:, joint] |= result[:, parent]
    return result


@dataclass(frozen=True, eq=False)
class Poses:
    """Hold the poses of a body: places of its root (F, 3) and local rotations (F, J, 4)."""

    root: Array
    rotations: Array

    def __len__(self) -> int:
        return len(self.root)

    def __getitem__(self, frames: slice | Places) -> Poses:
        return Poses(self.root[frames], self.rotations[frames])

    def moved(self, step: Array) -> Poses:
        """Return poses after a step (F, 3 + 3 J): of the root, then turns in the joints' axes."""
        turns = step[:, 3:].reshape(len(self), -1, 3)
        rotations = rot.multiply(self.rotations, rot.from_rotation_vector(turns))
        return Poses(self.root + step[:, :3], rotations)


def chained(parents: tuple[int, ...], at: Array, turns: Array) -> Poses:
    """Return poses of a tree whose joints are at (F, J, 3) and whose bones are turned (F, J, 4)."""
    rotations, above = turns.copy(), list(parents[1:])
    rotations[:, 1:] = rot.multiply(rot.conjugate(turns[:, above]), turns[:, 1:])
    return Poses(at[:, 0], rotations)
