"""Loops of frames that a person chose, of what does not repeat: ends joined, or there and back.

Joining is inertial blending, as games do it (Bollo 2018, "Inertialization: high-performance
animation transitions in Gears of War"): behind the join the motion goes on at the pose and the
speed that it had before, and the difference to what is played then dies away as a quintic.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from roundelay.base.checks import expected
from roundelay.base.errors import TooShort
from roundelay.base.options import Checked, option
from roundelay.base.spans import Span
from roundelay.base.threads import one_thread
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.models.regression import fit_cycle
from roundelay.cycles.thresholds import CYCLE
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import heading
from roundelay.loops.exported import exported
from roundelay.loops.mend import continued
from roundelay.loops.options import LoopOptions
from roundelay.loops.thresholds import BY_HAND
from roundelay.motion.features import point_cloud
from roundelay.motion.motion import Motion, concatenate

__all__ = ["ByHand", "CloseOptions", "close_by_hand"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CloseOptions(Checked):
    """Choices of how frames are closed to a loop.

    Parameters
    ----------
    fade : float
        Seconds in which a join dies away, or a turning point is eased.
    ping_pong : bool
        Play the frames there and back, for idles, instead of joining their ends.
    """

    title: ClassVar[str] = "How frames are closed"

    fade: float = option(
        0.3,
        "How long it takes a join to die away, or to turn about at an end.",
        unit="seconds",
        above=0,
        most=10,
    )
    ping_pong: bool = option(False, "Play the frames there and back instead of joining their ends.")


@dataclass(frozen=True, eq=False)
class ByHand:
    """A loop of frames that a person chose.

    Attributes
    ----------
    loop : Motion
        One period, the body's motion in its root.
    again : Motion
        One frame: the first one as it comes again after the last.
    asked, frames : (int, int)
        The frames asked for, and those taken, half-open.
    ping_pong : bool
    apart : float
        How far the poses at the join were apart, RMS over joints in body sizes; 0 there and back.
    largest : float
        The largest angle in radians by which a joint was turned to close the loop.
    """

    loop: Motion
    again: Motion
    asked: Span
    frames: Span
    ping_pong: bool
    apart: float
    largest: float

    def repeated(self) -> Motion:
        """Return the loop with the frame that repeats the first, as players need it."""
        return concatenate([self.loop, self.again])

    def cycle(self) -> Cycle:
        """Return the curve through its frames, by as many harmonics as they can tell apart."""
        count = len(self.loop)
        thrice = continued(continued(self.loop, count), count)
        phase = np.arange(len(thrice)) / count
        return fit_cycle(thrice, phase, [(0, len(thrice))], harmonics=(count - 1) // 2)

    def exported(self, written: LoopOptions) -> Motion:
        """Return the frames as they are written: its own, unless others are asked for.

        Parameters
        ----------
        written : LoopOptions
            Without start, mirror, resize, foot lock and repair: frames chosen by hand stay.

        Raises
        ------
        ValueError
            If the target cannot tell all joints by their names.
        """
        own = written.fps is None and written.periods == 1 and not written.in_place
        frames = self.repeated() if written.first_repeated else self.loop
        return exported(self.cycle(), replace(written, foot_lock=False), frames if own else None)

    def record(self) -> dict[str, Any]:
        """Describe it as plain data."""
        way = self.again.root_path[0] - self.loop.root_path[0]
        turned = rot.multiply(self.again.rotations[0, 0], rot.conjugate(self.loop.rotations[0, 0]))
        return {
            "kind": "closed by hand",
            "asked": list(self.asked),
            "frames": list(self.frames),
            "ping_pong": self.ping_pong,
            "period_seconds": self.loop.duration,
            "travel": way.tolist(),
            "turning_degrees": float(np.degrees(heading(turned, self.loop.up))),
            "poses_apart": self.apart,
            "largest_degrees": float(np.degrees(self.largest)),
        }


@one_thread
def close_by_hand(motion: Motion, frames: Span, options: CloseOptions | None = None) -> ByHand:
    """Make a loop of frames that a person chose.

    The ends are moved by up to .15 of the range to where they fit best: where pose and speed are
    most alike, or, there and back, where it is slowest.

    Parameters
    ----------
    motion : Motion
    frames : (int, int)
        Half-open.
    options : CloseOptions, optional

    Returns
    -------
    ByHand

    Raises
    ------
    ValueError
        If the frames are not all there.
    TooShort
        If they last shorter than a step.
    """
    options, motion = options or CloseOptions(), expected(Motion, motion).with_root_motion()
    _check(motion, frames)
    points, starts, stops = point_cloud(motion), *_near(motion, frames)
    if options.ping_pong:
        pace = _pace(points, motion) + _pace(motion.root_path / motion.skeleton.size, motion)
        slowest = int(starts[np.argmin(pace[starts])]), int(stops[np.argmin(pace[stops])])
        return _there_and_back(motion, frames, slowest, options.fade)
    taken = _most_alike(points, starts, stops, _reach(motion))
    apart = float(np.sqrt(3 * np.mean((points[taken[1]] - points[taken[0]]) ** 2)))
    return _joined(motion, frames, taken, options.fade, apart)


def _shortest(motion: Motion) -> int:
    return max(2, int(np.ceil(BY_HAND.shortest * motion.fps)))


def _check(motion: Motion, frames: Span) -> None:
    start, stop = frames
    if not 0 <= start < stop <= len(motion):
        raise ValueError(f"expected frames within 0 and {len(motion)}, found {start} to {stop}")
    if stop - start < _shortest(motion):
        raise TooShort(
            f"frames {start}-{stop} last {(stop - start) / motion.fps:.2f} s, shorter than a step "
            f"({BY_HAND.shortest:g} s)"
        )


def _reach(motion: Motion) -> int:
    """Return how many frames before and behind one tell of its speed, also where they are noisy.

    Over a stretch of this reach, r, speeds are weighed against poses as wanted: a difference that
    grows by v a second from 0 has the mean square r^2 / 3 v^2.
    """
    return max(1, round(np.sqrt(3) * BY_HAND.speed * motion.fps))


def _pace(values: Array, motion: Motion) -> Array:
    """Return how fast values (F, d) change a second (F,): the slope of a line through a stretch."""
    frames, last = np.arange(len(values)), len(values) - 1
    way, weight = np.zeros_like(values), np.zeros((len(values), 1))
    for away in range(1, _reach(motion) + 1):
        before, behind = np.maximum(frames - away, 0), np.minimum(frames + away, last)
        way += away * (values[behind] - values[before])
        weight += away * (behind - before)[:, None]
    return np.asarray(np.linalg.norm(way / weight, axis=1)) * motion.fps


def _near(motion: Motion, frames: Span) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return where a loop may begin, and the frames that may follow its last as the first."""
    reach, last = round(BY_HAND.near * (frames[1] - frames[0])), len(motion) - 1
    ends = [np.unique(np.clip(end + np.arange(-reach, reach + 1), 0, last)) for end in frames]
    shortest = min(_shortest(motion), int(ends[1][-1] - ends[0][0]))
    starts = ends[0][ends[0] <= ends[1][-1] - shortest]
    return starts, ends[1][ends[1] >= starts[-1] + shortest]


