"""From a motion to poses: what the distance between two poses means.

A pose becomes a point whose Euclidean distance to another says how different the two look.
The default, joint positions relative to the root with the root's own rotation left out,
weighs every bone by its length and has no full turns to unwrap, which joint angles have
([C] ch. 4 and 6 discuss both).
"""

from __future__ import annotations

from functools import cached_property
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.checks import as_numbers, expected
from roundelay.base.errors import SkeletonMismatch
from roundelay.base.numeric import SMALLEST, TINY
from roundelay.base.threads import one_thread
from roundelay.geometry import rotations as rot
from roundelay.geometry.contacts import find_feet, free_limbs
from roundelay.geometry.kinematics import forward_kinematics, heading
from roundelay.motion.motion import Motion
from roundelay.motion.poses import Mask

__all__ = [
    "Features",
    "MotionPoses",
    "Weights",
    "first_differences",
    "joint_turns",
    "point_cloud",
]

Array = NDArray[np.float64]
Features = Literal["positions", "heading", "quaternions", "angles", "configuration"]
Weights = Literal["none", "length", "mass"]


class MotionPoses:
    """Show the joints of a motion to the search, as `roundelay.motion.poses.Poses`.

    The root, by which the others are placed, is no point of a pose, but for the features
    "configuration", in which its velocity and its turning are one each.

    Parameters
    ----------
    motion : Motion
    features : {"positions", "heading", "quaternions", "angles", "configuration"}
        See `point_cloud`.
    weights : {"none", "length", "mass"}
        Weigh every joint by the length of its bones ([C] ch. 4) or by that of all bones it
        moves, which stands for their mass ([A] 7).

    Raises
    ------
    ValueError
        If `features` or `weights` is unknown.
    """

    missing: Mask | None = None

    def __init__(
        self, motion: Motion, features: Features = "positions", weights: Weights = "none"
    ) -> None:
        self._motion, skeleton = motion, motion.skeleton
        factors = {"none": None, "length": skeleton.bone_lengths, "mass": skeleton.moved_lengths}
        if weights not in factors:
            raise ValueError(f"expected weights among {tuple(factors)}, found {weights!r}")
        values, chosen = _features(motion, features), factors[weights]
        if chosen is not None:
            values = values * (chosen / max(float(chosen.max()), TINY))[:, None]
        self.names, self.values = skeleton.names[1:], values[:, 1:]
        if features == "configuration":
            rates = first_differences(motion).reshape(len(motion), 2, 3)
            root = skeleton.names[0]
            self.names = (*self.names, f"velocity of {root}", f"turning of {root}")
            self.values = np.concatenate([self.values, rates], axis=1)
        self.fps, self.size = motion.fps, skeleton.size

    @cached_property
    def groups(self) -> dict[str, tuple[int, ...]]:
        """The legs and the arms, by their points; without those that are not found."""
        motion = self._motion
        seen = motion.skeleton, motion.positions(), motion.up
        legs = [x for foot in find_feet(*seen) for x in (foot.hip, foot.knee, foot.ankle)]
        limbs = {"legs": legs, "arms": free_limbs(*seen)}
        points = {name: tuple(joint - 1 for joint in limbs[name] if joint) for name in limbs}
        return {name: inside for name, inside in points.items() if inside}


@one_thread
def point_cloud(
    motion: Motion,
    features: Features = "positions",
    *,
    joints: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    differences: bool = False,
) -> Array:
    """Map every frame to a point.

    Parameters
    ----------
    motion : Motion
    features : {"positions", "heading", "quaternions", "angles", "configuration"}
        - ``positions``: joint positions relative to the root, without the root's rotation, in
          units of the skeleton's size;
        - ``heading``: the same, with the root's pitch and roll but not its heading;
        - ``quaternions``: rotations of all joints but the root, signs continuous in time ([B]);
        - ``angles``: rotation vectors of all joints but the root, in radians, unwrapped
          ([A], [C]: joint angles);
        - ``configuration``: the same, and the root's six rates, as `differences` ([A] 4.1);
          noise of single frames counts for much in these.
    joints : (k,) array_like of int, optional
        Use these joints only (the root counts for ``heading`` only).
    weights : (J,) array_like, optional
        One factor a joint, for instance `Skeleton.bone_lengths` ([C] ch. 4) or masses ([A] 7).
    differences : bool
        Append the root's velocity and turning ([A] 4.1), a second, in sizes and radians.

    Returns
    -------
    (F, d) ndarray

    Raises
    ------
    ValueError
        If `features` is unknown.
    SkeletonMismatch
        If no joint is left.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> rl.point_cloud(walk).shape
    (429, 54)
    """
    values = _features(expected(Motion, motion), features)
    if weights is not None:
        factors = np.asarray(as_numbers(weights, "weights (J,)"), float)
        if factors.shape != (motion.skeleton.n_joints,):
            told = f"({motion.skeleton.n_joints},), found {factors.shape}"
            raise ValueError(f"expected weights of shape {told}")
        values = values * factors[None, :, None]
    chosen = np.arange(motion.skeleton.n_joints) if joints is None else np.asarray(joints)
    chosen = chosen[chosen != 0]
    if len(chosen) == 0:
        raise SkeletonMismatch("expected at least one joint besides the root, found none")
    points = values[:, chosen].reshape(len(motion), -1)
    differences = differences or features == "configuration"
    return np.hstack([points, first_differences(motion)]) if differences else points


