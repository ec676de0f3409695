"""Move the end of an arm or a leg: its two bones bend as they do, its end keeps its turn."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import TINY
from roundelay.geometry import rotations as rot
from roundelay.retargeting.anatomy import Limb
from roundelay.retargeting.carrying import Pose, shortest
from roundelay.retargeting.thresholds import MOVING

__all__ = ["move_end"]

Array = NDArray[np.float64]


def move_end(pose: Pose, limb: Limb, places: Array, turns: Array, offset: Array) -> None:
    """Move the end of a limb by an offset (F, 3), as it is turned.

    The two-bone problem in closed form: the lower bone turns in the plane of both, about the axis
    in which the limb bends where it is straight, until the end is as far away as it shall be; then
    the limb turns, the shortest way, to where it shall be. One that cannot reach points there.

    Parameters
    ----------
    pose : Pose
    limb : Limb
    places, turns : (F, J, 3), (F, J, 4) ndarray
        Of the pose.
    offset : (F, 3) ndarray
    """
    if not np.any(offset):
        return
    end = limb.lower[-1] if limb.end is None else limb.end
    top, middle, last = (places[:, joint] for joint in (limb.upper[0], limb.lower[0], end))
    upper, lower, wanted = middle - top, last - middle, last + offset - top
    frame = rot.multiply(turns[:, limb.lower[0]], pose.reference.frames[limb.lower[0]])
    bend = _bend(upper, lower, wanted, rot.rotate(frame, np.array([0.0, 1.0, 0.0])))
    swing = shortest(upper + rot.rotate(bend, lower), wanted)
    moves = np.any(offset, axis=1)
    still = np.array([1.0, 0.0, 0.0, 0.0])
    pose.turn(limb.upper, np.where(moves[:, None], swing, still))
    pose.turn(limb.lower, np.where(moves[:, None], rot.multiply(swing, bend), still))


def _bend(upper: Array, lower: Array, wanted: Array, usual: Array) -> Array:
    """Return the turns (F, 4) of a lower bone after which its end is as far as is wanted."""
    a, b = np.linalg.norm(upper, axis=1), np.linalg.norm(lower, axis=1)
    across = np.cross(upper, lower) / np.maximum(a * b, TINY)[:, None]
    # Of a straight limb the bones tell no axis.
    axis = across + MOVING.straight * usual
    axis = axis / np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), TINY)
    along = np.sum(upper * lower, axis=1) / np.maximum(a * b, TINY)
    now = np.arctan2(np.linalg.norm(across, axis=1), along)
    # What is straighter already may stay so.
    longest = np.maximum(MOVING.reach * (a + b), np.linalg.norm(upper + lower, axis=1))
    reach = np.clip(np.linalg.norm(wanted, axis=1), np.abs(a - b), longest)
    cosine = (reach**2 - a**2 - b**2) / np.maximum(2.0 * a * b, TINY)
    turn = np.arccos(np.clip(cosine, -1.0, 1.0)) - now
    return rot.from_rotation_vector(axis * turn[:, None])
