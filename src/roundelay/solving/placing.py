"""Where a body is solved: in metres, Y up; and the way back to the world of the points."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion
from roundelay.motion.points import Points
from roundelay.solving.body import Body, Poses
from roundelay.solving.landmarks import Landmark
from roundelay.solving.thresholds import PERSON, RIGID

__all__ = ["Placement", "placement_of_body", "placement_of_person"]

Array = NDArray[np.float64]

# Metres a unit.
_UNITS = {
    "mm": 1 / 1000,
    "cm": 1 / 100,
    "dm": 1 / 10,
    "m": 1.0,
    "in": 254 / 10_000,
    "ft": 3048 / 10_000,
}
_LOW, _HIGH = ("Leg", "Foot"), ("Hips", "UpLeg")


@dataclass(frozen=True)
class Placement:
    """Lead from the points' world to metres with Y up.

    Attributes
    ----------
    scale : float
        Metres a unit of the points.
    up : {0, 1, 2}
        The axis that points up.
    downward : bool
        Whether it points down, as in pictures; a motion is turned about X, then.
    """

    scale: float
    up: int
    downward: bool

    def into(self, positions: Array) -> Array:
        """Return positions (..., 3) in metres with Y up."""
        return rot.rotate(self._turn, positions) * self.scale

    def motion(self, body: Body, poses: Poses, points: Points) -> Motion:
        """Return the motion in the world of the points."""
        back = rot.conjugate(rot.axis_to_y(self.up))
        factor = 1.0 / self.scale
        offsets = rot.rotate(back, body.offsets) * factor
        ends = tuple((j, rot.rotate(back, end) * factor) for j, end in body.ends())
        skeleton = Skeleton(body.names, body.parents, offsets, ends)
        turns = rot.multiply(rot.multiply(back, poses.rotations), rot.conjugate(back))
        path = rot.rotate(back, poses.root) * factor
        return Motion(skeleton, turns, path, 1.0 / points.fps, name=points.name, up=self.up)

    @property
    def _turn(self) -> Array:
        upright = rot.axis_to_y(self.up)
        if not self.downward:
            return upright
        return rot.multiply(rot.from_rotation_vector([np.pi, 0.0, 0.0]), upright)


def placement_of_person(points: Points, marks: list[Landmark | None]) -> Placement | None:
    """Find unit and vertical of a person; None if no hips or legs are named.

    Parameters
    ----------
    points : Points
    marks : list of Landmark or None
        One a point.
    """
    bones = [(mark.bone[len(mark.side) :] if mark else "") for mark in marks]
    high = [place for place, bone in enumerate(bones) if bone == _HIGH[0]]
    high = high or [place for place, bone in enumerate(bones) if bone == _HIGH[1]]
    low = [place for place, bone in enumerate(bones) if bone in _LOW]
    if not high or not low:
        return None
    values = points.to_array()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        ways = np.nanmean(values[:, high], axis=1) - np.nanmean(values[:, low], axis=1)
        way = np.nanmedian(ways, axis=0)
        feet = values[:, [p for p in low if bones[p] == "Foot"] or low]
        apart = np.linalg.norm(np.nanmean(values[:, high], axis=1, keepdims=True) - feet, axis=2)
        leg = float(np.nanquantile(apart, PERSON.stretched))
    if not np.all(np.isfinite(way)) or not leg > 0.0:
        return None
    up = int(np.argmax(np.abs(way))) if points.up is None else points.up
    return Placement(_scale(points.units, leg), up, bool(way[up] < 0.0))


def _scale(units: str, leg: float) -> float:
    """Return metres a unit: as told if a leg has a person's length by it, else by the leg."""
    told = _UNITS.get(units.strip().lower())
    if told is not None and PERSON.children < told * leg / PERSON.leg < PERSON.giants:
        return told
    for metres in _UNITS.values():
        if PERSON.children < metres * leg / PERSON.leg < PERSON.giants:
            return metres
    return PERSON.leg / leg


def placement_of_body(points: Points) -> Placement:
    """Scale any body to about a person's size, and find its vertical."""
    values = points.to_array()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        middle = np.nanmedian(values, axis=1, keepdims=True)
        apart = np.nanmedian(np.linalg.norm(values - middle, axis=2), axis=0)
        lowest = np.nanmin(values, axis=1)
        height = np.nanmean(np.nanmean(values, axis=1) - lowest, axis=0)
    size = float(np.nanmax(apart)) or 1.0
    up = points.up
    if up is None:
        up = 2 if height[2] > height[1] else 1
    return Placement(RIGID.size / size, up, points.image)
