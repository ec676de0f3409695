"""Made takes of markers and keypoints with truth: a walk whose feet stand, seen in two ways."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay import synth
from roundelay.base.spans import Spans
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.motion.motion import Motion
from roundelay.motion.points import Points
from roundelay.solving import Solution

Array = NDArray[np.float64]

THIGH, SHANK, ANKLE = 0.42, 0.40, 0.06
# Share of a stride in which a foot stands, and metres a stride.
STANCE, STRIDE = 0.62, 1.0


@dataclass(frozen=True, eq=False)
class Take:
    """Points, the motion they were made of, and when each foot stands, (F, 2) left and right."""

    points: Points
    motion: Motion
    standing: NDArray[np.bool_]


def standing_walk(
    *, strides: float = 4.0, period: float = 1.1, fps: float = 30.0, seed: int = 0
) -> tuple[Motion, NDArray[np.bool_]]:
    """A walk of `synth.humanoid` in metres whose feet stand still while they stand."""
    made = synth.gait("walk", repetitions=strides, period=period, fps=fps, rng=seed)
    skeleton, phase = made.motion.skeleton, made.phase
    rotations, path = made.motion.rotations.copy(), made.motion.root_path.copy()
    path[:, 1] = 0.85 + 0.01 * np.cos(4 * np.pi * phase)
    path[:, 2] = STRIDE * phase
    placed = Motion(skeleton, rotations, path, made.motion.frame_time)
    joints, turns = forward_kinematics(skeleton, placed.rotations, placed.root_path)
    standing = np.zeros((len(phase), 2), bool)
    for side, name in enumerate(("Left", "Right")):
        ankle, pitch, standing[:, side] = _foot(phase + 0.5 * side)
        hip = skeleton.index(f"{name}UpLeg")
        ankle[:, 0] = joints[:, hip, 0].mean()
        ankle[:, 2] -= 0.5 * side * STRIDE
        thigh, shank = _leg(ankle - joints[:, hip])
        world = [
            rot.from_rotation_vector(a[:, None] * [1.0, 0.0, 0.0]) for a in (thigh, shank, pitch)
        ]
        above = turns[:, 0]
        for joint, turn in zip((hip, hip + 1, hip + 2), world, strict=True):
            rotations[:, joint] = rot.multiply(rot.conjugate(above), turn)
            above = turn
        elbow = -0.4 - 0.2 * np.sin(2 * np.pi * (phase + 0.5 * side))
        bent = rot.from_rotation_vector(elbow[:, None] * [1.0, 0.0, 0.0])
        rotations[:, skeleton.index(f"{name}ForeArm")] = bent
    return Motion(skeleton, rotations, path, made.motion.frame_time, name="walk"), standing


def _foot(phase: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Where an ankle is (F, 3), the pitch of its foot, and whether the foot stands."""
    number, part = np.floor(phase), phase - np.floor(phase)
    swing = np.clip((part - STANCE) / (1.0 - STANCE), 0.0, 1.0)
    ease = swing**3 * (10 - 15 * swing + 6 * swing**2)
    ankle = np.zeros((len(phase), 3))
    # The foot is ahead when it comes down, and behind when it goes up, by half a stance.
    ankle[:, 2] = STRIDE * (number + ease + 0.5 * STANCE)
    ankle[:, 1] = ANKLE + 0.1 * np.sin(np.pi * swing) ** 2
    return ankle, 0.35 * np.sin(np.pi * swing) ** 2, part < STANCE


def _leg(way: Array) -> tuple[Array, Array]:
    """Turns about X of thigh and shank that bring an ankle where it shall be; the knee ahead."""
    reach = np.minimum(np.linalg.norm(way, axis=1), 0.999 * (THIGH + SHANK))
    ahead = np.arctan2(way[:, 2], -way[:, 1])
    inner = np.arccos((THIGH**2 + reach**2 - SHANK**2) / (2 * THIGH * reach))
    knee = np.pi - np.arccos((THIGH**2 + SHANK**2 - reach**2) / (2 * THIGH * SHANK))
    thigh = -(ahead + inner)
    return thigh, thigh + knee


