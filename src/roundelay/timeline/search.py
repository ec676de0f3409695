"""What topology looks at: the points of a take, and what the user chose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.brief import brief
from roundelay.base.checks import expected
from roundelay.base.errors import TooShort
from roundelay.base.spans import Span
from roundelay.motion.features import MotionPoses
from roundelay.motion.motion import Motion
from roundelay.motion.poses import Poses, point_indices, points_of
from roundelay.timeline.options import Options
from roundelay.timeline.thresholds import SEARCH

__all__ = ["Search", "points_of_take"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Search:
    """What topology looks at, and how closely.

    Attributes
    ----------
    points : (F, d) ndarray
        One pose a frame, of the whole take.
    fps : float
        Frames a second.
    step : int
        Every how many-th frame topology looks at.
    options : Options
    poses : Poses
        Where the points are from, for looking at some limbs alone.
    """

    points: Array
    fps: float
    step: int
    options: Options
    poses: Poses

    __repr__ = brief

    @classmethod
    def of_take(cls, take: Motion | Poses, options: Options) -> Search:
        """Look at all points of a take, or at those of the options.

        Parameters
        ----------
        take : Motion or Poses
            Of a motion, the joints in the features and weights of the options.
        options : Options

        Raises
        ------
        TooShort
            If there are fewer than 8 frames.
        SkeletonMismatch
            If a joint of the options does not exist.
        ValueError
            If the frames of the options are not all there.
        TypeError
            If it is neither, or the options are of another type.
        """
        poses, points = points_of_take(take, options)
        if len(points) < SEARCH.fewest:
            raise TooShort(f"a period needs at least {SEARCH.fewest} frames, found {len(points)}")
        span = options.span(len(points)) or (0, len(points))
        return cls(points, poses.fps, _step(poses.fps, span), options, poses)

    def of(self, joints: Sequence[str]) -> Search:
        """Look at some joints alone, if the take has any of them."""
        places = {name: place for place, name in enumerate(self.poses.names)}
        chosen = [places[name] for name in joints if name in places]
        return replace(self, points=points_of(self.poses, chosen)) if chosen else self


def points_of_take(take: Motion | Poses, options: Options) -> tuple[Poses, Array]:
    """Return the poses of a take, and one point (F, d) a frame of those that count.

    Parameters
    ----------
    take : Motion or Poses
    options : Options

    Raises
    ------
    SkeletonMismatch
        If a joint of the options does not exist, or none is left.
    TypeError
        If it is neither, or the options are of another type.
    """
    poses, joints = _poses(take, options)
    chosen = None if joints is None else point_indices(poses, joints)
    return poses, points_of(poses, chosen)


def _poses(take: Motion | Poses, options: Options) -> tuple[Poses, tuple[str, ...] | None]:
    """Return the poses of a take, and the points that the options choose among them."""
    joints = expected(Options, options).joints
    if not isinstance(take, Motion):
        if not isinstance(take, Poses):
            raise TypeError(f"expected a Motion or Poses, found {type(take).__name__}")
        return take, joints
    take = take.with_root_motion()
    if joints is not None:
        take.skeleton.indices(joints)
        # The root, by which all others are placed, is no point of a pose.
        joints = tuple(name for name in joints if name != take.skeleton.names[0])
    return MotionPoses(take, options.features, options.weights), joints


def _step(fps: float, span: Span) -> int:
    """Thin to some 60 frames a second, long captures to 30."""
    short = (span[1] - span[0]) / fps < SEARCH.long
    target = SEARCH.rate if short else SEARCH.long_rate
    return max(1, round(fps / target))
