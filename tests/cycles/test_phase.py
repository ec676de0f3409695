"""One phase a cycle: what it was fitted by is kept, and its poses and its travel share it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.base.spans import Spans
from roundelay.cycles.edit.align import shifted
from roundelay.cycles.edit.blend import blend
from roundelay.cycles.models import cycle_models
from roundelay.geometry import rotations as rot

METHODS = ("harmonic", "centroid", "paper")
SHIFTS = np.linspace(-0.1, 0.1, 81)


def out_of_step(shown, captured):
    """By how much of a period what is shown (n, d) at phases must be shifted to fit best."""
    apart = [np.mean((shown(shift) - captured) ** 2) for shift in SHIFTS]
    return SHIFTS[int(np.argmin(apart))]


@pytest.mark.parametrize("repetitions", [1.4, 2.5, 4.3])
@pytest.mark.parametrize("method", METHODS)
def test_poses_and_travel_are_in_step_with_the_frames(method, repetitions):
    """[A]'s centroids were up to .07 periods behind."""
    motion = synth.gait("walk", repetitions=repetitions, seed=2).motion
    (cycle,) = rl.find_cycles(motion, rl.Options(method=method))
    frames = np.flatnonzero(np.isfinite(cycle.phase))
    assert Spans.of_mask(np.isfinite(cycle.phase)) == cycle.evidence.runs
    phase, heights = cycle.phase[frames], motion.root_path[frames, motion.up, None]

    def poses(shift):
        return np.abs(cycle.rotations(phase + shift)[:, 1:])

    assert abs(out_of_step(poses, np.abs(motion.rotations[frames, 1:]))) < 0.01
    assert abs(out_of_step(lambda shift: cycle.height(phase + shift), heights)) < 0.01


def test_the_phase_moves_with_the_cycle():
    motion = synth.gait("walk", repetitions=3).motion
    (cycle,) = rl.find_cycles(motion)
    moved = shifted(cycle, 0.3)
    frames = np.array([40, 90])
    there, here = (one.rotations(one.phase[frames]) for one in (moved, cycle))
    assert rot.angle_between(there, here).max() < 1e-6
    assert blend([cycle, cycle], [0.5, 0.5]).phase is None


class Forgetful:
    name = "forgetful"

    def fit(self, *given):
        return replace(cycle_models["harmonic"].fit(*given), phase=None)


def test_a_model_that_forgets_the_phase_is_helped():
    motion = synth.gait("walk", repetitions=3).motion
    cycle_models.add(Forgetful())
    try:
        (cycle,) = rl.find_cycles(motion, rl.Options(method="forgetful"))
    finally:
        cycle_models.remove("forgetful")
    assert np.isfinite(cycle.phase).sum() == cycle.evidence.runs.total
