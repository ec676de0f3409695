"""Faults of loops that people already have: what would be seen when they are played."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.checks import expected
from roundelay.base.errors import TooShort
from roundelay.base.numeric import TINY
from roundelay.base.threads import one_thread
from roundelay.loops.join import join_ratio
from roundelay.loops.thresholds import GAIT, LINT
from roundelay.loops.unrolled import Gait, Seen, Steps, climb_of, gait_of, seen, steps_of
from roundelay.motion.motion import Motion
from roundelay.timeline.thresholds import CLOSING

__all__ = [
    "Apart",
    "Fault",
    "Period",
    "faults_of",
    "lint",
    "odd_rate",
    "period_of",
    "phase_of_set",
    "repeating",
    "taken_apart",
]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Fault:
    """A fault of a loop.

    Attributes
    ----------
    name : str
        "frame too many", "frame missing", "pop", "foot slide", "drift", "rate", "unit",
        "root bob" or "phase".
    value, limit : float
        What was measured, and beyond what it is a fault.
    unit : str
        Of both.
    says : str
        What is wrong, in a sentence.
    """

    name: str
    value: float
    limit: float
    unit: str
    says: str


@dataclass(frozen=True)
class Period:
    """Which frames of a file are one period, or several.

    Attributes
    ----------
    count : int
        The first so many frames.
    missing : int
        So many more would come before the first again.
    over : int
        So many more frames are in the file than its format wants; less than 0 if they are missing.
    measured : float
        The same, not rounded.
    one : int
        Frames of a period, those that are missing too: fewer where the same poses come again.
    """

    count: int
    missing: int
    over: int
    measured: float
    one: int


@dataclass(frozen=True, eq=False)
class Apart:
    """A file of a loop taken apart.

    Attributes
    ----------
    wraps : bool
        See `lint`.
    seen : Seen
    period : Period
    steps : Steps
    gait : Gait or None
    """

    wraps: bool
    seen: Seen
    period: Period
    steps: Steps
    gait: Gait | None

    @property
    def phase(self) -> float | None:
        """Where in a gait the left foot is farthest ahead, in turns of a stride; else None."""
        return None if self.gait is None else self.gait.phase

    @property
    def recognised(self) -> bool:
        """Whether it is a loop at all, with faults or without.

        The ends of one lie nearer to each other than poses do to their mean, but for frames that
        are missing; a long take with such ends must also tell its period.
        """
        if self.period.missing:
            return True
        poses = self.seen.poses[: self.period.count]
        apart = float(np.linalg.norm(poses[-1] - poses[0]))
        known = self.period.measured != 0.0 or self.period.one < self.period.count
        short = len(poses) <= CLOSING.longest * self.seen.motion.fps
        return apart <= float(np.sqrt(np.var(poses, axis=0).sum())) and (known or short)


@one_thread
def lint(motion: Motion, wraps: bool, set_phase: float | None = None) -> tuple[Fault, ...]:
    """Find the faults of a loop.

    Parameters
    ----------
    motion : Motion
        One period or several, as they are in the file: several are told by their poses, which
        come again as they were.
    wraps : bool
        Whether the format's players go from the last key to the first without any time between, so
        that the last should repeat the first; see `roundelay.formats.wraps_at_last_key`. Lengths
        of such formats are metres.
    set_phase : float, optional
        Where the left foot is farthest ahead in the gaits of the set that the loop belongs to, in
        turns; see `phase_of_set`.

    Returns
    -------
    tuple of Fault
        Empty if the loop is clean.

    Raises
    ------
    TooShort
        If there are fewer than 8 frames.
    """
    return faults_of(taken_apart(motion, wraps), set_phase)


@one_thread
def taken_apart(motion: Motion, wraps: bool) -> Apart:
    """Find period, steps and gait of a loop. Arguments and errors as of `lint`."""
    frames = len(expected(Motion, motion))
    if frames < LINT.shortest:
        raise TooShort(f"a loop needs at least {LINT.shortest} frames, found {frames}")
    loop = seen(motion)
    period = period_of(loop, wraps)
    steps = steps_of(loop, period.count)
    return Apart(wraps, loop, period, steps, gait_of(loop, period.count, steps.below))


@one_thread
def faults_of(loop: Apart, set_phase: float | None = None) -> tuple[Fault, ...]:
    """Find the faults of a loop that was taken apart, as `lint` does."""
    found = [
        *_miscounted(loop.period, loop.wraps),
        *_pop(loop.seen, loop.period, loop.wraps),
        *_slide(loop.seen, loop.steps),
        *_drift(loop.seen, loop.period, loop.steps),
        *_rate(loop),
        *_unit(loop.seen.motion, loop.wraps),
        *_bob(loop.seen, loop.period),
        *_out_of_phase(loop.gait, set_phase),
    ]
    return tuple(found)


def odd_rate(motion: Motion, wraps: bool) -> Fault | None:
    """Find out whether a gait takes too short or too long for a person, as `lint` does.

    None if it does not, or the motion is no gait, or too short to tell. Arguments as of `lint`.
    """
    if len(motion) < LINT.shortest:
        return None
    return next(_rate(taken_apart(motion, wraps)), None)


def phase_of_set(phases: Sequence[float]) -> float | None:
    """Return the phase that most loops of a set agree on; None if they do not.

    Parameters
    ----------
    phases : sequence of float
        In turns, as `Apart.phase` tells them.
    """
    if len(phases) < LINT.set_least:
        return None
    apart = np.array([[abs(_turned(a - b)) for b in phases] for a in phases])
    chosen = int(np.argmin(apart.sum(axis=1)))
    agree = np.count_nonzero(apart[chosen] <= LINT.phase)
    return float(phases[chosen]) if 2 * agree > len(phases) else None


def _turned(turns: float) -> float:
    """Return a difference of phases in [-.5, .5]."""
    return float(turns - np.round(turns))


def period_of(loop: Seen, wraps: bool) -> Period:
    """Find how many of the frames are one period, from how far the last is from the first.

    How many steps lie between them is told from the pose's speed and acceleration at both ends, if
    these explain the way between.

    Parameters
    ----------
    loop : Seen
        Of 8 frames or more.
    wraps : bool
        See `lint`.

    Returns
    -------
    Period
    """
    poses, frames = loop.poses, len(loop.joints)
    steps, left, pace = _steps_across(poses)
    fastest = float(np.linalg.norm(np.diff(poses, axis=0), axis=1).max())
    known = left <= LINT.unlike * pace * max(1.0, abs(steps)) and pace > LINT.slow * fastest
    known |= left <= LINT.same * pace and pace > TINY
    measured = (0.0 if wraps else 1.0) - steps if known else 0.0
    over = round(measured) if abs(measured) > LINT.miscount else 0
    over = min(over, frames - LINT.shortest)
    count, missing = frames - max(0, over + int(wraps)), max(0, -over - int(wraps))
    return Period(count, missing, over, measured, repeating(poses[:count], count + missing))


def repeating(poses: Array, frames: int) -> int:
    """Return of how many frames a period is: fewer than all, if the same poses come again.

    Parameters
    ----------
    poses : (n, d) ndarray
    frames : int
        Of all periods: n, and those that are missing at the end.
    """
    step = float(np.median(np.linalg.norm(np.diff(poses, axis=0), axis=1)))
    for period in range(LINT.shortest, frames // 2 + 1):
        if frames % period == 0:
            changes = np.linalg.norm(poses[period:] - poses[:-period], axis=1)
            if changes.max() <= LINT.same * step:
                return period
    return frames


def _steps_across(poses: Array) -> tuple[float, float, float]:
    """Return how many steps lead from the last pose to the first, what they leave, and the pace.

    The way in g steps is the integral of the speed, by the trapezoidal rule with its correction by
    the accelerations at the ends (Euler and Maclaurin).
    """
    way = poses[0] - poses[-1]
    (before, ending), (starting, after) = np.diff(poses[-3:], axis=0), np.diff(poses[:3], axis=0)
    speeding, slowing = ending - before, after - starting
    speed = 0.5 * (ending + 0.5 * speeding + starting - 0.5 * slowing)
    tried = np.arange(-LINT.most * LINT.parts, LINT.most * LINT.parts + 1)[:, None] / LINT.parts
    left = np.linalg.norm(way - tried * speed + tried**2 / 12 * (slowing - speeding), axis=1)
    best = int(np.argmin(left))
    return float(tried[best, 0]), float(left[best]), float(np.linalg.norm(speed))


def _miscounted(period: Period, wraps: bool) -> Iterator[Fault]:
    if period.over > 0:
        last = (
            "last frame repeats the first" if period.over == 1 else "last frames repeat the first"
        )
        wanted = "more often than once" if wraps else "which lasts twice as long then"
        says = f"the {last}, {wanted}: {period.over} too many"
        yield Fault("frame too many", period.measured, LINT.miscount, "frames", says)
    elif period.over < 0:
        says = (
            "the last frame does not repeat the first, as players of this format need"
            if period.over == -1 and wraps
            else f"between the last frame and the first {-period.over} are missing"
        )
        yield Fault("frame missing", -period.measured, LINT.miscount, "frames", says)


def _pop(loop: Seen, period: Period, wraps: bool) -> Iterator[Fault]:
    """Compare second differences of the joints' places at the joins with those elsewhere."""
    joints = loop.joints[:, loop.body :]
    poses = joints[: period.count]
    filled = np.concatenate([poses, _between(poses, period.missing)])
    last = joints[-1] if wraps and not period.over else None
    value = join_ratio(filled, period.one, missing=period.missing, last_key=last)
    if value > LINT.pop:
        says = "joints jerk at the join more than anywhere else"
        yield Fault("pop", value, LINT.pop, "times the largest jerk elsewhere", says)


