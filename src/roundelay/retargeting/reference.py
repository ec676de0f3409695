"""How the joints' own axes stand to the body they carry, whatever the pose at rest.

Every bone has an anatomical frame: along the bone and about the axis in which it bends, or as the
body stands, faces and has its left. What a joint's own axes are against that frame is constant and
is learned once: from a pose in which the body stands upright (at rest, or in which its meshes were
bound), or, where a file has none, from the mean over the frames of a motion.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import SkeletonMismatch
from roundelay.base.numeric import ROUNDING, TINY
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion
from roundelay.retargeting.anatomy import Anatomy, Limb
from roundelay.retargeting.thresholds import REFERENCE

__all__ = ["Reference", "Stand", "along", "from_axes", "reference_of", "upright"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Stand:
    """What a foot stands on.

    Attributes
    ----------
    joint : int
        The joint that carries the ball of the foot.
    offset : (3,) ndarray
        The ball, in that joint's axes.
    ankle, ball : float
        How high the ankle and the ball are when the foot stands flat.
    """

    joint: int
    offset: Array
    ankle: float
    ball: float


@dataclass(frozen=True, eq=False)
class Reference:
    """The anatomical frames of a skeleton.

    Attributes
    ----------
    frames : dict of int to (4,) ndarray
        The anatomical frame of each joint that has one, in the joint's own axes.
    still : (J, 4) ndarray
        Local rotations of a usual pose, for joints that have none.
    up : {0, 1, 2} or None
        The axis that points up in the pose at rest; None where that tells nothing.
    lift : (4,) ndarray
        What turns the root so that the pose stands upright.
    stands : tuple of Stand
        Of the legs.
    """

    frames: dict[int, Array]
    still: Array
    up: int | None
    lift: Array
    stands: tuple[Stand, ...]


def reference_of(anatomy: Anatomy, motion: Motion | None = None) -> Reference:
    """Learn how a skeleton's joints stand to its body.

    Parameters
    ----------
    anatomy : Anatomy
    motion : Motion, optional
        Of this skeleton; asked where no pose at rest is upright.

    Raises
    ------
    SkeletonMismatch
        If no pose at rest is upright, and there is no motion to learn from; the message says what
        is wrong with the pose.
    """
    faults = []
    for pose in _poses(anatomy.skeleton, motion):
        up, fault = upright(anatomy, pose)
        if up is not None:
            return _of_pose(anatomy, pose, up, motion)
        faults.append(fault)
    if motion is None or len(motion) < REFERENCE.fewest:
        told = f"expected a pose at rest in which the body stands, found one in which {faults[0]}"
        raise SkeletonMismatch(f"{told}; give a motion of the character to learn it from")
    return _of_motion(anatomy, motion)


def _poses(skeleton: Skeleton, motion: Motion | None) -> Iterator[Array]:
    """Yield local rotations (J, 4) of poses that may be upright."""
    bound = _bound_pose(skeleton)
    if bound is not None:
        yield bound
    if skeleton.rest is not None:
        yield skeleton.rest
    yield rot.identity(skeleton.n_joints)
    if motion is not None and len(motion) < REFERENCE.fewest:
        yield motion.rotations[0]


def _bound_pose(skeleton: Skeleton) -> Array | None:
    """Return the pose (J, 4) in which meshes were bound to their joints; None without meshes."""
    turns: dict[str, Array] = {}
    for mesh in skeleton.figure.meshes if skeleton.figure else ():
        for bone, bind in zip(mesh.bones, mesh.binds, strict=True):
            left, sizes, right = np.linalg.svd(np.linalg.pinv(bind[:, :3][:3]))
            if sizes.min() > 0.0 and np.linalg.det(left @ right) > 0.0:
                turns.setdefault(bone, rot.from_matrix(left @ right))
    if not turns:
        return None
    local = skeleton.rest if skeleton.rest is not None else rot.identity(skeleton.n_joints)
    local = local.copy()
    whole = local.copy()
    for joint, parent in enumerate(skeleton.parents):
        above = rot.identity() if parent < 0 else whole[parent]
        whole[joint] = turns.get(skeleton.names[joint], rot.multiply(above, local[joint]))
        local[joint] = rot.multiply(rot.conjugate(above), whole[joint])
    return local


def upright(anatomy: Anatomy, pose: Array) -> tuple[Array | None, str]:
    """Tell whether a body stands upright in a pose.

    Parameters
    ----------
    anatomy : Anatomy
    pose : (J, 4) ndarray
        Local rotations.

    Returns
    -------
    up : (3,) ndarray or None
        The direction that is up; None where it does not stand.
    fault : str
        What is wrong then.
    """
    places = forward_kinematics(anatomy.skeleton, pose[None])[0][0]
    hips, shoulders = places[list(anatomy.hips)], places[list(anatomy.shoulders)]
    across = _unit(hips[0] - hips[1])
    trunk = _unit(shoulders.mean(axis=0) - hips.mean(axis=0))
    feet = places[[_end(limb) for limb in anatomy.legs]].mean(axis=0)
    if anatomy.body.kind == "biped":
        up = _snapped(_unit(hips.mean(axis=0) - feet))
        if trunk @ up < REFERENCE.erect:
            return None, "the trunk is not above the legs"
    else:
        up = _snapped(_unit(np.cross(trunk, across)))
        if abs(trunk @ up) > REFERENCE.level:
            return None, "the trunk is not level"
    if abs(across @ up) > REFERENCE.askew:
        return None, "one hip is above the other"
    for limb in anatomy.legs:
        top, knee, end = places[[limb.upper[0], limb.lower[0], _end(limb)]]
        if min(_unit(top - knee) @ up, _unit(knee - end) @ up) < REFERENCE.straight:
            return None, f"the {limb.name} does not reach down"
    for limb in anatomy.arms:
        top, elbow, end = places[[limb.upper[0], limb.lower[0], _end(limb)]]
        if _unit(elbow - top) @ _unit(end - elbow) < REFERENCE.folded:
            return None, f"the {limb.name} is folded"
    return up, ""


def _end(limb: Limb) -> int:
    return limb.lower[-1] if limb.end is None else limb.end


def _unit(vector: Array) -> Array:
    return np.asarray(vector / max(float(np.linalg.norm(vector)), TINY))


def _snapped(direction: Array) -> Array:
    """Return the axis that a direction is nearest to, if it is near."""
    axis = int(np.argmax(np.abs(direction)))
    near = np.sign(direction[axis]) * np.eye(3)[axis]
    return np.asarray(near if near @ direction > REFERENCE.axis else direction)


def _of_pose(anatomy: Anatomy, pose: Array, up: Array, motion: Motion | None) -> Reference:
    """Learn from one pose; of feet that are not flat in it from the motion."""
    axis = int(np.argmax(np.abs(up)))
    lift = _shortest(up, np.eye(3)[axis])
    places, turns = forward_kinematics(anatomy.skeleton, pose[None])
    frames = {
        joint: rot.multiply(rot.conjugate(turns[0, joint]), frame[0])
        for joint, (frame, weight) in _framed(anatomy, places, turns, up, bent=False).items()
        if weight[0] > 0.0
    }
    if motion is not None and len(motion) >= REFERENCE.fewest:
        frames |= _bending(anatomy, motion, frames)
    learned = None
    for limb in anatomy.legs:
        if limb.end is not None and limb.end not in frames:
            if learned is None and motion is not None and len(motion) >= REFERENCE.fewest:
                learned = _of_motion(anatomy, motion)
            frames |= _foot_frames(anatomy, limb, learned, turns[0], places[0], up)
    still = pose.copy()
    still[0] = rot.multiply(lift, still[0])
    stands = tuple(_stand(anatomy, limb, frames, still) for limb in anatomy.legs)
    return Reference(frames, still, axis, lift, stands)


def _bending(anatomy: Anatomy, motion: Motion, frames: dict[int, Array]) -> dict[int, Array]:
    """Return frames of arms and legs that clearly bend about another axis than at rest."""
    _, places, turns = _few_frames(motion)
    found = {}
    for limb in anatomy.limbs:
        end = _lower_end(anatomy, limb, places, turns)
        upper = _units(places[:, limb.lower[0]] - places[:, limb.upper[0]])
        lower = _units(end - places[:, limb.lower[0]])
        across = np.cross(upper, lower)
        clear = np.maximum(np.linalg.norm(across, axis=1) - REFERENCE.clearly_bent, 0.0)
        if np.mean(clear > 0.0) < REFERENCE.often:
            continue
        for joint, bone in [*((j, upper) for j in limb.upper), *((j, lower) for j in limb.lower)]:
            own = _mean_of(turns[:, joint], along(bone, across), clear)
            usual = rot.angle_between(own, frames[joint])
            if usual > np.radians(REFERENCE.other_axis):
                found[joint] = own
    return found


def _foot_frames(
    anatomy: Anatomy, limb: Limb, learned: Reference | None, turns: Array, places: Array, up: Array
) -> dict[int, Array]:
    """Return the frames of a foot that is not flat at rest: learned, or by a usual pitch."""
    joints = [joint for joint in (limb.end, limb.tip) if joint is not None]
    if learned is not None:
        return {joint: learned.frames[joint] for joint in joints}
    whole = _standing(anatomy, places[None], up)[0]
    ahead = rot.rotate(whole, np.array([0.0, 0.0, 1.0]))
    bone = _unit(rot.rotate(turns[joints[0]], _ball(anatomy, limb)[2]))
    pitch = np.radians(REFERENCE.pitch)
    flat = _shortest(bone, np.cos(pitch) * ahead - np.sin(pitch) * up)
    return {
        joint: rot.multiply(rot.conjugate(rot.multiply(flat, turns[joint])), whole)
        for joint in joints
    }


def _of_motion(anatomy: Anatomy, motion: Motion) -> Reference:
    """Learn from the mean over the frames of a motion; the trunk from a straight one at rest."""
    part, places, turns = _few_frames(motion)
    frames = {}
    framed = _framed(anatomy, places, turns, motion.up_vector, bent=True)
    for joint, (frame, weight) in framed.items():
        frames[joint] = _mean_of(turns[:, joint], frame, weight)
    trunk = _straight_trunk(anatomy)
    if trunk is not None:
        frames |= _trunk_frames(anatomy, trunk, frames)
        chest = anatomy.spine[-1] if anatomy.spine else anatomy.pelvis[-1]
        facing = rot.multiply(turns[:, chest], frames[chest])
        for limb in anatomy.limbs:
            if limb.girdle is not None:
                frames[limb.girdle] = _mean_of(turns[:, limb.girdle], facing, np.ones(len(part)))
    still = rot.mean(part.rotations)
    stands = tuple(_stand(anatomy, limb, frames, still) for limb in anatomy.legs)
    return Reference(frames, still, None, rot.identity(), stands)


def _few_frames(motion: Motion) -> tuple[Motion, Array, Array]:
    """Return some frames of a motion, with places and turns of the joints in them."""
    few = np.unique(np.linspace(0, len(motion) - 1, REFERENCE.frames).round().astype(int))
    part = motion.at(few)
    moved = forward_kinematics(
        part.skeleton, part.rotations, part.root_path, translations=part.translations
    )
    return part, *moved


def _mean_of(turns: Array, frame: Array, weight: Array) -> Array:
    """Return the mean (4,) of frames (F, 4) in a joint's own axes."""
    own = rot.multiply(rot.conjugate(turns), frame)
    return rot.mean(own, weight if weight.sum() > 0.0 else None)


