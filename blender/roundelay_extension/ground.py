# SPDX-License-Identifier: GPL-3.0-or-later
"""The way a body goes: its root's path made straight, and what goes along with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay import Cycle, Motion
from roundelay.cycles.continuity import followed_poses
from roundelay.cycles.edit.footlock import lock_offsets
from roundelay.cycles.thresholds import CYCLE
from roundelay.geometry import rotations as rot

from .averaging import Values, Windows

Array = NDArray[np.float64]

# Radians by which a heading may stray and still be straight on.
_STRAIGHT = np.radians(3.0)
# The share of its way that is left, seen from the body, of what goes along with it.
_ALONG = 0.5
# Steps of a control that stands, as a share of the body's.
_STANDS = 0.05


@dataclass(frozen=True, eq=False)
class Ground:
    """The root of a body over the frames looked at, and in the loop; in the body's axes.

    Attributes
    ----------
    windows : Windows
    frames : (V,) ndarray
        Frames of the scene.
    path : (V, 3) ndarray
        The root's.
    heading : (V,) ndarray
        In radians, as it drifts over the repetitions; 0 where it goes straight on.
    along : (3,) ndarray
        1 for the axes along which the body goes: the plane, and up where it climbs.
    size : float
        Of the body.
    loop : (N + 1, 3) ndarray
        The root's path in the loop, where it goes along; 0 elsewhere.
    travels : bool
        Whether it goes anywhere.
    """

    windows: Windows
    frames: Array = field(repr=False)
    path: Array = field(repr=False)
    heading: Array = field(repr=False)
    along: Array
    size: float
    loop: Array = field(repr=False)
    travels: bool

    @property
    def moves(self) -> bool:
        """Whether it goes or turns, so that what goes along must be told from what stays."""
        return self.travels or bool(np.any(self.heading))

    def back(self, frames: Array) -> Array:
        """Return the turns (..., 4) that take the drift of the heading out at frames (...)."""
        return rot.from_rotation_vector(-_at(self.heading, self.frames, frames) * np.eye(3)[2])

    def relative(self, places: Values) -> Values:
        """Return places as seen from the root, straight on; heights as they are."""

        def values(frames: Array) -> Array:
            root = _at(self.path, self.frames, frames) * self.along
            return rot.rotate(self.back(frames), places(frames) - root)

        return values

    def unturned(self, turns: Values) -> Values:
        """Return rotations without the drift of the heading."""
        return lambda frames: rot.multiply(self.back(frames), turns(frames))

    def goes_along(self, places: Values) -> bool:
        """Tell whether places come back rather as seen from the root than as they are."""
        ends = self.windows.ends
        seen = np.diff(self.windows.sampled(self.relative(places), ends), axis=1)
        plain = np.diff(self.windows.sampled(places, ends), axis=1)
        apart = [np.linalg.norm(one, axis=-1).sum() for one in (seen, plain)]
        return bool(apart[0] < _ALONG * apart[1])

    def turns_along(self, turns: Values) -> bool:
        """Tell whether rotations come back rather without the drift of the heading."""
        if not np.any(self.heading):
            return False
        ends = self.windows.ends
        seen = rot.normalize(self.windows.sampled(self.unturned(turns), ends))
        plain = rot.normalize(self.windows.sampled(turns, ends))
        apart = [rot.angle_between(one[:, 0], one[:, 1]).sum() for one in (seen, plain)]
        return bool(apart[0] < apart[1])

    def mean(self, places: Values, *, held: bool) -> Array:
        """Return the mean of places (N + 1, 3) that go along; held while they stand."""
        mean = self.windows.mean(self.relative(places)) + self.loop
        return mean + self._holding(mean) if held and self.travels else mean

    def _holding(self, mean: Array) -> Array:
        """Return by how much to move what stands, so that it stands still."""
        gain = mean[-1] - mean[0]
        around = np.concatenate([mean[:-1] - gain, mean[:-1], mean + gain])
        steps = np.linalg.norm(np.diff(around, axis=0)[:, :2], axis=-1)
        pace = float(np.linalg.norm(np.diff(self.loop, axis=0)[:, :2], axis=-1).mean())
        still = steps < _STANDS * pace
        stands = np.append(still, False) | np.insert(still, 0, False)
        if not stands.any() or stands.all():
            return np.zeros_like(mean)
        count = self.windows.count
        offsets = lock_offsets(around[:, None], stands[:, None], 2)[:, 0]
        middle = offsets[count : 2 * count]
        return np.concatenate([middle, middle[:1]])


def ground_of(
    cycle: Cycle, motion: Motion, frames: Array, windows: Windows, travel: Callable[..., Array]
) -> Ground:
    """Make the way of a body straight and the mean of its repetitions.

    Parameters
    ----------
    cycle : Cycle
        Of the motion, with its evidence and phase.
    motion : Motion
        The body's.
    frames : (V,) ndarray
        Its frames in the scene.
    windows : Windows
    travel : callable
        Gives the loop's path (N + 1, 3) of that with its travel and that without.
    """
    evidence: Any = cycle.evidence
    heading = followed_poses(motion, cycle.phase, evidence.runs, 1).drift  # type: ignore[arg-type]
    heading = _straight(heading, evidence.runs)
    path, size = motion.root_path, motion.skeleton.size
    straight = _straightened(path, heading, evidence.runs)
    values = _values(straight, frames)
    gain = windows.gain(values)
    climbs = abs(gain[2]) > CYCLE.climbs * size
    along = np.array([1.0, 1.0, float(climbs)])
    travels = bool(np.linalg.norm(gain * along) > CYCLE.travels * size)
    gain = gain * along * travels
    closed = windows.each(values, gain)
    mean = closed.mean(axis=0)
    if travels:
        # The loop goes where the first run went.
        mean += closed[0].mean(axis=0) - mean.mean(axis=0)
    still = np.concatenate([mean, mean[:1]]) * along
    loop = travel(still + windows.turns[:, None] * gain, still)
    return Ground(windows, frames, path, heading, along, size, loop, travels)


def _straight(heading: Array, runs: Any) -> Array:
    """Return a heading, or none where all of it is straight on."""
    seen = np.concatenate([heading[a:b] for a, b in runs])
    return heading if np.ptp(seen) > _STRAIGHT else np.zeros_like(heading)


def _straightened(path: Array, heading: Array, runs: Any) -> Array:
    """Return a path (V, 3) whose steps are turned back by the heading; each run by itself."""
    if not np.any(heading):
        return path
    middle = 0.5 * (heading[1:] + heading[:-1])
    back = rot.from_rotation_vector(-middle[:, None] * np.eye(3)[2])
    steps = rot.rotate(back, np.diff(path, axis=0))
    straight = path.copy()
    for start, stop in runs:
        straight[start + 1 : stop] = path[start] + np.cumsum(steps[start : stop - 1], axis=0)
    return straight


def _values(samples: Array, at: Array) -> Values:
    return lambda frames: _at(samples, at, frames)


def _at(samples: Array, at: Array, frames: Array) -> Array:
    """Return samples (V, ...) of some frames at others (...), interpolated."""
    columns = samples.reshape(len(at), -1).T
    found = np.stack([np.interp(frames, at, column) for column in columns], axis=-1)
    return found