def _between(poses: Array, missing: int) -> Array:
    """Return frames that lead smoothly from the last to the first."""
    t = np.arange(1, missing + 1)[:, None, None] / (missing + 1)
    first, last = poses[-1], poses[0]
    leaving, arriving = (missing + 1) * (first - poses[-2]), (missing + 1) * (poses[1] - last)
    return np.asarray(
        (2 * t**3 - 3 * t**2 + 1) * first
        + (t**3 - 2 * t**2 + t) * leaving
        + (3 * t**2 - 2 * t**3) * last
        + (t**3 - t**2) * arriving
    )


def _slide(loop: Seen, steps: Steps) -> Iterator[Fault]:
    """Take the way that each foot slides while it stands: to and fro is none."""
    level = steps.speeds * (1.0 - loop.motion.up_vector)
    pairs = zip(level.swapaxes(0, 1), steps.standing.T, strict=True)
    ways = [np.median(speeds[stands], axis=0) for speeds, stands in pairs if stands.any()]
    value = max((float(np.linalg.norm(way)) for way in ways), default=0.0)
    if value > LINT.slide:
        says = "feet slide over the ground while they stand"
        yield Fault("foot slide", value, LINT.slide, "body sizes a second", says)


def _drift(loop: Seen, period: Period, steps: Steps) -> Iterator[Fault]:
    """Compare the body's climb with the ground's: on stairs and slopes standing feet stay level."""
    climb = climb_of(loop.height, period.count, period.missing)
    if steps.standing.any():
        seconds = period.count * loop.motion.frame_time
        sinking = float(np.median(steps.speeds[..., loop.motion.up][steps.standing])) * seconds
        if (climb + sinking) * climb < LINT.level * climb * climb:
            return
    if abs(climb) > LINT.climb:
        says = f"the body {'climbs' if climb > 0.0 else 'sinks'} from period to period"
        yield Fault("drift", abs(climb), LINT.climb, "body sizes a period", says)


