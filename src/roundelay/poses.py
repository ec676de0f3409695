"""From poses to points: what the distance between two poses means.

A pose becomes a point whose Euclidean distance to another says how different the two look.
The default, joint positions relative to the root with the root's own rotation left out,
weighs every bone by its length and has no full turns to unwrap, which joint angles have
([C] ch. 4 and 6 discuss both).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.errors import SkeletonMismatch
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics, heading
from roundelay.motion import Motion

__all__ = [
    "Features",
    "first_differences",
    "lag_distances",
    "point_cloud",
    "principal_components",
    "with_velocity",
]

Array = NDArray[np.float64]
Features = Literal["positions", "heading", "quaternions", "angles"]


def point_cloud(
    motion: Motion,
    features: Features = "positions",
    *,
    joints: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    differences: bool = False,
) -> Array:
    """Map every frame to a point.

    Parameters
    ----------
    motion : Motion
    features : {"positions", "heading", "quaternions", "angles"}
        - ``positions``: joint positions relative to the root, without the root's rotation, in
          units of the skeleton's size;
        - ``heading``: the same, with the root's pitch and roll but not its heading;
        - ``quaternions``: rotations of all joints but the root, signs continuous in time ([B]);
        - ``angles``: rotation vectors of all joints but the root, in radians, unwrapped
          ([A], [C]: joint angles).
    joints : (k,) array_like of int, optional
        Use these joints only (the root counts for ``heading`` only).
    weights : (J,) array_like, optional
        One factor a joint, for instance `Skeleton.bone_lengths` ([C] ch. 4) or masses ([A] 7).
    differences : bool
        Append the root's velocity and turning rate ([A] 4.1), per frame, in sizes and radians.

    Returns
    -------
    (F, d) ndarray

    Raises
    ------
    ValueError
        If `features` is unknown.
    SkeletonMismatch
        If no joint is left.
    """
    if features not in get_args(Features):
        raise ValueError(f"expected features among {get_args(Features)}, found {features!r}")
    values = _JOINT_FEATURES[features](motion)
    if weights is not None:
        values = values * np.asarray(weights, float)[None, :, None]
    chosen = np.arange(motion.skeleton.n_joints) if joints is None else np.asarray(joints)
    chosen = chosen[chosen != 0]
    if len(chosen) == 0:
        raise SkeletonMismatch("expected at least one joint besides the root, found none")
    points = values[:, chosen].reshape(len(motion), -1)
    return np.hstack([points, first_differences(motion)]) if differences else points


def _positions(motion: Motion) -> Array:
    upright = motion.rotations.copy()
    upright[:, 0] = (1.0, 0.0, 0.0, 0.0)
    placed, _ = forward_kinematics(motion.skeleton, upright, translations=motion.translations)
    return placed / motion.skeleton.size


def _heading_positions(motion: Motion) -> Array:
    ahead = motion.rotations.copy()
    ahead[:, 0] = rot.multiply(
        rot.conjugate(rot.twist(motion.rotations[:, 0], motion.up_vector)), ahead[:, 0]
    )
    placed, _ = forward_kinematics(motion.skeleton, ahead, translations=motion.translations)
    return placed / motion.skeleton.size


def _angles(motion: Motion) -> Array:
    vectors = rot.to_rotation_vector(motion.rotations)
    return _unwrap_vectors(vectors)


def _unwrap_vectors(vectors: Array) -> Array:
    """Add whole turns about each vector's axis where that is nearer to the frame before."""
    result = vectors.copy()
    for frame in range(1, len(vectors)):
        angle = np.linalg.norm(vectors[frame], axis=-1, keepdims=True)
        axis = vectors[frame] / np.maximum(angle, 1e-12)
        along = np.sum(axis * result[frame - 1], axis=-1, keepdims=True)
        result[frame] += np.round((along - angle) / (2 * np.pi)) * 2 * np.pi * axis
    return result


_JOINT_FEATURES = {
    "positions": _positions,
    "heading": _heading_positions,
    "quaternions": lambda motion: motion.rotations,
    "angles": _angles,
}


