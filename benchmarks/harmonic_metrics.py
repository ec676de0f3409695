"""How far a loop of rotations is from a capture, as [C] measures it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.formats.acclaim import AcclaimLayout
from roundelay.geometry import rotations as rot
from roundelay.motion.motion import Motion
from roundelay.reproduction.configuration import euler_angles

Array = NDArray[np.float64]

# Whose channels some functions read: what [C] measures distances in.
LABELLED = {"errors": "[C] channels"}


def euler_squares(capture: Array, loop: Array) -> Array:
    """Return squared distances (M, N, J) of Euler angles, over equivalent triples the least."""
    best = np.full((len(capture), len(loop), capture.shape[1]), np.inf)
    for triple in (loop, loop * (1.0, -1.0, 1.0) + np.pi):
        apart = capture[:, None] - triple
        apart -= 2 * np.pi * np.round(apart / (2 * np.pi))
        best = np.minimum(best, np.einsum("mnjk,mnjk->mnj", apart, apart))
    return best


def rotation_squares(capture: Array, loop: Array) -> Array:
    """Return squared angles of rotation (M, N, J)."""
    cosine = np.abs(np.einsum("mjk,njk->mnj", capture, loop))
    return (2.0 * np.arccos(np.minimum(cosine, 1.0))) ** 2


def matched(squares: Array, *, root: bool) -> float:
    """Lay a repeated loop against a capture: [C] eq. 4.4, 4.5 on squared distances (M, N, J)."""
    apart = np.sqrt(squares[:, :, 0 if root else 1 :].sum(axis=2))
    where, size = np.arange(len(apart)), apart.shape[1]
    rows = [apart[where, (where + n) % size] for n in range(size)]
    best = min(rows, key=lambda row: float(row.sum()))
    return float(np.sqrt(np.mean(best**2)))


def composed(motion: Motion, angles: Array) -> Array:
    """Return rotations (F, J, 4) of angles as `euler_angles` gives them."""
    layout = motion.skeleton.layout
    if isinstance(layout, AcclaimLayout):
        axes = layout.local_axes()
        own = rot.from_euler(angles, "ZYX")
        return rot.multiply(axes, rot.multiply(own, rot.conjugate(axes)))
    turned = rot.identity(*angles.shape[:2])
    for joint, order in enumerate(layout.orders):
        turned[:, joint] = rot.from_euler(angles[:, joint, : len(order)], order)
    return turned


def errors(motion: Motion, loop: Array) -> dict[str, float]:
    """Measure a loop of rotations (N, J, 4) by both metrics."""
    euler = euler_squares(euler_angles(motion, motion.rotations), euler_angles(motion, loop))
    turned = rotation_squares(motion.rotations, loop)
    return {
        "channels": matched(euler, root=True),
        "rotation": matched(turned, root=False),
    }
