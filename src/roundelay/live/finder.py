"""A period found as frames come, without a cycle: "three alike, you may stop".

After each frame the last three repetitions of every period that they could have are compared: how
far poses a period apart are from each other, over how far poses of these frames are from each other
at random. Where that is small, and not at a part of the period, the frames repeat. Sums over time
are kept for every lag, so that a frame costs the same however long the take is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.checks import expected
from roundelay.base.errors import SkeletonMismatch
from roundelay.base.numeric import SMALL
from roundelay.geometry.skeleton import Skeleton
from roundelay.live.thresholds import FIND
from roundelay.motion.motion import checked_rate
from roundelay.phase.tempo import lowest_between

__all__ = ["Discovered", "PeriodFinder"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Discovered:
    """A period that goes on.

    Attributes
    ----------
    period : float
        Seconds.
    repetitions : float
        How many were seen, at least three.
    alike : float
        Share of the spread of poses that repeats, from 0 to 1.

    Examples
    --------
    >>> rl.Discovered(period=1.1, repetitions=3.0, alike=0.95).period
    1.1
    """

    period: float
    repetitions: float
    alike: float


class PeriodFinder:
    """Look for a period frame by frame.

    Parameters
    ----------
    skeleton : Skeleton
        Whose rotations come.
    fps : float
        Rate at which frames come.

    Raises
    ------
    SkeletonMismatch
        If it is one of points, which have no rotations.
    ValueError
        If the rate is not positive.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> finder = rl.PeriodFinder(walk.skeleton, walk.fps)
    >>> for rotations in walk.rotations:
    ...     found = finder.frame(rotations)
    >>> round(found.period, 2), round(found.repetitions, 1)
    (1.1, 6.4)
    """

    def __init__(self, skeleton: Skeleton, fps: float) -> None:
        if expected(Skeleton, skeleton).free:
            raise SkeletonMismatch("expected a skeleton with rotations, found points")
        self._every = max(1, int(checked_rate(fps) / FIND.rate))
        self._rate = fps / self._every
        reach = skeleton.reaches / skeleton.size
        reach[list(skeleton.trunk)] = 0.0
        self._shape = (skeleton.n_joints, 4)
        mixed = np.random.default_rng(0).normal(size=(4 * skeleton.n_joints, FIND.signals))
        self._mix = mixed * np.repeat(reach, 4)[:, None] / np.sqrt(FIND.signals)
        self._least = max(3, int(FIND.shortest * self._rate))
        self._most = max(self._least + 2, int(FIND.longest * self._rate))
        self.reset()

    def reset(self) -> None:
        """Forget all frames."""
        self._frames, self._count = 0, 0
        self._last: Array | None = None
        rows = 8 * self._most
        self._poses = np.zeros((rows, FIND.signals))
        # Sums over time, from the first row on: of squared changes at every lag, of poses, of
        # their squares.
        self._changes = np.zeros((rows + 1, self._most + 1))
        self._sums = np.zeros((rows + 1, FIND.signals))
        self._squares = np.zeros(rows + 1)
        self._found: Discovered | None = None
        self._since, self._until = 0.0, 0.0

    def frame(self, rotations: ArrayLike) -> Discovered | None:
        """Take a frame, and tell the period that goes on.

        Parameters
        ----------
        rotations : (J, 4) array_like
            Local rotations of all joints as quaternions (w, x, y, z), of either sign.

        Returns
        -------
        Discovered or None
            None where the last frames repeat nothing three times.

        Raises
        ------
        ValueError
            If there are not as many, or one is not finite.
        """
        q = np.asarray(rotations, float)
        if q.shape != self._shape:
            raise ValueError(f"expected rotations of shape {self._shape}, found {q.shape}")
        self._frames += 1
        if self._frames % self._every:
            return self._found
        if not np.isfinite(q).all():
            raise ValueError("expected finite rotations, found others")
        if self._last is not None:
            q = q * np.where(np.sum(q * self._last, axis=1) < 0.0, -1.0, 1.0)[:, None]
        self._last = q
        self._add(q.ravel() @ self._mix)
        self._look()
        return self._found

    def _add(self, pose: Array) -> None:
        """Add a pose to the sums."""
        if self._count == len(self._poses):
            self._forget()
        at, most = self._count, self._most
        self._poses[at] = pose
        lags = min(at, most)
        before = self._poses[at - lags : at][::-1]
        changes = self._changes[at + 1]
        changes[:] = self._changes[at]
        away = before - pose
        changes[1 : lags + 1] += np.einsum("lk,lk->l", away, away)
        self._sums[at + 1] = self._sums[at] + pose
        self._squares[at + 1] = self._squares[at] + pose @ pose
        self._count += 1

    def _forget(self) -> None:
        """Keep what three of the longest periods need."""
        kept = 4 * self._most
        start = self._count - kept
        self._poses[:kept] = self._poses[start:].copy()
        for sums in (self._changes, self._sums, self._squares):
            sums[: kept + 1] = sums[start:].copy()
            sums[: kept + 1] -= sums[0].copy()
        self._count = kept
        self._since, self._until = self._since - start, self._until - start

    def _look(self) -> None:
        """Find the period of the last frames, or let one that was found go on or end."""
        longest = min(self._most, self._count // 3)
        if longest <= self._least + 1:
            return
        periods = np.arange(self._least, longest + 1)
        now = self._count
        spread = self._spread(3 * periods)
        apart = self._apart(periods, 2 * periods) / np.maximum(2.0 * spread, SMALL)
        inner = apart[1:-1]
        lowest = (inner <= apart[:-2]) & (inner <= apart[2:]) & (inner < FIND.like)
        lowest &= spread[1:-1] > FIND.moves**2
        if self._found is not None:
            # Twice a period is a period as well: the one that was told goes on.
            near = abs(periods[1:-1] / (self._found.period * self._rate) - 1.0) < FIND.near
            lowest = lowest & near if (lowest & near).any() else lowest
        if lowest.any():
            best = 1 + int(np.argmin(np.where(lowest, inner, np.inf)))
            period = int(periods[best])
            if self._unlike(period, float(spread[best])):
                self._tell(period + lowest_between(apart[best - 1 : best + 2]), 1.0 - apart[best])
        if self._found is not None and now > self._until:
            self._found = None

    def _tell(self, period: float, alike: float) -> None:
        if self._found is None:
            self._since = self._count - 3.0 * period
        self._until = self._count + period
        repetitions = max(3.0, (self._count - self._since) / period)
        self._found = Discovered(period / self._rate, repetitions, float(alike))

    def _apart(self, lags: NDArray[np.intp], frames: NDArray[np.intp]) -> Array:
        """Return the mean squared change at lags, over the last frames of each."""
        total = self._changes[self._count, lags] - self._changes[self._count - frames, lags]
        return np.asarray(total / frames)

    def _spread(self, frames: NDArray[np.intp]) -> Array:
        """Return the variance of poses over the last frames."""
        start = self._count - frames
        mean = (self._sums[self._count] - self._sums[start]) / frames[:, None]
        squares = (self._squares[self._count] - self._squares[start]) / frames
        return np.asarray(squares - np.sum(mean**2, axis=1))

    def _unlike(self, period: int, spread: float) -> bool:
        """Tell whether poses a part of a period apart differ as much as poses at random."""
        lags = np.arange(max(1, period // 3), 2 * period // 3 + 1)
        apart = self._apart(lags, 3 * period - lags)
        return bool(apart.max() > FIND.unlike * 2.0 * spread)
