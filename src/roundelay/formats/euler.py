"""Euler angles of files, in each joint's own channel order, to and from quaternions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from roundelay.geometry import rotations as rot

__all__ = ["DEGREE", "Winding", "compose", "decompose", "winding"]

Array = NDArray[np.float64]

Winding = Literal["principal", "positive", "continuous"]
"""Which of the equivalent triples a file writes: the second angle within a quarter turn, the
first in [0, 180), or the one nearest to the frame before."""

# Radians of one frame beyond which a pose is no continuation of the one before it.
_JUMP = 1.0
_ROUNDING = 1e-9
_BLOCK = 256

DEGREE = float(np.pi / 180.0)


def compose(
    table: Array, orders: Sequence[str], columns: Sequence[Sequence[int]], *, unit: float
) -> Array:
    """Return the joints' rotations from a table of channels.

    Parameters
    ----------
    table : (F, C) ndarray
        All channels of a file, one row a frame.
    orders : sequence of J str
        Axes of each joint's rotation channels, as `rotations.from_euler` takes them.
    columns : sequence of J sequences of int
        The columns of those channels.
    unit : float
        Radians in one unit of the table's angles.

    Returns
    -------
    (F, J, 4) ndarray
        Continuous in sign.
    """
    result = rot.identity(len(table), len(orders))
    for order in sorted(set(orders) - {""}):
        joints = [joint for joint, own in enumerate(orders) if own == order]
        places = [columns[joint] for joint in joints]
        for rows in _blocks(len(table)):
            result[rows, joints] = rot.from_euler(table[rows, places] * unit, order)
    _make_continuous(result)
    return result


def _make_continuous(rotations: Array) -> None:
    """Choose the signs of rotations (F, J, 4) in place; each block goes on from the one before."""
    for rows in _blocks(len(rotations)):
        first = max(rows.start - 1, 0)
        rotations[first : rows.stop] = rot.continuous(rotations[first : rows.stop])


def _blocks(frames: int) -> Iterator[slice]:
    """Yield ranges of frames that stay in the processor's cache: twice as fast as all at once."""
    for start in range(0, frames, _BLOCK):
        yield slice(start, start + _BLOCK)


def winding(degrees: Array) -> Winding:
    """Tell which equivalent triples of angles (F, 3) a file has written."""
    low, high = degrees.min(axis=0), degrees.max(axis=0)
    extent = np.maximum(-low, high)
    if np.all(extent <= (180.0, 90.0, 180.0)):
        return "principal"
    if low[0] >= 0.0 and np.all(extent <= 180.0):
        return "positive"
    return "continuous"


def decompose(rotations: Array, order: str, written: Winding) -> Array:
    """Return angles in degrees of joints with one channel order.

    Parameters
    ----------
    rotations : (F, J, 4) ndarray
    order : str
        One to three different axes. Of a rotation that they cannot express they give a part.
    written : {"principal", "positive", "continuous"}
        Which equivalent angles to give.

    Returns
    -------
    (F, J, len(order)) ndarray
    """
    full = order + "".join(axis for axis in "ZYX" if axis not in order)
    angles = np.empty((*rotations.shape[:2], 3))
    for rows in _blocks(len(angles)):
        angles[rows] = rot.to_euler(rotations[rows], full)
    if len(order) < 3:
        other = _other(angles)
        angles = _chosen(angles, np.abs(other[..., 2]) < np.abs(angles[..., 2]))
    elif written == "positive":
        first = angles[..., 0]
        angles = _chosen(angles, (first < -_ROUNDING) | (first > np.pi - _ROUNDING))
    if written == "continuous":
        _continue(angles, rotations, branches=len(order) == 3)
    return np.degrees(angles)[..., : len(order)]


def _other(angles: Array) -> Array:
    """Return the other triples (..., 3) of the same rotations."""
    return _wrapped(angles * (1.0, -1.0, 1.0) + np.pi)


def _wrapped(angles: Array) -> Array:
    return np.pi - (np.pi - angles) % (2.0 * np.pi)


def _chosen(angles: Array, turned: NDArray[np.bool_]) -> Array:
    return np.where(turned[..., None], _other(angles), angles)


def _continue(angles: Array, rotations: Array, *, branches: bool) -> None:
    """Make angles (F, J, 3) continuous in place, by whole turns and, if asked, other triples.

    Two triples of a rotation are two half turns apart. Where the angles of a joint change by
    less than one half turn in all, it stays on its branch and on its turn: most joints do.
    """
    steps = np.abs(np.diff(angles, axis=0)).sum(axis=-1)
    restless = np.flatnonzero((steps >= np.pi).any(axis=0))
    if not restless.size:
        return
    own, turns = angles[:, restless], rotations[:, restless]
    jumps = rot.angle_between(turns[1:], turns[:-1]) > _JUMP
    if branches:
        own = _chosen(own, _nearest_branch(own, jumps))
    angles[:, restless] = _unwrapped(own, jumps)


def _nearest_branch(angles: Array, jumps: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return where (F, J) the other triple continues the choice of the frame before."""
    stay = np.abs(_wrapped(angles[1:] - angles[:-1])).sum(axis=-1)
    change = np.abs(_wrapped(_other(angles[1:]) - angles[:-1])).sum(axis=-1)
    turned = np.zeros(angles.shape[:2], int)
    turned[1:] = np.cumsum(change < stay, axis=0)
    return (turned - _at_last_jump(turned, jumps)) % 2 == 1


def _unwrapped(angles: Array, jumps: NDArray[np.bool_]) -> Array:
    turns = np.zeros(angles.shape, int)
    turns[1:] = np.cumsum(np.rint(np.diff(angles, axis=0) / (2.0 * np.pi)).astype(int), axis=0)
    return angles - 2.0 * np.pi * (turns - _at_last_jump(turns, jumps))


def _at_last_jump(values: NDArray[np.int_], jumps: NDArray[np.bool_]) -> NDArray[np.int_]:
    """Return values (F, J, ...) as they were at each joint's last jump (F - 1, J)."""
    starts = np.zeros(values.shape[:2], int)
    starts[1:] = np.where(jumps, np.arange(1, len(values))[:, None], 0)
    starts = np.maximum.accumulate(starts, axis=0)
    return values[starts, np.arange(values.shape[1])]