# MediaPipe's 33 keypoints: the joint of `synth.humanoid` that carries each, and where.
_FACE = {
    "nose": (0.0, 0.08, 0.11),
    "left_eye_inner": (0.015, 0.11, 0.09),
    "left_eye": (0.03, 0.11, 0.09),
    "left_eye_outer": (0.045, 0.11, 0.08),
    "right_eye_inner": (-0.015, 0.11, 0.09),
    "right_eye": (-0.03, 0.11, 0.09),
    "right_eye_outer": (-0.045, 0.11, 0.08),
    "left_ear": (0.075, 0.09, 0.0),
    "right_ear": (-0.075, 0.09, 0.0),
    "mouth_left": (0.025, 0.04, 0.09),
    "mouth_right": (-0.025, 0.04, 0.09),
}
_LIMBS = {
    "shoulder": ("Arm", (0.0, 0.0, 0.0)),
    "elbow": ("ForeArm", (0.0, 0.0, 0.0)),
    "wrist": ("Hand", (0.0, 0.0, 0.0)),
    "pinky": ("Hand", (0.0, -0.08, -0.04)),
    "index": ("Hand", (0.0, -0.09, 0.03)),
    "thumb": ("Hand", (0.0, -0.05, 0.05)),
    "hip": ("UpLeg", (0.0, 0.0, 0.0)),
    "knee": ("Leg", (0.0, 0.0, 0.0)),
    "ankle": ("Foot", (0.0, 0.0, 0.0)),
    "heel": ("Foot", (0.0, -0.05, -0.05)),
    "foot_index": ("Foot", (0.0, -0.06, 0.17)),
}
# Plug-in Gait: the joint that carries each marker, and where (left side; X turns over).
_CENTRAL = {
    "SACR": ("Hips", (0.0, 0.05, -0.11)),
    "C7": ("Chest", (0.0, 0.22, -0.07)),
    "T10": ("Spine", (0.0, 0.17, -0.11)),
    "CLAV": ("Chest", (0.0, 0.16, 0.08)),
    "STRN": ("Chest", (0.0, 0.02, 0.12)),
}
_SIDED = {
    "FHD": ("Head", (0.07, 0.12, 0.08)),
    "BHD": ("Head", (0.07, 0.12, -0.08)),
    "SHO": ("Shoulder", (0.13, 0.065, 0.0)),
    "UPA": ("Arm", (0.05, -0.14, 0.01)),
    "ELB": ("Arm", (0.045, -0.28, 0.0)),
    "FRM": ("ForeArm", (0.04, -0.12, 0.02)),
    "WRA": ("ForeArm", (0.0, -0.25, 0.04)),
    "WRB": ("ForeArm", (0.0, -0.25, -0.04)),
    "FIN": ("Hand", (0.02, -0.09, 0.01)),
    "ASI": ("Hips", (0.12, 0.044, 0.07)),
    "THI": ("UpLeg", (0.09, -0.22, 0.03)),
    "KNE": ("UpLeg", (0.055, -0.42, 0.0)),
    "TIB": ("Leg", (0.06, -0.2, 0.03)),
    "ANK": ("Leg", (0.042, -0.4, 0.0)),
    "HEE": ("Foot", (0.0, -0.03, -0.06)),
    "TOE": ("Foot", (0.0, -0.04, 0.13)),
}


def keypoints(motion: Motion) -> tuple[tuple[str, ...], Array]:
    """Names and places (F, 33, 3) of MediaPipe's keypoints of a motion of `synth.humanoid`."""
    rows = {name: ("Head", place) for name, place in _FACE.items()}
    for side in ("Left", "Right"):
        for name, (joint, place) in _LIMBS.items():
            rows[f"{side.lower()}_{name}"] = (f"{side}{joint}", place)
    return _carried(motion, rows)


def markers(motion: Motion) -> tuple[tuple[str, ...], Array]:
    """Names and places (F, 37, 3) of Plug-in Gait's markers of a motion of `synth.humanoid`."""
    rows = dict(_CENTRAL)
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        for name, (joint, (x, y, z)) in _SIDED.items():
            carrier = joint if joint in ("Hips", "Head") else f"{side}{joint}"
            rows[f"{side[0]}{name}"] = (carrier, (sign * x, y, z))
    return _carried(motion, rows)


