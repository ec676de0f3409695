"""What a pose is to segmentation: quaternions of fourteen joints, root left out ([B] 3, 3.1)."""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import SkeletonMismatch
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.features import point_cloud
from roundelay.motion.motion import Motion
from roundelay.segmentation.thresholds import MODEL

__all__ = ["STANDARD_JOINTS", "corresponding_joints", "joint_quaternions"]

STANDARD_JOINTS = (
    "lowerback",
    "upperback",
    "thorax",
    "lowerneck",
    "upperneck",
    "head",
    "lhumerus",
    "lradius",
    "lfemur",
    "ltibia",
    "rhumerus",
    "rradius",
    "rfemur",
    "rtibia",
)
"""The fourteen joints of [B] 3.1, as the Acclaim skeletons of the CMU database name them."""

_TRUNK = re.compile(r"spine|back|chest|thorax|torso|waist|abdomen|neck|head(?!.*(end|top|nub))")
_LIMBS = {
    "upper arm": re.compile(r"humerus|upper_?arm|up_?arm|^[lr]_?arm$|(left|right)_?arm$|shldr"),
    "forearm": re.compile(r"radius|fore_?arm|lo(w|wer)?_?arm|elbow"),
    "thigh": re.compile(r"femur|thigh|up(per)?_?leg"),
    "shin": re.compile(r"tibia|shin|calf|knee|lo(w|wer)?_?leg|^[lr]_?leg$|(left|right)_?leg$"),
}
_EXTRAS = re.compile(r"end|nub|twist|roll|finger|thumb|index|eye|jaw|top|site|ik|pole")


def joint_quaternions(motion: Motion, joints: Iterable[str] | None = None) -> NDArray[np.float64]:
    """Return the poses as points: one quaternion a joint, as four coordinates ([B] 3.1).

    Of markers and keypoints, which have none, their places relative to the trunk, in units in which
    they move as far as quaternions do.

    Parameters
    ----------
    motion : Motion
    joints : iterable of str, optional
        The corresponding joints by default, see `corresponding_joints`.

    Returns
    -------
    (F, 4 k) ndarray
        Signs continuous in time; 56 columns with the standard joints. Of a free skeleton (F, 3 k).

    Raises
    ------
    SkeletonMismatch
        If a joint does not exist; the message names it.
    ValueError
        If no joint is given.
    """
    names = corresponding_joints(motion.skeleton) if joints is None else tuple(joints)
    if not names:
        raise ValueError("expected at least one joint, found none")
    chosen = motion.skeleton.indices(names)
    if motion.skeleton.free:
        return MODEL.turn * point_cloud(motion, joints=chosen)
    return motion.rotations[:, chosen].reshape(len(motion), 4 * len(chosen))


def corresponding_joints(skeleton: Skeleton) -> tuple[str, ...]:
    """Choose the joints that stand for the standard ones of [B].

    An Acclaim skeleton has the standard joints themselves; its trunk may have fewer. On others,
    spine, neck, head, upper arms, forearms, thighs and shins are found by the usual names; where
    one kind of limb is found under no name, all joints but the root are taken.

    Raises
    ------
    SkeletonMismatch
        If most of the standard joints are there and one of a limb is missing: the message names
        it.
    """
    missing = [name for name in STANDARD_JOINTS if name not in skeleton.names]
    if 2 * len(missing) < len(STANDARD_JOINTS):
        of_limbs = [name for name in missing if not _TRUNK.search(name)]
        if of_limbs:
            raise SkeletonMismatch(
                f"the standard joints {', '.join(of_limbs)} are missing; name the joints to use"
            )
        return tuple(name for name in STANDARD_JOINTS if name not in missing)
    found = {name: _kinds(name) for name in skeleton.names[1:]}
    if {kind for kinds in found.values() for kind in kinds} >= set(_LIMBS):
        return tuple(name for name, kinds in found.items() if kinds)
    return skeleton.names[1:] or skeleton.names


def _kinds(name: str) -> list[str]:
    """Return which parts of the body a joint's name speaks of."""
    # A prefix names the character or the program ("mixamorig:", "Bip01_"), not the joint.
    plain = re.sub(r"[\s\-.]+", "_", name.split(":")[-1].lower())
    if _EXTRAS.search(plain):
        return []
    kinds = [kind for kind, pattern in _LIMBS.items() if pattern.search(plain)]
    return kinds or (["trunk"] if _TRUNK.search(plain) else [])
