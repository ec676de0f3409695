"""Packing, unpacked again as the page does."""

from __future__ import annotations

import numpy as np
import pytest

from roundelay.output.page.packing import Packer

from .unpack import unpacked, values


@pytest.mark.parametrize("common", [False, True])
def test_arrays_come_back(common):
    rng = np.random.default_rng(0)
    first = np.cumsum(rng.normal(size=(50, 4)), axis=0) * [1.0, 10.0, 0.0, 1e-3]
    second = np.array([3.0, -1.0, 3.0, 1e6])
    packer = Packer()
    document = {"a": packer.add(first, common_step=common), "b": packer.add(second)}
    found, data = unpacked(packer.text(document))
    width = np.ptp(first, axis=0).max() if common else np.ptp(first, axis=0)
    assert np.all(abs(values(found["a"], data) - first) <= 0.51 * width / 65535 + 1e-7)
    assert np.allclose(values(found["b"], data)[:, 0], second, atol=10.0)


def test_what_does_not_change_costs_nothing():
    packer = Packer()
    reference = packer.add(np.full((1000, 30), 2.5))
    assert len(packer.text({"x": reference})) < 1500


def test_numbers_must_be_finite():
    with pytest.raises(ValueError):
        Packer().text({"x": float("nan")})


def test_decimals_come_back_exactly():
    rng = np.random.default_rng(1)
    numbers = np.round(np.cumsum(rng.normal(size=(80, 3)), axis=0) * [1.0, 30.0, 700.0], 3)
    packer = Packer()
    found, data = unpacked(packer.text({"a": packer.add_decimals(numbers, 3)}))
    assert np.array_equal(np.round(values(found["a"], data), 3), numbers)


@pytest.mark.parametrize("size", [1e-9, 1e-3, 5e4, 1e12])
def test_wide_columns_have_fewer_decimals(size):
    numbers = np.array([[0.0, -size, 0.5], [180.0, size, 0.125]])
    for decimals in (3, 11):
        packer = Packer()
        found, data = unpacked(packer.text({"a": packer.add_decimals(numbers, decimals)}))
        apart = abs(values(found["a"], data) - numbers)
        assert np.all(apart <= np.maximum(10.0**-decimals, 1e-6 * abs(numbers).max(axis=0)))