def _straight_trunk(anatomy: Anatomy) -> Array | None:
    """Return the frame (4,) of a trunk that is straight where no joint is turned; else None.

    Some programs lay all bones along one axis: the trunk is upright then, though no limb is.
    """
    still = rot.identity(1, anatomy.skeleton.n_joints)
    places = forward_kinematics(anatomy.skeleton, still)[0][0]
    hips, shoulders = places[list(anatomy.hips)], places[list(anatomy.shoulders)]
    across = _unit(hips[0] - hips[1])
    up = _snapped(_unit(shoulders.mean(axis=0) - hips.mean(axis=0)))
    chain = places[[anatomy.carrier, *anatomy.spine, *anatomy.neck]]
    bones = np.diff(chain, axis=0)
    long = np.linalg.norm(bones, axis=1) > REFERENCE.least * anatomy.skeleton.size
    if abs(across @ up) > REFERENCE.askew or not np.all(_units(bones[long]) @ up > REFERENCE.erect):
        return None
    return _standing(anatomy, places[None], up)[0]


def _framed(
    anatomy: Anatomy, places: Array, turns: Array, up: Array, *, bent: bool
) -> dict[int, tuple[Array, Array]]:
    """Return the anatomical frame (F, 4) of every joint that has one, with weights (F,)."""
    whole = _standing(anatomy, places, up)
    erect = _erect(anatomy, places, up) if bent else np.ones(len(places))
    trunk = (*anatomy.pelvis, *anatomy.spine, *anatomy.neck, *anatomy.tail)
    found = dict.fromkeys(trunk, (whole, erect))
    for limb in anatomy.limbs:
        if limb.girdle is not None:
            found[limb.girdle] = (whole, erect)
        found |= _limb_frames(anatomy, limb, places, turns, whole, bent=bent)
    for limb in anatomy.legs:
        if limb.end is not None:
            found |= _flat_frames(anatomy, limb, places, turns, up, whole, bent=bent)
    return found


