"""The oracle itself."""

from __future__ import annotations

import numpy as np
import pytest

from roundelay import synth


@pytest.mark.parametrize("kind", ["walk", "run", "jacks", "punch", "spin"])
def test_a_gait_repeats_after_its_period(kind):
    made = synth.gait(kind, repetitions=2, period=1.0, fps=100, unevenness=0.5)
    first, second = made.motion.rotations[:100, 1:], made.motion.rotations[100:, 1:]
    assert np.allclose(np.abs(np.sum(first * second, axis=-1)), 1.0)
    assert np.allclose(made.phase, np.arange(200) / 100)


def test_noise_and_seed_make_a_difference():
    plain, noisy = synth.gait("walk"), synth.gait("walk", noise=0.05)
    other = synth.gait("walk", seed=3)
    assert not np.allclose(plain.motion.rotations, noisy.motion.rotations)
    assert not np.allclose(plain.motion.rotations, other.motion.rotations)


def test_a_sequence_knows_its_cuts():
    made = synth.sequence(synth.gait("walk"), synth.wander(2.0), synth.gait("run"))
    assert made.cuts == (396, 636)
    assert made.labels == ("walk", "wander", "run")
    steps = np.linalg.norm(np.diff(made.motion.rotations, axis=0), axis=-1).max(axis=1)
    assert steps.max() < 0.2, "no jump at a cut"


def test_an_unknown_gait_is_refused():
    with pytest.raises(ValueError, match="expected a gait among"):
        synth.gait("swim")


@pytest.mark.parametrize("made", [synth.gait, synth.wander])
def test_random_numbers_come_from_a_seed_or_a_generator(made):
    given = {"fps": 30.0}
    seven = made(**given, rng=7).motion.rotations
    for same in ({"rng": np.random.default_rng(7)}, {"seed": 7}):
        np.testing.assert_array_equal(made(**given, **same).motion.rotations, seven)
    assert np.abs(made(**given, rng=8).motion.rotations - seven).max() > 0.01
    drawing = np.random.default_rng(7)
    first, second = (made(**given, rng=drawing).motion.rotations for _ in range(2))
    assert np.abs(first - second).max() > 0.01