def _most_alike(
    points: Array, starts: NDArray[np.intp], stops: NDArray[np.intp], reach: int
) -> Span:
    """Return the start and the stop about which poses (F, d) are most alike.

    They are compared over a stretch: one pose and its neighbours would tell noise for speed.
    """
    ours, theirs = (np.arange(x[0] - reach, x[-1] + reach + 1) for x in (starts, stops))
    there = [(x >= 0) & (x < len(points)) for x in (ours, theirs)]
    both = np.outer(*there)
    ours, theirs = (points[np.clip(x, 0, len(points) - 1)] for x in (ours, theirs))
    squares = np.sum(ours**2, axis=1)[:, None] + np.sum(theirs**2, axis=1) - 2 * ours @ theirs.T
    squares *= both
    total, count = np.zeros((2, len(starts), len(stops)))
    for away in range(2 * reach + 1):
        place = slice(away, away + len(starts)), slice(away, away + len(stops))
        total += squares[place]
        count += both[place]
    start, stop = np.unravel_index(np.argmin(total / count), total.shape)
    return int(starts[start]), int(stops[stop])


def _joined(motion: Motion, asked: Span, taken: Span, fade: float, apart: float) -> ByHand:
    """Let what the ends lack to meet die away behind the join."""
    start, stop = taken
    gained = rot.multiply(motion.rotations[stop, 0], rot.conjugate(motion.rotations[start, 0]))
    back = rot.from_rotation_vector(-heading(gained, motion.up) * motion.up_vector)
    count = min(max(2, round(fade * motion.fps)), stop - start)
    turns = _fading_turns(motion, taken, back, count)
    path = motion.root_path[start:stop].copy()
    path[:count] += _fading_path(motion, taken, back, count)
    rotations = motion.rotations[start:stop].copy()
    rotations[:count] = rot.multiply(rotations[:count], rot.from_rotation_vector(turns))
    moved = motion.translations
    if moved is not None:
        lack, slower = (
            moved[stop] - moved[start],
            _slope(moved, stop, _reach(motion)) - _slope(moved, start, _reach(motion)),
        )
        moved = moved[start:stop].copy()
        moved[:count] += _dying(lack, slower, count)
    loop = replace(motion, rotations=rotations, root_path=path, translations=moved)
    largest = float(np.linalg.norm(turns, axis=-1).max())
    return ByHand(loop, _again(motion, taken, path[0]), asked, taken, False, apart, largest)


