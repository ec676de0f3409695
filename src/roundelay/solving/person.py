"""A person: the tree of joints, how they bend, and the first guess of shape and poses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.geometry import rotations as rot
from roundelay.motion.poses import Mask
from roundelay.solving.body import Body, Poses, chained
from roundelay.solving.centres import SIDES, Centres, hinged, unit
from roundelay.solving.landmarks import Landmark
from roundelay.solving.thresholds import BENDS, PERSON, SHAPES

__all__ = ["Guess", "attached", "guessed_person"]

Array = NDArray[np.float64]

# Joint, its parent, the centre it is at, the centre its bone leads to.
_TREE = [
    ("Hips", "", "hips", ""),
    ("Spine", "Hips", "lumbar", "neck"),
    ("Neck", "Spine", "neck", "skull"),
    ("Head", "Neck", "skull", "head"),
    *(
        (f"{side}{name}", parent.replace("*", side), f"{side}{start}", f"{side}{end}")
        for side in SIDES
        for name, parent, start, end in (
            ("Shoulder", "Spine", "collar", "shoulder"),
            ("Arm", "*Shoulder", "shoulder", "elbow"),
            ("ForeArm", "*Arm", "elbow", "wrist"),
            ("Hand", "*ForeArm", "wrist", "hand"),
        )
    ),
    *(
        (f"{side}{name}", parent.replace("*", side), f"{side}{start}", f"{side}{end}")
        for side in SIDES
        for name, parent, start, end in (
            ("UpLeg", "Hips", "hip", "knee"),
            ("Leg", "*UpLeg", "knee", "ankle"),
            ("Foot", "*Leg", "ankle", "toe"),
        )
    ),
]
# The centre without which a joint is left out; its own apart.
_NEEDED = {
    "Neck": "skull",
    "Shoulder": "elbow",
    "Arm": "elbow",
    "ForeArm": "wrist",
    "UpLeg": "knee",
    "Leg": "ankle",
}
# Keypoints that are the joints themselves.
_JOINT_KEYPOINTS = ("hips", "hip", "knee", "ankle", "shoulder", "elbow", "wrist")


# Landmarks at the far ends of their bones, and the joint there.
_ENDS = {
    "knee lateral": "Leg",
    "knee medial": "Leg",
    "ankle lateral": "Foot",
    "ankle medial": "Foot",
    "acromion": "Arm",
    "elbow lateral": "ForeArm",
    "elbow medial": "ForeArm",
    "wrist radial": "Hand",
    "wrist ulnar": "Hand",
}


@dataclass(frozen=True, eq=False)
class Guess:
    """Hold a body, its poses, and which points are its markers.

    Attributes
    ----------
    body : Body
    poses : Poses
    points : (M,) ndarray of int
        The point that each marker of the body is.
    """

    body: Body
    poses: Poses
    points: NDArray[np.intp]


def guessed_person(
    positions: Array,
    seen: Mask,
    marks: list[Landmark | None],
    centres: Centres,
    *,
    keypoints: bool,
) -> Guess:
    """Make the tree, its shape and poses from joint centres.

    Parameters
    ----------
    positions : (F, N, 3) ndarray
        Points in metres, Y up.
    seen : (F, N) ndarray of bool
    marks : list of Landmark or None
    centres : Centres
    keypoints : bool
        Whether points are joint centres, not markers on the skin.
    """
    places = _completed(centres.places)
    tree = [row for row in _TREE if row[2] in places and _wanted(row[0], places)]
    number = {row[0]: place for place, row in enumerate(tree)}
    parents = tuple(number.get(row[1], -1) for row in tree)
    axes = _axes(list(number), places, centres)
    at = np.stack([places[row[2]] for row in tree], axis=1)
    turned = np.stack([axes[name] for name in number], axis=1)
    carriers = [number.get(mark.bone) if mark else None for mark in marks]
    points, joints, on_bones = attached(positions, seen, carriers, at, turned)
    free = np.full((len(points), 3), SHAPES.marker)
    free[joints == 0] = SHAPES.pelvis
    if keypoints:
        named = [mark.name if mark else "" for mark in marks]
        fixed = [named[point] in _JOINT_KEYPOINTS for point in points]
        on_bones[fixed], free[fixed] = 0.0, SHAPES.fixed
    offsets, pairs = _alike(_offsets(parents, at, turned), number)
    body = Body(
        tuple(number),
        parents,
        offsets,
        np.array([_offset_spread(name, keypoints) for name in number]),
        joints,
        on_bones,
        free,
        np.array([_bend(name) for name in number]),
        np.array([_one_way(name) for name in number]),
        pairs,
        SHAPES.alike,
        _anchors(marks, points, number),
        SHAPES.near,
    )
    return Guess(body, chained(parents, at, rot.from_matrix(turned)), points)


def _anchors(
    marks: list[Landmark | None], points: NDArray[np.intp], number: dict[str, int]
) -> tuple[tuple[int, int], ...]:
    """Return markers at the far ends of their bones, as at a knee, with the joints there."""
    found = []
    for marker, point in enumerate(points):
        mark = marks[point]
        end = _ENDS.get(mark.name) if mark else None
        if mark and end and f"{mark.side}{end}" in number:
            found.append((marker, number[f"{mark.side}{end}"]))
    return tuple(found)


def _wanted(name: str, places: dict[str, Array]) -> bool:
    """Tell whether a joint moves anything that is seen."""
    side = next((side for side in SIDES if name.startswith(side)), "")
    rest = _NEEDED.get(name.removeprefix(side))
    return rest is None or f"{side}{rest}" in places


def _completed(places: dict[str, Array]) -> dict[str, Array]:
    """Return centres with those between them: of the lower spine, collar bones, skull."""
    result = dict(places)
    if "neck" in places:
        trunk = places["neck"] - places["hips"]
        result["lumbar"] = places["hips"] + PERSON.lumbar * trunk
        for side in SIDES:
            if f"{side}shoulder" in places:
                aside = places[f"{side}shoulder"] - places["neck"]
                result[f"{side}collar"] = places["neck"] + PERSON.collar * aside
        if "head" in places:
            result["skull"] = places["neck"] + PERSON.skull * (places["head"] - places["neck"])
    return result


def _frame(up: Array, left: Array) -> Array:
    """Return axes (F, 3, 3), as columns, of which Y is given and X near a direction."""
    y = unit(up)
    x = unit(left - np.sum(left * y, axis=1, keepdims=True) * y)
    return np.stack([x, y, np.cross(x, y)], axis=-1)


def _axes(names: list[str], places: dict[str, Array], centres: Centres) -> dict[str, Array]:
    """Return the axes (F, 3, 3) of every joint's bone."""
    found: dict[str, Array] = {}
    left = centres.left["Hips"]
    world = np.broadcast_to(np.array([0.0, 1.0, 0.0]), left.shape)
    upward = places["neck"] - places["hips"] if "neck" in places else world
    if centres.ahead_of_hips is None:
        found["Hips"] = _frame(upward, left)
    else:
        up = np.cross(centres.ahead_of_hips, left)
        found["Hips"] = _levelled(_frame(up, left), upward)
    if "Spine" in names:
        chest_left = centres.left.get("Spine", left)
        found["Spine"] = _frame(places["neck"] - places["lumbar"], chest_left)
    if "Head" in names:
        found["Neck"] = _frame(places["head"] - places["neck"], found["Spine"][..., 0])
        head_left = centres.left.get("Head", found["Spine"][..., 0])
        found["Head"] = _frame(found["Neck"][..., 1], head_left)
    for side in SIDES:
        _add_arm(found, names, places, centres, side)
        _add_leg(found, names, places, side)
    return found