def _trunk_frames(anatomy: Anatomy, trunk: Array, means: dict[int, Array]) -> dict[int, Array]:
    """Return the frames of a trunk that is straight where no joint is turned.

    Bones along one axis do not tell how joints are twisted about it: the mean over a motion does,
    to a quarter of a turn against the joint below, as programs lay axes.
    """
    found, up = {}, rot.rotate(trunk, np.array([0.0, 1.0, 0.0]))
    twisted, below = 0.0, 0.0
    for number, joint in enumerate((*anatomy.pelvis, *anatomy.spine, *anatomy.neck)):
        part = rot.twist(rot.multiply(means[joint], rot.conjugate(trunk)), up)
        angle = 2.0 * np.arctan2(part[1:] @ up, part[0])
        if number:
            twisted += 0.5 * np.pi * np.round((angle - below) / (0.5 * np.pi))
        below = angle
        found[joint] = rot.multiply(rot.from_rotation_vector(twisted * up), trunk)
    return found


def _standing(anatomy: Anatomy, places: Array, up: Array) -> Array:
    """Return the rotations (F, 4) from X left, Y up, Z ahead to how a body stands in the world."""
    left, right = anatomy.hips
    across = places[:, left] - places[:, right]
    across = across - (across @ up)[:, None] * up
    across = _units(across)
    return from_axes(across, np.broadcast_to(up, across.shape))