def _rate(apart: Apart) -> Iterator[Fault]:
    loop, period, steps, gait = apart.seen, apart.period, apart.steps, apart.gait
    if gait is None:
        return
    frames = (period.count + period.missing) / gait.strides
    seconds = frames * loop.motion.frame_time
    speed = np.linalg.norm(loop.ways[: period.count - 1].mean(axis=0)) * loop.motion.fps
    length = max(float(speed), float(np.linalg.norm(steps.below))) * seconds
    runs = steps.low < GAIT.airborne or length > GAIT.far
    long = GAIT.longest_run if runs else GAIT.longest_walk
    if not GAIT.shortest <= seconds <= long:
        limit = GAIT.shortest if seconds < GAIT.shortest else long
        says = f"a stride of {frames:.0f} frames takes too {'short' if limit < long else 'long'}"
        yield Fault("rate", seconds, limit, "seconds a stride", says)


def _unit(motion: Motion, wraps: bool) -> Iterator[Fault]:
    size, largest = motion.skeleton.size, LINT.tallest if wraps else LINT.longest
    if not LINT.smallest <= size <= largest:
        limit = LINT.smallest if size < LINT.smallest else largest
        says = f"the body is {size:.3g} {'m ' if wraps else ''}from end to end"
        yield Fault("unit", size, limit, "metres" if wraps else "lengths of the file", says)


def _bob(loop: Seen, period: Period) -> Iterator[Fault]:
    if not _lies_on_the_ground(loop, period):
        return
    height = loop.root[: period.count]
    level = height - climb_of(loop.root, period.count) * np.arange(len(height)) / len(height)
    value = float(np.ptp(level))
    if value > LINT.bob:
        says = "the root bone on the ground goes up and down"
        yield Fault("root bob", value, LINT.bob, "body sizes", says)


def _lies_on_the_ground(loop: Seen, period: Period) -> bool:
    """Tell whether the root lies as low as any joint, and below the one bone that hangs on it."""
    parents, up = loop.motion.skeleton.parents, loop.motion.up
    if parents[1:].count(0) != 1:
        return False
    joints = loop.joints[: period.count] - loop.joints[: period.count, :1]
    above = joints[:, parents.index(0)].mean(axis=0)
    below = above[up] > LINT.below * float(np.linalg.norm(above))
    lowest = float(joints[:, 1:, up].min(axis=1).mean())
    return bool(below and abs(lowest) < LINT.ground)


def _out_of_phase(gait: Gait | None, set_phase: float | None) -> Iterator[Fault]:
    if gait is None or set_phase is None:
        return
    value = abs(_turned(gait.phase - set_phase))
    if value > LINT.phase:
        says = "the left foot is ahead at another phase than in the other loops of the folder"
        yield Fault("phase", value, LINT.phase, "turns", says)