def _levelled(axes: Array, upward: Array) -> Array:
    """Return axes turned about their X by a constant angle, so that Y is upward on average."""
    y, z = (np.sum(upward * axes[..., k], axis=1) for k in (1, 2))
    angle = float(np.arctan2(np.median(z), np.median(y)))
    return np.asarray(axes @ rot.to_matrix(rot.from_rotation_vector([angle, 0.0, 0.0])))


def _add_arm(
    found: dict[str, Array],
    names: list[str],
    places: dict[str, Array],
    centres: Centres,
    side: str,
) -> None:
    if f"{side}Arm" not in names:
        return
    chest, shoulder, elbow = found["Spine"], places[f"{side}shoulder"], places[f"{side}elbow"]
    found[f"{side}Shoulder"] = chest
    upper, axis = elbow - shoulder, chest[..., 0]
    if f"{side}ForeArm" in names:
        lower = places[f"{side}wrist"] - elbow
        axis = hinged(upper, lower, -1.0, axis)
        found[f"{side}Arm"] = _frame(-upper, axis)
        found[f"{side}ForeArm"] = _limb(-lower, found[f"{side}Arm"], centres, f"{side}ForeArm")
        bone = places.get(f"{side}hand")
        bone = -lower if bone is None else places[f"{side}wrist"] - bone
        found[f"{side}Hand"] = _limb(bone, found[f"{side}ForeArm"], centres, f"{side}Hand")
    else:
        found[f"{side}Arm"] = _frame(-upper, axis)


def _limb(up: Array, above: Array, centres: Centres, name: str) -> Array:
    """Return axes of a forearm or hand: its front as markers tell, else as that above."""
    ahead = centres.ahead.get(name)
    return _frame(up, above[..., 0] if ahead is None else np.cross(up, ahead))


