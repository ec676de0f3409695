"""Hands that touch the body: on the hips, at the head, on a thigh, together.

Where a wrist is near a part of the body and still on it, it goes to the same place on that part of
the other body: as far along its bone, and as far off it as the other body is larger.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import TINY, smoothstep
from roundelay.geometry import rotations as rot
from roundelay.retargeting.anatomy import Anatomy, Limb
from roundelay.retargeting.carrying import Pose, Seen
from roundelay.retargeting.moving import move_end
from roundelay.retargeting.reference import from_axes
from roundelay.retargeting.thresholds import TOUCHING

__all__ = ["Touch", "keep_touches", "touches_of"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Touch:
    """A hand on a part of the body.

    Attributes
    ----------
    arm : int
        The number of the arm.
    part : str
        "trunk", "head", "left thigh", "other hand" and so on.
    share : (F,) ndarray
        How much it is there: 0 away from it, 1 on it.
    place : (F,) ndarray
        How far along the part's bone.
    off : (F, 3) ndarray
        How far off it, in the part's axes, in leg lengths.
    """

    arm: int
    part: str
    share: Array
    place: Array
    off: Array


@dataclass(frozen=True, eq=False)
class _Part:
    """A part of a body: where its bone begins and ends, and its axes."""

    start: Array
    stop: Array
    turns: Array

    def at(self, place: Array) -> Array:
        return self.start + place[:, None] * (self.stop - self.start)


def _parts(anatomy: Anatomy, places: Array, across: Array) -> Iterator[tuple[str, _Part]]:
    """Yield the parts of a body that hands touch; their axes follow bones and the body's left."""
    hips = places[:, list(anatomy.hips)].mean(axis=1)
    shoulders = places[:, list(anatomy.shoulders)].mean(axis=1)
    yield "trunk", _part(hips, shoulders, across)
    if anatomy.neck:
        head = places[:, anatomy.neck[-1]]
        yield "head", _part(head, head + 0.5 * (head - shoulders), across)
    for limb in anatomy.legs:
        if limb.end is not None:
            top, knee, ankle = (places[:, j] for j in (limb.upper[0], limb.lower[0], limb.end))
            yield f"{limb.name}, thigh", _part(top, knee, across)
            yield f"{limb.name}, shin", _part(knee, ankle, across)


def _part(start: Array, stop: Array, across: Array) -> _Part:
    bone = stop - start
    first = bone / np.maximum(np.linalg.norm(bone, axis=1, keepdims=True), TINY)
    second = across - np.sum(across * first, axis=1, keepdims=True) * first
    sizes = np.maximum(np.linalg.norm(second, axis=1, keepdims=True), TINY)
    return _Part(start, stop, from_axes(first, second / sizes))


def _wrists(anatomy: Anatomy, places: Array) -> list[tuple[Limb, Array]]:
    """Return where each hand begins (F, 3), with its arm: all bodies have that."""
    return [(limb, places[:, limb.end]) for limb in anatomy.arms if limb.end is not None]


def _across(anatomy: Anatomy, places: Array) -> Array:
    left, right = anatomy.hips
    return np.asarray(places[:, left] - places[:, right])


def touches_of(source: Seen, anatomy: Anatomy, fps: float) -> list[Touch]:
    """Find when and where hands touch the body.

    Parameters
    ----------
    source : Seen
    anatomy : Anatomy
    fps : float
    """
    wrists = _wrists(anatomy, source.places)
    size, found = anatomy.leg_length, []
    parts = list(_parts(anatomy, source.places, _across(anatomy, source.places)))
    bent = [_bent(limb, source.places) for limb, _ in wrists]
    for number, (_, wrist) in enumerate(wrists):
        for name, part in parts:
            near = TOUCHING.trunk if name == "trunk" else TOUCHING.limb
            place, off = _on(part, wrist)
            share = _near(np.linalg.norm(off, axis=1) / size, near) * bent[number]
            slow = _still(off / size, place, part, size, fps)
            # Beyond its ends it hangs beside, or is in front of, another part.
            share = share * slow * ((place > 0.0) & (place < 1.0))
            found.append(Touch(number, name, share, place, off / size))
    if len(wrists) == 2:
        apart = wrists[1][1] - wrists[0][1]
        share = _near(np.linalg.norm(apart, axis=1) / size, TOUCHING.hands) * bent[0] * bent[1]
        own = dict(parts)["trunk"].turns
        off = rot.rotate(rot.conjugate(own), apart) / size
        found.append(Touch(1, "other hand", share, np.zeros(len(apart)), off))
    return [touch for touch in found if touch.share.any()]


