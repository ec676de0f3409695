"""How alike a motion and what was made of it on another body are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from roundelay.base.spans import Spans
from roundelay.geometry import rotations as rot
from roundelay.geometry.contacts import contacts
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.retargeting.anatomy import Anatomy
from roundelay.retargeting.reference import Reference

Array = NDArray[np.float64]

# Centimetres of a leg, by which lengths are told, and body sizes of one.
LEG, SIZES = 90.0, 2.14
# Degrees from frame to frame: a joint that turns more has flipped, if none did before.
FLIP, STEADY = 60.0, 30.0
# Degrees by which a knee or an elbow bends backwards.
BACK = 5.0


@dataclass(frozen=True)
class Shown:
    """A motion as it is compared: Y up, lengths in legs, from the middle of the hips."""

    ends: dict[str, Array]
    roots: dict[str, Array]
    lengths: dict[str, float]
    angles: dict[str, Array]
    bends: dict[str, Array]
    facing: Array
    balls: Array
    soles: Array
    standing: NDArray[np.bool_]
    level: float
    steps: Array


def shown(motion: rl.Motion, anatomy: Anatomy, reference: Reference) -> Shown:
    """Take a motion apart."""
    places, turns = forward_kinematics(
        motion.skeleton, motion.rotations, motion.root_path, translations=motion.translations
    )
    to_y = rot.axis_to_y(motion.up)
    places, turns = rot.rotate(to_y, places) / anatomy.leg_length, rot.multiply(to_y, turns)
    hips = places[:, list(anatomy.hips)].mean(axis=1)
    ends, roots, lengths, angles, bends = {}, {}, {}, {}, {}
    for limb in anatomy.limbs:
        if limb.end is None:
            continue
        top, middle, end = (places[:, j] for j in (limb.upper[0], limb.lower[0], limb.end))
        ends[limb.name], roots[limb.name] = end - hips, top - hips
        lengths[limb.name] = anatomy.length(limb) / anatomy.leg_length
        one, two = _units(middle - top), _units(end - middle)
        angles[limb.name] = np.degrees(np.arccos(np.clip(np.sum(one * two, axis=1), -1.0, 1.0)))
        frame = reference.frames[limb.upper[-1]]
        axis = rot.rotate(rot.multiply(turns[:, limb.upper[-1]], frame), np.array([0.0, 1.0, 0.0]))
        across = np.sum(np.cross(one, two) * axis, axis=1)
        bends[limb.name] = np.degrees(np.arctan2(across, np.sum(one * two, axis=1)))
    if anatomy.neck:
        ends["head"] = places[:, anatomy.neck[-1]] - hips
        roots["head"] = np.zeros_like(hips)
        lengths["head"] = float(np.median(np.linalg.norm(ends["head"], axis=1)))
    across = places[:, anatomy.hips[0]] - places[:, anatomy.hips[1]]
    stands, legs = reference.stands, anatomy.legs
    balls = np.stack(
        [places[:, s.joint] + rot.rotate(turns[:, s.joint], s.offset) / anatomy.leg_length
         for s in stands], axis=1)  # fmt: skip
    heights = balls[:, :, 1] - np.array([s.ball for s in stands]) / anatomy.leg_length
    heels = []
    for limb, stand in zip(legs, stands, strict=True):
        end = limb.lower[-1] if limb.end is None else limb.end
        up = rot.rotate(rot.multiply(turns[:, end], reference.frames[end]), np.eye(3)[1])
        heels.append(places[:, end, 1] - up[:, 1] * stand.ankle / anatomy.leg_length)
    standing = contacts(balls, fps=motion.fps, size=SIZES, up=1)
    level = np.median(heights[standing]) if standing.any() else np.quantile(heights, 0.05)
    steps = np.degrees(rot.angle_between(turns[1:], turns[:-1]))
    joints = sorted(set(anatomy.at.values()))
    return Shown(
        ends, roots, lengths, angles, bends,
        np.arctan2(-across[:, 2], across[:, 0]),
        balls, np.minimum(heights, np.stack(heels, axis=1)), standing, float(level),
        steps[:, joints].max(axis=1, initial=0.0),
    )  # fmt: skip


def _units(vectors: Array) -> Array:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12))


def compared(source: Shown, target: Shown) -> dict[str, float]:
    """Return how far a motion on another body is from what it was.

    ``limb_ends``: RMS of wrists, ankles and head against the hips, in leg lengths;
    ``limb_ends_own``: each against where its limb begins, in its own length; ``angles``: RMS of
    knees and elbows, and ``angles_95`` their 95 %, degrees; ``facing``: the largest, degrees;
    ``contacts``, ``kept``: frames in which a foot stood, and still does; ``slip``: how much farther
    a standing foot strays from its mean, and ``depth`` how much deeper a sole lies below the
    ground, centimetres of a leg of 90; ``flips`` and ``backward``: frames of joints that jump, or
    bend the wrong way, though they did not.
    """
    both = [name for name in source.ends if name in target.ends]
    limbs = [name for name in source.angles if name in target.angles]
    apart = [np.mean(np.sum((source.ends[k] - target.ends[k]) ** 2, axis=1)) for k in both]
    own = [np.mean(np.sum((_own(source, k) - _own(target, k)) ** 2, axis=1)) for k in both]
    angles = np.concatenate([source.angles[k] - target.angles[k] for k in limbs])
    turned = (source.facing - target.facing + np.pi) % (2 * np.pi) - np.pi
    stood = source.standing
    backward = [np.sum((target.bends[k] < -BACK) & (source.bends[k] > -BACK)) for k in limbs]
    return {
        "frames": len(turned),
        "limb_ends": float(np.sqrt(np.mean(apart))),
        "limb_ends_own": float(np.sqrt(np.mean(own))),
        "angles": float(np.sqrt(np.mean(angles**2))),
        "angles_95": float(np.quantile(np.abs(angles), 0.95)),
        "facing": float(np.degrees(np.abs(turned).max())),
        "contacts": int(stood.sum()),
        "kept": int((stood & target.standing).sum()),
        "slip": _slip(source, target),
        "depth": _depth(source, target),
        "flips": int(np.sum((target.steps > FLIP) & (source.steps < STEADY))),
        "backward": int(sum(backward)),
    }


def _own(one: Shown, name: str) -> Array:
    return (one.ends[name] - one.roots[name]) / one.lengths[name]


def _slip(source: Shown, target: Shown) -> float:
    more = [0.0]
    for foot in range(source.standing.shape[1]):
        for start, stop in Spans.of_mask(source.standing[:, foot]):
            strayed = []
            for one in (source, target):
                level = one.balls[start:stop, foot][:, [0, 2]]
                strayed.append(float(np.linalg.norm(level - level.mean(axis=0), axis=1).max()))
            more.append(LEG * (strayed[1] - strayed[0]))
    return max(more)


def _depth(source: Shown, target: Shown) -> float:
    """Return how much deeper a sole is below the ground than it was."""
    deep = [np.maximum(one.level - one.soles, 0.0).max(axis=1) for one in (source, target)]
    return float(LEG * np.maximum(deep[1] - deep[0], 0.0).max())
