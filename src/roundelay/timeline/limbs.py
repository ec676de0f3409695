"""The limbs of a body as signals: each may repeat by itself.

Only the motion in the world counts: positions of the joints against the first joint at which the
body branches, turned with it, in units of the body's size. Where in the world the body is, still
roots below or beside the hips, the unit and the order of joints do not matter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from roundelay.base.spans import Span, Spans
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics, heading
from roundelay.geometry.skeleton import Skeleton
from roundelay.geometry.symmetry import is_left, other_side
from roundelay.motion.motion import Motion
from roundelay.motion.poses import Poses, bridged, point_indices, principal_components
from roundelay.timeline.thresholds import LIMBS, PREDICTION, SEARCH

__all__ = ["Body", "Limb", "body_of", "within_ends"]

Array = NDArray[np.float64]

# Numbers that are worked on at once: they stay in the processor's cache.
_BLOCK = 200_000


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
    span : (start, stop)
        The frames that are looked at, without a neutral pose at either end.
    unseen : Spans
        Of the frames asked for, the stretches in which the body is not seen.
    step : int
        How many frames a sample takes.
    names : tuple of str
        Of the joints.
    n_frames : int
        Of the take.
    """

    limbs: tuple[Limb, ...]
    signals: Array = field(repr=False)
    seen: NDArray[np.float32] = field(repr=False)
    rate: float
    span: Span
    unseen: Spans
    step: int
    names: tuple[str, ...] = field(repr=False)
    n_frames: int
    _axes: dict[str, Array] = field(default_factory=dict, init=False, repr=False)

    def __len__(self) -> int:
        return len(self.signals)

    def columns(self, members: tuple[int, ...]) -> NDArray[np.intp]:
        """Return the columns of some limbs, by their places in `limbs`."""
        return np.concatenate([np.arange(*self.limbs[place].columns) for place in members])

    def groups(self) -> dict[str, tuple[int, ...]]:
        """Return the groups of limbs that are searched: all, legs, arms, each by itself."""
        kinds = {
            kind: tuple(i for i, limb in enumerate(self.limbs) if limb.kind == kind)
            for kind in ("leg", "arm")
        }
        found = {
            "body": tuple(range(len(self.limbs))),
            "legs": kinds["leg"],
            "arms": kinds["arm"],
        } | {limb.name: (place,) for place, limb in enumerate(self.limbs)}
        groups: dict[str, tuple[int, ...]] = {}
        for name, members in found.items():
            if members and members not in groups.values():
                groups[name] = members
        return groups

    def columns_of(self, claimed: NDArray[np.bool_]) -> NDArray[np.intp]:
        """Return the columns of some limbs (L,)."""
        return self.columns(tuple(np.flatnonzero(claimed).tolist()))

    def axes_of(self, group: str) -> Array:
        """Return the principal axes (n, k) of a group of limbs."""
        if group not in self._axes:
            own = self.signals[:, self.columns(self.groups()[group])]
            self._axes[group] = principal_components(own, PREDICTION.held)[:, : PREDICTION.axes]
        return self._axes[group]

    @cached_property
    def covariance(self) -> Array:
        """Covariances (d, d) of the signals."""
        centred = self.signals - self.signals.mean(axis=0)
        return np.asarray(centred.T @ centred / len(self))

    @cached_property
    def changes(self) -> Array:
        """Mean squared changes (d,) of the signals from sample to sample."""
        return np.asarray(np.mean(np.diff(self.signals, axis=0) ** 2, axis=0))

    def seen_of(
        self, claimed: NDArray[np.bool_], runs: Sequence[tuple[float, float]]
    ) -> list[Array]:
        """Return the joints (n, 3 J) of some limbs (L,) as one sees them in each of some runs."""
        joints = self.joints(claimed)
        found = (self.seen[max(0, int(a)) : int(np.ceil(b)), joints] for a, b in runs)
        return [own.reshape(len(own), -1).astype(float) for own in found]

    def joints(self, claimed: NDArray[np.bool_]) -> list[int]:
        """Return the joints of some limbs (L,)."""
        chosen = (limb for limb, own in zip(self.limbs, claimed, strict=True) if own)
        return sorted({joint for limb in chosen for joint in limb.joints})

    def frames(self, sample: float) -> int:
        """Return the frame of a sample; the end of the last is that of the frames."""
        if sample >= len(self):
            return self.span[1]
        return min(self.span[1], max(self.span[0], self.span[0] + round(sample * self.step)))


