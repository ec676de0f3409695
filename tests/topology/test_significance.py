from __future__ import annotations

import numpy as np
import pytest

from clouds import noisy_circle
from roundelay.topology import (
    count_classes,
    p_values,
    persistent_cohomology,
    turns,
    two_bar_ratio,
)


def test_a_loop_is_significant_and_noise_is_not() -> None:
    loop = persistent_cohomology(noisy_circle(200, noise=0.1))
    assert p_values(loop)[0] < 1e-3
    assert count_classes(loop) == 1
    noise = persistent_cohomology(np.random.default_rng(0).normal(size=(200, 3)))
    assert count_classes(noise) == 0
    assert p_values(noise).shape == (len(noise),)
    assert ((p_values(noise) >= 0) & (p_values(noise) <= 1)).all()


def test_two_loops_are_two_classes() -> None:
    loops = [noisy_circle(200, noise=0.05, seed=seed) + 5 * seed for seed in (0, 1)]
    assert count_classes(persistent_cohomology(np.concatenate(loops))) == 2


def test_few_bars() -> None:
    line = persistent_cohomology(np.arange(6.0)[:, None])
    assert len(line) == 0
    assert (p_values(line).size, count_classes(line), two_bar_ratio(line)) == (0, 0, 0.0)
    one = persistent_cohomology([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    assert two_bar_ratio(one) == float("inf")


def test_all_bars_are_needed() -> None:
    with pytest.raises(ValueError, match="longest only"):
        p_values(persistent_cohomology(noisy_circle(50, noise=0.1), longest=1))


def test_two_bar_ratio() -> None:
    barcode = persistent_cohomology(noisy_circle(200, noise=0.1))
    assert two_bar_ratio(barcode) == barcode.persistence[0] / barcode.persistence[1] > 3


def test_turns_are_counted_within_runs() -> None:
    phase = np.linspace(0, 2.5, 101) % 1.0
    assert turns(phase, [(0, 101)]) == pytest.approx((2.5, 2.5))
    assert turns(-phase % 1.0, [(0, 101)]) == pytest.approx((-2.5, 2.5))
    assert turns(phase, [(0, 41), (41, 101)]) == pytest.approx((2.475, 2.475))
    assert turns(phase, []) == (0.0, 0.0)
