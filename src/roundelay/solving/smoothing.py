"""Poses of all frames at once: as the markers tell, and as smooth as their noise asks for.

The most likely motion if joints accelerate at random, with a known spread, and markers are off by a
known noise (a Wiener process; Wahba 1990, as splines; Woltring 1985 for markers). The noise is
measured in the take: what third differences in time hold beyond a motion (Rice 1984). Little noise
means little smoothing; where markers are missing or do not tell a turn, the motion goes on evenly.

Each step solves one banded system of equations, frames two by two.
"""

from __future__ import annotations

from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import ROUNDING
from roundelay.geometry import rotations as rot
from roundelay.motion.poses import Mask
from roundelay.solving.body import Body, Poses
from roundelay.solving.equations import Targets, in_blocks, normal_equations, pose_cost
from roundelay.solving.thresholds import SMOOTHING

__all__ = ["measured_noise", "smooth_poses"]

Array = NDArray[np.float64]


def measured_noise(positions: Array, seen: Mask) -> float:
    """Return the standard deviation of a coordinate's noise, the median of all points.

    Parameters
    ----------
    positions : (F, N, 3) ndarray
    seen : (F, N) ndarray of bool
    """
    if len(positions) < 4:
        return 0.0
    changes = np.diff(positions, n=3, axis=0)
    whole = seen[3:] & seen[2:-1] & seen[1:-2] & seen[:-3]
    # Third differences of white noise have 1 + 9 + 9 + 1 times its variance; half of a normal
    # variable lies within the quartiles.
    usual = NormalDist().inv_cdf(3 / 4) * np.sqrt(1 + 9 + 9 + 1)
    spreads = [
        np.median(np.abs(changes[whole[:, point], point])) / usual
        for point in range(positions.shape[1])
        if whole[:, point].any()
    ]
    return float(np.median(spreads)) if spreads else 0.0


