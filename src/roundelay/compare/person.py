"""A person's 22 points on any skeleton, so that motions of different ones can be compared.

Joints are told by their names: those of Acclaim, Mixamo, LAFAN1, MakeHuman, depth cameras and most
others. What lies between, the hips, the spine, the neck, is taken from the tree and from where
joints are. Points are seen from above the hips, ahead where hips and shoulders face, so that axes
of joints and roots do not matter.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from roundelay.base.brief import brief
from roundelay.base.numeric import TINY
from roundelay.geometry.skeleton import Skeleton
from roundelay.geometry.symmetry import is_left, other_side

__all__ = ["BONES", "POINTS", "Person", "person_of"]

Array = NDArray[np.float64]
Thing = TypeVar("Thing")

_SIDED = ("hip", "knee", "ankle", "toe", "collar", "shoulder", "elbow", "wrist")
POINTS = (
    *("hips", "spine 1", "spine 2", "spine 3", "neck", "head"),
    *(f"{side} {name}" for name in _SIDED for side in ("left", "right")),
)
"""Names of a person's points."""
_TRUNK = POINTS[:6]
BONES = (
    *pairwise(_TRUNK),
    *(
        bone
        for side in ("left", "right")
        for chain in (
            ("neck", *(f"{side} {name}" for name in ("collar", "shoulder", "elbow", "wrist"))),
            ("hips", *(f"{side} {name}" for name in ("hip", "knee", "ankle", "toe"))),
        )
        for bone in pairwise(chain)
    ),
)
"""Pairs of points between which a figure has lines."""

# What joints of a side are called without it; the first pattern that any joint has is taken.
_CALLED = {
    "hip": (r"upleg|upperleg|thigh|femur", r"hip"),
    "knee": (r"loleg|lowleg|lowerleg|shin|calf|tibia|knee", r"^leg"),
    "ankle": (r"foot|ankle",),
    "toe": (r"toe|ball",),
    "shoulder": (r"uparm|upperarm|humerus", r"^arm", r"shoulder|shldr"),
    "elbow": (r"forearm|loarm|lowarm|lowerarm|radius|elbow",),
    "wrist": (r"wrist", r"hand"),
}
_HEAD = (r"head",)


@dataclass(frozen=True, eq=False)
class Person:
    """How a person's points follow from the joints of a skeleton.

    Attributes
    ----------
    shares : (22, J) ndarray
        Of each joint's position in each point.
    """

    shares: Array

    __repr__ = brief

    def seen(self, positions: Array, up: int) -> Array:
        """Return the points (F, 22, 3) as seen from the body: forward, up, left.

        The unit is the length of a leg and the trunk. Of the hips, by which the others are placed,
        the height above the lowest point of all frames is told.

        Parameters
        ----------
        positions : (F, J, 3) ndarray
            Of all joints, in the world.
        up : int
            The vertical axis.
        """
        points = np.einsum("pj,fjx->fpx", self.shares, positions)
        height = points[:, 0, up] - points[:, :, up].min()
        points -= points[:, :1]
        across = _across(points)
        across[:, up] = 0.0
        across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), TINY)
        above = np.eye(3)[up]
        axes = np.stack([np.cross(across, above), np.broadcast_to(above, across.shape), across], 1)
        seen = np.einsum("fax,fpx->fpa", axes, points)
        seen[:, 0, 1] = height
        return seen / _size(points)


def _across(points: Array) -> Array:
    """Return the way (F, 3) from right to left, of hips and shoulders together."""
    pairs = [(_place(f"left {name}"), _place(f"right {name}")) for name in ("hip", "shoulder")]
    return np.sum([points[:, left] - points[:, right] for left, right in pairs], axis=0)


def _size(points: Array) -> float:
    """Return the length of a leg and the trunk."""
    chains = [("left hip", "left knee", "left ankle"), ("right hip", "right knee", "right ankle")]
    long = [
        float(np.median(np.linalg.norm(points[:, _place(a)] - points[:, _place(b)], axis=1)))
        for chain in chains
        for a, b in pairwise(chain)
    ]
    trunk = float(np.median(np.linalg.norm(points[:, _place("neck")], axis=1)))
    return max(0.5 * sum(long) + trunk, TINY)


def _place(name: str) -> int:
    return POINTS.index(name)


