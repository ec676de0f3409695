"""Who is asked what repeats, and in which order."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.base.spans import Spans
from roundelay.timeline.proposals import Proposal, proposers
from roundelay.timeline.search import Search
from roundelay.timeline.selection import find_evidence


@pytest.fixture(scope="module")
def walk() -> synth.Synthetic:
    return synth.gait("walk", repetitions=4, period=1.1, fps=60.0, seed=2)


class Told:
    """Propose what it was told."""

    name = "told"

    def __init__(self, *proposals: Proposal) -> None:
        self.proposals, self.asked = proposals, 0

    def propose(self, search: Search) -> Iterator[Proposal]:
        self.asked += 1
        yield from self.proposals


@pytest.fixture
def told() -> Iterator[Told]:
    brought = Told(Proposal(Spans([(0, 200)]), 66.0))
    yield proposers.add(brought)
    proposers.remove("told")


def test_a_proposer_is_asked_only_if_those_before_it_led_to_nothing(walk, told):
    (found,) = rl.find_periodic(walk.motion)
    assert told.asked == 0
    (own,) = rl.find_periodic(walk.motion, rl.Options(proposers=("told", "recurrence")))
    assert told.asked == 1
    assert own.runs == ((0, 200),)
    assert own.period == pytest.approx(found.period, rel=0.02)
    (again,) = rl.find_periodic(walk.motion, rl.Options(proposers=("gestures", "recurrence")))
    assert again.runs == found.runs


def test_what_is_refused_together_is_asked_apart(walk, told):
    rest = np.repeat(walk.motion.rotations[:1], 240, axis=0)
    still = rl.Motion(walk.motion.skeleton, rest, np.zeros((240, 3)), 1 / 60)
    both = rl.concatenate([still, walk.motion])
    part = Proposal(Spans([(240, 480)]), 66.0)
    told.proposals = (Proposal(Spans([(0, 4)]), 2.0, apart=(part,)),)
    (found,) = rl.find_periodic(both, rl.Options(proposers=("told",)))
    assert found.runs[0][0] >= 240


def test_frames_that_are_taken_are_not_asked_about_again(walk, told):
    told.proposals = tuple(Proposal(Spans([(0, 200)]), 66.0, fresh=fresh) for fresh in (0.0, 0.5))
    assert len(rl.find_periodic(walk.motion, rl.Options(proposers=("told",)))) == 1
    told.proposals = tuple(Proposal(Spans([(0, 200)]), 66.0) for _ in range(2))
    assert len(rl.find_periodic(walk.motion, rl.Options(proposers=("told",)))) == 2


def test_a_proposer_that_was_named_is_not_taken_for_gestures(walk, told):
    told.proposals = (Proposal(Spans([(0, 4)]), 2.0),)
    with pytest.raises(rl.NoPeriod, match=r"^no periodic motion found: frames 0-4"):
        rl.find_periodic(walk.motion, rl.Options(proposers=("told",), gestures=True))


def test_limbs_that_a_take_lacks_are_refused(walk, told):
    told.proposals = (Proposal(Spans([(0, 200)]), 66.0, limbs="wings"),)
    with pytest.raises(rl.NoPeriod, match="there are no wings"):
        rl.find_periodic(walk.motion, rl.Options(proposers=("told",)))


def test_the_search_may_look_at_some_limbs_alone(walk):
    search = Search.of_take(walk.motion, rl.Options())
    arms = search.of("arms")
    assert arms.points.shape[1] < search.points.shape[1]
    assert arms.of("arms") is arms
    assert search.of("wings") is None
    assert find_evidence(arms)[0].period == pytest.approx(66.0, rel=0.03)
    chosen = rl.Options(joints=("LeftLeg", "LeftFoot"))
    assert Search.of_take(walk.motion, chosen).of("arms") is None
