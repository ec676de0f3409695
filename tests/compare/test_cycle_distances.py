"""Distances of barcodes and cycles, and clusters."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

import roundelay as rl
from clouds import noisy_circle, random_clouds
from roundelay import synth
from roundelay.compare.distances import (
    bottleneck_distance,
    cluster,
    cycle_distance,
    distance_matrix,
    wasserstein_distance,
)
from roundelay.cycles.edit.align import mirrored, shifted
from roundelay.topology import Barcode, persistent_cohomology


@pytest.fixture(scope="module")
def barcodes() -> list[Barcode]:
    found = [persistent_cohomology(points) for points in random_clouds(40, largest=16)]
    return [barcode for barcode in found if len(barcode) <= 3][:12]


def by_hand(first: Barcode, second: Barcode, order: float) -> float:
    """The least cost over all matchings of bars and of the places where they vanish."""
    a, b = (np.column_stack([x.births, x.deaths]) for x in (first, second))
    best = np.inf
    for places in permutations(range(len(a) + len(b)), len(a)):
        costs = [
            np.abs(bar - b[p]).max() if p < len(b) else (bar[1] - bar[0]) / 2
            for bar, p in zip(a, places, strict=True)
        ]
        costs += [(bar[1] - bar[0]) / 2 for p, bar in enumerate(b) if p not in places]
        best = min(best, np.linalg.norm(costs, order) if costs else 0.0)
    return best


def test_distances_of_barcodes_are_the_least_over_all_matchings(barcodes):
    for first in barcodes:
        for second in barcodes:
            assert bottleneck_distance(first, second) == pytest.approx(
                by_hand(first, second, np.inf)
            )
            for order in (1.0, 2.0):
                assert wasserstein_distance(first, second, order=order) == pytest.approx(
                    by_hand(first, second, order)
                )


def test_small_changes_of_points_change_barcodes_little():
    points = noisy_circle(60, noise=0.05)
    moved = points + 0.01 * np.random.default_rng(1).uniform(-1, 1, points.shape)
    most = 2 * np.linalg.norm(moved - points, axis=1).max()
    clouds = persistent_cohomology(points), persistent_cohomology(moved)
    assert 0.0 < bottleneck_distance(*clouds) <= most


def test_endless_bars_and_orders_below_one_are_refused():
    points = noisy_circle(30, noise=0.0)
    endless, whole = persistent_cohomology(points, max_scale=0.5), persistent_cohomology(points)
    with pytest.raises(ValueError, match="alive at the largest scale"):
        bottleneck_distance(endless, whole)
    with pytest.raises(ValueError, match="order of at least 1"):
        wasserstein_distance(whole, whole, order=0.5)


@pytest.fixture(scope="module")
def cycles() -> list[rl.Cycle]:
    kinds = ["walk", "run", "jacks", "walk", "run", "jacks"]
    return [
        rl.find_cycles(synth.gait(kind, repetitions=2.6, seed=seed, start=0.1 * seed).motion)[0]
        for seed, kind in enumerate(kinds)
    ]


def test_cycles_are_near_their_own_kind(cycles):
    apart = distance_matrix(cycles, cycle_distance)
    assert cluster(apart, 3).tolist() == [0, 1, 2, 0, 1, 2]
    # Walks and runs are nearer to each other than to jumping jacks.
    assert cluster(apart).tolist() == [0, 0, 1, 0, 0, 1]
    assert cluster(apart, 1).tolist() == [0] * 6
    assert cluster(apart, 6).tolist() == list(range(6))
    assert np.argsort(apart[1])[:2].tolist() == [1, 4]


def test_phase_and_side_do_not_count(cycles):
    other = shifted(mirrored(cycles[2]), 0.3)
    assert cycle_distance(cycles[2], other) < 2e-3
    assert cycle_distance(cycles[2], other, mirror=False) > 4e-3


def test_bad_distances_and_counts_are_refused():
    with pytest.raises(ValueError, match=r"expected distances \(n, n\)"):
        cluster(np.zeros((2, 3)))
    with pytest.raises(ValueError, match="count from 1 to 3"):
        cluster(np.zeros((3, 3)), 4)


@pytest.mark.parametrize("how", [{"count": 4}, {"within": 0.4}, {}])
def test_groups_do_not_depend_on_the_order(how):
    rng = np.random.default_rng(3)
    places = rng.normal(size=(25, 2))
    distances = np.linalg.norm(places[:, None] - places, axis=2)
    order = rng.permutation(25)
    here, there = cluster(distances, **how), cluster(distances[np.ix_(order, order)], **how)
    assert np.array_equal(here[order][:, None] == here[order], there[:, None] == there)
    assert np.array_equal(
        np.unique(there, return_index=True)[1].argsort(), np.arange(there.max() + 1)
    )
