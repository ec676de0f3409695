"""The principal ways in which repetitions differ, and how many of them predict."""

import numpy as np
import pytest
from benchmarks._left_out import predicted

import roundelay as rl
from roundelay import synth
from roundelay.cycles.modes import chosen_modes, curves


@pytest.fixture(scope="module")
def varied():
    made = synth.varied(14, rng=1)
    cycle = rl.find_cycles(made.motion)[0]
    own = rl.repetitions(cycle, made.motion)
    numbers = np.round(made.phase[np.round(own.starts).astype(int)]).astype(int)
    return own, made.scores[numbers], rl.modes(own)


def test_known_ways_are_found(varied):
    own, known, found = varied
    assert found.count >= 2
    assert found.error < 0.2
    assert found.shares.sum() == pytest.approx(1.0)
    table = np.column_stack([np.ones(len(own)), found.scores[:, :3]])
    for column in known.T:
        fitted = table @ np.linalg.lstsq(table, column, rcond=None)[0]
        assert np.corrcoef(fitted, column)[0, 1] ** 2 > 0.9


def test_scores_are_standard_deviations(varied):
    _, _, found = varied
    assert np.allclose(found.scores.mean(axis=0), 0.0)
    assert np.allclose(found.scores.std(axis=0, ddof=1), 1.0)


def test_a_mode_is_shown_as_a_loop(varied):
    own, _, found = varied
    here, there, none = (found.loop(0, amount, foot_lock=False) for amount in (2.0, -2.0, 0.0))
    arm = own.cycle.skeleton.index("LeftArm")
    middle = [one.rotations[len(one) // 2, arm] for one in (here, none, there)]
    assert abs(middle[0] @ middle[1]) < 0.99
    assert abs(middle[2] @ middle[1]) < 0.99
    mean = own.cycle.sample(foot_lock=False)
    assert np.allclose(abs(np.sum(none.rotations * mean.rotations, axis=2)), 1.0, atol=1e-3)
    with pytest.raises(ValueError, match="expected a mode from 0 to"):
        found.loop(len(own))


def test_noise_has_no_modes():
    draw = np.random.default_rng(3)
    values, early = draw.normal(size=(12, 300)), np.arange(300) < 150
    chosen = chosen_modes(values, early)
    assert chosen.error > 0.97
    new = draw.normal(size=300)
    far = predicted(values, early, chosen, new[early]) - values.mean(axis=0)[~early]
    assert np.linalg.norm(far) < 0.2 * np.linalg.norm(new)


def test_what_modes_know_they_predict():
    draw = np.random.default_rng(4)
    shape, early = draw.normal(size=(2, 200)), np.arange(200) < 100
    values = draw.normal(size=(10, 2)) @ shape + 0.01 * draw.normal(size=(10, 200))
    chosen = chosen_modes(values, early)
    assert chosen.count == 2
    new = np.array([2.0, -1.0]) @ shape
    told = predicted(values, early, chosen, new[early])
    assert np.linalg.norm(told - new[~early]) < 0.05 * np.linalg.norm(new)


def test_repetitions_all_alike_have_none():
    values, early = np.ones((6, 40)), np.arange(40) < 20
    chosen = chosen_modes(values, early)
    assert (chosen.count, chosen.error) == (0, 1.0)
    assert np.array_equal(predicted(values, early, chosen, np.ones(20)), np.ones(20))


def test_too_few_are_told():
    motion = synth.gait("walk", repetitions=3.2, fps=60.0).motion
    own = rl.repetitions(rl.find_cycles(motion)[0], motion)
    with pytest.raises(rl.TooShort, match="expected 4 whole repetitions or more for modes, found"):
        rl.modes(own)
    with pytest.raises(ValueError, match=f"expected rows of {len(own)} shares"):
        own.mixed([1.0])


def test_points_have_modes_too():
    made = synth.varied(8, rng=2)
    points = synth.as_points(made.motion)
    own = rl.repetitions(rl.find_cycles(points)[0], points)
    values, early = curves(own)
    assert values.shape[0] == len(own)
    assert 0 < early.sum() < len(early)
    assert rl.modes(own).count >= 1
