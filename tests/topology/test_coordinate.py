from __future__ import annotations

import numpy as np
import pytest

from clouds import closed_curve, torus
from roundelay.topology import persistent_cohomology, turns
from roundelay.topology.coordinate import CircularCoordinate, circular_coordinate
from roundelay.topology.lattice import reduce_lattice
from roundelay.topology.toroidal import combined_coordinates, toroidal_coordinates


def agreement(a: np.ndarray, b: np.ndarray) -> float:
    """1 for phases equal up to a rotation."""
    return float(abs(np.exp(2j * np.pi * (a - b)).mean()))


def error(a: np.ndarray, b: np.ndarray) -> float:
    """Root-mean-square difference up to rotation and reflection, in cycles."""
    best = np.inf
    for sign in (1, -1):
        turned = np.exp(2j * np.pi * (a - sign * b))
        best = min(best, np.sqrt((np.angle(turned / turned.mean()) ** 2).mean()) / (2 * np.pi))
    return float(best)


@pytest.mark.parametrize("winding", [1.0, 2.0, 5.0, -3.0, 2.5])
def test_winding_numbers_of_known_curves(winding: float) -> None:
    phase = np.linspace(0, winding, 241)
    points = closed_curve(phase) + 1e-3 * np.random.default_rng(0).normal(size=(241, 12))
    coordinate = circular_coordinate(persistent_cohomology(points), runs=[(0, 241)])
    net, total = turns(coordinate.phase, [(0, 241)])
    assert abs(net) == pytest.approx(abs(winding), abs=0.03)
    assert total == pytest.approx(abs(net), abs=0.05)
    assert coordinate.largest_step < 0.5
    assert ((coordinate.phase >= 0) & (coordinate.phase < 1)).all()


def uneven(n: int) -> tuple[np.ndarray, np.ndarray]:
    """A circle run through at uneven speed, and its arc length in turns."""
    time = np.linspace(0, 3, n, endpoint=False)
    phase = time + 0.8 * np.sin(2 * np.pi * time) / (2 * np.pi)
    noise = 0.03 * np.random.default_rng(0).normal(size=(n, 2))
    return np.column_stack((np.cos(2 * np.pi * phase), np.sin(2 * np.pi * phase))) + noise, phase


def test_density_weights_follow_arc_length() -> None:
    points, phase = uneven(400)
    barcode = persistent_cohomology(points)
    errors = [
        error(circular_coordinate(barcode, weights=w).phase, phase) for w in ("density", "uniform")
    ]
    assert errors[0] < 0.015
    assert errors[1] > 4 * errors[0]


def test_the_coordinate_minimises_the_norm() -> None:
    """The smoothed cocycle sums to 0 around every vertex, and still to whole turns on loops."""
    points = uneven(80)[0]
    barcode = persistent_cohomology(points)
    coordinate = circular_coordinate(barcode, scale=1.0, weights="uniform")
    edges, _ = barcode.cocycle(0, scale=1.0)
    i, j = edges.T
    steps = coordinate.phase[j] - coordinate.phase[i]
    steps -= np.round(steps)
    around = np.bincount(i, steps, 80) - np.bincount(j, steps, 80)
    assert abs(around).max() < 1e-6
    assert abs(steps).max() == pytest.approx(coordinate.largest_step)


def test_rotation_order_and_unit_do_not_matter() -> None:
    rng = np.random.default_rng(5)
    points = closed_curve(np.linspace(0, 2, 150)) + 0.01 * rng.normal(size=(150, 12))
    base = circular_coordinate(persistent_cohomology(points))
    rotation, order = np.linalg.qr(rng.normal(size=(12, 12)))[0], rng.permutation(150)
    for moved, expected in (
        (points @ rotation, base.phase),
        (points * 250.0, base.phase),
        (points[order], base.phase[order]),
    ):
        assert error(circular_coordinate(persistent_cohomology(moved)).phase, expected) < 1e-3


def test_default_scales() -> None:
    barcode = persistent_cohomology(uneven(120)[0])
    birth, death = barcode.births[0], barcode.deaths[0]
    plain = circular_coordinate(barcode)
    assert plain.scale == pytest.approx(birth + 0.7 * (death - birth))
    assert birth < circular_coordinate(barcode, runs=[(0, 120)]).scale < death
    assert (plain.class_index, plain.combination, plain.multiplier) == (0, ((0, 1),), 1)


def test_no_motion_is_counted_across_a_break() -> None:
    phase = np.concatenate((np.linspace(0, 2, 100), np.linspace(1.5, 3.5, 100)))
    coordinate = circular_coordinate(
        persistent_cohomology(closed_curve(phase)), runs=[(0, 100), (100, 200)]
    )
    assert abs(turns(coordinate.phase, [(0, 100), (100, 200)])[0]) == pytest.approx(4, abs=0.05)


def test_misuse() -> None:
    barcode = persistent_cohomology(uneven(60)[0])
    with pytest.raises(ValueError, match="class from 0"):
        circular_coordinate(barcode, k=len(barcode))
    with pytest.raises(ValueError, match="class from 0"):
        circular_coordinate(barcode, k=-1)
    with pytest.raises(ValueError, match="scale in"):
        circular_coordinate(barcode, scale=99.0)
    with pytest.raises(ValueError, match="weights"):
        circular_coordinate(barcode, weights="mass")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="points"):
        circular_coordinate(barcode).evaluate(np.zeros((3, 5)))


def test_toroidal_coordinates_tell_two_motions_apart() -> None:
    points, (u, v) = torus(500)
    barcode = persistent_cohomology(points)
    found = toroidal_coordinates(barcode)
    best = [max(agreement(c.phase, s * t) for t in (u, v) for s in (1, -1)) for c in found]
    assert min(best) > 0.99
    skew = combined_coordinates(barcode, [[1, 1], [2, 1]])
    assert [c.combination for c in skew] == [((0, 1), (1, 1)), ((0, 2), (1, 1))]
    assert max(agreement(skew[0].phase, a * u + b * v) for a in (1, -1) for b in (1, -1)) > 0.99
    assert all(isinstance(c, CircularCoordinate) for c in skew)


def test_classes_that_never_live_together() -> None:
    barcode = persistent_cohomology(torus(500)[0])
    late = int(np.flatnonzero(barcode.deaths < barcode.births[0])[0])
    with pytest.raises(ValueError, match="alive together"):
        toroidal_coordinates(barcode, classes=(0, late))
    with pytest.raises(ValueError, match="2 coefficients a row"):
        combined_coordinates(barcode, [[1, 2, 3]])


def test_lattice_reduction_finds_the_short_basis() -> None:
    skew = np.array([[1, 0, 0], [7, 1, 0], [-4, 9, 1]])
    gram = skew @ np.diag([1.0, 1.1, 1.2]) @ skew.T
    basis = reduce_lattice(gram)
    assert abs(np.linalg.det(basis)) == pytest.approx(1)
    np.testing.assert_allclose(basis @ gram @ basis.T, np.diag([1.0, 1.1, 1.2]), atol=1e-9)
