"""What a proposer must do."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np

from roundelay import synth
from roundelay.motion.features import point_cloud
from roundelay.motion.motion import Motion, concatenate
from roundelay.motion.poses import PoseArray, Poses
from roundelay.testing.expecting import SECONDS, Subject
from roundelay.timeline.limbs import Body, body_of
from roundelay.timeline.proposals import Candidate, Proposer

__all__ = ["check_proposer"]

_MOST = 1000
_RATE = 60.0
# Frames that are put before a take, and not looked at.
_BEFORE = 90
# Samples by which ends and periods may differ for it: sums of floats do.
_CLOSE = 1.0


def check_proposer(proposer: Proposer) -> None:
    """Check that what a proposer proposes can be measured.

    Takes are made that are periodic, in part, or not at all, and one of bare points.

    - It has a name, and proposes at most 1000 times, within 30 s.
    - Stretches are not empty and within the take; periods are positive, and no longer than it;
      groups are among those of the body; phases have a value a sample.
    - The same body gives the same candidates, and is left as it is.
    - Frames that are not looked at change nothing.

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
        _check_take(subject, body_of(take))
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
    yield walk[:8]
    values = point_cloud(walk).reshape(len(walk), -1, 3)
    names = tuple(f"point {number}" for number in range(values.shape[1]))
    yield PoseArray(names, values, walk.fps)
    yield PoseArray(names, np.repeat(values[:1], 60, axis=0), walk.fps)


def _check_take(subject: Subject, body: Body) -> None:
    before = body.signals.copy()
    found = _proposed(subject, body)
    for candidate in found:
        _check_candidate(subject, candidate, body)
    again = _proposed(subject, body)
    same = len(found) == len(again) and all(map(_like, found, again))
    subject.expect(same, "the same candidates again", "others")
    left = np.array_equal(before, body.signals)
    subject.expect(left, "signals left as they are", "changed ones")


def _check_candidate(subject: Subject, candidate: Candidate, body: Body) -> None:
    expect = subject.expect
    expect(isinstance(candidate, Candidate), "a Candidate", repr(candidate))
    expect(candidate.group in body.groups(), f"a group of {tuple(body.groups())}", candidate.group)
    start, stop = candidate.start, candidate.stop
    expect(0 <= start < stop <= len(body), f"samples within 0 and {len(body)}", (start, stop))
    fits = 0.0 < candidate.period <= len(body)
    expect(fits, f"a period above 0 and up to {len(body)} samples", candidate.period)
    if candidate.turns is not None:
        shape = np.shape(candidate.turns)
        expect(shape == (len(body),), f"a phase for each of {len(body)} samples", shape)


def _check_moved(subject: Subject, motion: Motion) -> None:
    """Put frames before a take, and look at the take alone."""
    whole = body_of(motion, (0, len(motion)))
    before = synth.wander(_BEFORE / _RATE, fps=_RATE).motion
    both = concatenate([before, motion])
    moved = body_of(both, (_BEFORE, len(both)))
    found, again = _proposed(subject, whole), _proposed(subject, moved)
    like = len(found) == len(again) and all(map(_like, found, again))
    subject.expect(like, "candidates that move with the take", f"{again} after {found}")


def _like(first: Candidate, second: Candidate) -> bool:
    return first.group == second.group and all(
        abs(a - b) <= _CLOSE
        for a, b in (
            (first.start, second.start),
            (first.stop, second.stop),
            (first.period, second.period),
        )
    )


def _proposed(subject: Subject, body: Body) -> list[Candidate]:
    found = subject.within(
        SECONDS, lambda: list(islice(subject.item.propose(body), _MOST + 1)), "proposing"
    )
    subject.expect(len(found) <= _MOST, f"at most {_MOST} candidates", "more")
    return found
