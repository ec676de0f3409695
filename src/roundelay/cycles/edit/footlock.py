"""Foot lock: keep standing feet where they stand, by inverse kinematics of the legs."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import ROUNDING, smoothstep
from roundelay.base.spans import Span, Spans
from roundelay.cycles.thresholds import FOOTLOCK
from roundelay.geometry import rotations as rot
from roundelay.geometry.contacts import Foot, Mask, contacts, find_feet, foot_points
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion

__all__ = ["eased", "lock_feet", "lock_offsets", "move_foot"]

Array = NDArray[np.float64]


def lock_feet(motion: Motion, longest: int) -> tuple[list[int], Array]:
    """Hold the feet of a motion still while they stand.

    Parameters
    ----------
    motion : Motion
    longest : int
        Stands of this many frames and more are left as they are: those of a foot that stands
        throughout a loop drift with it.

    Returns
    -------
    joints : list of int
        The k joints of legs whose rotations change.
    rotations : (F, k, 4) ndarray
        Their new local rotations.
    """
    positions, orientations = forward_kinematics(
        motion.skeleton, motion.rotations, motion.root_path, translations=motion.translations
    )
    # Points are no legs with bones of one length: they stay as they are.
    free = motion.skeleton.free
    feet = () if free else find_feet(motion.skeleton, positions, motion.up)
    if not feet:
        return [], motion.rotations[:, []]
    points = foot_points(feet, positions, orientations)
    standing = contacts(points, fps=motion.fps, size=motion.skeleton.size, up=motion.up)
    for stands in standing.T:
        for start, stop in Spans.of_mask(stands):
            stands[start:stop] = stop - start < longest
    offsets = lock_offsets(points, standing, motion.up)
    rotations = motion.rotations.copy()
    for foot, offset in zip(feet, np.moveaxis(offsets, 1, 0), strict=True):
        move_foot(motion.skeleton, rotations, foot, offset, positions, orientations)
    joints = [joint for foot in feet for joint in (foot.hip, foot.knee, foot.ankle)]
    return joints, rotations[:, joints]


def lock_offsets(points: Array, standing: Mask, up: int) -> Array:
    """Return by how much to move each foot so that it stands still while it stands.

    While a foot stands it is held, in the plane, where it stands on average; in between, the
    offset of one stand goes over into that of the next, smoothly.

    Parameters
    ----------
    points : (F, n, 3) ndarray
        Where the feet touch the ground, as from `roundelay.geometry.contacts.foot_points`.
    standing : (F, n) ndarray of bool
        When they do.
    up : int
        The vertical axis, in which nothing is moved.

    Returns
    -------
    (F, n, 3) ndarray
        Zero for a foot that never stands.
    """
    offsets = np.zeros_like(points)
    for foot in range(points.shape[1]):
        held = Spans.of_mask(standing[:, foot])
        for start, stop in held:
            here = points[start:stop, foot]
            offsets[start:stop, foot] = here.mean(axis=0) - here
        if held:
            offsets[:, foot] = eased(offsets[:, foot], held)
    offsets[:, :, up] = 0.0
    return offsets


def eased(offsets: Array, held: Sequence[Span]) -> Array:
    """Fill the gaps between held stretches by smooth steps; before and after, stay as held.

    Parameters
    ----------
    offsets : (F, 3) ndarray
        Of which the held frames count.
    held : sequence of (start, stop)
        At least one.

    Returns
    -------
    (F, 3) ndarray
    """
    result = offsets.copy()
    for (_, stop), (start, _) in pairwise(held):
        x = (np.arange(stop, start) - (stop - 1)) / (start - stop + 1)
        step = smoothstep(x)[:, None]
        result[stop:start] = (1.0 - step) * offsets[stop - 1] + step * offsets[start]
    result[: held[0][0]] = offsets[held[0][0]]
    result[held[-1][1] :] = offsets[held[-1][1] - 1]
    return result


def move_foot(
    skeleton: Skeleton,
    rotations: Array,
    foot: Foot,
    offset: Array,
    positions: Array,
    orientations: Array,
) -> None:
    """Move a foot by an offset (F, 3), its orientation kept; changes `rotations` (F, J, 4).

    The two-bone problem solved in closed form: the knee opens or closes in its own plane to
    the new distance from hip to ankle, then the hip turns the leg, the shortest way, to where
    the ankle shall be. A leg that cannot reach is stretched and points there.

    Parameters
    ----------
    skeleton : Skeleton
    rotations : (F, J, 4) ndarray
        Local rotations.
    foot : Foot
    offset : (F, 3) ndarray
    positions, orientations : (F, J, 3), (F, J, 4) ndarray
        Forward kinematics of the rotations given.
    """
    hip, knee, ankle = (positions[:, j] for j in (foot.hip, foot.knee, foot.ankle))
    upper, lower = knee - hip, ankle - knee
    wanted = ankle + offset - hip
    bend = _knee_turn(upper, lower, np.linalg.norm(wanted, axis=-1))
    swung = upper + rot.rotate(bend, lower)
    swing = _shortest(swung, wanted)
    hip_turn = rot.multiply(swing, orientations[:, foot.hip])
    knee_turn = rot.multiply(swing, rot.multiply(bend, orientations[:, foot.knee]))
    above = skeleton.parents[foot.hip]
    chain = [
        (foot.hip, orientations[:, above], hip_turn),
        (foot.knee, hip_turn, knee_turn),
        (foot.ankle, knee_turn, orientations[:, foot.ankle]),
    ]
    for joint, parent, turn in chain:
        rotations[:, joint] = rot.multiply(rot.conjugate(parent), turn)


def _knee_turn(upper: Array, lower: Array, distance: Array) -> Array:
    """Return the turn (F, 4) of the lower bone that gives hip and ankle a distance (F,)."""
    a, b = np.linalg.norm(upper, axis=-1), np.linalg.norm(lower, axis=-1)
    stretch = FOOTLOCK.stretch
    reachable = np.clip(distance, abs(a - b) / stretch, (a + b) * stretch)
    cosine = (reachable**2 - a**2 - b**2) / (2.0 * a * b)
    normal = np.cross(upper, lower)
    sine = np.linalg.norm(normal, axis=-1)
    now = np.arctan2(sine, np.einsum("ij,ij->i", upper, lower))
    turn = np.arccos(np.clip(cosine, -1.0, 1.0)) - now
    # Where the leg is nearly straight, much bending moves the foot little: damped there, as in
    # damped least squares, or the knee would snap.
    bent = np.sin(now) ** 2
    turn *= bent / (bent + FOOTLOCK.damping**2)
    axis = normal / np.maximum(sine, ROUNDING * a * b)[:, None]
    return rot.from_rotation_vector(axis * turn[:, None])


def _shortest(source: Array, target: Array) -> Array:
    """Return the least rotations (F, 4) that turn vectors (F, 3) into directions of others."""
    across = np.cross(source, target)
    along = np.einsum("ij,ij->i", source, target)
    both = np.linalg.norm(source, axis=-1) * np.linalg.norm(target, axis=-1)
    return rot.normalize(np.concatenate([(both + along)[:, None], across], axis=-1))
