"""The phase of a known cycle, told of each frame as it comes.

A frame is its joints' local rotations, weighed by how far they move what hangs on them, in the few
components in which the cycle's poses lie; the pose some frames before is set against it, so that
the speed counts as well. Two things run side by side. A filter goes on from phase to phase at its
pace, and corrects both by the error of the pose along the cycle (Gauss-Newton). And the errors of
all phases are summed over the last part of a period, as if each had gone on at that pace; where
another phase explains these frames much better, the filter goes there. So who was lost, or begins,
is found within a part of a period.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import deque
from math import exp, isfinite, nan
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.checks import expected
from roundelay.base.errors import SkeletonMismatch
from roundelay.base.numeric import SMALL
from roundelay.base.threads import one_thread
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.events import events_of
from roundelay.live.thresholds import TRACK
from roundelay.motion.motion import Motion, checked_rate

__all__ = ["PhaseTracker", "Tracked"]

Array = NDArray[np.float64]


class Tracked(NamedTuple):
    """What is known after a frame.

    Attributes
    ----------
    phase : float
        In [0, 1), in turns of the cycle.
    speed : float
        Periods a second.
    confidence : float
        Share of the poses' spread that the cycle explains, from 0 to 1.
    found : bool
        Whether it is followed; otherwise phase and speed are guesses.
    event : str
        The next that a foot does, as by `roundelay.cycles.events`; empty where none steps.
    seconds : float
        Until then, at the present speed; NaN without one.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> told = rl.PhaseTracker(rl.find_cycles(walk)[0]).follow(walk)
    >>> isinstance(told[-1], rl.Tracked), told[-1].event
    (True, 'left contact')
    """

    phase: float
    speed: float
    confidence: float
    found: bool
    event: str
    seconds: float


class PhaseTracker:
    """Follow a cycle frame by frame.

    Parameters
    ----------
    cycle : Cycle
        Of a skeleton.
    fps : float, optional
        Rate at which frames come; the cycle's by default.

    Raises
    ------
    SkeletonMismatch
        If the cycle is one of points, which have no rotations.
    ValueError
        If the rate is not positive, or the cycle does not move.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> tracker = rl.PhaseTracker(rl.find_cycles(walk)[0])
    >>> for rotations in walk.rotations:
    ...     told = tracker.frame(rotations)
    >>> told.found, round(told.speed, 2)
    (True, 0.91)
    """

    def __init__(self, cycle: Cycle, fps: float | None = None) -> None:
        self.cycle = expected(Cycle, cycle)
        self.fps = checked_rate(cycle.fps if fps is None else fps)
        self._poses = _Poses(self.cycle)
        # The first of the next period comes after the last.
        events = [(event.phase, event.name) for event in events_of(self.cycle)]
        first = [(events[0][0] + 1.0, events[0][1])] if events else [(nan, "")]
        self._events, self._moments = events + first, [phase for phase, _ in events]
        period = self.cycle.period * self.fps
        self._pace = 1.0 / period
        self._reach = max(1, round(TRACK.delay * period))
        self._lay_out(self._poses.curve, self._reach / period)
        self._every = max(1, round(period / TRACK.looks))
        self._forget = exp(-self._every / (TRACK.memory * period))
        self._gain = 1.0 - exp(-1.0 / (TRACK.phase_gain * period))
        # A quarter of the square: phase and speed come to rest without swinging.
        self._gain_of_speed = self._gain**2 * period / 4
        self._sure = 1.0 - exp(-1.0 / (TRACK.sure * period))
        self._learn = 1.0 - exp(-self._every / (TRACK.posture * period))
        self.reset()

    def _lay_out(self, curve: Array, lag: float) -> None:
        """Lay poses and their changes side by side, and how both go on along the phase."""
        count, size = curve.shape
        change = curve - _at(curve, np.arange(count) / count - lag)
        # A change weighs as much as a pose.
        scale = float(np.linalg.norm(curve) / np.linalg.norm(change))
        self._poses.weigh(scale)
        both = np.concatenate([curve, scale * change], axis=1)
        slope = (np.roll(both, -1, axis=0) - np.roll(both, 1, axis=0)) * (count / 2)
        steep = np.sum(slope**2, axis=1)
        self._rows = list(zip(both, slope, (steep + steep.mean()).tolist(), strict=True))
        squares = np.sum(both**2, axis=1)
        self._twice = -2.0 * np.concatenate([both, both])
        self._squares = np.concatenate([squares, squares])
        self._spread = float(squares.mean())
        # What is seen of a frame: its pose, and how that changed.
        self._size, self._seen = size, np.zeros(2 * size)
        self._pose, self._change = self._seen[:size], self._seen[size:]

    def reset(self) -> None:
        """Forget all frames."""
        self._past: deque[Array] = deque(maxlen=self._reach + 1)
        self._posture = self._poses.middle.copy()
        self._phase, self._speed = 0.0, self._pace
        self._errors = np.zeros(TRACK.phases)
        self._moved, self._frames = 0.0, 0
        self._energy, self._missed = SMALL, 0.0
        self.confidence, self.found = 0.0, False

    @one_thread
    def follow(self, motion: Motion) -> list[Tracked]:
        """Take all frames of a motion, one after the other.

        Parameters
        ----------
        motion : Motion

        Raises
        ------
        SkeletonMismatch
            If its skeleton has other joints than the cycle's.
        ValueError
            If its rate is another than the tracker's.
        """
        self.cycle.skeleton.require_same(expected(Motion, motion).skeleton)
        if abs(motion.fps / self.fps - 1.0) > TRACK.rate:
            raise ValueError(
                f"expected {self.fps:g} frames a second, found {motion.fps:g}; "
                "give the rate to the tracker by fps"
            )
        return [self.frame(rotations) for rotations in motion.rotations]

    def frame(self, rotations: ArrayLike) -> Tracked:
        """Take a frame and tell what is known.

        Parameters
        ----------
        rotations : (J, 4) array_like
            Local rotations of all joints as quaternions (w, x, y, z), of either sign.

        Raises
        ------
        ValueError
            If there are not as many, or one is not finite.
        """
        seen, past = self._poses.of(rotations), self._past
        weighed = seen[self._size :]
        past.append(weighed)
        np.subtract(seen[: self._size], self._posture, self._pose)
        np.subtract(weighed, past[0], self._change)
        error = self._go_on()
        self._frames += 1
        if self._frames % self._every == 0:
            self._look_around()
            if self.found:
                self._posture += self._learn * error[: self._size]
        return self._told()

    def _go_on(self) -> Array:
        """Let the filter go on to the next frame and correct it; return its error (2 K,)."""
        count, seen = TRACK.phases, self._seen
        phase = self._phase + self._speed
        place = (phase % 1.0) * count
        nearest = round(place)
        wanted, slope, steep = self._rows[nearest % count]
        error = seen - wanted
        # From the nearest phase of the table; the rest of the way counts as well.
        off = float(slope.dot(error)) / steep - (place - nearest) / count
        self._phase = phase + self._gain * off
        faster = (1.0 + self._gain_of_speed * off) * self._speed
        self._speed = min(max(faster, self._pace / TRACK.pace), self._pace * TRACK.pace)
        self._missed += self._sure * (float(error.dot(error)) - self._missed)
        energy = float(seen.dot(seen)) + self._spread
        self._energy += self._sure * (energy - self._energy)
        self.confidence = max(0.0, 1.0 - self._missed / self._energy)
        self.found = self.confidence >= TRACK.lost
        return error

    def _look_around(self) -> None:
        """Sum the errors of all phases, each gone on at the present pace, and go to the best."""
        count, errors = TRACK.phases, self._errors
        self._moved = (self._moved + self._every * self._speed * count) % count
        whole = int(self._moved)
        squares = self._twice.dot(self._seen)
        squares += self._squares
        errors *= self._forget
        errors += squares[whole : whole + count]
        best = int(errors.argmin())
        own = round(self._phase * count - self._moved) % count
        worse = float(errors[own] - errors[best]) * (1.0 - self._forget) / self._spread
        if worse > TRACK.better:
            self._phase = (best + self._moved) / count
            if not self.found:
                self._speed = self._pace

    def _told(self) -> Tracked:
        phase, speed = self._phase % 1.0, self._speed * self.fps
        at, name = self._events[bisect_right(self._moments, phase)]
        return Tracked(phase, speed, self.confidence, self.found, name, (at - phase) / speed)


class _Poses:
    """Poses of a cycle as points: how they are taken from rotations, and its own (P, K)."""

    def __init__(self, cycle: Cycle) -> None:
        skeleton = cycle.skeleton
        if skeleton.free:
            raise SkeletonMismatch("expected a cycle of a skeleton, found one of points")
        count = TRACK.phases
        rotations = cycle.rotations(np.arange(count) / count)
        reach = skeleton.reaches / skeleton.size
        reach[list(skeleton.trunk)] = 0.0
        if cycle.odd_pose is not None:
            turning = np.abs(cycle.odd_pose.cosine).sum(axis=0).reshape(-1, 4).sum(axis=1) > 0.0
            reach[turning] = 0.0
        middle = rotations.mean(axis=0)
        signs = np.where(np.sum(rotations * middle, axis=2) < 0.0, -1.0, 1.0)
        rows = (rotations * signs[..., None] * reach[:, None]).reshape(count, -1)
        mean = rows.mean(axis=0)
        _, lengths, axes = np.linalg.svd(rows - mean, full_matrices=False)
        if lengths[0] <= TRACK.still * np.sqrt(count):
            raise ValueError("expected a cycle that moves, found one pose")
        axes = axes[: TRACK.modes]
        self.curve = (rows - mean) @ axes.T
        self._onto = axes * np.repeat(reach, 4)
        # A row a joint: whether it lies on the mean's side.
        rows = np.eye(skeleton.n_joints)[:, :, None] * middle
        self._signs = rows.reshape(skeleton.n_joints, -1)
        self.middle = axes @ mean
        self._shape = (skeleton.n_joints, 4)

    def weigh(self, scale: float) -> None:
        """Let `of` return a pose twice, the second time multiplied."""
        self._onto = np.concatenate([self._onto, scale * self._onto])

    def of(self, rotations: ArrayLike) -> Array:
        """Return the pose (K,) of local rotations (J, 4), its middle not taken off."""
        q = np.asarray(rotations, float)
        if q.shape != self._shape:
            raise ValueError(f"expected rotations of shape {self._shape}, found {q.shape}")
        signs = np.copysign(1.0, self._signs.dot(q.ravel()))
        pose = self._onto.dot((q * signs[:, None]).ravel())
        if not isfinite(pose.dot(pose)):
            raise ValueError("expected finite rotations, found others")
        return pose


def _at(curve: Array, phase: Array) -> Array:
    """Return values (n, K) of a closed curve (P, K) at phases (n,)."""
    place = (phase % 1.0) * len(curve)
    whole = place.astype(int)
    part = (place - whole)[:, None]
    return (1.0 - part) * curve[whole % len(curve)] + part * curve[(whole + 1) % len(curve)]