def from_axes(first: Array, second: Array) -> Array:
    """Return rotations (..., 4) to unit axes (..., 3) that are square to each other."""
    third = np.cross(first, second)
    return rot.from_matrix(np.stack([first, second, third], axis=-1))


def along(direction: Array, about: Array) -> Array:
    """Return rotations (F, 4) whose X is a direction and whose Y is as near to an axis as can be.

    Parameters
    ----------
    direction, about : (F, 3) ndarray
        Directions of a bone, and axes about which it bends.
    """
    first = _units(direction)
    second = about - np.sum(about * first, axis=-1, keepdims=True) * first
    return from_axes(first, _units(second))


def _units(vectors: Array) -> Array:
    sizes = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.maximum(sizes, TINY))


def _erect(anatomy: Anatomy, places: Array, up: Array) -> Array:
    """Return weights (F,): 1 where the trunk is upright (of a quadruped level), 0 far from it."""
    trunk = _units(
        places[:, list(anatomy.shoulders)].mean(axis=1) - places[:, list(anatomy.hips)].mean(axis=1)
    )
    upward = trunk @ up
    share = upward if anatomy.body.kind == "biped" else np.sqrt(np.maximum(1.0 - upward**2, 0.0))
    weights = np.clip((share - np.quantile(share, 0.5)) * 4.0 + 0.5, 0.0, 1.0)
    return np.asarray(weights)


