"""From the timeline to the evidence of each motion: what the user may choose."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.motion.features import point_cloud
from roundelay.timeline.inspection import inspect
from roundelay.timeline.limbs import Body
from roundelay.timeline.options import Options, TopologyOptions
from roundelay.timeline.proposals import Candidate, proposers
from roundelay.timeline.search import Search


@pytest.fixture(scope="module")
def walk() -> synth.Synthetic:
    return synth.gait("walk", repetitions=4, period=1.1, fps=60.0, seed=2)


@pytest.fixture(scope="module")
def several() -> rl.Motion:
    gaits = [synth.gait(kind, repetitions=6, fps=30, seed=1) for kind in ("walk", "jacks")]
    return synth.sequence(*gaits).motion


class Told:
    """Propose what it was told."""

    name = "told"

    def __init__(self, *candidates: Candidate) -> None:
        self.candidates, self.asked = candidates, 0

    def propose(self, body: Body) -> Iterator[Candidate]:
        self.asked += 1
        yield from self.candidates


@pytest.fixture
def told() -> Iterator[Told]:
    brought = Told(Candidate("body", 0, 100, 33.0))
    yield proposers.add(brought)
    proposers.remove("told")


def test_all_proposers_are_asked_and_one_account_chooses(walk, told):
    (found,) = rl.find_periodic(walk.motion)
    assert told.asked == 1
    (own,) = rl.find_periodic(walk.motion, Options(proposers=("told",)))
    assert told.asked == 2
    assert own.period == pytest.approx(found.period, rel=0.02)
    told.candidates = (Candidate("body", 0, 100, 50.0),)
    (again,) = rl.find_periodic(walk.motion)
    assert again.runs == found.runs


def test_what_loops_are_made_of_is_what_the_timeline_tells(several):
    behaviours = rl.understand(several).cyclic
    cycles = rl.find_cycles(several)
    assert len(cycles) == len(behaviours) == 2
    for cycle, behaviour in zip(cycles, behaviours, strict=True):
        assert cycle.evidence.runs == behaviour.spans
        assert cycle.evidence.confidence == behaviour.probability
        assert cycle.evidence.repetitions == behaviour.repetitions
        assert cycle.period == pytest.approx(behaviour.period, rel=0.02)


def test_a_class_and_a_scale_are_those_of_the_motion_they_are_given_to(several):
    second = inspect(several)[1]
    scale = second.evidence.coordinate.scale
    chosen = Options(motion=2, topology=TopologyOptions(class_index=0, scale=scale))
    (only,) = rl.find_periodic(several, chosen)
    assert only.runs == second.evidence.runs
    assert only.coordinate.scale == pytest.approx(scale)
    both = rl.find_periodic(several, Options(topology=TopologyOptions(scale=scale)))
    assert len(both) == 2
    with pytest.raises(rl.NoPeriod, match="expected one of 2 motions, found motion 3"):
        rl.find_periodic(several, Options(motion=3))


def test_classes_are_one_motion_each(several):
    found = rl.find_periodic(several, Options(topology=TopologyOptions(classes=2)))
    assert [one.coordinate.class_index for one in found] == [0, 1]
    assert all(one.runs == ((0, len(several)),) for one in found)


def test_what_rather_does_not_repeat_is_given_when_asked_for(boxing):
    told = rl.understand(boxing)
    assert told.uncertain
    sure = rl.find_periodic(boxing) if told.behaviours else []
    every = rl.find_periodic(boxing, Options(uncertain=True))
    assert len(every) == len(sure) + len(told.uncertain)
    assert every[-1].confidence < 0.5


def test_limbs_that_repeat_alone_are_looked_at_alone(walk):
    arms = tuple(name for name in walk.motion.skeleton.names if "Arm" in name)
    search = Search.of_take(walk.motion, Options())
    chosen = walk.motion.skeleton.indices(arms)
    assert np.array_equal(search.of(arms).points, point_cloud(walk.motion, joints=chosen))
    assert search.of(("wings",)) is search
    (found,) = rl.find_periodic(walk.motion, Options(joints=arms))
    assert found.period == pytest.approx(66.0, rel=0.03)


def test_arms_that_repeat_over_wandering_legs_are_found_and_named():
    """Boxing: the punches repeat, legs and trunk wander."""
    made = synth.gait("punch", repetitions=5.0)
    wandering = synth.wander(len(made.motion) / 120.0).motion
    arms = [j for j, name in enumerate(made.motion.skeleton.names) if "Arm" in name]
    rotations = wandering.rotations.copy()
    rotations[:, arms] = made.motion.rotations[:, arms]
    mixed = rl.Motion(made.motion.skeleton, rotations, wandering.root_path, 1 / 120)
    cycle = rl.find_cycles(mixed)[0]
    assert cycle.period == pytest.approx(made.period, rel=0.03)
    assert set(cycle.evidence.partial) <= {"left arm", "right arm"}
    assert cycle.evidence.partial


def test_without_a_class_that_turns_the_alignment_is_the_phase(walk, monkeypatch):
    (found,) = rl.find_periodic(walk.motion)
    assert not found.aligned
    monkeypatch.setattr("roundelay.timeline.evidence._turns_with", lambda *_: False)
    (other,) = rl.find_periodic(walk.motion)
    assert other.aligned
    assert other.period == pytest.approx(found.period, rel=0.02)
    apart = (other.turns - found.turns)[found.runs.frames]
    assert np.ptp(apart) < 0.15


def test_a_class_that_cannot_be_lifted_leaves_the_alignment(walk, monkeypatch):
    def unliftable(*_: object, **__: object) -> None:
        raise rl.LiftError("class 0 lifts to no integer cocycle")

    monkeypatch.setattr("roundelay.timeline.evidence.circular_coordinate", unliftable)
    with pytest.raises(rl.NoPeriod, match="lifts to no integer cocycle"):
        rl.find_cycles(walk.motion)
