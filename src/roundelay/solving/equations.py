"""The least squares between markers and a body: residuals, slopes, normal equations.

A marker m on the bone of joint s lies at ``P_s + R_s p_m``. A small turn d of joint j, in its own
axes, moves it by ``(R_j d) x (x_m - P_j)`` if it hangs below j (the geometric Jacobian; Murray, Li,
Sastry 1994, section 3.4); an offset o of joint c moves all below c by ``R_parent(c) do``, a place p
by ``R_s dp``. Markers far off weigh less (Huber 1964); those not seen weigh nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import SIX_DIGITS
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.solving.body import Body, Poses, below
from roundelay.solving.thresholds import FITTING

__all__ = [
    "Equations",
    "Targets",
    "bends",
    "in_blocks",
    "marker_places",
    "normal_equations",
    "pose_cost",
    "shape_slopes",
]

Array = NDArray[np.float64]

_UPRIGHT = np.array([0.0, 1.0, 0.0])
# Step of numerical slopes of the bends, in radians.
_STEP = SIX_DIGITS
# Numbers that are held at once: 80 MB.
_BLOCK = 10_000_000


@dataclass(frozen=True, eq=False)
class Targets:
    """Hold where markers were seen.

    Attributes
    ----------
    places : (F, M, 3) ndarray
        Of what was not seen any value.
    weights : (F, M) ndarray
        One over the variance; 0 for what was not seen.
    turns : (F, J, 4) ndarray, optional
        Local rotations that neighbouring frames lead to expect.
    trust : (F, J) ndarray, optional
        One over their variance, in radians.
    """

    places: Array
    weights: Array
    turns: Array | None = None
    trust: Array | None = None

    def __getitem__(self, frames: slice | NDArray[np.intp]) -> Targets:
        turns = None if self.turns is None else self.turns[frames]
        trust = None if self.trust is None else self.trust[frames]
        return Targets(self.places[frames], self.weights[frames], turns, trust)


def in_blocks(frames: int, body: Body, columns: int) -> list[slice]:
    """Return ranges of frames whose slopes of so many columns fit into little memory."""
    size = max(1, _BLOCK // (3 * max(len(body.joints), 1) * columns))
    return [slice(start, min(start + size, frames)) for start in range(0, frames, size)]


@dataclass(frozen=True, eq=False)
class _Placed:
    """Hold a posed body: joints (F, J, 3), their axes (F, J, 3, 3), markers (F, M, 3)."""

    joints: Array
    axes: Array
    markers: Array


def _placed(body: Body, poses: Poses) -> _Placed:
    """Place joints and markers in the world."""
    joints, turns = forward_kinematics(body.skeleton, poses.rotations, poses.root)
    carried = rot.rotate(turns[:, body.joints], body.places)
    return _Placed(joints, rot.to_matrix(turns), joints[:, body.joints] + carried)


def marker_places(body: Body, poses: Poses) -> Array:
    """Return where the markers of a body are, (F, M, 3)."""
    return _placed(body, poses).markers


def bends(body: Body, rotations: Array) -> Array:
    """Return how far joints are bent (..., J, 3), in standard deviations.

    Swing about X, twist about Y, swing about Z: the bone along Y first twists, then swings. A
    joint that bends one way is held, where it bends the other, by a limit.
    """
    twist = rot.twist(rotations, _UPRIGHT)
    swing = rot.to_rotation_vector(rot.multiply(rotations, rot.conjugate(twist)))
    angles = np.stack(
        [swing[..., 0], rot.to_rotation_vector(twist)[..., 1], swing[..., 2]], axis=-1
    )
    spread = np.broadcast_to(body.bend, angles.shape).copy()
    beyond = angles[..., 0] * body.one_way < 0.0
    spread[..., 0] = np.where(beyond, FITTING.limit, spread[..., 0])
    return np.asarray(angles / spread)


def _bend_slopes(body: Body, rotations: Array, now: Array) -> Array:
    """Return slopes (F, J, 3, 3) of the bends (row) by turns in the joints' axes (column)."""
    columns = []
    for axis in np.eye(3):
        turned = rot.multiply(rotations, rot.from_rotation_vector(_STEP * axis))
        columns.append((bends(body, turned) - now) / _STEP)
    slopes = np.stack(columns, axis=-1)
    # At a fold of the angles numbers jump; nothing is known of the slope there.
    return np.where(np.abs(slopes) < FITTING.steepest, slopes, 0.0)


def _slack(body: Body, poses: Poses, targets: Targets) -> Array | None:
    """Return turns (F, J, 3) from the expected rotations; None where none is expected."""
    if targets.turns is None:
        return None
    return rot.vector_between(targets.turns, poses.rotations)