def _bent(limb: Limb, places: Array) -> Array:
    """Return 0 for an arm that hangs straight (F,), 1 for one that is bent to touch something."""
    assert limb.end is not None
    top, elbow, end = (places[:, joint] for joint in (limb.upper[0], limb.lower[0], limb.end))
    upper, lower = elbow - top, end - elbow
    sizes = np.linalg.norm(upper, axis=1) * np.linalg.norm(lower, axis=1)
    cosine = np.sum(upper * lower, axis=1) / np.maximum(sizes, TINY)
    angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    return smoothstep(np.clip(angle / TOUCHING.bent - 1.0, 0.0, 1.0))


def _on(part: _Part, points: Array) -> tuple[Array, Array]:
    """Return how far along a part points are (F,), and how far off it, in its axes (F, 3)."""
    bone, apart = part.stop - part.start, points - part.start
    along = np.sum(apart * bone, axis=1) / np.maximum(np.sum(bone * bone, axis=1), TINY)
    place = np.clip(along, 0.0, 1.0)
    return place, rot.rotate(rot.conjugate(part.turns), points - part.at(place))


def _near(distance: Array, near: float) -> Array:
    return smoothstep(np.clip(1.0 - (distance - near) / TOUCHING.fades, 0.0, 1.0))


def _still(off: Array, place: Array, part: _Part, size: float, fps: float) -> Array:
    """Return 1 where a point rests on a part (F,), 0 where it passes by."""
    bone = np.linalg.norm(part.stop - part.start, axis=1) / size
    inside = off + np.stack([place * bone, np.zeros_like(place), np.zeros_like(place)], axis=1)
    reach = max(1, round(TOUCHING.reach * fps))
    at = np.arange(len(inside))
    ahead, behind = np.minimum(at + reach, len(at) - 1), np.maximum(at - reach, 0)
    moved = np.linalg.norm(inside[ahead] - inside[behind], axis=1)
    speed = moved * fps / np.maximum(ahead - behind, 1)
    return smoothstep(np.clip(2.0 - speed / TOUCHING.slow, 0.0, 1.0))


def keep_touches(pose: Pose, touches: list[Touch], path: Array) -> None:
    """Bring the hands of a body where those of the other touched it.

    Parameters
    ----------
    pose : Pose
        Its feet stand already.
    touches : list of Touch
    path : (F, 3) ndarray
        Of the root.
    """
    if not touches:
        return
    anatomy = pose.anatomy
    for _ in range(TOUCHING.rounds):
        _, places, turns = pose.solved(path)
        wrists = _wrists(anatomy, places)
        moves = _asked(anatomy, touches, places, wrists)
        for (limb, _), offset in zip(wrists, moves, strict=True):
            move_end(pose, limb, places, turns, offset)


def _asked(
    anatomy: Anatomy, touches: list[Touch], places: Array, wrists: list[tuple[Limb, Array]]
) -> list[Array]:
    """Return by how much (F, 3) to move each hand: what its touches ask, by their shares."""
    parts = dict(_parts(anatomy, places, _across(anatomy, places)))
    moves = [np.zeros((len(places), 3)) for _ in wrists]
    shares = [np.zeros(len(places)) for _ in wrists]
    for touch in touches:
        if touch.part == "other hand" and len(wrists) == 2:
            wanted = rot.rotate(parts["trunk"].turns, touch.off * anatomy.leg_length)
            lack = 0.5 * touch.share[:, None] * (wanted - (wrists[1][1] - wrists[0][1]))
            for number, sign in ((0, -1.0), (1, 1.0)):
                moves[number] += sign * lack
                shares[number] += touch.share
        elif touch.part in parts and touch.arm < len(wrists):
            part = parts[touch.part]
            wanted = part.at(touch.place) + rot.rotate(part.turns, touch.off * anatomy.leg_length)
            moves[touch.arm] += touch.share[:, None] * (wanted - wrists[touch.arm][1])
            shares[touch.arm] += touch.share
    return [
        move / np.maximum(share, 1.0)[:, None] for move, share in zip(moves, shares, strict=True)
    ]
