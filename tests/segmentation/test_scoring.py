"""Scores against hand-made cases and scikit-learn."""

import itertools

import numpy as np
import pytest

from roundelay.segmentation import Truth, pooled, score
from roundelay.segmentation.partitions import (
    adjusted_rand,
    best_assignment,
    contingency,
    mutual_information,
)

TRUTH = Truth(
    ((0, 100, "walk"), (100, 200, "jump"), (200, 300, "walk")), ((90, 110), (195, 205)), 1 / 100
)


def test_perfect():
    result = score([100, 200], TRUTH, labels=[4, 7, 4])
    assert [a.f for a in result.cuts] == [1.0] * 4
    assert (result.covering, result.label_accuracy) == (1.0, 1.0)
    assert result.nmi == pytest.approx(1.0)
    assert result.ari == pytest.approx(1.0)


def test_second_cut_in_a_window_is_false():
    result = score([95, 105], TRUTH).strict
    assert (result.hits, result.found, result.true) == (1, 2, 2)
    assert (result.precision, result.recall, result.f) == (0.5, 0.5, 0.5)


def test_tolerance_widens_windows():
    result = score([60, 220], TRUTH)
    assert [a.hits for a in result.cuts] == [0, 1, 2, 2]
    with pytest.raises(ValueError, match=r"0\.1 s"):
        result.at(0.1)


def test_one_cut_serves_one_window():
    close = Truth(((0, 50, "a"), (50, 60, "b"), (60, 99, "c")), ((40, 60), (50, 70)), 0.01)
    assert score([55], close).strict.hits == 1
    assert score([45, 55], close).strict.hits == 2
    assert score([52, 65], close).strict.hits == 2


def test_windows_in_either_order():
    swapped = Truth(((0, 100, "a"), (100, 200, "b")), ((130, 90),), 0.01)
    assert score([95], swapped).strict.f == 1.0


def test_nothing_to_find():
    alone = Truth.around([(0, 500, "walk")], frame_time=0.01)
    assert score([], alone).strict.f == 1.0
    assert score([100], alone).strict.precision == 0.0
    assert score([], TRUTH).strict.precision == 1.0
    assert score([], TRUTH).strict.recall == 0.0


def test_usual_windows():
    truth = Truth.around([(0, 300, "a"), (300, 600, "b")], frame_time=1 / 120)
    assert truth.windows == ((250, 350),)


def test_covering_by_hand():
    # Best overlaps: 100/150, 100/150 (first found), 100/150.
    truth = Truth.around([(0, 100, "a"), (100, 200, "b"), (200, 300, "c")], frame_time=1.0)
    assert score([150], truth).covering == pytest.approx((100 / 150 + 50 / 200 + 100 / 150) / 3)


def test_pooled_adds_counts():
    parts = [score([100, 200], TRUTH).strict, score([20], TRUTH).strict]
    total = pooled(parts)
    assert (total.hits, total.found, total.true) == (2, 3, 4)
    with pytest.raises(ValueError, match="one tolerance"):
        pooled([])


@pytest.mark.parametrize("seed", range(20))
def test_labels_agree_with_scikit_learn(seed):
    metrics = pytest.importorskip("sklearn.metrics")
    rng = np.random.default_rng(seed)
    one, other = rng.integers(0, 4, 60), rng.integers(0, 5, 60)
    counts = contingency(one, other)
    assert adjusted_rand(counts) == pytest.approx(metrics.adjusted_rand_score(one, other))
    assert mutual_information(counts) == pytest.approx(
        metrics.normalized_mutual_info_score(one, other)
    )


@pytest.mark.parametrize("shape", [(1, 1), (3, 3), (2, 5), (5, 2), (4, 6)])
def test_best_assignment_against_all(shape):
    for seed in range(20):
        counts = np.random.default_rng(seed).integers(0, 30, shape)
        wide = counts if shape[0] <= shape[1] else counts.T
        best = max(
            sum(wide[i, j] for i, j in enumerate(columns))
            for columns in itertools.permutations(range(wide.shape[1]), wide.shape[0])
        )
        assert best_assignment(counts) == best


@pytest.mark.parametrize("cuts", [[0], [300], [5, 5], [9, 5], [-1]])
def test_impossible_cuts(cuts):
    with pytest.raises(ValueError, match="rising cuts"):
        score(cuts, TRUTH)


def test_labels_must_fit():
    with pytest.raises(ValueError, match="3 labels"):
        score([100, 200], TRUTH, labels=[0, 1])


@pytest.mark.parametrize(
    ("segments", "windows"),
    [
        ((), ()),
        (((5, 10, "a"),), ()),
        (((0, 10, "a"), (11, 20, "b")), ((9, 12),)),
        (((0, 10, "a"), (10, 20, "b")), ()),
    ],
)
def test_impossible_truth(segments, windows):
    with pytest.raises(ValueError, match="expected"):
        Truth(segments, windows, 0.01)
