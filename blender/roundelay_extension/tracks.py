# SPDX-License-Identifier: GPL-3.0-or-later
"""The curves of a loop: values of what is keyed, a row a frame, the last the first again."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from mathutils import Quaternion
from numpy.typing import NDArray

from roundelay.geometry import rotations as rot

from .keyed import Keyed, Property

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Track:
    """A property of a loop.

    Attributes
    ----------
    target : Property
    group : str
    indices : tuple of int
        Which of its values are keyed.
    rows : (N + 1, n) ndarray
        All of its values.
    stepped : bool
        Whether it jumps from row to row.
    onward : bool
        Whether it goes on where a period ended, however little.
    """

    target: Property
    group: str
    indices: tuple[int, ...]
    rows: Array = field(repr=False)
    stepped: bool = False
    onward: bool = False

    @classmethod
    def of(cls, one: Property, keyed: Keyed, rows: Array, *, stepped: bool = False) -> Track:
        """Make the track of what is keyed of a property."""
        indices = tuple(sorted(keyed.curves[one]))
        return cls(one, keyed.groups[one], indices, rows, stepped)

    def begun(self, later: int) -> Track:
        """Return the track that begins so many rows later."""
        gain = np.array([self.goes_on(k) for k in range(self.rows.shape[1])])
        rows = self.rows[1 : later + 1] + np.where(gain, self.rows[-1] - self.rows[0], 0.0)
        if self.target.name == "rotation_quaternion":
            rows = rows * np.sign(self.rows[0] @ self.rows[-1])
        return replace(self, rows=np.concatenate([self.rows[later:], rows]))

    def goes_on(self, index: int) -> bool:
        """Tell whether a value's last row is not its first."""
        first, last = self.rows[[0, -1], index]
        least = 1e-6 * max(1.0, float(np.abs(self.rows[:, index]).max()))
        turns_over = self.target.name == "rotation_quaternion"
        return not turns_over and (self.onward or abs(last - first) > least)


def rows_of(turns: Array, name: str) -> Array:
    """Return rotations (n, 4), the last the first again, as quaternions or angles about axes."""
    if name == "rotation_quaternion":
        rows = rot.continuous(turns)
        rows[-1] = rows[0] * np.sign(rows[0] @ rows[-1])
        return rows
    vectors = rot.to_rotation_vector(rot.normalize(turns))
    angles = np.linalg.norm(vectors, axis=1, keepdims=True)
    rows = np.hstack([angles, np.where(angles > 1e-9, vectors, (0.0, 1.0, 0.0))])
    rows[:, 1:] /= np.linalg.norm(rows[:, 1:], axis=1, keepdims=True)
    rows[-1] = rows[0]
    return rows


def angles_of(turns: Array, order: str) -> Array:
    """Return Euler angles (n, 3), each nearest to the one before; the last whole turns on."""
    angles = [Quaternion(turns[0]).to_euler(order)]
    for turn in turns[1:]:
        angles.append(Quaternion(turn).to_euler(order, angles[-1]))
    rows = np.array(angles)
    whole = (rows[-1] - rows[0]) / (2.0 * np.pi)
    if np.allclose(whole, np.round(whole), atol=1e-4):
        rows[-1] = rows[0] + 2.0 * np.pi * np.round(whole)
    return rows