def _again(motion: Motion, taken: Span, first: Array) -> Motion:
    """Return the frame at which the loop begins again: where it stops, at the loop's height."""
    again = motion[taken[1] : taken[1] + 1]
    path = again.root_path.copy()
    if not _climbs(motion, taken):
        path[:, motion.up] = first[motion.up]
    return replace(again, root_path=path)


def _fading_turns(motion: Motion, taken: Span, back: Array, count: int) -> Array:
    """Return the rotation vectors (count, J, 3) that die away."""
    start, stop = taken
    end = motion.rotations[stop].copy()
    end[0] = rot.multiply(back, end[0])
    lack = rot.vector_between(motion.rotations[start], end)
    slower = _turning(motion.rotations, stop, _reach(motion)) - _turning(
        motion.rotations, start, _reach(motion)
    )
    return _dying(lack, slower, count)


def _fading_path(motion: Motion, taken: Span, back: Array, count: int) -> Array:
    """Return the way (count, 3) that dies away: the root goes on at the speed that it had."""
    start, stop = taken
    before = rot.rotate(back, _slope(motion.root_path, stop, _reach(motion)))
    lack = (motion.root_path[stop] - motion.root_path[start]) * motion.up_vector
    lack = lack * (not _climbs(motion, taken))
    return _dying(lack, before - _slope(motion.root_path, start, _reach(motion)), count)


def _climbs(motion: Motion, taken: Span) -> bool:
    heights = motion.root_path[list(taken), motion.up]
    return bool(abs(heights[1] - heights[0]) > CYCLE.climbs * motion.skeleton.size)


def _slope(values: Array, frame: int, reach: int) -> Array:
    """Return the change of values (F, ...) a frame: the slope of a line through a stretch."""
    before, behind, weights = _pairs(len(values), frame, reach)
    return np.tensordot(weights, values[behind] - values[before], axes=1)


def _turning(rotations: Array, frame: int, reach: int) -> Array:
    """Return how joints turn a frame (J, 3), in their own axes, as `_slope` does."""
    before, behind, weights = _pairs(len(rotations), frame, reach)
    return np.tensordot(weights, rot.vector_between(rotations[before], rotations[behind]), axes=1)


def _pairs(count: int, frame: int, reach: int) -> tuple[NDArray[np.intp], NDArray[np.intp], Array]:
    """Return frames before and behind one, and by what to weigh the change between them."""
    away = np.arange(1, reach + 1)
    before, behind = np.maximum(frame - away, 0), np.minimum(frame + away, count - 1)
    return before, behind, away / np.sum(away * (behind - before))


def _dying(lack: Array, slower: Array, count: int) -> Array:
    """Return the quintic (count, ...) from a value and a slope a frame to rest at 0."""
    x = (np.arange(count) / count).reshape(-1, *[1] * lack.ndim)
    value = 1.0 - x**3 * (10 - 15 * x + 6 * x**2)
    slope = x - x**3 * (6 - 8 * x + 3 * x**2)
    return np.asarray(lack * value + slower * count * slope)


def _there_and_back(motion: Motion, asked: Span, taken: Span, fade: float) -> ByHand:
    """Go from one end to the other and back, slowly about both."""
    length = taken[1] - taken[0]
    eased = min(max(2.0, fade * motion.fps), float(length))
    along = np.arange(2 * length, dtype=float)
    # How far it is to the nearer turning point; about it, a parabola.
    away = np.abs((along + 0.5 * length) % length - 0.5 * length)
    rounded = np.where(away < 0.5 * eased, away**2 / eased + eased / 4, away)
    forth = np.abs(along - length) > 0.5 * length
    loop = motion.at(taken[0] + np.where(forth, rounded, length - rounded))
    return ByHand(loop, loop[:1], asked, taken, True, 0.0, 0.0)