def _limb_frames(
    anatomy: Anatomy, limb: Limb, places: Array, turns: Array, whole: Array, *, bent: bool
) -> dict[int, tuple[Array, Array]]:
    top, elbow = places[:, limb.upper[0]], places[:, limb.lower[0]]
    upper, lower = elbow - top, _lower_end(anatomy, limb, places, turns) - elbow
    about = _usual_axes(limb, upper, whole, anatomy.body.kind == "quadruped")
    weight = np.ones(len(places))
    if bent:
        across = np.cross(_units(upper), _units(lower))
        sine = np.linalg.norm(across, axis=1)
        clear = np.maximum(sine - REFERENCE.bent, 0.0)
        if clear.sum() > 0.0:
            about, weight = across, clear**2
    one, two = along(upper, about), along(lower, about)
    found = dict.fromkeys(limb.upper, (one, weight)) | dict.fromkeys(limb.lower, (two, weight))
    if limb.end is not None and limb not in anatomy.legs:
        found[limb.end] = (_hand_frames(anatomy, limb, turns, two), weight)
    return found


def _usual_axes(limb: Limb, upper: Array, whole: Array, quadruped: bool) -> Array:
    """Return the axes (F, 3) about which limbs bend: knees backwards, elbows forwards."""
    left, ahead = (rot.rotate(whole, axis) for axis in np.eye(3)[[0, 2]])
    if limb.is_leg:
        return left
    return -left if quadruped else np.cross(_units(upper), ahead)


def _lower_end(anatomy: Anatomy, limb: Limb, places: Array, turns: Array) -> Array:
    if limb.end is not None:
        return places[:, limb.end]
    last = limb.lower[-1]
    tip = anatomy.tip_of(last)
    if tip is None:
        return places[:, last] + places[:, last] - places[:, limb.upper[0]]
    return places[:, last] + rot.rotate(turns[:, last], tip)


def _hand_frames(anatomy: Anatomy, limb: Limb, turns: Array, lower: Array) -> Array:
    """Return the frames (F, 4) of a hand: in line with the forearm, unless it is clearly not."""
    assert limb.end is not None
    tip = anatomy.tip_of(limb.end)
    if tip is None:
        return lower
    fingers = _units(rot.rotate(turns[:, limb.end], tip))
    forearm, axis = (rot.rotate(lower, one) for one in np.eye(3)[:2])
    in_line = np.sum(fingers * forearm, axis=1) > REFERENCE.in_line
    return np.asarray(np.where(in_line[:, None], lower, along(fingers, axis)))


def _ball(anatomy: Anatomy, limb: Limb) -> tuple[int, Array, Array]:
    """Return the joint and place of a foot's ball, and the way there from the ankle's axes."""
    assert limb.end is not None
    if limb.tip is not None:
        return limb.tip, np.zeros(3), anatomy.skeleton.offsets[limb.tip]
    tip = anatomy.tip_of(limb.end)
    place = np.zeros(3) if tip is None else tip
    return limb.end, place, place