def _features(motion: Motion, features: Features) -> Array:
    if features not in get_args(Features):
        raise ValueError(f"expected features among {get_args(Features)}, found {features!r}")
    return _JOINT_FEATURES[features](motion)


def _positions(motion: Motion) -> Array:
    upright = motion.rotations.copy()
    upright[:, 0] = (1.0, 0.0, 0.0, 0.0)
    placed, _ = forward_kinematics(motion.skeleton, upright, translations=motion.translations)
    return placed / motion.skeleton.size


def _heading_positions(motion: Motion) -> Array:
    ahead = motion.rotations.copy()
    ahead[:, 0] = rot.multiply(
        rot.conjugate(rot.twist(motion.rotations[:, 0], motion.up_vector)), ahead[:, 0]
    )
    placed, _ = forward_kinematics(motion.skeleton, ahead, translations=motion.translations)
    return placed / motion.skeleton.size


def _angles(motion: Motion) -> Array:
    vectors = rot.to_rotation_vector(motion.rotations)
    return _unwrap_vectors(vectors)


def _unwrap_vectors(vectors: Array) -> Array:
    """Add whole turns about each vector's axis where that is nearer to the frame before."""
    result = vectors.copy()
    for frame in range(1, len(vectors)):
        angle = np.linalg.norm(vectors[frame], axis=-1, keepdims=True)
        axis = vectors[frame] / np.maximum(angle, TINY)
        along = np.sum(axis * result[frame - 1], axis=-1, keepdims=True)
        result[frame] += np.round((along - angle) / (2 * np.pi)) * 2 * np.pi * axis
    return result


_JOINT_FEATURES = {
    "positions": _positions,
    "heading": _heading_positions,
    "quaternions": lambda motion: motion.rotations,
    "angles": _angles,
    "configuration": _angles,
}


def joint_turns(motion: Motion) -> Array:
    """Return how far the joints are turned (F, J, 4): their local rotations.

    Of a free skeleton these say nothing: its lines' own are returned, each the smallest turn from
    where the line points at rest.
    """
    moved = motion.translations
    if not motion.skeleton.free or moved is None:
        return motion.rotations
    rest = np.broadcast_to(motion.skeleton.offsets, moved.shape)
    axis, cosine = np.cross(rest, moved), np.sum(rest * moved, axis=-1)
    sine = np.linalg.norm(axis, axis=-1)
    angle = np.arctan2(sine, cosine)
    turns = rot.from_rotation_vector(axis * (angle / np.maximum(sine, SMALLEST))[..., None])
    turns[:, 0] = motion.rotations[:, 0]
    return rot.continuous(turns)


def first_differences(motion: Motion) -> Array:
    """Return the root's motion from each frame to the next ([A] 4.1).

    Returns
    -------
    (F, 6) ndarray
        Velocity of the root in sizes a second, and its turning about three axes in radians a
        second, both in its own heading; the last row repeats the one before.
    """
    if len(motion) < 2:
        return np.zeros((len(motion), 6))
    turn = np.unwrap(heading(motion.rotations[:, 0], motion.up))
    back = rot.from_rotation_vector(-turn[:-1, None] * motion.up_vector)
    step = np.diff(motion.root_path, axis=0) / motion.skeleton.size
    before, after = motion.rotations[:-1, 0], motion.rotations[1:, 0]
    turned = rot.to_rotation_vector(rot.multiply(after, rot.conjugate(before)))
    rows = np.hstack([rot.rotate(back, step), rot.rotate(back, turned)]) * motion.fps
    return np.vstack([rows, rows[-1:]])
