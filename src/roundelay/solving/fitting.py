"""Fitting a body to markers: poses frame by frame, and its shape with the poses of many frames.

Poses are found by Levenberg's and Marquardt's method (Marquardt 1963), all frames at once. The
shape, bone lengths and places of markers, is found together with the poses of some frames: bundle
adjustment (Triggs et al. 2000), whose poses are eliminated by Schur's complement. What is known
beforehand enters as observations with a standard deviation.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import TINY
from roundelay.solving.body import Body, Poses
from roundelay.solving.equations import (
    Targets,
    in_blocks,
    normal_equations,
    pose_cost,
    shape_slopes,
)
from roundelay.solving.thresholds import FITTING, SHAPES

__all__ = ["fitted_poses", "fitted_shape"]

Array = NDArray[np.float64]


def fitted_poses(body: Body, poses: Poses, targets: Targets, rounds: int) -> Poses:
    """Fit poses to markers, from poses near them.

    Parameters
    ----------
    body : Body
    poses : Poses
    targets : Targets
    rounds : int
        The most steps.
    """
    blocks = in_blocks(len(poses), body, 3 + 3 * len(body.parents))
    parts = [_fitted_block(body, poses[block], targets[block], rounds) for block in blocks]
    return Poses(
        np.concatenate([part.root for part in parts]),
        np.concatenate([part.rotations for part in parts]),
    )


def _fitted_block(body: Body, poses: Poses, targets: Targets, rounds: int) -> Poses:
    root, rotations = poses.root.copy(), poses.rotations.copy()
    cost, damping = pose_cost(body, poses, targets), np.full(len(poses), FITTING.damping)
    active = np.arange(len(poses))
    for _ in range(rounds):
        now, seen = Poses(root[active], rotations[active]), targets[active]
        equations = normal_equations(body, now, seen)
        step = _solved(equations.matrix, equations.right[..., None], damping[active])
        trial = now.moved(step[..., 0])
        after = pose_cost(body, trial, seen)
        better = after < cost[active]
        gain = (cost[active] - after) / np.maximum(cost[active], TINY)
        taken = active[better]
        root[taken], rotations[taken] = trial.root[better], trial.rotations[better]
        cost[taken] = after[better]
        damping[active] *= np.where(better, 1.0 / FITTING.change, FITTING.change)
        going = np.where(better, gain > FITTING.gain, damping[active] < FITTING.stuck)
        active = active[going]
        if not len(active):
            break
    return Poses(root, rotations)


def fitted_shape(body: Body, poses: Poses, targets: Targets) -> tuple[Body, Poses]:
    """Fit the shape of a body and its poses to markers, from a shape and poses near them.

    Parameters
    ----------
    body : Body
        Its shape is what is expected beforehand, too.
    poses : Poses
        Of some frames.
    targets : Targets
        Of the same frames.
    """
    # Skin moves alike in frames that are alike: they are no new observations.
    certainty = body.certainty() * max(1.0, len(poses) / SHAPES.independent)
    expected = body.shape
    damping = FITTING.damping

    def cost(body: Body, poses: Poses) -> float:
        apart = body.shape - expected
        return float(pose_cost(body, poses, targets).sum() + apart @ certainty @ apart)

    now = cost(body, poses)
    for _ in range(FITTING.shape_rounds):
        shape, steps = _joint_step(body, poses, targets, expected, certainty, damping)
        trial, moved = body.shaped(body.shape + shape), poses.moved(steps)
        after = cost(trial, moved)
        if after >= now:
            damping *= FITTING.change
            if damping > FITTING.stuck:
                break
            continue
        gain, body, poses, now = (now - after) / now, trial, moved, after
        damping /= FITTING.change
        if gain < FITTING.shape_gain:
            break
    return body, poses


def _joint_step(
    body: Body, poses: Poses, targets: Targets, expected: Array, certainty: Array, damping: float
) -> tuple[Array, Array]:
    """Return the step of the shape (G,) and of the poses (F, D)."""
    matrix = certainty.copy()
    right = certainty @ (expected - body.shape)
    kept: list[Array] = []
    for block in in_blocks(len(poses), body, len(right) + 3 + 3 * len(body.parents)):
        equations = normal_equations(body, poses[block], targets[block])
        slopes = shape_slopes(body, equations)
        mixed = np.swapaxes(equations.slopes, 1, 2) @ slopes
        both = np.concatenate([mixed, equations.right[..., None]], axis=2)
        solved = _solved(equations.matrix, both, damping)
        flat = slopes.reshape(-1, slopes.shape[2])
        joint = np.einsum("fdg,fdh->gh", mixed, solved, optimize=True)
        matrix += flat.T @ flat - joint[:, :-1]
        right += flat.T @ equations.residuals.ravel() - joint[:, -1]
        kept.append(solved)
    np.fill_diagonal(matrix, matrix.diagonal() * (1.0 + damping))
    shape = np.asarray(np.linalg.solve(matrix, right), float)
    steps = np.concatenate(kept)
    return shape, steps[:, :, -1] - steps[:, :, :-1] @ shape


def _solved(matrix: Array, right: Array, damping: Array | float) -> Array:
    """Solve damped normal equations (F, D, D) for right sides (F, D, k)."""
    damped = matrix.copy()
    diagonal = np.einsum("fii->fi", matrix)
    least = FITTING.ridge * (diagonal.mean(axis=1, keepdims=True) + 1.0)
    np.einsum("fii->fi", damped)[:] += np.reshape(damping, (-1, 1)) * diagonal + least
    return np.asarray(np.linalg.solve(damped, right))
