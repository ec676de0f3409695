from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from roundelay.errors import TooShort
from roundelay.topology import delay_distances, pairwise_distances
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


def test_delays_equal_the_built_embedding() -> None:
    rng = np.random.default_rng(1)
    frames, runs, delays = rng.normal(size=(60, 4)), [(0, 25), (25, 32), (40, 60)], [0, 3, 8]
    distances, kept, after = delay_distances(cdist(frames, frames) ** 2, delays, runs)
    starts = [t for start, stop in runs for t in range(start, stop - 8)]
    built = np.array([np.concatenate([frames[t + delay] for delay in delays]) for t in starts])
    assert kept.tolist() == starts
    assert after == [(0, 17), (17, 29)]
    assert distances.dtype == np.float32
    np.testing.assert_allclose(distances, cdist(built, built) / np.sqrt(3), rtol=1e-4, atol=1e-6)


def test_no_delay_changes_nothing() -> None:
    frames = np.random.default_rng(2).normal(size=(10, 3))
    distances, _, _ = delay_distances(cdist(frames, frames) ** 2, [0], [(0, 10)])
    np.testing.assert_allclose(distances, cdist(frames, frames), rtol=1e-5)


@pytest.mark.parametrize("delays", [[], [1, 2], [0, 3, 3], [0, 5, 2]])
def test_delays_ascend_from_zero(delays: list[int]) -> None:
    with pytest.raises(ValueError, match="ascend from 0"):
        delay_distances(np.zeros((9, 9)), delays, [(0, 9)])


def test_runs_too_short_for_the_delays() -> None:
    with pytest.raises(TooShort):
        delay_distances(np.zeros((9, 9)), [0, 6], [(0, 9)])
