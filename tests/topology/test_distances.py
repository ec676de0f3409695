from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from roundelay.topology import pairwise_distances, persistent_cohomology
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


def test_the_sign_of_zero_is_nothing():
    angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    points = np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.concatenate([points, points[:5]])
    signed = np.where(points == 0.0, -0.0, points)
    full = np.linalg.norm(points[:, None] - points, axis=-1)
    negative = np.where(full < 1e-9, -0.0, full)
    condensed = negative[np.triu_indices(len(full), 1)]
    barcodes = [
        persistent_cohomology(points),
        persistent_cohomology(signed),
        persistent_cohomology(negative, metric="precomputed"),
        persistent_cohomology(condensed, metric="precomputed"),
        persistent_cohomology(np.where(full < 1e-9, 0.0, full), metric="precomputed"),
    ]
    assert [len(barcode) for barcode in barcodes] == [1] * 5
    assert len(barcodes[2].up_to(-0.0)) == 0
    assert len(barcodes[2].cocycle(scale=-0.0)[0]) == len(barcodes[2].cocycle(scale=0.0)[0])


CLOUD = np.random.default_rng(0).normal(size=(12, 2))


@pytest.mark.parametrize("unit", [2.0**-120, 2.0**-60, 2.0**60, 2.0**123])
def test_a_unit_near_the_ends_of_single_precision_changes_nothing(unit):
    expected = persistent_cohomology(CLOUD)
    found = persistent_cohomology(CLOUD * unit)
    np.testing.assert_array_equal(found.components, expected.components * unit)


@pytest.mark.parametrize("unit", [1e-310, 1e-60, 1e60, 1e307])
def test_a_unit_beyond_single_precision_is_named(unit):
    with pytest.raises(ValueError, match=r"^expected points in a unit .* found one of "):
        persistent_cohomology(CLOUD * unit)
    with pytest.raises(ValueError, match=r"^expected distances .* found (larger|smaller) ones"):
        persistent_cohomology(cdist(CLOUD, CLOUD) * unit, metric="precomputed")


def test_what_only_its_distances_leave_single_precision():
    with pytest.raises(ValueError, match=r"^expected distances up to 3.4e\+38, found larger ones"):
        pairwise_distances(3e38 * np.array([[-1, -1], [1, 1], [1, -1], [-1, 1]]))