def _add_leg(
    found: dict[str, Array], names: list[str], places: dict[str, Array], side: str
) -> None:
    if f"{side}UpLeg" not in names:
        return
    hip, knee = places[f"{side}hip"], places[f"{side}knee"]
    axis = found["Hips"][..., 0]
    if f"{side}Leg" not in names:
        found[f"{side}UpLeg"] = _frame(hip - knee, axis)
        return
    ankle = places[f"{side}ankle"]
    axis = hinged(knee - hip, ankle - knee, 1.0, axis)
    found[f"{side}UpLeg"] = _frame(hip - knee, axis)
    found[f"{side}Leg"] = shank = _frame(knee - ankle, axis)
    found[f"{side}Foot"] = shank
    if f"{side}toe" in places:
        toe = places[f"{side}toe"]
        ahead = toe - places.get(f"{side}heel", ankle)
        foot = _frame(np.cross(ahead, shank[..., 0]), shank[..., 0])
        low = toe[:, 1] <= np.quantile(toe[:, 1], PERSON.standing)
        up = np.array([0.0, 1.0, 0.0])
        y, z = (np.median(foot[low][..., k] @ up) for k in (1, 2))
        level = rot.from_rotation_vector([np.arctan2(z, y), 0.0, 0.0])
        found[f"{side}Foot"] = foot @ rot.to_matrix(level)


def _offsets(parents: tuple[int, ...], at: Array, axes: Array) -> Array:
    """Return offsets (J, 3): medians over the take."""
    offsets = np.zeros((len(parents), 3))
    for joint, parent in enumerate(parents[1:], 1):
        apart = at[:, joint] - at[:, parent]
        offsets[joint] = np.median(np.einsum("fik,fi->fk", axes[:, parent], apart), axis=0)
    return offsets


def _alike(offsets: Array, number: dict[str, int]) -> tuple[Array, tuple[tuple[int, int], ...]]:
    """Return offsets of which both sides are alike, and the pairs of joints for which they are.

    Sides that differ much, as with a prosthesis or a marker elsewhere, are left as they are.
    """
    result, pairs = offsets.copy(), []
    mirror = np.array([-1.0, 1.0, 1.0])
    for name, joint in number.items():
        other = number.get(name.replace("Left", "Right"), joint)
        lengths = np.linalg.norm(offsets[[joint, other]], axis=1)
        if other != joint and abs(lengths[0] - lengths[1]) < SHAPES.sides * lengths.mean():
            result[joint] = 0.5 * (offsets[joint] + mirror * offsets[other])
            result[other] = mirror * result[joint]
            pairs.append((joint, other))
    return result, tuple(pairs)


def attached(
    positions: Array, seen: Mask, carriers: list[int | None], at: Array, axes: Array
) -> tuple[NDArray[np.intp], NDArray[np.intp], Array]:
    """Return the points that are markers, their joints and places: medians over the take.

    Parameters
    ----------
    positions : (F, N, 3) ndarray
    seen : (F, N) ndarray of bool
    carriers : list of int or None
        The joint whose bone carries each point; a point without one goes where it moves least, if
        it moves little enough.
    at : (F, J, 3) ndarray
        Joints.
    axes : (F, J, 3, 3) ndarray
        Of their bones.
    """
    points, joints, places = [], [], []
    for point, carrier in enumerate(carriers):
        rows = seen[:, point]
        apart = positions[rows, point, None] - at[rows]
        own = np.einsum("fjik,fji->fjk", axes[rows], apart)
        middle = np.median(own, axis=0)
        loose = np.quantile(np.linalg.norm(own - middle, axis=2), SHAPES.often, axis=0)
        joint = int(np.argmin(loose)) if carrier is None else carrier
        if carrier is not None or loose[joint] <= SHAPES.loose:
            points.append(point)
            joints.append(joint)
            places.append(middle[joint])
    return np.array(points, np.intp), np.array(joints, np.intp), np.reshape(places, (-1, 3))


def _part(name: str) -> str:
    return name.removeprefix("Left").removeprefix("Right")


def _bend(name: str) -> tuple[float, ...]:
    bends = {
        "Spine": BENDS.spine,
        "Neck": BENDS.neck,
        "Head": BENDS.head,
        "Shoulder": BENDS.collar,
        "Arm": BENDS.shoulder,
        "ForeArm": BENDS.elbow,
        "Hand": BENDS.wrist,
        "UpLeg": BENDS.hip,
        "Leg": BENDS.knee,
        "Foot": BENDS.ankle,
    }
    return bends.get(_part(name), (np.inf, np.inf, np.inf))


def _one_way(name: str) -> float:
    return {"Leg": 1.0, "ForeArm": -1.0}.get(_part(name), 0.0)


def _offset_spread(name: str, keypoints: bool) -> tuple[float, float, float]:
    """Return how sure an offset is: across a limb's bone it is 0 by choice of the axes."""
    part = _part(name)
    if part in ("ForeArm", "Hand", "Leg", "Foot"):
        return SHAPES.fixed, SHAPES.bone, SHAPES.fixed
    if part == "UpLeg" and not keypoints:
        return SHAPES.hip, SHAPES.hip, SHAPES.hip
    return SHAPES.joint, SHAPES.joint, SHAPES.joint