def body_of(
    take: Motion | Poses, span: Span | None = None, joints: Sequence[str] | None = None
) -> Body:
    """Take a body apart into limbs.

    Parameters
    ----------
    take : Motion or Poses
        Of poses, the groups are the limbs, and what is in none is the trunk.
    span : (start, stop), optional
        The frames to look at; all by default.
    joints : sequence of str, optional
        The joints or points to look at; all by default.

    Returns
    -------
    Body

    Raises
    ------
    SkeletonMismatch
        If a joint does not exist.
    """
    step = max(1, round(take.fps / LIMBS.rate))
    view = _Joints(take, span, step) if isinstance(take, Motion) else _Points(take)
    chosen = set(range(len(view.names)) if joints is None else view.indices(joints))
    whole = span or (0, view.count)
    unseen = _unseen(take, whole)
    first, stop = _without_neutral_ends(view, within_ends(whole, unseen), step)
    inside, seen = view.at(slice(first, stop, step))
    limbs, signals, at = [], [], 0
    for name, kind, members in view.limbs():
        own = [joint for joint in members if joint in chosen]
        axes = _axes(inside[:, own])
        if axes.shape[1]:
            limbs.append(Limb(name, kind, tuple(own), (at, at + axes.shape[1])))
            signals.append(axes)
            at += axes.shape[1]
    stacked = np.hstack(signals) if signals else np.zeros((len(inside), 0))
    rate, frames = take.fps / step, (first, stop)
    return Body(tuple(limbs), stacked, seen, rate, frames, unseen, step, view.names, view.count)


def _unseen(take: Motion | Poses, span: Span) -> Spans:
    """Return the stretches of a span in which the body is not seen; none if it never is."""
    if not isinstance(take, Motion) or take.missing is None:
        return Spans()
    hidden = ~take.shown[slice(*span)]
    return Spans() if hidden.all() else Spans.of_mask(hidden).moved(span[0])


def within_ends(span: Span, taken: Spans) -> Span:
    """Return what spans at the ends of a span leave of it."""
    start, stop = span
    start = next((b for a, b in taken if a == start), start)
    return start, next((a for a, b in taken if b == stop), stop)


