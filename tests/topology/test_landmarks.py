from __future__ import annotations

import numpy as np
import pytest

from clouds import closed_curve, full_matrix
from roundelay.base.errors import TooShort
from roundelay.topology import (
    Landmarks,
    choose_landmarks,
    pairwise_distances,
    persistent_cohomology,
)
from roundelay.topology.coordinate import circular_coordinate
from roundelay.topology.landmarks import Method

PHASE = np.linspace(0, 3, 1500) % 1.0
POINTS = closed_curve(PHASE)


def circular_error(a: np.ndarray, b: np.ndarray) -> float:
    """Largest difference of phases up to rotation and reflection."""
    errors = []
    for sign in (1, -1):
        turned = np.exp(2j * np.pi * (a - sign * b))
        errors.append(abs(np.angle(turned / turned.mean())).max() / (2 * np.pi))
    return float(min(errors))


@pytest.mark.parametrize("method", ["stride", "greedy"])
def test_landmarks_cover_the_points(method: Method) -> None:
    landmarks = choose_landmarks(POINTS, count=60, method=method)
    assert len(landmarks.indices) == 60
    assert (np.diff(landmarks.indices) > 0).all()
    to_nearest = np.linalg.norm(POINTS[:, None] - POINTS[landmarks.indices], axis=2).min(axis=1)
    assert landmarks.cover_radius == pytest.approx(to_nearest.max(), rel=1e-5)
    assert landmarks.error_bound == 2 * landmarks.cover_radius


def test_greedy_covers_better_where_frames_crowd() -> None:
    crowded = closed_curve(np.concatenate((np.full(900, 0.2), np.linspace(0, 1, 100))))
    radii = [
        choose_landmarks(crowded, count=40, method=m).cover_radius for m in ("greedy", "stride")
    ]
    assert radii[0] < radii[1] / 2


def test_greedy_takes_duplicates_once() -> None:
    points = np.repeat(np.eye(5), 20, axis=0)
    assert len(choose_landmarks(points, count=50, method="greedy").indices) == 5


def test_bars_of_landmarks_are_within_their_bound() -> None:
    landmarks = choose_landmarks(POINTS, count=80)
    few, all_bars = persistent_cohomology(POINTS[landmarks.indices]), persistent_cohomology(POINTS)
    for ours, true in ((few.births, all_bars.births), (few.deaths, all_bars.deaths)):
        assert abs(ours[0] - true[0]) <= landmarks.error_bound
    assert few.births[0] >= all_bars.births[0]


@pytest.mark.parametrize("method", ["stride", "greedy"])
def test_the_coordinate_is_extended_to_all_and_to_new_points(method: Method) -> None:
    landmarks = choose_landmarks(POINTS, count=100, method=method)
    barcode = persistent_cohomology(POINTS[landmarks.indices])
    coordinate = circular_coordinate(barcode, landmarks=landmarks, runs=[(0, len(POINTS))])
    exact = circular_coordinate(persistent_cohomology(POINTS), scale=coordinate.scale)
    assert coordinate.phase.shape == (1500,)
    assert coordinate.is_covered.all()
    assert circular_error(coordinate.phase, exact.phase) < 0.03
    np.testing.assert_allclose(coordinate.evaluate(POINTS), coordinate.phase, atol=1e-6)
    new = np.linspace(0.013, 0.97, 77)
    assert (
        circular_error(coordinate.evaluate(closed_curve(new)), exact.evaluate(closed_curve(new)))
        < 0.03
    )


def test_landmarks_of_distances() -> None:
    matrix = full_matrix(pairwise_distances(POINTS[::3]))
    landmarks = choose_landmarks(matrix, count=100, metric="precomputed")
    chosen = matrix[np.ix_(landmarks.indices, landmarks.indices)]
    barcode = persistent_cohomology(chosen, metric="precomputed")
    coordinate = circular_coordinate(barcode, landmarks=landmarks)
    again = coordinate.evaluate(matrix[:, landmarks.indices])
    np.testing.assert_allclose(again, coordinate.phase, atol=1e-6)
    with pytest.raises(ValueError, match=r"\(m, 100\)"):
        coordinate.evaluate(matrix)


def test_a_point_far_from_all_takes_the_phase_of_the_nearest() -> None:
    coordinate = circular_coordinate(persistent_cohomology(POINTS[::10]))
    far = coordinate.evaluate(POINTS[[40]] * 50)
    assert abs(far[0] - coordinate.phase[4]) < 1e-6


def test_misuse() -> None:
    with pytest.raises(ValueError, match="count of at least 4"):
        choose_landmarks(POINTS, count=2)
    with pytest.raises(ValueError, match="method"):
        choose_landmarks(POINTS, method="random")  # type: ignore[arg-type]
    with pytest.raises(TooShort):
        choose_landmarks(POINTS[:3])
    few: Landmarks = choose_landmarks(POINTS, count=50)
    with pytest.raises(ValueError, match="50 landmarks, found 1500"):
        circular_coordinate(persistent_cohomology(POINTS), landmarks=few)
    assert len(choose_landmarks(POINTS[:20], count=400).indices) == 20
