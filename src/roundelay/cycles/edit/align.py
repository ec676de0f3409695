"""Bring cycles into phase and heading with each other ([A] section 7).

What a cycle consists of is linear in its coefficients: shifting the phase, turning about the
vertical and exchanging left and right are linear maps of them, exact and without resampling.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import SIX_DIGITS
from roundelay.base.threads import one_thread
from roundelay.cycles.contacts import standing_feet
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.thresholds import ALIGNMENT
from roundelay.geometry import rotations as rot
from roundelay.geometry import symmetry
from roundelay.geometry.kinematics import heading
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.features import point_cloud
from roundelay.phase.harmonic import HarmonicCurve
from roundelay.phase.tempo import lowest_between

__all__ = ["Alignment", "Criterion", "align", "hung_as", "mapped", "mirrored", "shifted"]

Array = NDArray[np.float64]
Criterion = Literal["poses", "contacts"]


@dataclass(frozen=True, eq=False)
class Alignment:
    """A cycle brought into phase and heading with another.

    Attributes
    ----------
    cycle : Cycle
        The second cycle, shifted, turned and, where asked and better, mirrored.
    offset : float
        Phase by which it was shifted.
    distance : float
        RMS distance of the joints over the cycle, in body sizes.
    mirrored : bool
        Whether left and right were exchanged.
    """

    cycle: Cycle
    offset: float
    distance: float
    mirrored: bool


def shifted(cycle: Cycle, offset: float) -> Cycle:
    """Return the cycle that begins at phase `offset` of this one."""
    moved = None if cycle.translations is None else cycle.translations.shifted(offset)
    return replace(
        cycle,
        pose=cycle.pose.shifted(offset),
        odd_pose=None if cycle.odd_pose is None else cycle.odd_pose.shifted(offset),
        velocity=cycle.velocity.shifted(offset),
        height=cycle.height.shifted(offset),
        translations=moved,
        phase=None if cycle.phase is None else cycle.phase - offset,
    )


def mirrored(cycle: Cycle) -> Cycle:
    """Return the cycle with left and right exchanged.

    Raises
    ------
    SkeletonMismatch
        If a joint of one side has no partner.
    """
    other = symmetry.partners(cycle.skeleton)
    across = symmetry.lateral_axis(cycle.skeleton, other)
    sideways = across if across != cycle.up else (0 if cycle.up else 2)
    joints = cycle.skeleton.n_joints

    def poses(values: Array) -> Array:
        rows = values.reshape(-1, joints, 4)
        turned = symmetry.reflected_rotations(rows, other, across, sideways)
        return turned.reshape(values.shape)

    def places(values: Array) -> Array:
        rows = values.reshape(-1, joints, 3)[:, other] * symmetry.reflection(across)
        return rows.reshape(values.shape)

    moved = None if cycle.translations is None else mapped(cycle.translations, places)
    return replace(
        cycle,
        skeleton=symmetry.reflected_skeleton(cycle.skeleton, other, across, sideways),
        pose=mapped(cycle.pose, poses),
        odd_pose=None if cycle.odd_pose is None else mapped(cycle.odd_pose, poses),
        velocity=mapped(cycle.velocity, lambda v: v * symmetry.reflection(sideways)),
        turning=-cycle.turning,
        translations=moved,
        above=cycle.above and cycle.above.reflected(across, sideways),
    )


def hung_as(cycle: Cycle, onto: Skeleton) -> Cycle:
    """Return a cycle whose hips hang on the root as in another skeleton; no joint moves.

    Some files give the place of the hips in their first frame as the bone's offset from the root,
    which says nothing of the body.

    Parameters
    ----------
    cycle : Cycle
    onto : Skeleton
        With the same joints.
    """
    chain = list(cycle.skeleton.trunk[1:])
    new, old = onto.offsets[chain].sum(axis=0), cycle.skeleton.offsets[chain].sum(axis=0)
    if np.allclose(new, old, rtol=0.0, atol=SIX_DIGITS * cycle.skeleton.size):
        return cycle
    count = ALIGNMENT.phases
    grid, up = np.arange(count) / count, np.eye(3)[cycle.up]
    away = HarmonicCurve.through(rot.rotate(cycle.rotations(grid)[:, 0], old - new))
    moves = away(grid, derivative=1) + cycle.turning * np.cross(up, away(grid))
    velocity = cycle.velocity(grid) + moves * (1.0 - up)
    height = cycle.height(grid) + away(grid)[:, [cycle.up]]

    def hung(rows: Array) -> Array:
        changed = rows.reshape(-1, 3).copy()
        changed[chain] = onto.offsets[chain]
        return changed

    moved, above = cycle.translations, cycle.above
    if above is not None:
        # The root's path begins at the origin, wherever the root is on the body.
        shifts = np.where(above.travels[:, None], away.constant, away([0.0])) * (1.0 - up)
        above = replace(above, places=above.places - shifts)
    return replace(
        cycle,
        skeleton=replace(cycle.skeleton, offsets=hung(cycle.skeleton.offsets)),
        velocity=HarmonicCurve.through(velocity),
        height=HarmonicCurve.through(height),
        translations=moved and replace(moved, constant=hung(moved.constant).reshape(-1)),
        above=above,
    )


def mapped(curve: HarmonicCurve, change: Callable[[Array], Array]) -> HarmonicCurve:
    """Apply a linear map of values (n, d) to a curve by its coefficients."""
    return replace(
        curve,
        constant=change(curve.constant[None])[0],
        sine=change(curve.sine),
        cosine=change(curve.cosine),
    )


@one_thread
def align(
    first: Cycle, second: Cycle, *, by: Criterion = "poses", mirror: bool = False
) -> Alignment:
    """Bring a cycle into phase and heading with another ([A] section 7: a search in one dimension).

    Parameters
    ----------
    first, second : Cycle
        Of one skeleton; bone lengths may differ.
    by : {"poses", "contacts"}
        What shall agree: the poses, or when the feet stand; where they stand equally well at
        several phases, and where not the same feet do, the poses decide.
    mirror : bool
        Try the second one mirrored as well and take the one whose poses are nearer.

    Returns
    -------
    Alignment

    Raises
    ------
    SkeletonMismatch
        Naming the joints that only one of them has.
    ValueError
        If the criterion is unknown, or another axis points up in each.
    """
    if by not in get_args(Criterion):
        raise ValueError(f"expected to align by one of {get_args(Criterion)}, found {by!r}")
    first.skeleton.require_same(second.skeleton)
    if first.up != second.up:
        raise ValueError(
            f"expected one axis that points up, found {'XYZ'[first.up]} and {'XYZ'[second.up]}"
        )
    second = hung_as(second, first.skeleton)
    tried = [(second, False)] + ([(mirrored(second), True)] if mirror else [])
    found = [_in_phase(first, candidate, by, swapped) for candidate, swapped in tried]
    return min(found, key=lambda alignment: alignment.distance)


def _in_phase(first: Cycle, second: Cycle, by: Criterion, swapped: bool) -> Alignment:
    count = ALIGNMENT.phases
    grid = np.arange(count) / count
    shown = [c.at(grid, frame_time=1.0).with_root_motion() for c in (first, second)]
    squares = _apart(*map(point_cloud, shown))
    allowed = _same_contacts(first, second) if by == "contacts" else np.ones(count, bool)
    best = int(np.argmin(np.where(allowed, squares, np.inf)))
    offset = (best + lowest_between(squares[[best - 1, best, (best + 1) % count]])) / count
    distance = float(np.sqrt(max(squares[best], 0.0) / (count * first.skeleton.n_joints)))
    turn = _facing(first) - _facing(second)
    return Alignment(_turned(shifted(second, offset), turn), offset % 1.0, distance, swapped)


def _apart(ours: Array, theirs: Array) -> Array:
    """Sum |a(x) - b(x + s)|^2 over x, for all s at once by the correlation theorem."""
    product = np.conj(np.fft.rfft(ours, axis=0)) * np.fft.rfft(theirs, axis=0)
    correlation = np.fft.irfft(product.sum(axis=1), len(ours))
    return np.asarray(np.sum(ours**2) + np.sum(theirs**2) - 2.0 * correlation)


def _same_contacts(first: Cycle, second: Cycle) -> NDArray[np.bool_]:
    """Tell the shifts (phases,) at which the feet stand at the same time, as nearly as they can."""
    count = ALIGNMENT.phases
    (ours, one), (theirs, two) = (standing_feet(cycle, count) for cycle in (first, second))
    if [foot.joint for foot in ours] != [foot.joint for foot in theirs]:
        return np.ones(count, bool)
    differing = np.round(_apart(one.astype(float), two.astype(float)))
    return np.asarray(differing == differing.min())


def _facing(cycle: Cycle) -> float:
    grid = np.arange(ALIGNMENT.phases) / ALIGNMENT.phases
    root = rot.mean(cycle.rotations(grid)[:, 0])
    return float(heading(root, cycle.up))


def _turned(cycle: Cycle, angle: float) -> Cycle:
    """Turn the whole cycle about the up axis."""
    turn = rot.from_rotation_vector(angle * np.eye(3)[cycle.up])

    def poses(values: Array) -> Array:
        rows = values.reshape(-1, cycle.skeleton.n_joints, 4).copy()
        rows[:, 0] = rot.multiply(turn, rows[:, 0])
        return rows.reshape(values.shape)

    return replace(
        cycle,
        pose=mapped(cycle.pose, poses),
        odd_pose=None if cycle.odd_pose is None else mapped(cycle.odd_pose, poses),
        velocity=mapped(cycle.velocity, lambda v: rot.rotate(turn, v)),
        above=cycle.above and cycle.above.turned(turn),
    )
