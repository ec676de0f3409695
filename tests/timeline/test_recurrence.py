"""Candidate parts, and how they are grouped."""

from __future__ import annotations

import numpy as np
import pytest

from roundelay import synth
from roundelay.motion.features import point_cloud
from roundelay.motion.poses import leading_rest_pose
from roundelay.timeline.proposals.recurrence import (
    candidate_parts,
    recurring_groups,
)


def parts_of(made: synth.Synthetic, step: int = 2):
    return candidate_parts(point_cloud(made.motion)[::step], made.motion.fps / step)


@pytest.mark.parametrize("kind", ["walk", "run", "jacks", "punch", "spin"])
@pytest.mark.parametrize("repetitions", [1.4, 3.0, 6.0])
def test_a_gait_is_one_part_with_its_period(kind, repetitions):
    made = synth.gait(kind, repetitions=repetitions)
    (part,) = parts_of(made)
    assert part.period * 2 / made.motion.fps == pytest.approx(made.period, rel=0.03)
    assert part.start <= 2
    assert part.stop * 2 >= len(made.motion) - 4


@pytest.mark.parametrize("seed", range(6))
def test_wandering_has_no_part(seed):
    assert parts_of(synth.wander(8.0, seed=seed)) == []


def test_standing_still_has_no_part():
    points = point_cloud(synth.gait("walk", repetitions=2).motion)
    assert candidate_parts(np.repeat(points[:1], 200, axis=0), 60.0) == []
    assert candidate_parts(points[:4], 60.0) == []


def test_recurring_parts_are_grouped_and_others_are_not():
    walk, jacks = synth.gait("walk", seed=1), synth.gait("jacks", seed=1)
    made = synth.sequence(walk, jacks, synth.gait("walk", repetitions=4, seed=1))
    points = point_cloud(made.motion)[::2]
    groups = recurring_groups(points, candidate_parts(points, made.motion.fps / 2))
    assert sorted(len(group) for group in groups) == [1, 2]
    both = next(group for group in groups if len(group) == 2)
    assert both[0].stop * 2 <= made.cuts[0] + 40
    assert both[1].start * 2 >= made.cuts[1] - 40


def test_a_rest_pose_in_front_is_noticed(jumps):
    points = point_cloud(jumps)
    assert leading_rest_pose(points)
    assert not leading_rest_pose(points[1:])
