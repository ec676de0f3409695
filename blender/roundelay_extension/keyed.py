# SPDX-License-Identifier: GPL-3.0-or-later
"""What is keyed: the properties that an armature's curves drive, and their values over time."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from . import compat
from .compat import Armature
from .takes import Take, curves_of

Array = NDArray[np.float64]
Samples = dict["Property", Array]

ROTATIONS = {
    "rotation_quaternion": "QUATERNION",
    "rotation_axis_angle": "AXIS_ANGLE",
    "rotation_euler": "EULER",
}


@dataclass(frozen=True)
class Property:
    """A property that is keyed.

    Attributes
    ----------
    owner : bpy.types.ID
        The armature, or shape keys that its action drives, too.
    path : str
    bone : str
        Empty where it is none of a bone's.
    name : str
        What follows the owner or the bone: "location", '["ik"]'.
    """

    owner: Any
    path: str
    bone: str
    name: str

    @property
    def holder(self) -> Any:
        """The bone or the owner."""
        return self.owner.pose.bones[self.bone] if self.bone else self.owner

    @property
    def turns(self) -> bool:
        """Whether it is the rotation that its bone or object uses."""
        mode = ROTATIONS.get(self.name)
        used = getattr(self.holder, "rotation_mode", "") if mode else ""
        return bool(mode) and (used == mode or (mode == "EULER" and used in _ORDERS))

    def now(self) -> Array:
        """Return its value, all of it (n,)."""
        return np.atleast_1d(np.array(self.owner.path_resolve(self.path), float))


_ORDERS = ("XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX")


@dataclass(frozen=True)
class Keyed:
    """All properties that are keyed, each with its curves by index.

    Attributes
    ----------
    curves : dict
        From property to a dict from index to the curves that drive it: several where strips do.
    groups : dict
        Name of the group that the curves of a property are in.
    orphans : tuple of str
        Paths of curves that drive nothing.
    """

    curves: dict[Property, dict[int, list[Any]]]
    groups: dict[Property, str]
    orphans: tuple[str, ...]

    def of(self, bones: Iterable[str]) -> Keyed:
        """Keep what is keyed of some bones."""
        names = set(bones)
        kept = {one: each for one, each in self.curves.items() if one.bone in names}
        return Keyed(kept, self.groups, self.orphans)

    def has(self, bone: str, name: str) -> bool:
        """Tell whether a property of a bone is keyed; of rotations, whether any is."""
        turns = name in ROTATIONS
        return any(
            one.bone == bone and (one.name == name or (turns and one.name in ROTATIONS))
            for one in self.curves
        )

    @property
    def keys(self) -> int:
        """The most keys that a curve has."""
        counts = (len(c.keyframe_points) for each in self._all() for c in each)
        return max(counts, default=0)

    def spans(self, one: Property) -> float:
        """Return by how much a property changes; infinite where modifiers alone make it."""
        return max(span(curve) for each in self.curves[one].values() for curve in each)

    def stepped(self, one: Property) -> bool:
        """Tell whether a property jumps from key to key instead of going over."""
        if one.bone and one.name in ("location", "scale", *ROTATIONS):
            return False
        if isinstance(one.owner.path_resolve(one.path), bool | int | str):
            return True
        return all(_constant(curve) for each in self.curves[one].values() for curve in each)

    def values(self, one: Property, frames: Array) -> Array:
        """Return the values (..., n) of a property at frames (...), by its curves."""
        rest = one.now()
        found = np.tile(rest, (frames.size, 1))
        for index, (curve, *_) in self.curves[one].items():
            found[:, index] = values_of(curve, frames.ravel())
        return found.reshape(*frames.shape, len(rest))

    def _all(self) -> Iterable[list[Any]]:
        return (each for by_index in self.curves.values() for each in by_index.values())


def keyed_of(armature: Armature, take: Take) -> Keyed:
    """Collect what is keyed of an armature, and of shape keys that the same action drives."""
    curves: dict[Property, dict[int, list[Any]]] = {}
    groups: dict[Property, str] = {}
    orphans = [_collect(armature, curve, curves, groups) for curve in curves_of(armature)]
    if not take.bare:
        slot = compat.slot_of(armature.animation_data)
        for other, user in compat.other_slots(take.action, slot):
            for curve in compat.curves_of_slot(take.action, other):
                _collect(user, curve, curves, groups)
    return Keyed(curves, groups, tuple(path for path in orphans if path))


def _collect(owner: Any, curve: Any, curves: Any, groups: Any) -> str:
    """File a curve by its property; return the path of one that drives nothing."""
    bone, name = _parted(owner, curve.data_path)
    one = Property(owner, curve.data_path, bone, name)
    try:
        size = len(one.now())
    except (ValueError, TypeError, KeyError):
        return str(curve.data_path)
    if curve.array_index >= size:
        return str(curve.data_path)
    groups[one] = curve.group.name if curve.group else bone
    curves.setdefault(one, {}).setdefault(curve.array_index, []).append(curve)
    return ""


def _parted(owner: Any, path: str) -> tuple[str, str]:
    """Return the bone of a path, if it is one's, and what follows."""
    parts = path.split('"')
    if len(parts) < 3 or parts[0] != "pose.bones[" or not hasattr(owner, "pose"):
        return "", path
    rest = path[len('pose.bones["') + len(parts[1]) + 2 :]
    return bpy.utils.unescape_identifier(parts[1]), rest.removeprefix(".")


def span(curve: Any) -> float:
    """Return by how much a curve changes; infinite where it is made by modifiers alone."""
    points = keys_of(curve)[:, 1]
    return float(np.ptp(points)) if len(points) else float("inf")


def keys_of(curve: Any) -> Array:
    """Return frames and values (n, 2) of a curve's keys."""
    points = np.empty(2 * len(curve.keyframe_points), np.float32)
    curve.keyframe_points.foreach_get("co", points)
    return points.reshape(-1, 2).astype(float)


def values_of(curve: Any, frames: Array) -> Array:
    """Return a curve's values at frames (n,); its keys as they are where each has one."""
    if len(curve.modifiers) == 0 and np.all(frames == np.round(frames)):
        keys = keys_of(curve)
        first = int(np.searchsorted(keys[:, 0], frames[0] - _APART))
        run = keys[first : first + len(frames)]
        if len(run) == len(frames) and np.all(np.abs(run[:, 0] - frames) < _APART):
            return np.asarray(run[:, 1])
    return np.array([curve.evaluate(frame) for frame in frames])


# Files round the frames of keys.
_APART = 1e-3


def _constant(curve: Any) -> bool:
    return all(point.interpolation == "CONSTANT" for point in curve.keyframe_points[:-1])