def smooth_poses(body: Body, poses: Poses, targets: Targets, *, fps: float, share: float) -> Poses:
    """Fit the poses of all frames together, from poses near them.

    Parameters
    ----------
    body : Body
    poses : Poses
    targets : Targets
    fps : float
    share : float
        The measured noise as a share of the deviation that the targets' weights stand for.
    """
    spread = np.full(3 + 3 * len(body.parents), SMOOTHING.turning)
    spread[:3] = SMOOTHING.moving
    stiffness = (max(share, SMOOTHING.least) * fps**2 / spread) ** 2
    # Many joints make large matrices.
    size = max(2 * SMOOTHING.lap, SMOOTHING.window * SMOOTHING.joints**2 // len(body.parents) ** 2)
    size, lap = min(size, SMOOTHING.window), SMOOTHING.lap
    root, rotations = poses.root.copy(), poses.rotations.copy()
    for start in range(0, len(poses), size):
        window = slice(max(start - lap, 0), min(start + size + lap, len(poses)))
        now = Poses(root[window], rotations[window])
        found = _smooth_window(body, now, targets[window], stiffness)
        # Frames that the window before left are not changed any more.
        skip = start - window.start
        root[start : window.stop] = found.root[skip:]
        rotations[start : window.stop] = found.rotations[skip:]
    return Poses(root, rotations)


def _accelerations(poses: Poses) -> Array:
    """Return second differences (F - 2, D) of places and turns."""
    moved = np.diff(poses.root, n=2, axis=0)
    turned = np.diff(rot.vector_between(poses.rotations[:-1], poses.rotations[1:]), axis=0)
    return np.concatenate([moved, turned.reshape(len(turned), -1)], axis=1)


def _smooth_window(body: Body, poses: Poses, targets: Targets, stiffness: Array) -> Poses:
    def cost(poses: Poses) -> float:
        rough = np.sum(stiffness * _accelerations(poses) ** 2)
        return float(pose_cost(body, poses, targets).sum() + rough)

    if len(poses) < 3:
        return poses
    now, damping = cost(poses), SMOOTHING.damping
    for _ in range(SMOOTHING.rounds):
        matrix, right = _system(body, poses, targets)
        right -= _spread_out(stiffness * _accelerations(poses))
        trial = poses.moved(_banded_step(matrix, right, stiffness, damping))
        after = cost(trial)
        if after >= now:
            damping *= SMOOTHING.change
            continue
        gain, poses, now = (now - after) / now, trial, after
        damping /= SMOOTHING.change
        if gain < SMOOTHING.gain:
            break
    return poses


def _system(body: Body, poses: Poses, targets: Targets) -> tuple[Array, Array]:
    """Return the normal equations of all frames, each by itself: (F, D, D) and (F, D)."""
    size = 3 + 3 * len(body.parents)
    matrix, right = np.empty((len(poses), size, size)), np.empty((len(poses), size))
    for block in in_blocks(len(poses), body, size):
        equations = normal_equations(body, poses[block], targets[block])
        matrix[block], right[block] = equations.matrix, equations.right
    return matrix, right


def _spread_out(forces: Array) -> Array:
    """Return the adjoint of second differences, (F, D) of (F - 2, D)."""
    result = np.zeros((len(forces) + 2, forces.shape[1]))
    result[:-2] += forces
    result[1:-1] -= 2.0 * forces
    result[2:] += forces
    return result


def _band(frames: int) -> tuple[Array, Array, Array]:
    """Return the diagonals 0, 1 and 2 of second differences squared."""
    at = np.arange(frames - 2)
    middle, first, second = np.zeros(frames), np.zeros(frames - 1), np.zeros(frames - 2)
    for place, value in enumerate((1.0, -2.0, 1.0)):
        middle[at + place] += value * value
    first[at] += -2.0
    first[at + 1] += -2.0
    second[at] += 1.0
    return middle, first, second


def _banded_step(matrix: Array, right: Array, stiffness: Array, damping: float) -> Array:
    """Solve for the steps (F, D) of all frames: block elimination, two frames a block."""
    frames, size = right.shape
    middle, first, second = _band(frames)
    blocks = matrix.copy()
    diagonal = np.einsum("fii->fi", blocks)
    diagonal += middle[:, None] * stiffness + damping * diagonal + ROUNDING
    pairs = (frames + 1) // 2
    kept: list[Array] = []
    below: Array | None = None
    for pair in range(pairs):
        a, b = 2 * pair, min(2 * pair + 2, frames)
        width = (b - a) * size
        own, side = np.zeros((width, width)), right[a:b].reshape(-1).copy()
        for k in range(b - a):
            own[k * size : (k + 1) * size, k * size : (k + 1) * size] = blocks[a + k]
        if b - a == 2:
            own[:size, size:] = own[size:, :size] = np.diag(first[a] * stiffness)
        if below is not None:
            carried = kept[-1]
            own -= below.T @ carried[:, :-1]
            side -= below.T @ carried[:, -1]
        after = _coupling(a, b, frames, first, second, stiffness)
        kept.append(np.linalg.solve(own, np.column_stack([after, side])))
        below = after
    return _substituted(kept, size)


def _coupling(
    start: int, stop: int, frames: int, first: Array, second: Array, stiffness: Array
) -> Array:
    """Return how two frames hang together with the next two."""
    size, later = len(stiffness), min(stop + 2, frames)
    result = np.zeros(((stop - start) * size, (later - stop) * size))
    for row in range(start, stop):
        for column in range(stop, later):
            apart = column - row
            if apart <= 2:
                value = (first if apart == 1 else second)[row] * stiffness
                r, c = (row - start) * size, (column - stop) * size
                np.einsum("ii->i", result[r : r + size, c : c + size])[:] = value
    return result


def _substituted(kept: list[Array], size: int) -> Array:
    steps: list[Array] = []
    for solved in reversed(kept):
        step = solved[:, -1].copy()
        if steps:
            step -= solved[:, :-1] @ steps[-1]
        steps.append(step)
    return np.concatenate(steps[::-1]).reshape(-1, size)
