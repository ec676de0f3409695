"""Joint centres of a person as landmarks tell them, frame by frame: where the fit begins.

Hips by the regression of Harrington et al. 2007 (J. Biomech. 40, 595-602), shoulders as Rab et al.
2002 (Gait & Posture 15, 275-281) place them, knees, ankles, elbows and wrists half a joint's width
inside of the marker, or between two markers. The fit moves them to where the take turns.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import Unsolvable
from roundelay.motion.frame import trunk_frame
from roundelay.motion.poses import Mask
from roundelay.solving.landmarks import Landmark
from roundelay.solving.thresholds import PERSON

__all__ = ["Centres", "centres_of_keypoints", "centres_of_markers", "hinged", "unit"]

Array = NDArray[np.float64]
SIDES = {"Left": 1.0, "Right": -1.0}


@dataclass(frozen=True, eq=False)
class Centres:
    """Hold joint centres and directions by name, each (F, 3).

    Attributes
    ----------
    places : dict
        "hips", "neck", "head"; and with the side before it "hip", "knee", "ankle", "toe", "heel",
        "shoulder", "elbow", "wrist", "hand". Only those that are known.
    left : dict
        Directions to a joint's left: of "Hips", "Spine", "Head".
    ahead : dict
        Directions to a joint's front: of forearms and hands, thumbs ahead.
    ahead_of_hips : (F, 3) ndarray or None
        To the front of the hips, where markers tell it.
    """

    places: dict[str, Array]
    left: dict[str, Array]
    ahead: dict[str, Array]
    ahead_of_hips: Array | None


def unit(vectors: Array) -> Array:
    """Return vectors (..., 3) of length 1; zero stays."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.where(length > 0.0, length, 1.0))


def hinged(first: Array, second: Array, sign: float, guess: Array) -> Array:
    """Return where the axis (F, 3) of a hinge between two bones points: square to both.

    A straight limb does not tell it; then it is as guessed.
    """
    square = np.cross(unit(first), unit(second))
    return np.asarray(sign * square + PERSON.hinge * unit(guess))


@dataclass(frozen=True, eq=False)
class _Seen:
    """Hold positions (F, M, 3) without gaps, and which points each landmark has."""

    positions: Array
    found: dict[tuple[str, str], list[int]]

    def __contains__(self, key: tuple[str, str]) -> bool:
        return key in self.found

    def mean(self, side: str, *names: str) -> Array | None:
        """Return the mean place (F, 3) of landmarks; None if one is not there."""
        if any((side, name) not in self.found for name in names):
            return None
        each = [self.positions[:, self.found[side, name]].mean(axis=1) for name in names]
        return np.asarray(np.mean(each, axis=0))

    def certain(self, side: str, name: str) -> Array:
        """Return the mean place (F, 3) of a landmark that is there."""
        return np.asarray(self.positions[:, self.found[side, name]].mean(axis=1))

    def first(self, side: str, *names: str) -> Array | None:
        """Return the place (F, 3) of the first landmark that is there."""
        for name in names:
            if (side, name) in self.found:
                return self.mean(side, name)
        return None


def _seen(positions: Array, seen: Mask, marks: list[Landmark | None], trunk: list[int]) -> _Seen:
    """Bridge gaps, evenly as the trunk sees the points."""
    frame = trunk_frame(positions, seen, np.array(trunk, np.intp), planar=False)
    inside, frames = frame.inside(positions), np.arange(len(positions))
    for point in range(positions.shape[1]):
        known = np.flatnonzero(seen[:, point])
        for axis in range(3):
            inside[:, point, axis] = np.interp(frames, known, inside[known, point, axis])
    found: dict[tuple[str, str], list[int]] = {}
    for point, mark in enumerate(marks):
        if mark is not None:
            found.setdefault((mark.side, mark.name), []).append(point)
    return _Seen(frame.outside(inside), found)


def centres_of_keypoints(positions: Array, seen: Mask, marks: list[Landmark | None]) -> Centres:
    """Take joint centres from keypoints.

    Raises
    ------
    Unsolvable
        If hips or both legs are not there.
    """
    names = ("hips", "hip", "shoulder", "neck")
    trunk = [place for place, mark in enumerate(marks) if mark and mark.name in names]
    if len(trunk) < 3:
        raise Unsolvable("hips and shoulders")
    points = _seen(positions, seen, marks, trunk)
    places: dict[str, Array] = {}
    for side in SIDES:
        for name in ("hip", "knee", "ankle", "heel", "toe", "shoulder", "elbow", "wrist"):
            _put(places, f"{side}{name}", points.mean(side, name))
        _put(places, f"{side}hand", points.mean(side, "hand", "hand ulnar"))
        _put(places, f"{side}hand", points.mean(side, "hand"))
    if "Lefthip" not in places or "Righthip" not in places:
        raise Unsolvable("both hips")
    left, ahead = _directions(points, places)
    _middle(places, points.first("", "neck"), _face(points))
    return Centres(places, left, ahead, None)


