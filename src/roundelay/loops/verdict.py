"""A verdict first: can a loop be used as it is, and if not why, in words and centimetres."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from roundelay.base.checks import expected
from roundelay.base.threads import one_thread
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.swings import swings
from roundelay.geometry import rotations as rot
from roundelay.geometry.contacts import Foot, find_feet, skate
from roundelay.loops.join import join_ratio
from roundelay.loops.quality import Quality
from roundelay.loops.thresholds import VERDICT
from roundelay.loops.units import Lengths
from roundelay.motion.feet import touching
from roundelay.motion.motion import Motion
from roundelay.timeline.evidence import Evidence
from roundelay.timeline.limbs import Limb, body_of

__all__ = ["Verdict", "Word", "verdict_of"]

Array = NDArray[np.float64]
Word = Literal["good", "look", "do not use"]


@dataclass(frozen=True)
class Verdict:
    """Say in words whether a loop can be used.

    Attributes
    ----------
    word : {"good", "look", "do not use"}
    reasons : tuple of str
        Why it is not good, the gravest first; empty if it is.
    """

    word: Word
    reasons: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"{self.word}: {'; '.join(self.reasons)}" if self.reasons else self.word


@dataclass(frozen=True)
class _Fault:
    """One reason, and whether it forbids to use the loop."""

    reason: str
    grave: bool = False


@dataclass(frozen=True, eq=False)
class _Played:
    """A loop that is played on and on, the body's motion in its root."""

    cycle: Cycle
    loop: Motion
    in_place: bool

    @property
    def period(self) -> int:
        """Frames of a period."""
        return max(1, round(self.cycle.period * self.loop.fps))

    def along(self, points: Array) -> Array:
        """Return points (n, k, 3) for one who travels and turns along; a repeated first is out."""
        points = points[: max(1, len(points) // self.period) * self.period]
        if self.in_place:
            return points
        phase = np.arange(len(points)) / self.period
        return rot.rotate(rot.conjugate(self._turn(phase)), points - self._path(phase))

    def onward(self, points: Array) -> Array:
        """Return points (n + 1, k, 3) in the world, up to the first frame of the next round."""
        along = self.along(points)
        phase = np.arange(len(along) + 1) / self.period
        around = np.concatenate([along, along[:1]])
        return rot.rotate(self._turn(phase), around) + self._path(phase)

    def _turn(self, phase: Array) -> Array:
        angles = self.cycle.heading(phase)[:, None, None]
        return rot.from_rotation_vector(angles * self.loop.up_vector)

    def _path(self, phase: Array) -> Array:
        return self.cycle.steady_path(phase)[:, None]


@one_thread
def verdict_of(
    cycle: Cycle,
    motion: Motion,
    loop: Motion,
    figures: Quality,
    *,
    in_place: bool = False,
    resized: float = 1.0,
) -> Verdict:
    """Judge a loop as it is played, against the capture it was made from.

    Parameters
    ----------
    cycle : Cycle
        As from `find_cycles`.
    motion : Motion
        The capture given to it.
    loop : Motion
        What is written, as from `Cycle.sample` from phase 0 on.
    figures : Quality
        As from `quality`.
    in_place : bool
        Whether the loop leaves travel and turning out.
    resized : float
        By what all lengths were multiplied since they were read.

    Returns
    -------
    Verdict

    Raises
    ------
    ValueError
        If the cycle carries no evidence of where it was found.
    """
    cycle, motion, loop = expected(Cycle, cycle), expected(Motion, motion), expected(Motion, loop)
    if cycle.evidence is None:
        raise ValueError("expected a cycle found in a capture, with its evidence")
    motion, limbs = motion.with_root_motion(), body_of(motion).limbs
    played = _Played(cycle, loop.with_root_motion(), in_place)
    lengths = Lengths.of(motion.skeleton, resized)
    faults = [
        *_jerks(played),
        *_slides(played, motion, limbs, lengths),
        *_lost_swings(played, motion, cycle.evidence),
        *_climbs(cycle, lengths),
        *_seen_seldom(figures.repetitions),
    ]
    faults.sort(key=lambda fault: not fault.grave)
    word: Word = "good" if not faults else "do not use" if faults[0].grave else "look"
    return Verdict(word, tuple(fault.reason for fault in faults))


def _jerks(played: _Played) -> Iterator[_Fault]:
    """Tell of a join at which a joint is accelerated more than anywhere else."""
    points = played.along(played.loop.positions())
    if played.period < 4:
        return
    times = join_ratio(points, played.period)
    if times > VERDICT.jerks:
        reason = f"jerks where it is joined, {times:.1f} times as hard as anywhere else"
        yield _Fault(reason, times > VERDICT.breaks)


def _slides(
    played: _Played, motion: Motion, limbs: Sequence[Limb], lengths: Lengths
) -> Iterator[_Fault]:
    """Tell the feet that slide further in a period than in the capture."""
    feet = find_feet(motion.skeleton, motion.positions(), motion.up)
    runs = played.cycle.evidence.runs if played.cycle.evidence else ()
    seen = [touching(motion[start:stop], feet) for start, stop in runs]
    shown = played.onward(touching(played.loop, feet))
    usual = np.sum([_slid(points, motion) for points in seen], axis=0)
    usual *= played.cycle.period * motion.fps / sum(map(len, seen))
    slid = _slid(shown, played.loop) * played.period / (len(shown) - 1)
    for foot, far, before in zip(feet, slid, usual, strict=True):
        more = (far - before) / lengths.size
        if more > VERDICT.slides and far > VERDICT.worse * before:
            name = _name(foot, limbs, motion.skeleton.names)
            told = f"{lengths.told(far)} ({lengths.told(before)} in the capture)"
            yield _Fault(f"{name} slides {told}", more > VERDICT.skids)


def _slid(points: Array, motion: Motion) -> Array:
    """Return how far each foot (n,) slides, in the file's unit."""
    size = motion.skeleton.size
    columns = np.moveaxis(points[:, :, None], 1, 0)
    return size * np.array([skate(x, fps=motion.fps, size=size, up=motion.up) for x in columns])


def _name(foot: Foot, limbs: Sequence[Limb], names: Sequence[str]) -> str:
    """Return "left foot" where that says which, else the name of the joint."""
    for side in ("left", "right"):
        if any(foot.ankle in limb.joints for limb in limbs if limb.name == f"{side} leg"):
            return f"{side} foot"
    return names[foot.joint]


def _lost_swings(played: _Played, motion: Motion, evidence: Evidence) -> Iterator[_Fault]:
    """Tell the limbs that move less than in the usual repetition."""
    for swing in swings(played.loop[: played.period], motion, evidence):
        if swing.kept < VERDICT.kept:
            reason = f"{swing.limb} keeps {swing.kept:.0%} of its movement"
            yield _Fault(reason, swing.kept < VERDICT.lost)


def _climbs(cycle: Cycle, lengths: Lengths) -> Iterator[_Fault]:
    climb = float(cycle.velocity.constant[cycle.up])
    if climb != 0.0:
        yield _Fault(f"{'climbs' if climb > 0 else 'sinks'} {lengths.told(abs(climb))} a period")


def _seen_seldom(repetitions: float) -> Iterator[_Fault]:
    if repetitions < VERDICT.repetitions:
        # Rounded down: what is nearly 2 is not 2.
        yield _Fault(f"made of {np.floor(10 * repetitions) / 10:.1f} repetitions only")