def _huber(squares: Array) -> tuple[Array, Array]:
    """Return cost and weight of squared residuals in standard deviations."""
    size, far = np.sqrt(squares), FITTING.far
    cost = np.where(size <= far, squares, 2.0 * far * size - far * far)
    return cost, np.where(size <= far, 1.0, far / np.maximum(size, far))


def pose_cost(body: Body, poses: Poses, targets: Targets) -> Array:
    """Return twice the cost (F,) of poses: of markers, bends and expected rotations."""
    apart = marker_places(body, poses) - targets.places
    cost, _ = _huber(targets.weights * np.sum(apart**2, axis=2))
    total = cost.sum(axis=1) + np.sum(bends(body, poses.rotations) ** 2, axis=(1, 2))
    slack = _slack(body, poses, targets)
    if slack is not None and targets.trust is not None:
        total = total + np.sum(targets.trust * np.sum(slack**2, axis=2), axis=1)
    return np.asarray(total)


@dataclass(frozen=True, eq=False)
class Equations:
    """Hold normal equations of poses.

    Attributes
    ----------
    matrix : (F, D, D) ndarray
    right : (F, D) ndarray
        The step that is sought solves ``matrix step = right``.
    slopes : (F, 3 M, D) ndarray
        Weighted slopes of markers.
    residuals : (F, 3 M) ndarray
        Weighted, target minus marker.
    roots : (F, M) ndarray
        Roots of the weights.
    axes : (F, J, 3, 3) ndarray
    """

    matrix: Array
    right: Array
    slopes: Array
    residuals: Array
    roots: Array
    axes: Array


def normal_equations(body: Body, poses: Poses, targets: Targets) -> Equations:
    """Linearise about some poses."""
    frames, joints = len(poses), len(body.parents)
    now = _placed(body, poses)
    apart = targets.places - now.markers
    _, far = _huber(targets.weights * np.sum(apart**2, axis=2))
    roots = np.sqrt(targets.weights * far)
    slopes = np.zeros((frames, len(body.joints), 3, 3 + 3 * joints))
    slopes[..., :3] = np.eye(3)
    for joint, carried in enumerate(body.carried):
        arms = now.markers[:, carried] - now.joints[:, joint, None]
        column = 3 + 3 * joint
        slopes[:, carried, :, column : column + 3] = _turning(arms, now.axes[:, joint])
    slopes *= roots[:, :, None, None]
    rows = slopes.reshape(frames, -1, 3 + 3 * joints)
    residuals = (apart * roots[..., None]).reshape(frames, -1)
    across = np.swapaxes(rows, 1, 2)
    matrix, right = across @ rows, (across @ residuals[..., None])[..., 0]
    _add_bends(body, poses, targets, matrix, right)
    return Equations(matrix, right, rows, residuals, roots, now.axes)


def _turning(arms: Array, axes: Array) -> Array:
    """Return how ends of arms (F, m, 3) move as axes (F, 3, 3) turn about themselves."""
    x, y, z = np.moveaxis(arms, -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, z, -y], [-z, zero, x], [y, -x, zero]]
    crossed = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
    return np.asarray(crossed @ axes[:, None])


def _add_bends(body: Body, poses: Poses, targets: Targets, matrix: Array, right: Array) -> None:
    now = bends(body, poses.rotations)
    slopes = _bend_slopes(body, poses.rotations, now)
    blocks = np.einsum("fjik,fjil->fjkl", slopes, slopes)
    sides = -np.einsum("fjik,fji->fjk", slopes, now)
    slack = _slack(body, poses, targets)
    if slack is not None and targets.trust is not None:
        blocks = blocks + targets.trust[..., None, None] * np.eye(3)
        sides = sides - targets.trust[..., None] * slack
    for joint in range(len(body.parents)):
        own = slice(3 + 3 * joint, 6 + 3 * joint)
        matrix[:, own, own] += blocks[:, joint]
        right[:, own] += sides[:, joint]


def shape_slopes(body: Body, equations: Equations) -> Array:
    """Return weighted slopes (F, 3 M, G) of markers by the body's shape."""
    axes, carried = equations.axes, below(body.parents)[:, body.joints]
    frames, markers = equations.roots.shape
    bones = len(body.parents) - 1
    slopes = np.zeros((frames, markers, 3, 3 * (bones + markers)))
    for joint in range(1, bones + 1):
        moved = axes[:, body.parents[joint], None]
        slopes[:, carried[joint], :, 3 * (joint - 1) : 3 * joint] = moved
    for marker in range(markers):
        column = 3 * (bones + marker)
        slopes[:, marker, :, column : column + 3] = axes[:, body.joints[marker]]
    slopes *= equations.roots[:, :, None, None]
    return slopes.reshape(frames, 3 * markers, -1)