def first_differences(motion: Motion) -> Array:
    """Return the root's motion from each frame to the next ([A] 4.1).

    Returns
    -------
    (F, 4) ndarray
        Velocity of the root in its own heading, in sizes a frame, and the turning of the
        heading in radians a frame; the last row repeats the one before.
    """
    if len(motion) < 2:
        return np.zeros((len(motion), 4))
    turn = np.unwrap(heading(motion.rotations[:, 0], motion.up))
    step = np.diff(motion.root_path, axis=0) / motion.skeleton.size
    back = rot.from_rotation_vector(-turn[:-1, None] * motion.up_vector)
    rows = np.hstack([rot.rotate(back, step), np.diff(turn)[:, None]])
    return np.vstack([rows, rows[-1:]])


def principal_components(points: ArrayLike, dimensions: int | float = 0.99) -> Array:
    """Project centred points on their principal axes ([A] 5.1).

    Parameters
    ----------
    points : (n, d) array_like
    dimensions : int or float
        How many axes, or the share of the variance they shall hold, in (0, 1).

    Returns
    -------
    (n, k) ndarray
        Coordinates in the order of falling variance; signs fixed so that each axis's largest
        entry is positive.
    """
    x = np.asarray(points, float)
    centred = x - x.mean(axis=0)
    variance, axes = np.linalg.eigh(centred.T @ centred)
    variance, axes = np.maximum(variance[::-1], 0.0), axes[:, ::-1]
    if isinstance(dimensions, float):
        held = np.cumsum(variance) / max(float(variance.sum()), 1e-300)
        dimensions = int(np.searchsorted(held, dimensions)) + 1
    axes = axes[:, :dimensions]
    largest = np.take_along_axis(axes, np.argmax(np.abs(axes), axis=0)[None], axis=0)
    return centred @ (axes * np.sign(largest))


def lag_distances(points: ArrayLike, longest: int) -> Array:
    """Return squared distances between every frame and those that follow it.

    Parameters
    ----------
    points : (n, d) array_like
    longest : int
        The longest lag, in frames.

    Returns
    -------
    (n, longest + 1) ndarray
        Entry (i, t) is the squared distance of frames i and i + t; NaN where i + t >= n.
    """
    x = np.asarray(points, float)
    x = x - x.mean(axis=0)
    squares = np.einsum("ij,ij->i", x, x)
    result = np.full((len(x), longest + 1), np.nan)
    result[:, 0] = 0.0
    for lag in range(1, min(longest, len(x) - 1) + 1):
        inner = np.einsum("ij,ij->i", x[:-lag], x[lag:])
        result[: len(x) - lag, lag] = np.maximum(squares[:-lag] + squares[lag:] - 2 * inner, 0.0)
    return result


def with_velocity(points: ArrayLike, runs: Sequence[tuple[int, int]], period: float) -> Array:
    """Append velocities, so that poses passed in opposite directions lie apart.

    The delay embedding of [C] 3.8 in the limit of short delays (Takens' theorem holds for
    derivatives as for delays), without the frames that delays lose at the ends. Velocities are
    multiplied by period / 2 pi, which gives a sinusoid a circle.

    Parameters
    ----------
    points : (n, d) array_like
    runs : sequence of (start, stop)
        Ranges of consecutive frames to take, one after the other.
    period : float
        In frames.

    Returns
    -------
    (m, 2 d) ndarray
        m frames in all runs together.
    """
    x = np.asarray(points, float)
    # Slopes of local lines over a twelfth of the period: long against noise, short against
    # the motion.
    reach = max(1, round(period / 24.0))
    slopes = [_local_slopes(x[start:stop], reach) for start, stop in runs]
    taken = np.concatenate([x[start:stop] for start, stop in runs])
    return np.hstack([taken, np.concatenate(slopes) * (period / (2 * np.pi))])


def _local_slopes(values: Array, reach: int) -> Array:
    """Return the slopes (n, d) of least-squares lines over `reach` frames to either side."""
    n = len(values)
    if n < 2:
        return np.zeros_like(values)
    time = np.arange(n, dtype=float)
    first, last = (
        np.maximum(time - reach, 0).astype(int),
        np.minimum(time + reach, n - 1).astype(int),
    )
    sums = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values, axis=0)])
    moments = np.concatenate(
        [np.zeros((1, values.shape[1])), np.cumsum(time[:, None] * values, axis=0)]
    )
    count = (last - first + 1).astype(float)
    middle = 0.5 * (first + last)
    spread = count * (count**2 - 1.0) / 12.0
    total, moment = sums[last + 1] - sums[first], moments[last + 1] - moments[first]
    return (moment - middle[:, None] * total) / spread[:, None]