def _carried(
    motion: Motion, rows: dict[str, tuple[str, tuple[float, float, float]]]
) -> tuple[tuple[str, ...], Array]:
    places, turns = forward_kinematics(motion.skeleton, motion.rotations, motion.root_path)
    joints = motion.skeleton.indices(joint for joint, _ in rows.values())
    offsets = np.array([place for _, place in rows.values()])
    return tuple(rows), places[:, joints] + rot.rotate(turns[:, joints], offsets)


def with_gaps(points: Points, share: float, rng: np.random.Generator) -> Points:
    """Points of which stretches of a tenth to half a second were not seen."""
    missing = np.zeros((len(points), len(points.names)), bool)
    for column in missing.T:
        while column.mean() < share:
            length = max(1, round(rng.uniform(0.1, 0.5) * points.fps))
            start = int(rng.integers(0, len(points)))
            column[start : start + length] = True
    return Points(points.names, points.positions, points.fps, missing, units=points.units)


def bone_markers(
    motion: Motion, joints: tuple[str, ...], *, seed: int = 0
) -> tuple[tuple[str, ...], Array]:
    """Names that tell nothing, and places of five markers on each of some joints' bones."""
    rng, rows = np.random.default_rng(seed), {}
    for joint in joints:
        for _ in range(5):
            place = rng.normal(scale=0.06, size=3)
            place[1] -= 0.15 if "Leg" in joint else 0.0
            rows[f"marker {len(rows)}"] = (joint, tuple(place))
    return _carried(motion, rows)


def joint_errors(truth: Motion, solved: Solution) -> dict[str, float]:
    """Root mean square distance of each joint from the truth, by its name."""
    start, stop = solved.frames
    ours, theirs = solved.motion, truth.positions()[start:stop]
    places, names = ours.positions(), ours.skeleton.names
    return {
        name: float(np.sqrt(np.mean(np.sum((places[:, at] - theirs[:, place]) ** 2, axis=1))))
        for place, name in enumerate(truth.skeleton.names)
        if name in names
        for at in (names.index(name),)
    }


_ANGLES = {"knee": ("UpLeg", "Leg", "Foot"), "elbow": ("Arm", "ForeArm", "Hand")}


def joint_angles(truth: Motion, solved: Solution) -> dict[str, float]:
    """Root mean square error in degrees of knees and elbows, both sides together."""
    start, stop = solved.frames
    result = {}
    for name, parts in _ANGLES.items():
        errors = []
        for side in ("Left", "Right"):
            chain = [f"{side}{part}" for part in parts]
            if set(chain) <= set(solved.motion.skeleton.names):
                errors.append(_bend(truth, chain)[start:stop] - _bend(solved.motion, chain))
        if errors:
            result[name] = float(np.degrees(np.sqrt(np.mean(np.square(errors)))))
    return result


def _bend(motion: Motion, chain: list[str]) -> Array:
    first, middle, last = np.moveaxis(motion.positions()[:, motion.skeleton.indices(chain)], 1, 0)
    a, b = middle - first, last - middle
    cosine = np.sum(a * b, axis=1) / (np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1))
    return np.arccos(np.clip(cosine, -1.0, 1.0))


def slides(solved: Solution, standing: NDArray[np.bool_]) -> list[float]:
    """How far heels and toes go on the ground in each stance, at most, from their mean."""
    motion = solved.motion
    joints, turns = forward_kinematics(motion.skeleton, motion.rotations, motion.root_path)
    found = []
    for column, side in enumerate(("Left", "Right")):
        foot = motion.skeleton.index(f"{side}Foot")
        toe = next(end for joint, end in motion.skeleton.end_sites if joint == foot)
        path = joints[:, foot] + rot.rotate(turns[:, foot], toe)
        for start, stop in Spans.of_mask(standing[slice(*solved.frames), column]):
            # The first and last frames of a stance may belong to the swing.
            inside = path[start + 1 : stop - 1, ::2]
            if len(inside) > 3:
                found.append(float(np.linalg.norm(inside - inside.mean(axis=0), axis=1).max()))
    return found