def _put(places: dict[str, Array], name: str, value: Array | None) -> None:
    if value is not None:
        places.setdefault(name, value)


def _face(points: _Seen) -> Array | None:
    """Return the middle of the head (F, 3): between the ears, else of what is there."""
    ears = [points.mean(side, "ear") for side in SIDES]
    if ears[0] is not None and ears[1] is not None:
        return np.asarray(0.5 * (ears[0] + ears[1]))
    parts = [p for (_, name), p in points.found.items() if name in ("head", "nose", "ear", "eye")]
    flat = [point for part in parts for point in part]
    return np.asarray(points.positions[:, flat].mean(axis=1)) if flat else None


def _middle(places: dict[str, Array], neck: Array | None, head: Array | None) -> None:
    """Add the middle of the hips, the base of the neck, the head."""
    places["hips"] = 0.5 * (places["Lefthip"] + places["Righthip"])
    if neck is None and "Leftshoulder" in places and "Rightshoulder" in places:
        neck = 0.5 * (places["Leftshoulder"] + places["Rightshoulder"])
    _put(places, "neck", neck)
    if "neck" in places:
        _put(places, "head", head)


def _directions(
    points: _Seen, places: dict[str, Array]
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return directions to the left of hips, chest and head; to the front of forearms, hands."""
    left = {"Hips": places["Lefthip"] - places["Righthip"]}
    ahead: dict[str, Array] = {}
    if "Leftshoulder" in places and "Rightshoulder" in places:
        left["Spine"] = places["Leftshoulder"] - places["Rightshoulder"]
    for name in ("ear", "eye", "head", "temple"):
        sides = [points.mean(side, name) for side in SIDES]
        if sides[0] is not None and sides[1] is not None:
            left.setdefault("Head", sides[0] - sides[1])
    for side in SIDES:
        radial, ulnar = points.mean(side, "wrist radial"), points.mean(side, "wrist ulnar")
        if radial is not None and ulnar is not None:
            ahead[f"{side}ForeArm"] = radial - ulnar
        index, pinky = points.mean(side, "hand"), points.mean(side, "hand ulnar")
        if index is not None and pinky is not None:
            ahead[f"{side}Hand"] = index - pinky
    return left, ahead


def centres_of_markers(positions: Array, seen: Mask, marks: list[Landmark | None]) -> Centres:
    """Estimate joint centres from markers; lengths in metres.

    Raises
    ------
    Unsolvable
        If the pelvis or both legs are not there.
    """
    trunk = [place for place, mark in enumerate(marks) if mark and mark.bone == "Hips"]
    names = {(mark.side, mark.name) for mark in marks if mark}
    back = {("", "sacrum")} & names or {("Left", "psis"), ("Right", "psis")} <= names
    if not {("Left", "asis"), ("Right", "asis")} <= names or not back:
        raise Unsolvable("a pelvis of both ASIS and the sacrum or both PSIS")
    points = _seen(positions, seen, marks, trunk)
    places: dict[str, Array] = {}
    axes = _hips(points, places)
    for side in SIDES:
        _leg(points, places, side, axes[0])
    if not any(f"{side}ankle" in places for side in SIDES):
        raise Unsolvable("a leg with knee and ankle")
    neck = _neck(points)
    for side in SIDES:
        _arm(points, places, side, neck)
    left, ahead = _directions(points, places)
    _middle(places, neck, _face(points))
    return Centres(places, left, ahead, axes[2])


def _hips(points: _Seen, places: dict[str, Array]) -> tuple[Array, Array, Array]:
    """Add hip centres; return the directions left, up, ahead (F, 3) of the pelvis.

    Harrington et al. 2007, table 2: from the middle of both ASIS, in mm, with the pelvis' width W
    and depth D: .24 D + 9.9 back, .30 W + 10.9 down, .33 W + 7.3 aside.
    """
    asis = {side: points.certain(side, "asis") for side in SIDES}
    back = points.mean("", "sacrum")
    if back is None:
        back = 0.5 * (points.certain("Left", "psis") + points.certain("Right", "psis"))
    front = 0.5 * (asis["Left"] + asis["Right"])
    across = asis["Left"] - asis["Right"]
    width = float(np.median(np.linalg.norm(across, axis=1)))
    depth = float(np.median(np.linalg.norm(front - back, axis=1)))
    left = unit(across)
    ahead = front - back
    ahead = unit(ahead - np.sum(ahead * left, axis=1, keepdims=True) * left)
    up = np.cross(ahead, left)
    backward = PERSON.hip_back[0] * depth + PERSON.hip_back[1]
    downward = PERSON.hip_down[0] * width + PERSON.hip_down[1]
    outward = PERSON.hip_aside[0] * width + PERSON.hip_aside[1]
    for side, sign in SIDES.items():
        places[f"{side}hip"] = front - backward * ahead - downward * up + sign * outward * left
    return left, up, ahead


def _leg(points: _Seen, places: dict[str, Array], side: str, left: Array) -> None:
    """Add knee, ankle, heel and toe of one side."""
    sign, hip = SIDES[side], places[f"{side}hip"]
    knee = points.mean(side, "knee lateral", "knee medial")
    if knee is None:
        knee = points.first(side, "knee lateral")
        inward = _square(left, hip - knee) if knee is not None else left
        knee = None if knee is None else knee - sign * PERSON.knee * inward
    _put(places, f"{side}knee", knee)
    if knee is None:
        return
    heel, toe = points.first(side, "heel"), points.first(side, "toe", "toe lateral", "toe medial")
    _put(places, f"{side}heel", heel)
    _put(places, f"{side}toe", toe)
    ankle = points.mean(side, "ankle lateral", "ankle medial")
    if ankle is None:
        ankle = points.first(side, "ankle lateral")
        if ankle is not None:
            ankle = ankle - sign * PERSON.ankle * _square(left, knee - ankle)
        elif heel is not None and toe is not None:
            sole = toe - heel
            ankle = (
                heel + PERSON.ankle_ahead * sole + PERSON.ankle_above * _square(knee - heel, sole)
            )
    _put(places, f"{side}ankle", ankle)


def _square(vectors: Array, along: Array) -> Array:
    """Return the direction of vectors (F, 3) square to others."""
    axis = unit(along)
    return unit(vectors - np.sum(vectors * axis, axis=1, keepdims=True) * axis)


def _neck(points: _Seen) -> Array | None:
    """Return the base of the neck (F, 3): between C7 and the jugular notch, or what is there."""
    both = points.mean("", "c7", "jugular")
    return points.first("", "c7", "jugular") if both is None else both


def _arm(points: _Seen, places: dict[str, Array], side: str, neck: Array | None) -> None:
    """Add shoulder, elbow, wrist and hand of one side.

    The shoulder lies below the acromion by 17 % of the distance of both (Rab et al. 2002).
    """
    acromion = points.first(side, "acromion", "humeral head")
    if acromion is None:
        return
    both = [points.first(each, "acromion", "humeral head") for each in SIDES]
    width = PERSON.shoulders
    if both[0] is not None and both[1] is not None:
        width = float(np.median(np.linalg.norm(both[0] - both[1], axis=1)))
    middle = 0.5 * (places["Lefthip"] + places["Righthip"])
    down = unit(middle - (acromion if neck is None else neck))
    places[f"{side}shoulder"] = acromion + PERSON.below_acromion * width * down
    part: Callable[..., Array | None] = points.mean
    for name, pair in (
        ("elbow", ("elbow lateral", "elbow medial")),
        ("wrist", ("wrist radial", "wrist ulnar")),
        ("hand", ("hand", "hand ulnar")),
    ):
        both_sides = part(side, *pair)
        place = points.first(side, *pair) if both_sides is None else both_sides
        if place is None:
            return
        places[f"{side}{name}"] = place
    if points.mean(side, "elbow lateral", "elbow medial") is None:
        _elbow_inward(places, side, points)


def _elbow_inward(places: dict[str, Array], side: str, points: _Seen) -> None:
    """Move an elbow known by one marker inside, along its hinge."""
    elbow = places[f"{side}elbow"]
    upper = elbow - places[f"{side}shoulder"]
    left = places["Lefthip"] - places["Righthip"]
    axis = left
    if f"{side}wrist" in places:
        axis = hinged(upper, places[f"{side}wrist"] - elbow, -1.0, left)
    lateral = 1.0 if (side, "elbow lateral") in points else -1.0
    places[f"{side}elbow"] = elbow - lateral * SIDES[side] * PERSON.elbow * _square(axis, upper)
