"""The limbs of a body as signals: each may repeat by itself.

Only the motion in the world counts: positions of the joints against the first joint at which the
body branches, turned with it, in units of the body's size. Where in the world the body is, still
roots below or beside the hips, the unit and the order of joints do not matter.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics, heading
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion
from roundelay.motion.poses import principal_components
from roundelay.timeline.thresholds import LIMBS, SEARCH

__all__ = ["Body", "Limb", "body_of"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Limb:
    """A part of the body that may repeat by itself.

    Attributes
    ----------
    name : str
        For people: "left leg", "arm 1", "trunk".
    kind : {"leg", "arm", "trunk"}
    joints : tuple of int
        Of the skeleton.
    columns : (int, int)
        Its columns of `Body.signals`, half-open.
    """

    name: str
    kind: str
    joints: tuple[int, ...]
    columns: tuple[int, int]


@dataclass(frozen=True, eq=False)
class Body:
    """The limbs of a take at the clock of the search.

    Attributes
    ----------
    limbs : tuple of Limb
    signals : (n, d) ndarray
        Principal axes of every limb side by side, in body sizes, root mean square over its
        joints; limbs count alike, however many joints they have.
    seen : (n, J, 3) ndarray of float32
        Every joint's position against the hips as one sees it: turned by their heading alone,
        in body sizes.
    rate : float
        Samples a second.
    first, step : int
        The frame of the first sample, and how many frames a sample takes.
    n_frames : int
        Frames of the take.
    """

    limbs: tuple[Limb, ...]
    signals: Array = field(repr=False)
    seen: NDArray[np.float32] = field(repr=False)
    rate: float
    first: int
    step: int
    n_frames: int

    def __len__(self) -> int:
        return len(self.signals)

    def columns(self, members: tuple[int, ...]) -> NDArray[np.intp]:
        """Return the columns of some limbs, by their places in `limbs`."""
        return np.concatenate([np.arange(*self.limbs[place].columns) for place in members])

    def groups(self) -> dict[str, tuple[int, ...]]:
        """Return the groups of limbs that are searched: legs, arms, all, each by itself."""
        kinds = {
            kind: tuple(i for i, limb in enumerate(self.limbs) if limb.kind == kind)
            for kind in ("leg", "arm")
        }
        found = {
            "legs": kinds["leg"],
            "arms": kinds["arm"],
            "body": tuple(range(len(self.limbs))),
        } | {limb.name: (place,) for place, limb in enumerate(self.limbs)}
        groups: dict[str, tuple[int, ...]] = {}
        for name, members in found.items():
            if members and members not in groups.values():
                groups[name] = members
        return groups

    def joints(self, claimed: NDArray[np.bool_]) -> list[int]:
        """Return the joints of some limbs (L,)."""
        chosen = (limb for limb, own in zip(self.limbs, claimed, strict=True) if own)
        return sorted({joint for limb in chosen for joint in limb.joints})

    def frames(self, sample: float) -> int:
        """Return the frame of a sample."""
        return min(self.n_frames, max(0, self.first + round(sample * self.step)))


def body_of(motion: Motion) -> Body:
    """Take a motion's body apart into limbs.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    Body
    """
    skeleton, step = motion.skeleton, max(1, round(motion.fps / LIMBS.rate))
    moved = motion.translations
    places, turns = forward_kinematics(
        skeleton,
        motion.rotations[::step],
        motion.root_path[::step],
        translations=None if moved is None else moved[::step],
    )
    lengths = _bone_lengths(places, skeleton)
    tree = _Tree(skeleton, lengths)
    apart = (places - places[:, tree.hub, None]) / tree.size
    hips = turns[:, tree.hub]
    inside = rot.rotate(rot.conjugate(hips)[:, None], apart)
    first, last = _without_neutral_ends(inside)
    inside = inside[first:last]
    ahead = rot.from_rotation_vector(-_turned(hips, motion.up)[:, None] * motion.up_vector)
    seen = rot.rotate(ahead[:, None], apart)[first:last].astype(np.float32)
    height = places[first:last, :, motion.up]
    low = np.median(height - height.min(axis=1, keepdims=True), axis=0) / tree.size
    limbs, signals, at = [], [], 0
    for name, kind, joints in _named(tree, low, skeleton):
        axes = _axes(inside[:, joints])
        if axes.shape[1]:
            limbs.append(Limb(name, kind, tuple(joints), (at, at + axes.shape[1])))
            signals.append(axes)
            at += axes.shape[1]
    stacked = np.hstack(signals) if signals else np.zeros((len(inside), 0))
    return Body(tuple(limbs), stacked, seen, motion.fps / step, first * step, step, len(motion))


def _turned(orientations: Array, up: int) -> Array:
    """Return how far (n,) the hips have turned about the vertical, in radians.

    The sum of the turns from sample to sample: no pose of the hips is singular.
    """
    steps = rot.multiply(orientations[1:], rot.conjugate(orientations[:-1]))
    return np.concatenate([[0.0], np.cumsum(heading(steps, up))])


def _bone_lengths(places: Array, skeleton: Skeleton) -> Array:
    """Return the length (J,) of each joint's bone to its parent, as it is in the world."""
    shown = places[:: max(1, len(places) // 64)]
    lengths = np.zeros(skeleton.n_joints)
    above = np.array(skeleton.parents[1:], np.intp)
    apart = np.linalg.norm(shown[:, 1:] - shown[:, above], axis=2)
    lengths[1:] = np.median(apart, axis=0)
    return lengths


class _Tree:
    """A skeleton as branches with lengths."""

    def __init__(self, skeleton: Skeleton, lengths: Array) -> None:
        self.lengths = lengths
        self.children: list[list[int]] = [[] for _ in lengths]
        for joint, parent in enumerate(skeleton.parents[1:], 1):
            self.children[parent].append(joint)
        self.reach = np.zeros(len(lengths))
        for joint, offset in skeleton.end_sites:
            self.reach[joint] = max(self.reach[joint], float(np.linalg.norm(offset)))
        for joint in range(len(lengths) - 1, 0, -1):
            parent = skeleton.parents[joint]
            self.reach[parent] = max(self.reach[parent], self.below(joint))
        self.hub = self._hub()
        two = sorted((self.below(child) for child in self.children[self.hub]), reverse=True)[:2]
        self.size = sum(two) or 1.0

    def below(self, joint: int) -> float:
        """Return the length of the longest way from a joint's parent down through it."""
        return float(self.reach[joint] + self.lengths[joint])

    def _hub(self) -> int:
        """Return the first joint with several children: the hips, whatever lies above them."""
        hub = 0
        while len(self.children[hub]) == 1:
            hub = self.children[hub][0]
        return hub if self.children[hub] else 0

    def chains(self) -> tuple[list[list[int]], list[int]]:
        """Return the limbs, each from the last branching to its end, and what lies between."""
        limbs, between = [], []
        waiting = list(self.children[self.hub])
        while waiting:
            chain = [waiting.pop()]
            while True:
                ahead = self.children[chain[-1]]
                long = [j for j in ahead if self.below(j) > LIMBS.branch * self.size]
                if len(long) > 1:
                    between += chain
                    waiting += ahead
                    break
                if not ahead:
                    limbs.append(chain)
                    break
                chain.append(max(ahead, key=self.below))
        return limbs, between


def _named(tree: _Tree, low: Array, skeleton: Skeleton) -> list[tuple[str, str, list[int]]]:
    """Return name, kind and joints of every limb; what is no arm or leg belongs to the trunk."""
    chains, trunk = tree.chains()
    found: list[tuple[str, str, list[int]]] = []
    for chain in sorted(chains):
        if tree.lengths[chain].sum() <= LIMBS.long * tree.size:
            trunk += chain
            continue
        kind = "leg" if low[chain[-2:]].min() < LIMBS.low else "arm"
        names = " ".join(skeleton.names[joint] for joint in chain).lower()
        sides = [side for side in ("left", "right") if side in names]
        found.append((f"{sides[0]} {kind}" if len(sides) == 1 else kind, kind, chain))
    counts = {name: sum(name == other for other, _, _ in found) for name, _, _ in found}
    numbered, seen = [], dict.fromkeys(counts, 0)
    for name, kind, chain in found:
        seen[name] += 1
        numbered.append((f"{name} {seen[name]}" if counts[name] > 1 else name, kind, chain))
    return [*numbered, *([("trunk", "trunk", sorted(trunk))] if trunk else [])]


def _axes(positions: Array) -> Array:
    """Return the principal axes (n, k) of some joints' positions (n, j, 3), as one limb's."""
    values = positions.reshape(len(positions), -1) / np.sqrt(positions.shape[1])
    if np.ptp(values, axis=0).max() < SEARCH.still:
        return np.zeros((len(values), 0))
    return principal_components(values, LIMBS.held)[:, : LIMBS.axes]


def _without_neutral_ends(inside: Array) -> tuple[int, int]:
    """Return the samples without a pose put before or behind the movement, such as a T-pose."""
    steps = np.linalg.norm(np.diff(inside.reshape(len(inside), -1), axis=0), axis=1)
    if len(steps) < 4:
        return 0, len(inside)
    usual = float(steps[1:-1].max())
    first = int(steps[0] > LIMBS.jump * usual > 0.0)
    return first, len(inside) - int(steps[-1] > LIMBS.jump * usual > 0.0)
