from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from roundelay.topology import pairwise_distances
from roundelay.topology.distances import cross_distances


@pytest.mark.parametrize("unit", [1e-20, 1e-6, 1.0, 1e8, 1e15])
@pytest.mark.parametrize("d", [1, 3, 16, 62])
def test_distances_are_those_of_scipy(unit: float, d: int) -> None:
    points = np.random.default_rng(d).normal(size=(40, d)) * unit
    np.testing.assert_allclose(
        pairwise_distances(points), np.triu(cdist(points, points)), rtol=2e-6, atol=3e-7 * unit
    )
    np.testing.assert_allclose(
        cross_distances(points[:7], points[5:]), cdist(points[:7], points[5:]), rtol=2e-6,
        atol=3e-7 * unit,
    )  # fmt: skip


def test_near_points_far_away_lose_no_digits() -> None:
    points = 1e4 + np.array([[0.0, 0.0], [1e-2, 0.0], [1e-2, 1e-2], [1.0, 0.0]])
    assert pairwise_distances(points)[0, 1] == pytest.approx(1e-2, rel=1e-5)


def test_duplicates_are_at_distance_0() -> None:
    points = np.repeat(np.random.default_rng(0).normal(size=(5, 30)), 3, axis=0)
    lengths = pairwise_distances(points)
    assert (lengths[::3, :][np.arange(5), np.arange(5) * 3 + 1] == 0).all()


def test_cross_distances_need_the_same_dimension() -> None:
    with pytest.raises(ValueError, match=r"\(m, 3\)"):
        cross_distances(np.zeros((4, 2)), np.zeros((4, 3)))
