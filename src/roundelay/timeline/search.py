"""What is searched: the points of a take, the frames to look at, and what the user chose."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.brief import brief
from roundelay.base.checks import expected
from roundelay.base.errors import NoPeriod, TooShort
from roundelay.base.spans import Span
from roundelay.motion.features import MotionPoses
from roundelay.motion.motion import Motion
from roundelay.motion.poses import Poses, leading_rest_pose, point_indices, points_of
from roundelay.timeline.options import Options
from roundelay.timeline.thresholds import SEARCH

__all__ = ["Search"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Search:
    """What is searched, and how closely.

    Attributes
    ----------
    points : (F, d) ndarray
        One pose a frame, of the whole take.
    fps : float
        Frames a second.
    span : (start, stop)
        The frames to look at.
    step : int
        Every how many-th frame topology looks at.
    options : Options
    poses : Poses or None
        Where the points are from, for looking at some limbs alone.
    limbs : str
        The limbs that are looked at; empty for the whole body.
    """

    points: Array
    fps: float
    span: Span
    step: int = 1
    options: Options = field(default_factory=Options)
    poses: Poses | None = None
    limbs: str = ""

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
        NoPeriod
            If nothing moves.
        TypeError
            If it is neither, or the options are of another type.
        """
        poses, joints = _poses(take, options)
        frames = len(poses.values)
        if frames < SEARCH.fewest:
            raise TooShort(f"a period needs at least {SEARCH.fewest} frames, found {frames}")
        chosen = None if joints is None else point_indices(poses, joints)
        points = points_of(poses, chosen)
        span = _span(points, options)
        if np.ptp(points[slice(*span)], axis=0).max() < SEARCH.still:
            raise NoPeriod("no periodic motion found: nothing moves against the root")
        whole = None if chosen is not None else poses
        return cls(points, poses.fps, span, _step(poses.fps, span), options, whole)

    @property
    def n_frames(self) -> int:
        """How many frames are looked at."""
        return self.span[1] - self.span[0]

    def of(self, limbs: str) -> Search | None:
        """Look at some limbs alone; None where the take has none of that name."""
        if limbs == self.limbs:
            return self
        chosen = None if self.poses is None else self.poses.groups.get(limbs)
        if self.poses is None or not chosen:
            return None
        return replace(self, points=points_of(self.poses, chosen), limbs=limbs)


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


def _span(points: Array, options: Options) -> Span:
    chosen = options.span(len(points))
    if chosen is None:
        return (1 if leading_rest_pose(points) else 0), len(points)
    start, stop = chosen
    if stop - start < SEARCH.fewest:
        raise TooShort(f"a period needs at least {SEARCH.fewest} frames, found {stop - start}")
    return chosen


def _step(fps: float, span: Span) -> int:
    """Thin to some 60 frames a second, long captures to 30."""
    short = (span[1] - span[0]) / fps < SEARCH.long
    target = SEARCH.rate if short else SEARCH.long_rate
    return max(1, round(fps / target))
