"""Left and right: the partners of a skeleton's joints and the plane between them."""

from __future__ import annotations

import re
from collections.abc import Container
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import SkeletonMismatch
from roundelay.base.numeric import ROUNDING
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton

__all__ = [
    "facing",
    "is_left",
    "lateral_axis",
    "other_side",
    "partners",
    "reflected_rotations",
    "reflected_skeleton",
    "reflection",
    "sides",
]

Array = NDArray[np.float64]
Places = NDArray[np.intp]

_WORD = re.compile("left|right", re.IGNORECASE)
# L or R alone (L_Arm, arm.L, Bip01 L Thigh), before a capital (LHipJoint), or last (ArmL).
_LETTER = re.compile(
    r"(?<![A-Za-z])[lr](?![A-Za-z])|(?<![A-Za-z])[LR](?=[A-Z][a-z]|[^A-Za-z]|$)"
    r"|(?<=[a-z])[LR](?![A-Za-z])"
)
_OTHER = {"left": "right", "right": "left", "l": "r", "r": "l"}


def partners(skeleton: Skeleton) -> Places:
    """Return the joint on the other side (J,) of each joint; itself for those in the middle.

    Sides are told from names: Left and Right, L and R set apart or as a prefix or suffix, and
    the prefixes of Acclaim skeletons (lfemur, rfemur).

    Raises
    ------
    SkeletonMismatch
        If a joint of one side has no partner, or the two hang on joints that are none.
    """
    names = {name: joint for joint, name in enumerate(skeleton.names)}
    result = np.arange(len(names))
    for name, joint in names.items():
        other = other_side(name, names)
        if other is not None and other not in names:
            raise SkeletonMismatch(f"joint {name!r} has no partner {other!r} on the other side")
        result[joint] = joint if other is None else names[other]
    _check_tree(skeleton, result)
    return result


def sides(skeleton: Skeleton) -> tuple[Places, Places]:
    """Return the left joints and their partners.

    Parameters
    ----------
    skeleton : Skeleton

    Returns
    -------
    left, right : (n,) ndarray of int
        Empty also where `partners` would raise: where a joint of one side has no partner, or the
        two hang on joints that are none.
    """
    try:
        other = partners(skeleton)
    except SkeletonMismatch:
        return np.zeros(0, np.intp), np.zeros(0, np.intp)
    left = [j for j, k in enumerate(other) if is_left(skeleton.names[j], skeleton.names[k])]
    return np.array(left, np.intp), other[left]


def facing(left: Array, right: Array, up: int, size: float) -> Array | None:
    """Return the direction that a body faces on average: level, and square to its sides.

    Parameters
    ----------
    left, right : (..., 3) ndarray
        Places of joints and of their partners, of at least one.
    up : int
        The vertical axis.
    size : float
        The skeleton's size, in the unit of the places.

    Returns
    -------
    (3,) ndarray or None
        A unit vector; None where left and right lie at one place or above each other.
    """
    across = np.mean(np.reshape(left - right, (-1, 3)), axis=0)
    across[up] = 0.0
    width = float(np.linalg.norm(across))
    return None if width < ROUNDING * size else np.cross(across, np.eye(3)[up]) / width


def is_left(name: str, partner: str) -> bool:
    """Tell whether the first letter by which two names differ is that of the left."""
    differing = (one for one, two in zip(name, partner, strict=False) if one != two)
    return next(differing, "").lower() == "l"


def other_side(name: str, names: Container[str]) -> str | None:
    """Return what a joint's partner is called; None for a joint in the middle.

    Parameters
    ----------
    name : str
    names : container of str
        Of all joints. The glued prefixes of Acclaim skeletons (lfemur) and of markers (LTHI) are
        sides only where there is a partner.
    """
    for pattern in (_WORD, _LETTER):
        if pattern.search(name):
            return pattern.sub(lambda match: _swapped(match.group()), name)
    at = name.rfind(":") + 1
    first = name[at : at + 1]
    glued = name[:at] + _swapped(first) + name[at + 1 :] if first in tuple("lrLR") else ""
    return glued if glued in names else None


def _swapped(side: str) -> str:
    other = _OTHER[side.lower()]
    if side.isupper():
        return other.upper()
    return other.capitalize() if side[0].isupper() else other


def _check_tree(skeleton: Skeleton, other: Places) -> None:
    for joint, parent in enumerate(skeleton.parents[1:], 1):
        if skeleton.parents[other[joint]] != other[parent]:
            name, partner = skeleton.names[joint], skeleton.names[other[joint]]
            raise SkeletonMismatch(
                f"joint {name!r} hangs on {skeleton.names[parent]!r}, but its partner "
                f"{partner!r} does not hang on that joint's partner"
            )


def lateral_axis(skeleton: Skeleton, other: Places) -> int:
    """Return the axis from side to side: reflecting it takes each joint nearest its partner."""
    offsets, there = skeleton.offsets[1:], skeleton.offsets[other[1:]]
    costs = [np.sum((offsets * reflection(axis) - there) ** 2) for axis in range(3)]
    return int(np.argmin(costs))


def reflection(axis: int) -> Array:
    """Return the diagonal (3,) of the reflection of one axis."""
    return np.where(np.arange(3) == axis, -1.0, 1.0)


def reflected_skeleton(skeleton: Skeleton, other: Places, across: int, sideways: int) -> Skeleton:
    """Return a skeleton whose joints are their partners' reflections.

    Parameters
    ----------
    skeleton : Skeleton
    other : (J,) ndarray of int
        The joints' partners.
    across, sideways : int
        The axes to reflect, of the body and, for the root's place, of the world.
    """
    offsets = skeleton.offsets[other] * reflection(across)
    offsets[0] = skeleton.offsets[0] * reflection(sideways)
    ends = [(int(other[joint]), end * reflection(across)) for joint, end in skeleton.end_sites]
    ordered = tuple(sorted(ends, key=lambda end: end[0]))
    figure = skeleton.figure
    if figure is not None:
        names = skeleton.names
        partner = {name: names[other[joint]] for joint, name in enumerate(names)}
        figure = figure.mirrored(partner, reflection(across))
    rest = skeleton.rest
    if rest is not None:
        rest = reflected_rotations(rest[None], other, across, sideways)[0]
    return replace(skeleton, offsets=offsets, end_sites=ordered, figure=figure, rest=rest)


def reflected_rotations(rotations: Array, other: Places, across: int, sideways: int) -> Array:
    """Return local rotations (F, J, 4) of the reflected skeleton, arguments as there."""
    result = rotations[:, other]
    # M R M turns the other way about the reflected axis.
    result[..., 1:] *= -reflection(across)
    if across != sideways:
        # The root stands between world and body: W R M = (W M) (M R M), W M half a turn.
        half_turn = np.eye(4)[1 + 3 - across - sideways]
        result[:, 0] = rot.multiply(half_turn, result[:, 0])
    return result
