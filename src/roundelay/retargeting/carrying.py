"""Carry the poses of one body over to another: anatomical frames are read here and set there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import TINY
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.motion.motion import Motion
from roundelay.retargeting.anatomy import Anatomy, Limb
from roundelay.retargeting.reference import Reference, along
from roundelay.retargeting.thresholds import TWIST

__all__ = ["Pose", "Seen", "carried", "seen", "shortest", "trunk_of"]

Array = NDArray[np.float64]

_X, _Y = np.eye(3)[:2]


@dataclass(frozen=True, eq=False)
class Seen:
    """A motion as the canonical body does it: the anatomical frames of its bones, (F, 4) each.

    Attributes
    ----------
    pelvis : (F, 4) ndarray
    heights : tuple of float
        How far up the trunk its joints are, from the hips (0) to the neck (1).
    trunk : (F, n + 2, 3) ndarray
        Where hips, the joints of the spine and the neck are.
    spine, neck, tail : list of (F, 4) ndarray
        From below.
    limbs : dict of str to dict of str to (F, 4) ndarray
        "girdle", "upper", "lower", "end" and "tip" of each limb, by its name; what it has.
    places, turns : (F, J, 3), (F, J, 4) ndarray
        Of the joints.
    """

    pelvis: Array
    heights: tuple[float, ...]
    trunk: Array
    spine: list[Array]
    neck: list[Array]
    tail: list[Array]
    limbs: dict[str, dict[str, Array]]
    places: Array
    turns: Array


def seen(motion: Motion, anatomy: Anatomy, reference: Reference, axes: Array) -> Seen:
    """See a motion as the canonical body does it.

    Parameters
    ----------
    motion : Motion
    anatomy : Anatomy
    reference : Reference
    axes : (4,) ndarray
        Turns the world to that of the other body.
    """
    places, turns = forward_kinematics(
        motion.skeleton, motion.rotations, motion.root_path, translations=motion.translations
    )
    places, turns = rot.rotate(axes, places), rot.multiply(axes, turns)

    def frame(joint: int) -> Array:
        return rot.multiply(turns[:, joint], reference.frames[joint])

    limbs = {}
    for limb in anatomy.limbs:
        upper, lower = limb.upper[-1], limb.lower[0]
        top, elbow = places[:, limb.upper[0]], places[:, lower]
        end = _lower_end(anatomy, limb, places, turns)
        found = {
            "upper": along(elbow - top, rot.rotate(frame(upper), _Y)),
            "lower": along(end - elbow, rot.rotate(frame(lower), _Y)),
        }
        for name, joint in (("girdle", limb.girdle), ("end", limb.end), ("tip", limb.tip)):
            if joint is not None:
                found[name] = frame(joint)
        limbs[limb.name] = found
    return Seen(
        frame(anatomy.pelvis[-1]),
        anatomy.heights,
        trunk_of(anatomy, places),
        [frame(joint) for joint in anatomy.spine],
        [frame(joint) for joint in anatomy.neck],
        [frame(joint) for joint in anatomy.tail],
        limbs,
        places,
        turns,
    )


def trunk_of(anatomy: Anatomy, places: Array) -> Array:
    """Return where hips, the joints of the spine and the neck are, (F, n + 2, 3)."""
    ends = anatomy.neck[:1] or anatomy.shoulders
    top = places[:, list(ends)].mean(axis=1)
    return np.concatenate([places[:, [anatomy.carrier, *anatomy.spine]], top[:, None]], axis=1)


def _lower_end(anatomy: Anatomy, limb: Limb, places: Array, turns: Array) -> Array:
    if limb.end is not None:
        return places[:, limb.end]
    last, elbow = limb.lower[-1], places[:, limb.lower[0]]
    tip = anatomy.tip_of(last)
    if tip is None:
        return elbow + elbow - places[:, limb.upper[0]]
    return places[:, last] + rot.rotate(turns[:, last], tip)


class Pose:
    """The poses of the other body: what its bones are turned to, the others going along.

    Parameters
    ----------
    anatomy : Anatomy
    reference : Reference
    frames : int
        How many.
    """

    def __init__(self, anatomy: Anatomy, reference: Reference, frames: int) -> None:
        self.anatomy, self.reference, self.count = anatomy, reference, frames
        self.turned: dict[int, Array] = {}
        self.local: dict[int, Array] = {}

    def set_frame(self, joint: int, frame: Array) -> None:
        """Turn a joint so that its anatomical frame is (F, 4)."""
        if joint in self.reference.frames:
            own = rot.conjugate(self.reference.frames[joint])
            self.turned[joint] = rot.multiply(frame, own)

    def turn(self, joints: Sequence[int], turn: Array) -> None:
        """Turn joints by (F, 4) in the world, their children with them unless these are set."""
        for joint in joints:
            if joint in self.turned:
                self.turned[joint] = rot.multiply(turn, self.turned[joint])

    def solved(self, path: Array | None = None) -> tuple[Array, Array, Array]:
        """Return local rotations (F, J, 4), places (F, J, 3) and turns (F, J, 4) in the world."""
        skeleton, still = self.anatomy.skeleton, self.reference.still
        local = np.tile(still, (self.count, 1, 1))
        turns = np.empty_like(local)
        places = np.zeros((self.count, skeleton.n_joints, 3))
        if path is not None:
            places[:, 0] = path
        for joint, parent in enumerate(skeleton.parents):
            above = rot.identity(self.count) if parent < 0 else turns[:, parent]
            if joint in self.turned:
                turns[:, joint] = self.turned[joint]
                local[:, joint] = rot.multiply(rot.conjugate(above), turns[:, joint])
            else:
                local[:, joint] = self.local.get(joint, local[:, joint])
                turns[:, joint] = rot.multiply(above, local[:, joint])
            if parent >= 0:
                moved = rot.rotate(above, skeleton.offsets[joint])
                places[:, joint] = places[:, parent] + moved
        return local, places, turns


def carried(source: Seen, anatomy: Anatomy, reference: Reference) -> Pose:
    """Turn the bones of a body as those of another are.

    A spine or a neck of other number shares the bends out; in-line and side bones share the twist.

    Parameters
    ----------
    source : Seen
    anatomy : Anatomy
    reference : Reference
        Of the body that is turned.
    """
    pose = Pose(anatomy, reference, len(source.pelvis))
    _set_root(pose, source)
    for joint in anatomy.pelvis:
        pose.set_frame(joint, source.pelvis)
    chest = source.spine[-1] if source.spine else source.pelvis
    for joint, frame in zip(anatomy.spine, _bent(source, anatomy.heights), strict=True):
        pose.set_frame(joint, frame)
    for joints, base, frames in (
        (anatomy.neck, chest, source.neck),
        (anatomy.tail, source.pelvis, source.tail),
    ):
        for joint, frame in zip(joints, _shared(base, frames, len(joints)), strict=True):
            if frames or joints is not anatomy.tail:
                pose.set_frame(joint, frame)
    for limb in anatomy.limbs:
        _set_limb(pose, limb, source.limbs[limb.name], chest)
    _lean(pose, source)
    _share_twists(pose)
    return pose


def _set_root(pose: Pose, source: Seen) -> None:
    """Let a root above the hips head where the hips do, upright: it carries way and turning."""
    anatomy, still = pose.anatomy, pose.reference.still
    if not anatomy.carrier:
        return
    turn = rot.identity()
    for joint in anatomy.above(anatomy.carrier):
        turn = rot.multiply(turn, still[joint])
    usual = rot.multiply(turn, pose.reference.frames[anatomy.carrier])
    about = rot.rotate(usual, np.array([0.0, 1.0, 0.0]))
    heading = rot.twist(rot.multiply(source.pelvis, rot.conjugate(usual)), about)
    pose.turned[0] = rot.multiply(heading, still[0])


def _bent(source: Seen, heights: tuple[float, ...]) -> Iterator[Array]:
    """Yield the frames (F, 4) of a spine whose joints are at some heights of the trunk.

    Each bone stands as the bones of the other stand on average between its ends; the uppermost,
    which carries the arms, as the uppermost.
    """
    alike = len(heights) == len(source.heights)
    if alike and np.allclose(heights, source.heights, atol=TWIST.alike):
        yield from source.spine
        return
    edges = np.array([0.0, *source.heights, 1.0])
    frames = np.stack([source.pelvis, *source.spine])
    for low, high in pairwise((*heights, 1.0)):
        shares = np.minimum(edges[1:], high) - np.maximum(edges[:-1], low)
        shares = np.maximum(shares, 0.0)
        last = high == 1.0 or not shares.any()
        yield frames[-1] if last else rot.mean(frames, shares)


def _lean(pose: Pose, source: Seen) -> None:
    """Lean the middle of a spine so that the arms begin where they did, on the way to the neck.

    Joints at other heights bend the trunk elsewhere: what turns with the hips does not reach as far
    up, or farther.
    """
    anatomy, heights = pose.anatomy, pose.anatomy.heights
    alike = len(heights) == len(source.heights)
    if (
        len(heights) < 2
        or not source.heights
        or (alike and np.allclose(heights, source.heights, atol=TWIST.alike))
    ):
        return
    _, places, _ = pose.solved()
    own = trunk_of(anatomy, places)
    scale = np.linalg.norm(np.diff(own[0], axis=0), axis=1).sum()
    scale /= max(float(np.linalg.norm(np.diff(source.trunk[0], axis=0), axis=1).sum()), TINY)
    wanted = scale * _along(source, heights[-1]) + own[:, 0] - own[:, 1]
    middle = own[:, -2] - own[:, 1]
    turn = shortest(middle, wanted)
    angle = rot.angle_between(turn, rot.identity())
    share = np.minimum(1.0, np.radians(TWIST.lean) / np.maximum(angle, TINY))
    turn = rot.from_rotation_vector(share[:, None] * rot.to_rotation_vector(turn))
    pose.turn(anatomy.spine[:-1], turn)


def _along(source: Seen, height: float) -> Array:
    """Return the way (F, 3) from the hips to a height of a trunk."""
    edges = np.array([0.0, *source.heights, 1.0])
    at = int(np.clip(np.searchsorted(edges, height, side="right") - 1, 0, len(edges) - 2))
    share = (height - edges[at]) / max(edges[at + 1] - edges[at], TINY)
    points = source.trunk - source.trunk[:, :1]
    return np.asarray(points[:, at] + share * (points[:, at + 1] - points[:, at]))


def shortest(source: Array, target: Array) -> Array:
    """Return the least rotations (F, 4) that turn vectors (F, 3) into directions of others."""
    both = np.linalg.norm(source, axis=1) * np.linalg.norm(target, axis=1)
    along = np.sum(source * target, axis=1)
    turn = np.concatenate([(both + along)[:, None], np.cross(source, target)], axis=1)
    return np.where(both[:, None] > TINY, rot.normalize(turn), rot.identity(len(turn)))


def _shared(base: Array, frames: Sequence[Array], count: int) -> Iterator[Array]:
    """Yield so many frames (F, 4) along a chain that begins at a base."""
    chain = [base, *frames]
    for number in range(1, count + 1):
        at = number * len(frames) / count
        below = min(int(at), max(len(frames) - 1, 0))
        above = min(below + 1, len(frames))
        if above == below or at == below:
            yield chain[below]
        elif at == above:
            yield chain[above]
        else:
            share = np.full(len(base), at - below)
            yield rot.slerp(chain[below], chain[above], share)


def _set_limb(pose: Pose, limb: Limb, frames: dict[str, Array], chest: Array) -> None:
    if limb.girdle is not None:
        pose.set_frame(limb.girdle, frames.get("girdle", chest))
    for joint in limb.upper:
        pose.set_frame(joint, frames["upper"])
    for joint in limb.lower:
        pose.set_frame(joint, frames["lower"])
    if limb.end is not None:
        pose.set_frame(limb.end, frames.get("end", frames["lower"]))
    if limb.tip is not None:
        pose.set_frame(limb.tip, frames.get("tip", frames.get("end", frames["lower"])))


def _share_twists(pose: Pose) -> None:
    """Share the twist of upper and lower bones with the joints in line and beside them."""
    anatomy = pose.anatomy
    sharers = {
        limb.name: (_sharing(anatomy, limb.upper, limb.lower[0]),
                    [] if limb.end is None else _sharing(anatomy, limb.lower, limb.end))
        for limb in anatomy.limbs
    }  # fmt: skip
    if not any(one for pair in sharers.values() for one in pair):
        return
    _, _, turns = pose.solved()
    for limb in anatomy.limbs:
        above, below = sharers[limb.name]
        if above:
            bone, twist = _upper_twist(pose, turns, limb)
            for joint, place, in_line in above:
                part = place + in_line / len(limb.upper) - 1.0
                _turn_about(pose, joint, limb.upper[0], bone, part * twist)
        if below and limb.end is not None:
            bone, twist = _lower_twist(pose, turns, limb, limb.end)
            for joint, place, in_line in below:
                part = place if in_line else max(place, TWIST.least)
                _turn_about(pose, joint, limb.lower[0], bone, part * twist)


def _sharing(anatomy: Anatomy, chain: tuple[int, ...], to: int) -> list[tuple[int, float, bool]]:
    """Return joints that share a bone's twist, how far along it each is, and whether in line.

    Others hang beside it, with "twist" or "roll" in their names.
    """
    skeleton = anatomy.skeleton
    in_line = [(joint, number / len(chain), True) for number, joint in enumerate(chain)]
    whole = float(sum(np.linalg.norm(skeleton.offsets[joint]) for joint in (*chain[1:], to)))
    beside = [
        (joint, min(float(np.linalg.norm(skeleton.offsets[joint])) / max(whole, TINY), 1.0), False)
        for joint, parent in enumerate(skeleton.parents)
        if parent in chain and joint not in (*chain, to) and _twists(skeleton.names[joint])
    ]
    return (in_line if len(chain) > 1 else []) + beside


def _twists(name: str) -> bool:
    return "twist" in name.lower() or "roll" in name.lower()


def _upper_twist(pose: Pose, turns: Array, limb: Limb) -> tuple[Array, Array]:
    """Return an upper bone (3,) in its own axes, and by how much (F,) it is twisted."""
    joint = limb.upper[0]
    parent, bone = pose.anatomy.skeleton.parents[joint], _bone(pose, joint, limb.lower[0])
    above = turns[:, parent] if parent >= 0 else rot.identity(pose.count)
    usual = rot.multiply(above, pose.reference.still[joint])
    return bone, _twisted(rot.multiply(rot.conjugate(usual), turns[:, joint]), bone)


def _lower_twist(pose: Pose, turns: Array, limb: Limb, end: int) -> tuple[Array, Array]:
    """Return a lower bone (3,) in its own axes, and by how much (F,) its end is twisted on it."""
    joint = limb.lower[0]
    usual = rot.identity()
    for one in (*limb.lower[1:], end):
        usual = rot.multiply(usual, pose.reference.still[one])
    free = rot.multiply(rot.conjugate(turns[:, joint]), turns[:, end])
    bone = _bone(pose, joint, end)
    return bone, _twisted(rot.multiply(free, rot.conjugate(usual)), bone)


def _twisted(turns: Array, axis: Array) -> Array:
    """Return the angles (F,) in radians by which rotations turn about an axis."""
    part = rot.twist(turns, axis)
    angle = 2.0 * np.arctan2(part[:, 1:] @ axis, part[:, 0])
    return np.unwrap((angle + np.pi) % (2.0 * np.pi) - np.pi)


def _bone(pose: Pose, joint: int, to: int) -> Array:
    """Return the direction (3,) of a bone in the axes of the joint that carries it."""
    skeleton, still = pose.anatomy.skeleton, pose.reference.still
    way, turn = np.zeros(3), rot.identity()
    chain = pose.anatomy.above(to)
    for one in chain[chain.index(joint) + 1 :]:
        way = way + rot.rotate(turn, skeleton.offsets[one])
        turn = rot.multiply(turn, still[one])
    return np.asarray(way / max(float(np.linalg.norm(way)), TINY))


def _turn_about(pose: Pose, joint: int, root: int, bone: Array, angle: Array) -> None:
    """Turn a joint about a bone, which is given in the axes of its first joint."""
    about = rot.from_rotation_vector(angle[:, None] * bone)
    if joint in pose.turned:
        base = pose.turned[root]
        turn = rot.multiply(rot.multiply(base, about), rot.conjugate(base))
        pose.turned[joint] = rot.multiply(turn, pose.turned[joint])
    else:
        pose.local[joint] = rot.multiply(about, pose.reference.still[joint])
