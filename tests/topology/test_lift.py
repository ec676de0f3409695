from __future__ import annotations

import numpy as np
import pytest

from roundelay.base.errors import LiftError
from roundelay.topology import Barcode, persistent_cohomology
from roundelay.topology.coordinate import circular_coordinate
from roundelay.topology.kernel.reduction import Columns
from roundelay.topology.lift import lift_to_integers


def hard_cloud() -> np.ndarray:
    """35 points whose longest class is half an integral one, at every prime."""
    rng = np.random.default_rng(30244)
    n, _ = int(rng.integers(20, 70)), rng.integers(2, 6)
    t = np.sort(rng.random(n)) * 4 * np.pi
    waves = np.column_stack((np.cos(t), np.sin(t), 0.5 * np.cos(t / 2), 0.5 * np.sin(t / 2)))
    return waves + 0.2 * rng.normal(size=(n, 4))


def integer_defects(barcode: Barcode, values: np.ndarray) -> int:
    """Triangles below the death of class 0 on which integer values do not add up."""
    i, j = barcode.cocycle(0)[0].T
    n = barcode.n_points
    table, joined = np.zeros((n, n), np.int64), np.zeros((n, n), bool)
    table[i, j], table[j, i] = values, -values
    joined[i, j] = joined[j, i] = True
    around = table[:, :, None] + table[None, :, :] - table[:, None, :]
    triangles = joined[:, :, None] & joined[None, :, :] & joined[:, None, :]
    return int((around[triangles] != 0).sum())


@pytest.mark.parametrize("prime", [11, 13, 47, 53, 32749])
def test_a_class_that_lifts_at_no_prime_is_repaired(prime: int) -> None:
    barcode = persistent_cohomology(hard_cloud(), prime=prime)
    values = barcode.cocycle(0)[1]
    centred = np.where(values > prime // 2, values - prime, values)
    assert integer_defects(barcode, centred) > 0
    coordinate = circular_coordinate(barcode)
    assert (coordinate.multiplier, coordinate.divisor) == (2, 1)
    lift = lift_to_integers(
        barcode._on_births(0), prime, barcode._reduction.relations, barcode.deaths[0]
    )
    assert abs(lift.values).max() == 2


def test_the_repair_fails_with_what_was_tried() -> None:
    barcode = persistent_cohomology(hard_cloud(), prime=3)
    with pytest.raises(LiftError, match=r"mod 3 .* against \d+ relations; try a larger prime"):
        circular_coordinate(barcode)


def relation(*coefficients: int) -> Columns:
    count = len(coefficients)
    return Columns(
        np.array([0, count]), np.arange(count, dtype=np.int32), np.array(coefficients),
        np.ones(1, np.float32),
    )  # fmt: skip


def test_values_are_divided_by_what_they_share() -> None:
    """2 x = 3 y mod 47 with y = 1: x = 25, repaired to (3, 2)."""
    lift = lift_to_integers(np.array([25, 1]), 47, relation(2, -3), death=2.0)
    assert lift.values.tolist() in ([3, 2], [-3, -2])
    assert lift_to_integers(np.array([4, 4]), 47, relation(1, -1), 2.0).values.tolist() == [4, 4]


def test_relations_at_the_death_do_not_count() -> None:
    assert lift_to_integers(np.array([25, 1]), 47, relation(2, -3), death=1.0).multiplier == 1
