from __future__ import annotations

import numpy as np
import pytest
import ripser

from clouds import PRIMES, full_matrix, noisy_circle, random_clouds
from roundelay.base.errors import TooLarge, TooShort
from roundelay.topology import Barcode, pairwise_distances, persistent_cohomology


def oracle(points: np.ndarray, prime: int) -> tuple[np.ndarray, np.ndarray]:
    """Degree-0 deaths and degree-1 bars of ripser.py on the same float32 distances.

    It takes no prime beyond 8 bits; these clouds have no torsion, so that one of 47 will do.
    """
    matrix = full_matrix(pairwise_distances(points))
    zero, one = ripser.ripser(matrix, maxdim=1, coeff=min(prime, 47), distance_matrix=True)["dgms"]
    merges = zero[np.isfinite(zero[:, 1]), 1]
    return np.sort(merges[merges > 0]), one


def assert_same_bars(barcode: Barcode, bars: np.ndarray) -> None:
    ours = np.column_stack((barcode.births, barcode.deaths))
    theirs = bars[bars[:, 1] > bars[:, 0]]
    assert ours.shape == theirs.shape
    np.testing.assert_array_equal(ours[np.lexsort(ours.T)], theirs[np.lexsort(theirs.T)])


@pytest.mark.parametrize("prime", PRIMES)
def test_bars_equal_those_of_ripser(prime: int) -> None:
    for points in random_clouds(90):
        components, bars = oracle(points, prime)
        barcode = persistent_cohomology(points, prime=prime)
        assert_same_bars(barcode, bars)
        merges = barcode.components[barcode.components > 0]
        np.testing.assert_array_equal(merges, components.astype(np.float64))


@pytest.mark.parametrize("prime", [2, 3, 47, 32749])
def test_cocycles_satisfy_every_triangle(prime: int) -> None:
    for points in random_clouds(40, largest=30):
        barcode = persistent_cohomology(points, prime=prime)
        for k in range(len(barcode)):
            assert broken_triangles(barcode, k) == 0


def broken_triangles(barcode: Barcode, k: int, scale: float | None = None) -> int:
    edges, values = barcode.cocycle(k, scale=scale)
    n, (i, j) = barcode.n_points, edges.T
    table, joined = np.zeros((n, n), np.int64), np.zeros((n, n), bool)
    table[i, j], table[j, i] = values, -values
    joined[i, j] = joined[j, i] = True
    around = table[:, :, None] + table[None, :, :] - table[:, None, :]
    triangles = joined[:, :, None] & joined[None, :, :] & joined[:, None, :]
    return int((around[triangles] % barcode.prime != 0).sum())


def test_cocycle_is_restricted_to_the_scale() -> None:
    barcode = persistent_cohomology(noisy_circle(60, noise=0.05))
    edges, values = barcode.cocycle(0, scale=1.0)
    whole, all_values = barcode.cocycle(0)
    lengths = np.linalg.norm(np.diff(noisy_circle(60, noise=0.05)[edges], axis=1)[:, 0], axis=1)
    assert edges.dtype == np.int32
    assert lengths.max() <= 1.0 + 1e-6
    np.testing.assert_array_equal(edges, whole[: len(edges)])
    np.testing.assert_array_equal(values, all_values[: len(edges)])
    assert ((values >= 0) & (values < 47)).all()


def test_cocycle_is_not_a_coboundary_while_it_lives() -> None:
    """Around the circle the values add up to a non-zero number of turns."""
    barcode = persistent_cohomology(noisy_circle(40, noise=0.0))
    edges, values = barcode.cocycle(0)
    table = {tuple(edge): value for edge, value in zip(edges.tolist(), values, strict=True)}
    around = sum(table[k, k + 1] for k in range(39)) - table[0, 39]
    assert around % 47 != 0


@pytest.mark.parametrize("wanted", [1, 2, 3])
def test_longest_gives_the_first_of_all_bars(wanted: int) -> None:
    for points in random_clouds(120):
        every = persistent_cohomology(points)
        longest = persistent_cohomology(points, longest=wanted)
        np.testing.assert_array_equal(longest.persistence, every.persistence[:wanted])
        np.testing.assert_array_equal(longest.components, every.components)
        assert not longest.is_complete
        if len(longest):
            assert broken_triangles(longest, 0) == 0


def test_a_class_still_alive_at_an_early_stop_is_no_bar() -> None:
    """A circle and, joined to it by a point, a square that is born late and outlives it."""
    corners = 0.75 * np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]])
    points = np.zeros((45, 5))
    points[:40, :2] = noisy_circle(40, noise=0)
    points[40:44, 2:] = np.column_stack((corners, np.full(4, 1.6)))
    points[44] = (points[0] + points[40]) / 2
    every, longest = persistent_cohomology(points), persistent_cohomology(points, longest=1)
    assert every.deaths[1] > every.deaths[0]
    np.testing.assert_array_equal(longest.deaths, every.deaths[:1])


def test_classes_alive_at_the_largest_scale_do_not_die() -> None:
    barcode = persistent_cohomology(noisy_circle(50, noise=0.0), max_scale=1.0)
    assert barcode.deaths[0] == np.inf
    assert barcode.max_scale == 1.0
    assert broken_triangles(barcode, 0) == 0
    assert len(persistent_cohomology(noisy_circle(50, noise=0.0), max_scale=1.0, longest=1)) == 1


