"""Periodic or a mere loop, by the coordinate alone."""

from __future__ import annotations

import numpy as np
import pytest

from clouds import closed_curve
from roundelay.reproduction.periodicity import periodicity
from roundelay.topology import circular_coordinate, persistent_cohomology


def test_a_loop_run_to_and_fro_is_not_periodic() -> None:
    forward = np.linspace(0, 3, 300)
    assert periodicity(forward % 1.0, [(0, 300)]).is_periodic
    assert not periodicity(abs(forward - 1.5) % 1.0, [(0, 300)]).is_periodic
    assert not periodicity(forward[:120] % 1.0, [(0, 120)]).is_periodic


def test_periodicity_of_a_found_coordinate() -> None:
    phase = np.linspace(0, 4, 240)
    rng = np.random.default_rng(0)
    barcode = persistent_cohomology(closed_curve(phase) + 0.02 * rng.normal(size=(240, 12)))
    found = periodicity(circular_coordinate(barcode, runs=[(0, 240)]).phase, [(0, 240)])
    assert found.is_periodic
    assert abs(found.net) == pytest.approx(4, abs=0.1)