def person_of(skeleton: Skeleton) -> Person | None:
    """Find a person's points on a skeleton; None if it is none, or its joints are not told so.

    Parameters
    ----------
    skeleton : Skeleton
    """
    if skeleton.free:
        return None
    found = _joints(skeleton)
    if found is None:
        return None
    rows = {name: np.eye(skeleton.n_joints)[joint] for name, joint in found.items()}
    for name in ("hip", "shoulder"):
        rows[name] = 0.5 * (rows[f"left {name}"] + rows[f"right {name}"])
    rows["hips"], rows["neck"] = rows.pop("hip"), rows.pop("shoulder")
    for side in ("left", "right"):
        rows[f"{side} collar"] = 0.5 * (rows["neck"] + rows[f"{side} shoulder"])
        rows.setdefault(f"{side} toe", rows[f"{side} ankle"])
    rows |= _spine(skeleton, found, rows["hips"], rows["neck"])
    return Person(np.stack([rows[name] for name in POINTS]))


def _joints(skeleton: Skeleton) -> dict[str, int] | None:
    """Return the joint of each point that is called after one; None if some are missing."""
    names, found = _bare(skeleton.names), dict[str, int]()
    pairs = [(name, other_side(name, names)) for name in names]
    known = [(a, b) for a, b in pairs if b is not None and b in names]
    # Some programs put a joint of no length before a limb, and mark its name so.
    sided = [(a, b) for a, b in known if is_left(a, b) and not a.startswith("_")]
    for point, patterns in _CALLED.items():
        pair = _first([(_plain(a, b), (a, b)) for a, b in sided], patterns)
        if pair is None and point != "toe":
            return None
        for side, name in zip(("left", "right"), pair or (), strict=False):
            found[f"{side} {point}"] = names.index(name)
    head = _first([(_letters(name), name) for name in names], _HEAD)
    return None if head is None else found | {"head": names.index(head)}


def _bare(names: Sequence[str]) -> list[str]:
    """Return joints' names without what stands before all of them: a name space, a program's."""
    first, last = min(names), max(names)
    same = (k for k, (a, b) in enumerate(zip(first, last, strict=False)) if a != b)
    prefix = first[: next(same, min(len(first), len(last)))]
    own = [name[len(prefix) :] for name in names]
    apart = prefix[-1:].isalpha() and not all(name[:1].isupper() for name in own)
    return list(names) if apart or not all(own) else own


def _first(named: Sequence[tuple[str, Thing]], patterns: Sequence[str]) -> Thing | None:
    """Return what stands with the first name that the first pattern finds that finds any."""
    for pattern in patterns:
        for name, thing in named:
            if re.search(pattern, name):
                return thing
    return None


def _plain(left: str, right: str) -> str:
    """Return what two partners are called without their sides and what stands before both."""
    at = next(k for k, (a, b) in enumerate(zip(left, right, strict=False)) if a != b)
    words = re.split(r"(?i)left|right", left)
    if len(words) > 1:
        return _letters("".join(words))
    return _letters(left[:at] + left[at + 1 :])


def _letters(name: str) -> str:
    """Return the letters of a joint's name, without what stands before a colon."""
    return re.sub(r"[^a-z]", "", name.rpartition(":")[2].lower())


def _spine(skeleton: Skeleton, found: dict[str, int], hips: Array, neck: Array) -> dict[str, Array]:
    """Return points at quarters of the way from the hips along the trunk to the neck."""
    rest = _rest(skeleton)
    above = _ancestors(skeleton, found["left shoulder"])
    shared = [j for j in above if j in _ancestors(skeleton, found["right shoulder"])]
    below = set(_ancestors(skeleton, found["left hip"]))
    trunk = [joint for joint in shared if joint not in below][::-1]
    rows = [hips, *np.eye(skeleton.n_joints)[trunk], neck]
    places = np.array([row @ rest for row in rows])
    along = np.cumsum([0.0, *np.linalg.norm(np.diff(places, axis=0), axis=1)])
    result = {}
    for number in (1, 2, 3):
        at = number / 4 * along[-1]
        k = min(int(np.searchsorted(along, at, "right")) - 1, len(rows) - 2)
        inside = (at - along[k]) / max(along[k + 1] - along[k], TINY)
        result[f"spine {number}"] = (1.0 - inside) * rows[k] + inside * rows[k + 1]
    return result


def _rest(skeleton: Skeleton) -> Array:
    places = np.array(skeleton.offsets, float)
    for joint, parent in enumerate(skeleton.parents[1:], 1):
        places[joint] += places[parent]
    return places


def _ancestors(skeleton: Skeleton, joint: int) -> list[int]:
    """Return a joint and those above it, up to the root."""
    found = [joint]
    while skeleton.parents[found[-1]] >= 0:
        found.append(skeleton.parents[found[-1]])
    return found
