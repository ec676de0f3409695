"""Distances in every form: condensed, sparse, infinite where there is no edge."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
import ripser
from scipy import sparse
from scipy.spatial.distance import pdist, squareform

from clouds import noisy_circle, random_clouds
from roundelay.base.errors import TooLarge, TooShort
from roundelay.topology import (
    Barcode,
    choose_landmarks,
    circular_coordinate,
    p_values,
    persistent_cohomology,
    two_bar_ratio,
)
from roundelay.topology import rips as rips_module
from roundelay.topology.distances import check_distances
from roundelay.topology.kernel.reduction import count_shorter, count_up_to
from roundelay.topology.kernel.twin import Twin

CIRCLE = noisy_circle(60, noise=0.05)


def bars_of(distances: object, **options: object) -> Barcode:
    return persistent_cohomology(distances, metric="precomputed", **options)  # type: ignore[arg-type]


def graphs() -> Iterator[tuple[np.ndarray, sparse.csr_matrix]]:
    """Distances with the long ones left out, as infinity and as a sparse matrix."""
    for number, points in enumerate(random_clouds(60)):
        full = squareform(pdist(points)).astype(np.float32)
        joined = full <= np.quantile(full, 0.25 + 0.1 * (number % 6))
        np.fill_diagonal(joined, False)
        i, j = np.nonzero(joined)
        yield (
            np.where(joined | np.eye(len(full), dtype=bool), full, np.inf),
            sparse.csr_matrix((full[i, j], (i, j)), full.shape),
        )


def assert_same(first: Barcode, second: Barcode) -> None:
    np.testing.assert_array_equal(first.births, second.births)
    np.testing.assert_array_equal(first.deaths, second.deaths)
    np.testing.assert_array_equal(first.components, second.components)
    assert first.max_scale == second.max_scale


@pytest.mark.parametrize("form", ["condensed", "csr", "coo", "upper", "lower", "list"])
def test_every_form_gives_the_same(form: str) -> None:
    full = squareform(pdist(CIRCLE))
    given = {
        "condensed": pdist(CIRCLE),
        "csr": sparse.csr_array(full),
        "coo": sparse.coo_matrix(full),
        "upper": sparse.csc_matrix(np.triu(full)),
        "lower": sparse.csr_matrix(np.tril(full)),
        "list": pdist(CIRCLE).tolist(),
    }[form]
    assert_same(bars_of(given), bars_of(full))


def test_what_is_not_stored_is_infinite() -> None:
    for full, stored in graphs():
        assert_same(bars_of(full), bars_of(stored))


def test_bars_of_graphs_equal_those_of_ripser() -> None:
    """Also those that never die, of which there are as many as the graph has open cycles."""
    endless = 0
    for full, stored in graphs():
        upper = sparse.coo_matrix(sparse.triu(stored))
        theirs = ripser.ripser(upper, distance_matrix=True, coeff=47)["dgms"][1]
        theirs = theirs[theirs[:, 1] > theirs[:, 0]]
        barcode = bars_of(full)
        ours = np.column_stack((barcode.births, barcode.deaths))
        np.testing.assert_allclose(ours[np.lexsort(ours.T)], theirs[np.lexsort(theirs.T)])
        endless += int(np.isinf(barcode.deaths).sum())
    assert endless > 5


def test_the_twin_does_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = [bars_of(full) for full, _ in graphs()]
    monkeypatch.setattr(rips_module, "engine", Twin)
    for (full, _), ours in zip(graphs(), compiled, strict=True):
        assert_same(bars_of(full), ours)


@pytest.mark.parametrize("scale", [1e6, np.inf])
def test_no_scale_is_too_large_for_what_never_dies(scale: float) -> None:
    ring = np.full((8, 8), np.inf)
    np.fill_diagonal(ring, 0)
    for k in range(8):
        ring[k, k - 1] = ring[k - 1, k] = 1.0
    for barcode in (bars_of(ring), bars_of(ring, max_scale=scale), bars_of(ring, longest=1)):
        assert (barcode.births.tolist(), barcode.deaths.tolist()) == ([1.0], [np.inf])
        assert barcode.max_scale == 1.0
    barcode = bars_of(ring)
    assert (p_values(barcode).tolist(), two_bar_ratio(barcode)) == ([0.0], np.inf)
    phase = circular_coordinate(barcode, weights="uniform").phase
    steps = np.diff(phase, append=phase[0])
    np.testing.assert_allclose(abs((steps + 0.5) % 1.0 - 0.5), 0.125, atol=1e-6)


def test_parts_that_nothing_joins_have_their_own_loops() -> None:
    full = np.full((120, 120), np.inf)
    full[:60, :60] = full[60:, 60:] = squareform(pdist(CIRCLE))
    one, two = bars_of(full[:60, :60]), bars_of(full)
    np.testing.assert_array_equal(two.births[:2], one.births[[0, 0]])
    np.testing.assert_array_equal(two.deaths[:2], one.deaths[[0, 0]])
    assert len(two.components) == 118


def test_no_edge_at_all_is_no_bar() -> None:
    full = np.where(np.eye(5) > 0, 0.0, np.inf)
    barcode = bars_of(full)
    assert (len(barcode), len(barcode.components), barcode.max_scale) == (0, 0, 0.0)


def test_landmarks_take_every_form() -> None:
    full = squareform(pdist(CIRCLE))
    expected = choose_landmarks(full, count=20, method="greedy", metric="precomputed")
    for given in (pdist(CIRCLE), sparse.csr_matrix(full)):
        found = choose_landmarks(given, count=20, method="greedy", metric="precomputed")
        np.testing.assert_array_equal(found.indices, expected.indices)


@pytest.mark.parametrize("form", [np.asarray, squareform, sparse.csr_matrix])
def test_minus_nought_is_nought(form: object) -> None:
    """Its bits are those of a large number."""
    full = squareform(pdist(np.concatenate([CIRCLE, CIRCLE[:5]])))
    signed = np.where(full < 1e-9, -0.0, full)
    assert np.signbit(signed).any()
    assert_same(bars_of(form(signed)), bars_of(form(full)))  # type: ignore[operator]
    assert not np.signbit(check_distances(signed)).any()


@pytest.mark.parametrize("length", [-1.0, -0.0, np.nan])
def test_no_edge_is_shorter_than_nought(length: float) -> None:
    keys = np.arange(3, dtype=np.uint64)
    assert count_shorter(keys, length) == 0
    assert count_up_to(keys, 0.0) == 3
    assert count_up_to(keys, -1.0) == 0


def test_a_cocycle_below_every_edge_is_empty() -> None:
    edges, values = persistent_cohomology(CIRCLE).cocycle(scale=-1.0)
    assert (edges.shape, values.shape) == ((0, 2), (0,))


BAD = {
    "seven condensed": (np.ones(7), r"n \(n - 1\) / 2 condensed distances, found 7"),
    "wide": (sparse.csr_matrix(np.ones((4, 5))), r"\(n, n\), found a sparse matrix"),
    "NaN": (np.r_[np.nan, np.ones(9)], "found NaN"),
    "negative": (np.r_[-1.0, np.ones(9)], "at least 0, found -1"),
    "minus infinity": (np.r_[-np.inf, np.ones(9)], "at least 0, found -inf"),
    "too large": (np.full(10, 1e39), "found larger ones"),
    "asymmetric": (sparse.csr_matrix(np.ones((5, 5)) - np.eye(5) + np.eye(5, k=1)), "symmetric"),
    "one way": (np.where(np.tri(5, k=-1) > 0, np.inf, 1.0) * (1 - np.eye(5) > 0), "NaN|symmetric"),
    "diagonal": (sparse.csr_matrix(np.ones((5, 5))), "zero diagonal"),
    "text": ([["a", "b"]] * 5, "distances as numbers, found list"),
    "ragged": ([[0.0, 1.0], [1.0]], "distances as numbers, found list"),
    "complex": (np.ones((5, 5)) * 1j, "distances as numbers, found ndarray of complex128"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_is_wrong_is_told(case: str) -> None:
    given, message = BAD[case]
    with np.errstate(invalid="ignore"), pytest.raises(ValueError, match=message):
        bars_of(given)


def test_points_are_not_sparse() -> None:
    with pytest.raises(ValueError, match=r"points \(n, d\), found a sparse matrix"):
        persistent_cohomology(sparse.csr_matrix(CIRCLE))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="as numbers"):
        persistent_cohomology([["x", "y"]] * 5)  # type: ignore[arg-type]


def test_few_points_are_told_in_every_form() -> None:
    for given in (np.ones(3), sparse.csr_matrix((3, 3)), np.zeros((3, 3))):
        with pytest.raises(TooShort, match="found 3"):
            bars_of(given)


def test_memory_is_checked_before_a_form_is_unfolded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("roundelay.base.memory.available_memory", lambda: 1_000_000)
    for given in (sparse.csr_matrix((20_000, 20_000)), np.ones(2_000 * 1_999 // 2)):
        with pytest.raises(TooLarge, match="are free"):
            bars_of(given)


@pytest.mark.parametrize("number", [47.0, "47", True, None])
def test_a_prime_is_a_whole_number(number: object) -> None:
    with pytest.raises(ValueError, match="expected a prime from 2 to 46337"):
        persistent_cohomology(CIRCLE, prime=number)  # type: ignore[arg-type]


def test_whole_numbers_of_numpy_are_taken() -> None:
    barcode = persistent_cohomology(CIRCLE, prime=np.int64(47), longest=np.int32(1))
    assert type(barcode.prime) is int
    assert circular_coordinate(barcode, k=np.int64(0)).phase.shape == (60,)


@pytest.mark.parametrize(
    ("options", "message"),
    [({"longest": 1.5}, "longest"), ({"max_scale": "far"}, "max_scale"), ({"prime": 4}, "prime")],
)
def test_options_are_checked(options: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        persistent_cohomology(CIRCLE, **options)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="a class from 0"):
        circular_coordinate(persistent_cohomology(CIRCLE), k=0.5)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="a count of at least 4"):
        choose_landmarks(CIRCLE, count=10.0)  # type: ignore[arg-type]


def test_results_are_shown_in_a_line() -> None:
    landmarks = choose_landmarks(CIRCLE, count=30)
    barcode = persistent_cohomology(CIRCLE[landmarks.indices])
    coordinate = circular_coordinate(barcode, landmarks=landmarks)
    assert repr(landmarks).startswith("Landmarks(30 of 60 points, cover radius 0.")
    assert repr(barcode) == "Barcode(1 bar of 30 points, mod 47)"
    assert repr(coordinate).startswith("CircularCoordinate(60 points, class 0, scale ")
    longest = persistent_cohomology(CIRCLE, longest=1)
    assert repr(longest) == "Barcode(1 longest bar of 60 points, mod 47)"
