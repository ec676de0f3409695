"""What a proposer must do."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from roundelay import synth
from roundelay.base.errors import NoPeriod
from roundelay.base.spans import Spans
from roundelay.motion.features import point_cloud
from roundelay.motion.motion import Motion, concatenate
from roundelay.motion.poses import PoseArray, Poses
from roundelay.testing.expecting import SECONDS, Subject
from roundelay.timeline.options import Options
from roundelay.timeline.proposals import Proposal, Proposer
from roundelay.timeline.search import Search

__all__ = ["check_proposer"]

_MOST = 1000
_RATE = 60.0
# Frames that are put before a take, and not looked at.
_BEFORE = 90
# Frames by which ends of runs and periods may differ for it: sums of floats do.
_CLOSE = 1.0


def check_proposer(proposer: Proposer) -> None:
    """Check that what a proposer proposes can be judged.

    Takes are made that are periodic, in part, or not at all, and one of bare points.

    - It has a name, and proposes at most 1000 times, within 30 s; it may raise `NoPeriod`.
    - Runs are in order, not empty and within the span; periods are positive, and no longer than
      the span; limbs are among those of the take; shares are within 0 and 1.
    - The same search gives the same proposals, and is left as it is.
    - Frames before the span change nothing: proposals move with the take.

    Parameters
    ----------
    proposer : Proposer

    Raises
    ------
    AssertionError
        If it does not.
    """
    subject = Subject("proposer", proposer)
    subject.expect_parts("propose")
    for take in _takes():
        _check_take(subject, take, Options(frames=(0, _length(take))))
    for motion in _motions():
        _check_moved(subject, motion)


def _motions() -> Iterator[Motion]:
    walk = synth.gait("walk", repetitions=4.0, fps=_RATE)
    jacks = synth.gait("jacks", repetitions=3.0, fps=_RATE)
    between = synth.wander(2.0, fps=_RATE)
    yield walk.motion
    yield synth.sequence(walk, between, jacks).motion
    yield synth.wander(6.0, fps=_RATE).motion
    yield synth.gait("punch", repetitions=1.0, fps=_RATE).motion


def _takes() -> Iterator[Motion | Poses]:
    yield from _motions()
    walk = next(_motions())
    values = point_cloud(walk).reshape(len(walk), -1, 3)
    names = tuple(f"point {number}" for number in range(values.shape[1]))
    yield PoseArray(names, values, walk.fps)


def _length(take: Motion | Poses) -> int:
    return len(take) if isinstance(take, Motion) else len(take.values)


def _check_take(subject: Subject, take: Motion | Poses, options: Options) -> None:
    search = Search.of_take(take, options)
    before = search.points.copy()
    found = _proposed(subject, search)
    for proposal in found:
        _check_proposal(subject, proposal, search)
    subject.expect(_proposed(subject, search) == found, "the same proposals again", "others")
    same = np.array_equal(before, search.points)
    subject.expect(same, "points left as they are", "changed ones")


def _check_proposal(subject: Subject, proposal: Proposal, search: Search) -> None:
    expect = subject.expect
    expect(isinstance(proposal, Proposal), "a Proposal", repr(proposal))
    runs, (start, stop) = proposal.runs, search.span
    expect(isinstance(runs, Spans) and runs.total > 0, "runs as Spans of some frames", repr(runs))
    inside = start <= runs[0][0] and runs[-1][1] <= stop
    expect(inside, f"frames within {start} and {stop}", str(runs))
    expect(all(runs.lengths), "no empty run", str(runs))
    fits = 0.0 < proposal.period <= stop - start
    expect(fits, f"a period above 0 and up to {stop - start} frames", proposal.period)
    limbs = ("", *([] if search.poses is None else search.poses.groups))
    expect(proposal.limbs in limbs, f"limbs among {limbs}", repr(proposal.limbs))
    expect(0.0 <= proposal.fresh <= 1.0, "a fresh share within 0 and 1", proposal.fresh)
    least = proposal.least_prominence
    expect(0.0 <= least < np.inf, "a least prominence from 0 on", least)
    expect(proposal.rate is None or proposal.rate > 0.0, "a positive rate", proposal.rate)
    for part in proposal.apart:
        _check_proposal(subject, part, search)


def _check_moved(subject: Subject, motion: Motion) -> None:
    """Put frames before a take, and look at the take alone."""
    frames = len(motion)
    whole = Search.of_take(motion, Options(frames=(0, frames)))
    before = synth.wander(_BEFORE / _RATE, fps=_RATE).motion
    later = Options(frames=(_BEFORE, _BEFORE + frames))
    moved = Search.of_take(concatenate([before, motion]), later)
    found, again = _proposed(subject, whole), _proposed(subject, moved)
    like = len(found) == len(again) and all(map(_like, map(_moved, found), again))
    subject.expect(like, "proposals that move with the take", f"{again} after {found}")


def _moved(proposal: Proposal) -> Proposal:
    runs = Spans((start + _BEFORE, stop + _BEFORE) for start, stop in proposal.runs)
    return replace(proposal, runs=runs, apart=tuple(map(_moved, proposal.apart)))


def _like(first: Proposal, second: Proposal) -> bool:
    a, b = first.runs, second.runs
    return (
        len(a) == len(b)
        and bool(np.all(np.abs(np.subtract(a, b)) <= _CLOSE))
        and abs(first.period - second.period) <= _CLOSE
        and len(first.apart) == len(second.apart)
        and all(map(_like, first.apart, second.apart))
    )


def _proposed(subject: Subject, search: Search) -> list[Proposal]:
    def work() -> list[Proposal]:
        try:
            return list(islice(subject.item.propose(search), _MOST + 1))
        except NoPeriod:
            return []

    found = subject.within(SECONDS, work, "proposing")
    subject.expect(len(found) <= _MOST, f"at most {_MOST} proposals", "more")
    return found