class _Joints:
    """The joints of a motion, against the hips."""

    def __init__(self, motion: Motion, span: Span | None, step: int) -> None:
        self._motion, self.names, self.count = motion, motion.skeleton.names, len(motion)
        self._frames = slice(*(span or (0, self.count)), step)
        shown = range(self.count)[self._frames]
        places, _ = self._placed(_slice(shown[:: max(1, len(shown) // 64)]))
        self._tree = _Tree(motion.skeleton, _bone_lengths(places, motion.skeleton))
        self._whole, self._above = self._against_hips(self._frames)

    def indices(self, names: Sequence[str]) -> list[int]:
        return [int(joint) for joint in self._motion.skeleton.indices(names)]

    def _placed(self, frames: slice) -> tuple[Array, Array]:
        motion, moved = self._motion, self._motion.translations
        return forward_kinematics(
            motion.skeleton,
            motion.rotations[frames],
            motion.root_path[frames],
            translations=None if moved is None else moved[frames],
        )

    def at(self, frames: slice) -> tuple[Array, NDArray[np.float32]]:
        """Return positions (n, J, 3) turned with the hips, and turned with their heading alone."""
        return self._whole if frames == self._frames else self._against_hips(frames)[0]

    def _against_hips(self, frames: slice) -> tuple[tuple[Array, NDArray[np.float32]], Array]:
        """Return the same, and how high (n, J) each joint is above the lowest.

        Block by block, so that little memory is held beside.
        """
        motion, hub, every = self._motion, self._tree.hub, range(self.count)[frames]
        shape, up = (len(every), len(self.names)), motion.up
        inside, above = np.empty((*shape, 3)), np.empty(shape)
        seen, turned, before = np.empty((*shape, 3), np.float32), 0.0, None
        size = max(1, _BLOCK // (4 * shape[1]))
        for start in range(0, len(every), size):
            own = slice(start, start + size)
            places, turns = self._placed(_slice(every[own]))
            apart, hips = (places - places[:, hub, None]) / self._tree.size, turns[:, hub]
            inside[own] = rot.rotate(rot.conjugate(hips)[:, None], apart)
            angles = _turned(hips if before is None else np.concatenate([before, hips]), up, turned)
            ahead = rot.from_rotation_vector(-angles[-len(hips) :, None] * motion.up_vector)
            seen[own] = rot.rotate(ahead[:, None], apart)
            height = places[..., up]
            above[own] = height - height.min(axis=1, keepdims=True)
            turned, before = float(angles[-1]), hips[-1:].copy()
        return (inside, seen), above

    def limbs(self) -> list[tuple[str, str, list[int]]]:
        low = np.median(self._above, axis=0) / self._tree.size
        return _named(self._tree, low, self._motion.skeleton)


def _slice(frames: range) -> slice:
    return slice(frames.start, frames.stop, frames.step)


class _Points:
    """The points of poses, as they are."""

    def __init__(self, poses: Poses) -> None:
        self._poses, self.names, self.count = poses, tuple(poses.names), len(poses.values)
        self._values = bridged(poses)

    def indices(self, names: Sequence[str]) -> list[int]:
        return point_indices(self._poses, names)

    def at(self, frames: slice) -> tuple[Array, NDArray[np.float32]]:
        values = self._values[frames]
        return values, values.astype(np.float32)

    def limbs(self) -> list[tuple[str, str, list[int]]]:
        found, left = [], set(range(len(self.names)))
        for name, members in self._poses.groups.items():
            kind = next((kind for kind in ("leg", "arm") if kind in name.lower()), "trunk")
            own = [point for point in members if point in left]
            left -= set(own)
            found.append((name, kind, own))
        return [*found, *([("trunk" if found else "body", "trunk", sorted(left))] if left else [])]


def _without_neutral_ends(view: _Joints | _Points, span: Span, step: int) -> Span:
    """Return the frames without a pose put before or behind the movement, such as a T-pose.

    It lies so far off as no two frames near it do.
    """
    first, stop = span
    near = round(LIMBS.near * LIMBS.rate) * step

    def moved(frames: slice) -> Array:
        inside, _ = view.at(frames)
        return np.linalg.norm(np.diff(inside.reshape(len(inside), -1), axis=0), axis=1)

    head = _jump(moved(slice(first, min(stop, first + near))), step)
    tail = _jump(moved(slice(max(first, stop - near), stop))[::-1], step)
    return (first + head, stop - tail) if head + tail < stop - first else span


def _jump(steps: Array, reach: int) -> int:
    """Return how many frames lie before a jump within the first few steps; 0 without one."""
    if len(steps) <= reach + 2:
        return 0
    place = int(steps[:reach].argmax())
    others = float(np.delete(steps, place).max())
    return place + 1 if steps[place] > LIMBS.jump * others > 0.0 else 0


def _turned(orientations: Array, up: int, before: float) -> Array:
    """Return how far (n,) the hips have turned about the vertical, in radians.

    The sum of the turns from sample to sample: no pose of the hips is singular.
    """
    steps = rot.multiply(orientations[1:], rot.conjugate(orientations[:-1]))
    return np.cumsum(np.concatenate([[before], heading(steps, up)]))


def _bone_lengths(places: Array, skeleton: Skeleton) -> Array:
    """Return the length (J,) of each joint's bone to its parent, as it is in the world."""
    lengths = np.zeros(skeleton.n_joints)
    above = np.array(skeleton.parents[1:], np.intp)
    apart = np.linalg.norm(places[:, 1:] - places[:, above], axis=2)
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
        sides = _sides([skeleton.names[joint] for joint in chain], skeleton.names)
        found.append((f"{sides[0]} {kind}" if len(sides) == 1 else kind, kind, chain))
    counts = {name: sum(name == other for other, _, _ in found) for name, _, _ in found}
    numbered, seen = [], dict.fromkeys(counts, 0)
    for name, kind, chain in found:
        seen[name] += 1
        numbered.append((f"{name} {seen[name]}" if counts[name] > 1 else name, kind, chain))
    return [*numbered, *([("trunk", "trunk", sorted(trunk))] if trunk else [])]


def _sides(chain: Sequence[str], names: Sequence[str]) -> list[str]:
    """Return the sides that the names of a limb's joints tell: left, right, both or neither."""
    words = " ".join(chain).lower()
    found = {side for side in ("left", "right") if side in words}
    for name in chain if not found else ():
        other = other_side(name, names)
        if other is not None and other in names:
            found.add("left" if is_left(name, other) else "right")
    return sorted(found)


def _axes(positions: Array) -> Array:
    """Return the principal axes (n, k) of some joints' positions (n, j, 3), as one limb's."""
    if not positions.shape[1]:
        return np.zeros((len(positions), 0))
    values = positions.reshape(len(positions), -1) / np.sqrt(positions.shape[1])
    if np.ptp(values, axis=0).max() < SEARCH.still:
        return np.zeros((len(values), 0))
    return principal_components(values, LIMBS.held)[:, : LIMBS.axes]