def test_bars_up_to_a_scale_are_those_of_a_filtration_that_ends_there() -> None:
    points = np.concatenate([noisy_circle(60, noise=0.1), 3.0 + 0.5 * noisy_circle(40, noise=0.1)])
    whole = persistent_cohomology(points)
    for scale in (0.3, 0.6, 1.0, 99.0):
        cut, stopped = whole.up_to(scale), persistent_cohomology(points, max_scale=scale)
        assert np.all(np.diff(cut.persistence) <= 0.0)
        np.testing.assert_allclose(np.sort(cut.births), np.sort(stopped.births))
        ends = np.minimum(stopped.deaths, scale)
        np.testing.assert_allclose(np.sort(cut.deaths), np.sort(ends), rtol=1e-6)
        assert all(broken_triangles(cut, k) == 0 for k in range(min(3, len(cut))))
    assert len(whole.up_to(1e-6)) == 0


def test_a_scale_beyond_the_enclosing_radius_changes_nothing() -> None:
    points = noisy_circle(50, noise=0.1)
    far, default = persistent_cohomology(points, max_scale=99), persistent_cohomology(points)
    np.testing.assert_array_equal(far.deaths, default.deaths)


def test_bars_do_not_depend_on_position_order_or_unit() -> None:
    rng = np.random.default_rng(3)
    points = rng.normal(size=(60, 5))
    base = persistent_cohomology(points)
    rotation = np.linalg.qr(rng.normal(size=(5, 5)))[0]
    for moved in (points @ rotation, rng.permutation(points), points + 1e3):
        barcode = persistent_cohomology(moved)
        np.testing.assert_allclose(barcode.births, base.births, rtol=1e-5)
        np.testing.assert_allclose(barcode.deaths, base.deaths, rtol=1e-5)
    for unit in (1e-9, 1e-3, 1e6, 1e18):
        np.testing.assert_allclose(
            persistent_cohomology(points * unit).deaths, base.deaths * unit, rtol=1e-5
        )


def test_points_and_their_distances_give_the_same() -> None:
    points = noisy_circle(70, noise=0.2)
    matrix = full_matrix(pairwise_distances(points))
    from_points = persistent_cohomology(points)
    for given in (matrix, matrix.astype(np.float64), np.asfortranarray(matrix), matrix.tolist()):
        barcode = persistent_cohomology(given, metric="precomputed")
        np.testing.assert_array_equal(barcode.births, from_points.births)
        np.testing.assert_array_equal(barcode.deaths, from_points.deaths)


def test_distances_need_not_be_a_metric() -> None:
    """A bipartite graph: births far outnumber the points, none of the triangles is thin."""
    matrix = np.where(np.add.outer(np.arange(12), np.arange(12)) % 2 == 1, 1.0, 2.0)
    np.fill_diagonal(matrix, 0)
    barcode = persistent_cohomology(matrix, metric="precomputed")
    assert len(barcode) == 25
    assert_same_bars(barcode, ripser.ripser(matrix, distance_matrix=True)["dgms"][1])


SQUARE = np.array([[0, 1, 2, 1], [1, 0, 1, 2], [2, 1, 0, 1], [1, 2, 1, 0]], float)


def test_four_points_make_a_loop() -> None:
    barcode = persistent_cohomology(SQUARE, metric="precomputed", prime=3)
    assert (barcode.births.tolist(), barcode.deaths.tolist()) == ([1.0], [2.0])
    assert barcode.components.tolist() == [1.0, 1.0, 1.0]


@pytest.mark.parametrize("prime", [-3, 0, 1, 4, 9, 46349, 2**31])
def test_moduli_that_are_no_primes_in_range(prime: int) -> None:
    with pytest.raises(ValueError, match="prime"):
        persistent_cohomology(SQUARE, metric="precomputed", prime=prime)


@pytest.mark.parametrize(
    ("entry", "message"),
    [(-1.0, "at least 0"), (np.nan, "NaN"), (np.inf, "symmetric"), (5.0, "symmetric")],
)
def test_bad_distances(entry: float, message: str) -> None:
    matrix = SQUARE.copy()
    matrix[0, 1] = entry
    with pytest.raises(ValueError, match=message):
        persistent_cohomology(matrix, metric="precomputed")


def test_more_bad_input() -> None:
    with pytest.raises(ValueError, match="zero diagonal"):
        persistent_cohomology(SQUARE + np.eye(4), metric="precomputed")
    with pytest.raises(ValueError, match=r"\(n, n\)"):
        persistent_cohomology(SQUARE[:3], metric="precomputed")
    with pytest.raises(ValueError, match=r"\(n, d\)"):
        persistent_cohomology([1.0, 2.0, 3.0, 4.0])
    with pytest.raises(ValueError, match="finite points"):
        persistent_cohomology([[0.0], [1.0], [np.nan], [2.0]])
    with pytest.raises(ValueError, match="expected different points, found 5 equal ones"):
        persistent_cohomology(np.ones((5, 3)))
    with pytest.raises(ValueError, match="metric"):
        persistent_cohomology(SQUARE, metric="cosine")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="longest"):
        persistent_cohomology(SQUARE, longest=0)
    with pytest.raises(ValueError, match="max_scale"):
        persistent_cohomology(SQUARE, max_scale=np.nan)
    with pytest.raises(TooShort, match="at least 4 points, found 3"):
        persistent_cohomology(np.eye(3))


def test_a_problem_that_does_not_fit_is_refused_before_it_starts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("roundelay.base.memory.available_memory", lambda: 1_000_000)
    with pytest.raises(TooLarge, match=r"0\.0 GB are free: use landmarks"):
        persistent_cohomology(np.zeros((20_000, 2)))
    with pytest.raises(TooLarge, match="65535"):
        persistent_cohomology(np.zeros((70_000, 2)))