def _flat_frames(
    anatomy: Anatomy,
    limb: Limb,
    places: Array,
    turns: Array,
    up: Array,
    whole: Array,
    *,
    bent: bool,
) -> dict[int, tuple[Array, Array]]:
    """Return the frames of a foot and its toes as they are when the foot stands flat."""
    assert limb.end is not None
    joint, offset, way = _ball(anatomy, limb)
    ball = places[:, joint] + rot.rotate(turns[:, joint], offset)
    bone = ball - places[:, limb.end]
    ahead = rot.rotate(whole, np.array([0.0, 0.0, 1.0]))
    level = bone - (bone @ up)[:, None] * up
    size = np.linalg.norm(way)
    if size < REFERENCE.least * anatomy.skeleton.size:
        level, weight = ahead, np.ones(len(places))
    else:
        flat = np.linalg.norm(level, axis=1) > REFERENCE.flat * size
        weight = (flat & (np.sum(_units(level) * ahead, axis=1) > REFERENCE.ahead)).astype(float)
    if bent:
        height = (places[:, limb.end] + ball) @ up
        low = height <= np.quantile(height, REFERENCE.low)
        weight = weight * low if np.any(weight * low) else low.astype(float)
    front = _units(level)
    frame = from_axes(np.cross(np.broadcast_to(up, front.shape), front),
                      np.broadcast_to(up, front.shape))  # fmt: skip
    found = {limb.end: (frame, weight)}
    return found if limb.tip is None else found | {limb.tip: (frame, weight)}


def _stand(anatomy: Anatomy, limb: Limb, frames: dict[int, Array], still: Array) -> Stand:
    """Measure a foot as it stands flat, in the axes of the ankle."""
    end = limb.lower[-1] if limb.end is None else limb.end
    joint, offset, _ = (end, np.zeros(3), None) if limb.end is None else _ball(anatomy, limb)
    up = rot.rotate(frames[end], np.array([0.0, 1.0, 0.0]))
    pose = still.copy()
    pose[0] = rot.identity()
    places, turns = forward_kinematics(anatomy.skeleton, pose[None])
    inside = set(anatomy.skeleton.descendants(end))
    back = rot.conjugate(turns[0, end])

    def height(on: int, place: Array) -> float:
        apart = places[0, on] + rot.rotate(turns[0, on], place) - places[0, end]
        return float(rot.rotate(back, apart) @ up)

    points = [height(on, place) for on, place in anatomy.ground() if on in inside]
    points += _soles(anatomy, inside, height)
    ankle = max(0.0, -min(points, default=0.0))
    return Stand(joint, offset, ankle, ankle + height(joint, offset))


def _soles(anatomy: Anatomy, inside: set[int], height: object) -> list[float]:
    """Return how high the lowest points of meshes on a foot are against its ankle."""
    figure, names = anatomy.skeleton.figure, anatomy.skeleton.names
    lowest = []
    for mesh in figure.meshes if figure else ():
        main = mesh.joints[np.arange(len(mesh.joints)), mesh.weights.argmax(axis=1)]
        for number, bone in enumerate(mesh.bones):
            joint = names.index(bone) if bone in names else -1
            own = mesh.points[main == number]
            if joint in inside and len(own):
                bind = mesh.binds[number]
                local = own @ bind[:3, :3].T + bind[:3, 3]
                lowest.append(min(height(joint, place) for place in local))  # type: ignore[operator]
    return lowest


def _shortest(source: Array, target: Array) -> Array:
    """Return the least rotation (4,) from a unit vector to another."""
    cosine = float(source @ target)
    if cosine < -1.0 + ROUNDING:
        other = np.eye(3)[int(np.argmin(np.abs(source)))]
        return rot.from_rotation_vector(np.pi * _unit(np.cross(source, other)))
    return rot.normalize(np.array([1.0 + cosine, *np.cross(source, target)]))
