"""Poses: what the search sees of a take, be it of joints, markers or keypoints.

Whatever has these attributes can be searched; `roundelay.motion.features.MotionPoses` are those
of a motion, and `PoseArray` those of any array.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.checks import as_number, as_numbers, as_sequence
from roundelay.base.errors import SkeletonMismatch
from roundelay.base.numeric import SMALLEST
from roundelay.base.spans import Span
from roundelay.motion.thresholds import POSES

__all__ = [
    "PoseArray",
    "Poses",
    "bridged",
    "leading_rest_pose",
    "point_indices",
    "points_of",
    "principal_components",
    "with_velocity",
]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@runtime_checkable
class Poses(Protocol):
    """What the search sees of a take.

    Attributes
    ----------
    names : tuple of str
        One a point: a joint, a marker, a keypoint.
    values : (F, J, d) ndarray
        Positions or other features, in units of the body's size, free of where in the world
        the body is. What is missing may have any value.
    groups : mapping of str to sequence of int
        The points of each limb, or of several: "arms" and "legs" where there are such.
    missing : (F, J) ndarray of bool or None
        What was not seen; None if all was.
    fps : float
        Frames a second.
    size : float
        Of the body, in the take's unit of length.

    Examples
    --------
    >>> isinstance(rl.PoseArray(("hand",), np.zeros((9, 1, 3)), 30.0), rl.Poses)
    True
    """

    @property
    def names(self) -> tuple[str, ...]: ...  # noqa: D102
    @property
    def values(self) -> Array: ...  # noqa: D102
    @property
    def groups(self) -> Mapping[str, Sequence[int]]: ...  # noqa: D102
    @property
    def missing(self) -> Mask | None: ...  # noqa: D102
    @property
    def fps(self) -> float: ...  # noqa: D102
    @property
    def size(self) -> float: ...  # noqa: D102


@dataclass(frozen=True, eq=False)
class PoseArray:
    """Poses of an array; attributes as of `Poses`.

    Raises
    ------
    ValueError
        If shapes do not fit, a value that is not missing is not finite, or the rate or the size
        is not positive.

    Examples
    --------
    >>> angle = 2.0 * np.pi * np.arange(200) / 40.0
    >>> values = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)[:, None]
    >>> poses = rl.PoseArray(("hand",), values, fps=40.0)
    >>> round(rl.understand(poses).behaviours[0].period, 2)
    1.0
    """

    names: tuple[str, ...]
    values: Array = field(repr=False)
    fps: float
    size: float = 1.0
    groups: Mapping[str, Sequence[int]] = field(default_factory=dict)
    missing: Mask | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        values = as_numbers(self.values, "values (F, J, d)")
        object.__setattr__(self, "values", np.asarray(values, float))
        shape, names = self.values.shape, as_sequence(self.names, "names")
        if len(shape) != 3 or shape[1] != len(names):
            asked = f"(F, {len(names)}, d) for {len(names)} names"
            raise ValueError(f"expected values of shape {asked}, found {shape}")
        if self.missing is not None:
            object.__setattr__(self, "missing", np.asarray(self.missing, bool))
        seen = np.ones(shape[:2], bool) if self.missing is None else ~self.missing
        if seen.shape != shape[:2]:
            raise ValueError(f"expected a mask of shape {shape[:2]}, found {seen.shape}")
        if not np.all(np.isfinite(self.values[seen])):
            raise ValueError("expected finite values where none is missing, found NaN or infinity")
        for what, number in (("frame rate", self.fps), ("size", self.size)):
            if not (np.isfinite(as_number(number, what)) and number > 0.0):
                raise ValueError(f"expected a positive {what}, found {number:g}")


def point_indices(poses: Poses, names: Sequence[str]) -> list[int]:
    """Return the places of some points among a take's.

    Raises
    ------
    SkeletonMismatch
        If there is no point of a name; the message lists those there are.
    """
    places = {name: place for place, name in enumerate(poses.names)}
    for name in names:
        if name not in places:
            known = ", ".join(poses.names)
            raise SkeletonMismatch(f"no point {name!r}; the points are {known}")
    return [places[name] for name in names]


def points_of(poses: Poses, chosen: Sequence[int] | None = None) -> Array:
    """Return one point (F, J d) a frame of all or some of a take's points.

    What is missing is bridged in a straight line in time, and goes on unchanged at the ends; what
    is missing throughout is left out.

    Parameters
    ----------
    poses : Poses
    chosen : sequence of int, optional
        Places among the take's points; all by default.

    Raises
    ------
    SkeletonMismatch
        If no point is left.
    """
    kept = np.arange(len(poses.names)) if chosen is None else np.asarray(chosen, np.intp)
    values = bridged(poses)[:, kept]
    if poses.missing is not None:
        values = values[:, ~poses.missing[:, kept].all(axis=0)]
    if not values.shape[1]:
        raise SkeletonMismatch("expected at least one point, not counting the root, found none")
    return values.reshape(len(values), -1)


def bridged(poses: Poses) -> Array:
    """Return the points (F, J, d) of a take, what is missing interpolated in time.

    It goes on unchanged at the ends; a point that is missing throughout stays at 0.
    """
    if poses.missing is None:
        return poses.values
    result, frames = poses.values.copy(), np.arange(len(poses.values))
    for point in np.flatnonzero(poses.missing.any(axis=0)):
        seen = ~poses.missing[:, point]
        for column in range(result.shape[2]):
            own = result[seen, point, column]
            result[:, point, column] = np.interp(frames, frames[seen], own) if len(own) else 0.0
    return result


def principal_components(points: ArrayLike, dimensions: int | float) -> Array:
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
        held = np.cumsum(variance) / max(float(variance.sum()), SMALLEST)
        dimensions = int(np.searchsorted(held, dimensions)) + 1
    axes = axes[:, :dimensions]
    largest = np.take_along_axis(axes, np.argmax(np.abs(axes), axis=0)[None], axis=0)
    return centred @ (axes * np.sign(largest))


def with_velocity(points: ArrayLike, runs: Sequence[Span], period: float) -> Array:
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
    reach = max(1, round(period / POSES.slope))
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
    spread = count * (count**2 - 1.0) / 12
    total, moment = sums[last + 1] - sums[first], moments[last + 1] - moments[first]
    return (moment - middle[:, None] * total) / spread[:, None]


def leading_rest_pose(points: ArrayLike) -> bool:
    """Tell whether the first frame is a pose put before the capture.

    MotionBuilder-friendly conversions put a T-pose there; it is farther from the second frame
    than frames of a movement ever are from each other.
    """
    steps = np.linalg.norm(np.diff(np.asarray(points, float)[: POSES.rest_frames], axis=0), axis=1)
    if len(steps) <= POSES.rest_fewest:
        return False
    return bool(steps[0] > POSES.rest_step * steps[1:].max() and steps[0] > 0.0)
