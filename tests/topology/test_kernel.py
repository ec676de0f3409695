"""The compiled kernel against its NumPy twin."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import NoReturn

import numpy as np
import pytest

from clouds import PRIMES, noisy_circle, random_clouds
from roundelay.topology import kernel, persistent_cohomology
from roundelay.topology.coordinate import circular_coordinate
from roundelay.topology.kernel.compiled import Compiled, _interface
from roundelay.topology.kernel.reduction import Reduction, count_up_to, ends
from roundelay.topology.kernel.twin import Twin
from roundelay.topology.rips import enclosing_radius


@pytest.fixture(scope="module")
def compiled() -> Compiled:
    return Compiled()


def runs(
    compiled: Compiled, prime: int, count: int, longest: int = 0
) -> Iterator[tuple[Reduction, Reduction]]:
    for points in random_clouds(count, largest=32):
        lengths = compiled.distances((points - points.mean(axis=0)).astype(np.float32))
        options = {"limit": enclosing_radius(lengths), "prime": prime, "longest": longest}
        yield compiled.reduce(lengths, **options), Twin().reduce(lengths, **options)


def assert_same(ours: Reduction, twin: Reduction) -> None:
    for name in ("keys", "merges", "births", "deaths", "killer"):
        np.testing.assert_array_equal(getattr(ours, name), getattr(twin, name))
    i, j = ends(ours.keys)
    np.testing.assert_array_equal(ours.fill[i, j], twin.fill[i, j])
    for name in ("start", "index", "value", "time"):
        for one, other in ((ours.relations, twin.relations), (ours.reduced, twin.reduced)):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_distances_agree_to_the_bit(compiled: Compiled) -> None:
    rng = np.random.default_rng(0)
    for d in (0, 1, 15, 16, 17, 70):
        x, y = rng.normal(size=(9, d)).astype("f4"), rng.normal(size=(23, d)).astype("f4")
        np.testing.assert_array_equal(compiled.distances(x), Twin().distances(x))
        np.testing.assert_array_equal(compiled.distances(x, y), Twin().distances(x, y))


@pytest.mark.parametrize("prime", PRIMES)
def test_runs_agree_to_the_bit(compiled: Compiled, prime: int) -> None:
    for ours, twin in runs(compiled, prime, 60):
        assert_same(ours, twin)


@pytest.mark.parametrize("longest", [0, 1, 2])
def test_births_after_a_rest_are_found(compiled: Compiled, longest: int) -> None:
    """A circle dies, a point far from it joins, and a square is born: several buckets of edges."""
    points = np.zeros((200, 5), np.float32)
    points[:190, :2] = noisy_circle(190, noise=0.02)
    points[190] = (0, 0, 2.5, 0, 0)
    points[191] = (4, 0, 0, 0, 0)
    points[192:, 2:4] = 3.5 + np.repeat(((2, 2), (2, -2), (-2, -2), (-2, 2)), 2, axis=0)
    lengths = compiled.distances(points)
    options = {"limit": enclosing_radius(lengths), "prime": 47, "longest": longest}
    ours, twin = compiled.reduce(lengths, **options), Twin().reduce(lengths, **options)
    assert_same(ours, twin)


@pytest.mark.parametrize("longest", [1, 2])
def test_both_stop_at_the_same_edge(compiled: Compiled, longest: int) -> None:
    for ours, twin in runs(compiled, 47, 60, longest):
        np.testing.assert_array_equal(ours.keys, twin.keys)
        np.testing.assert_array_equal(ours.deaths, twin.deaths)


@pytest.mark.parametrize("modulus", [0, 2, 47, 32749])
def test_cocycles_agree(compiled: Compiled, modulus: int) -> None:
    rng = np.random.default_rng(modulus)
    for ours, twin in runs(compiled, modulus or 47, 40):
        given = rng.integers(0, modulus or 3, len(ours.births))
        count = int(rng.integers(len(ours.keys) + 1))
        np.testing.assert_array_equal(
            compiled.propagate(ours, count, given, modulus),
            Twin().propagate(twin, count, given, modulus),
        )


def test_integers_beyond_15_bits_are_refused(compiled: Compiled) -> None:
    lengths = compiled.distances(noisy_circle(30, noise=0).astype("f4"))
    run = compiled.reduce(lengths, limit=2.0, prime=47, longest=0)
    huge = np.full(len(run.births), 40_000)
    for which in (compiled, Twin()):
        with pytest.raises(OverflowError, match="15 bits"):
            which.propagate(run, len(run.keys), huge, 0)


def test_smoothing_agrees(compiled: Compiled) -> None:
    rng = np.random.default_rng(1)
    for ours, twin in runs(compiled, 47, 40):
        count = len(ours.keys) // 2
        keys = ours.keys[:count]
        values = compiled.propagate(ours, count, rng.integers(0, 2, len(ours.births)), 0)
        start = np.zeros(len(ours.fill))
        for close in (0, count // 2):
            w, largest = compiled.harmonic(keys, values, start, close=close, tolerance=1e-11)
            v, other = Twin().harmonic(
                twin.keys[:count], values, start, close=close, tolerance=1e-11
            )
            np.testing.assert_allclose(w, v, atol=1e-7)
            assert largest == pytest.approx(other, abs=1e-7)


@pytest.fixture
def no_binary(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    def refuse() -> NoReturn:
        raise OSError("no binary")

    monkeypatch.setattr(kernel, "Compiled", refuse)
    kernel.engine.cache_clear()
    yield
    kernel.engine.cache_clear()


def test_without_the_binary_one_warning_and_the_same_results(
    no_binary: None, compiled: Compiled, monkeypatch: pytest.MonkeyPatch
) -> None:
    points = noisy_circle(80, noise=0.1, turns=2)
    with pytest.warns(RuntimeWarning, match="NumPy version gives the same results"):
        slow = persistent_cohomology(points)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        slow_coordinate = circular_coordinate(slow, runs=[(0, 80)])
    kernel.engine.cache_clear()
    monkeypatch.undo()
    fast = persistent_cohomology(points)
    np.testing.assert_array_equal(slow.births, fast.births)
    np.testing.assert_array_equal(slow.deaths, fast.deaths)
    fast_coordinate = circular_coordinate(fast, runs=[(0, 80)])
    assert slow_coordinate.scale == fast_coordinate.scale
    np.testing.assert_allclose(slow_coordinate.phase, fast_coordinate.phase, atol=1e-7)


def test_count_up_to_includes_ties() -> None:
    bits = np.ones(10, np.float32).view(np.uint32).astype(np.uint64)
    keys = bits << np.uint64(32) | np.arange(10, dtype=np.uint64)
    assert (count_up_to(keys, 1.0), count_up_to(keys, 0.999)) == (10, 0)


def test_a_binary_of_another_version_is_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("roundelay.topology.kernel.compiled._INTERFACE", 9)
    with pytest.raises(OSError, match=r"a kernel with interface 9, found 2 in .*again"):
        Compiled()
    kernel.engine.cache_clear()
    try:
        with pytest.warns(RuntimeWarning, match="interface 9, found 2"):
            assert isinstance(kernel.engine(), Twin)
    finally:
        kernel.engine.cache_clear()


def test_a_binary_from_before_it_told_its_version_is_not_used() -> None:
    class Old:
        def __getattr__(self, name: str) -> NoReturn:
            raise AttributeError(name)

    assert _interface(Old()) == 1  # type: ignore[arg-type]


@pytest.mark.parametrize("value", [32768, -32768, 2**31 + 5])
def test_integers_out_of_range_are_refused(compiled: Compiled, value: int) -> None:
    lengths = compiled.distances(noisy_circle(30, noise=0.02).astype(np.float32))
    run = compiled.reduce(lengths, limit=enclosing_radius(lengths), prime=47, longest=0)
    on_births = np.full(len(run.births), value)
    for one in (compiled, Twin()):
        with pytest.raises(OverflowError, match="the range of 15 bits"):
            one.propagate(run, len(run.keys), on_births, 0)
        largest = on_births % 46337
        assert one.propagate(run, len(run.keys), largest, 46337).max() <= 46336
