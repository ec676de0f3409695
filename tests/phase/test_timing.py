"""Unwrapping, period, and time from structure."""

from __future__ import annotations

import numpy as np
import pytest

from roundelay.base.errors import TooShort
from roundelay.phase.period import line_period, return_period
from roundelay.phase.phase_map import phase_map, rank_remap
from roundelay.phase.unwrap import smooth_turns, unwrap


def uneven(phase: np.ndarray, depth: float = 0.7) -> np.ndarray:
    """A coordinate that runs fast in one half of the period and slowly in the other."""
    return phase + depth * np.sin(2 * np.pi * phase) / (2 * np.pi)


def test_unwrap_counts_turns_forwards_and_backwards():
    turns = np.concatenate([np.linspace(0.2, 3.1, 60), np.linspace(3.1, 1.4, 40)])
    assert np.allclose(unwrap(turns % 1.0, [(0, 100)]), turns)


def test_unwrap_counts_nothing_between_runs():
    turns = unwrap([0.0, 0.4, 0.8, 0.3, 0.6], [(0, 2), (3, 5)])
    assert np.isnan(turns[2])
    assert np.allclose(turns[[0, 1, 3, 4]], [0.0, 0.4, 0.3, 0.6])


@pytest.mark.parametrize("repetitions", [1.3, 1.5, 2.5])
def test_time_from_structure_is_unbiased_by_incomplete_periods(repetitions):
    period = 100.0
    time = np.arange(round(repetitions * period)) / period
    runs = [(0, len(time))]
    turns = uneven(time)
    mapping = phase_map(turns, runs)
    found = mapping(turns)
    error = np.abs(found - found[0] - time).max()
    # [C] eq. 3.20 on the same coordinate: ranks over-represent what is repeated.
    ranked = unwrap(rank_remap(turns), runs)
    assert mapping.period == pytest.approx(period, rel=0.005)
    assert error < 0.01
    assert np.abs(ranked - ranked[0] - time).max() > 5 * error


def test_return_period_needs_no_uniform_coordinate():
    found = {"return": [], "line": []}
    for start in np.linspace(0.0, 0.9, 10):
        turns = uneven(start + np.arange(140) / 100.0)
        found["return"].append(return_period(turns, [(0, 140)]))
        found["line"].append(line_period(turns, [(0, 140)]))
    worst = {name: max(abs(np.array(values) - 100.0)) for name, values in found.items()}
    assert worst["return"] < 0.2
    assert worst["line"] > 0.9


def test_line_period_of_several_runs_shares_one_slope():
    time = np.arange(300) / 80.0
    turns = time.copy()
    turns[150:] += 0.37
    assert line_period(turns, [(0, 150), (150, 300)]) == pytest.approx(80.0)


@pytest.mark.parametrize("function", [return_period, phase_map])
def test_less_than_a_period_is_too_short(function):
    with pytest.raises(TooShort):
        function(np.linspace(0.0, 0.9, 50), [(0, 50)])


def test_a_coordinate_that_does_not_advance_has_no_line_period():
    with pytest.raises(TooShort):
        line_period(np.zeros(20), [(0, 20)])


def test_phase_map_is_a_periodic_increasing_map():
    turns = uneven(np.linspace(0.3, 4.9, 500))
    mapping = phase_map(turns, [(0, 500)])
    x = np.linspace(-2.0, 3.0, 1001)
    y = mapping(x)
    assert np.all(np.diff(y) > 0)
    assert np.allclose(mapping(x + 1.0), y + 1.0)


@pytest.mark.parametrize("width", [3.0, 25.0, 1000.0, np.inf])
def test_smoothing_keeps_a_steady_advance(width):
    turns = np.linspace(0.2, 5.0, 240)
    assert np.allclose(smooth_turns(turns, [(0, 100), (100, 240)], width), turns)


def test_smoothing_takes_noise_away():
    rng = np.random.default_rng(0)
    turns = np.linspace(0.0, 4.0, 400)
    noisy = turns + rng.normal(scale=0.03, size=400)
    smooth = smooth_turns(noisy, [(0, 400)], 20.0)
    assert np.std(smooth - turns) < 0.3 * np.std(noisy - turns)


def test_rank_remap_is_uniform():
    phase = np.random.default_rng(1).uniform(size=50) ** 3
    assert np.allclose(np.sort(rank_remap(phase)), np.arange(50) / 50)
