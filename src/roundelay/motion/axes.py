"""Axes of a body of points: which way is up, and which way it stands at rest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import heading
from roundelay.geometry.symmetry import is_left, other_side
from roundelay.motion.frame import Frame, standing
from roundelay.motion.thresholds import FRAME

__all__ = ["upright_turn", "upward"]

Array = NDArray[np.float64]


def upward(frame: Frame, inside: Array, *, planar: bool) -> int:
    """Return the axis that points up.

    Along it the body stands high above its lowest point, which keeps its height. Of a plane it
    is Y; but the axis that one looks along where the body turns more than a quarter in the
    picture, as an animal does that is seen from above: its heading is of no account then.

    Parameters
    ----------
    frame : Frame
    inside : (F, J, 3) ndarray
        Points in the frame.
    planar : bool
        Whether they lie in the plane of X and Y.
    """
    if planar:
        return 2 if np.ptp(np.unwrap(heading(frame.turns, 2))) > np.pi / 2 else 1
    few = np.unique(np.linspace(0, len(inside) - 1, FRAME.frames).round().astype(int))
    placed = Frame(frame.places[few], frame.turns[few], frame.trunk, frame.shape)
    return standing(placed.outside(inside[few]))


def upright_turn(frame: Frame, names: Sequence[str], up: int) -> Array:
    """Return the turn (4,) after which the shape of a trunk stands upright and faces an axis.

    Its mean attitude over time becomes upright; where names tell sides, left lies along X.

    Parameters
    ----------
    frame : Frame
    names : sequence of str
        Of all points.
    up : int
        The vertical axis.
    """
    vertical = np.eye(3)[up]
    # The vertical as the trunk sees it, on average.
    own = rot.rotate(rot.conjugate(frame.turns), vertical).mean(axis=0)
    turn = _between(own, vertical)
    shape = rot.rotate(turn, frame.shape)
    across = _across(shape, [names[point] for point in frame.trunk], up)
    return turn if across is None else rot.multiply(_between(across, np.eye(3)[0]), turn)


def _between(first: Array, second: Array) -> Array:
    """Return the smallest turn (4,) that carries a direction to a unit vector."""
    axis, cosine = np.cross(first, second), float(first @ second)
    sine = float(np.linalg.norm(axis))
    if sine > 0.0:
        return rot.from_rotation_vector(axis / sine * np.arctan2(sine, cosine))
    # None, or half a turn about any axis square to it.
    return rot.from_rotation_vector(np.roll(second, 1) * (np.pi if cosine < 0.0 else 0.0))


def _across(shape: Array, names: Sequence[str], up: int) -> Array | None:
    """Return the level direction (3,) from right to left of a trunk's shape; None if unknown."""
    total, places = np.zeros(3), {name: place for place, name in enumerate(names)}
    for name, place in places.items():
        other = other_side(name, places)
        if other is not None and other in places and is_left(name, other):
            total += shape[place] - shape[places[other]]
    total[up] = 0.0
    return total if np.any(total) else None
