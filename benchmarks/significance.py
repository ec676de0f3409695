"""False positives on noise and power on noisy closed curves.

    python -m benchmarks.significance [--runs 200] [--frames 300] [--quick] [--json]

Three kinds of noise that hold no period: independent points, a random walk, an
Ornstein-Uhlenbeck process. A positive is a significant longest bar whose coordinate is periodic
in time; the columns "bar" and "time" give the two tests alone.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import LiftError
from roundelay.reproduction.periodicity import periodicity
from roundelay.topology import p_values, persistent_cohomology
from roundelay.topology.coordinate import circular_coordinate

Points = NDArray[np.float64]
DIMENSIONS = 10
NOISES = (0.05, 0.1, 0.2, 0.3)
LEVEL = 0.05


def independent(rng: np.random.Generator, frames: int) -> Points:
    return rng.normal(size=(frames, DIMENSIONS))


def random_walk(rng: np.random.Generator, frames: int) -> Points:
    return np.cumsum(rng.normal(size=(frames, DIMENSIONS)), axis=0)


def ornstein_uhlenbeck(rng: np.random.Generator, frames: int) -> Points:
    """A process that forgets itself in a tenth of the recording."""
    keep = np.exp(-10 / frames)
    steps = np.sqrt(1 - keep**2) * rng.normal(size=(frames, DIMENSIONS))
    steps[0] = rng.normal(size=DIMENSIONS)
    for t in range(1, frames):
        steps[t] += keep * steps[t - 1]
    return steps


def closed_curve(noise: float) -> Callable[[np.random.Generator, int], Points]:
    """Four turns of a random closed curve of size 1, with noise of that size in all directions."""

    def draw(rng: np.random.Generator, frames: int) -> Points:
        angle = 2 * np.pi * np.linspace(0, 4, frames)[:, None] * np.arange(1, 4)
        waves = np.concatenate((np.cos(angle), np.sin(angle)), axis=1) / [1, 2, 3, 1, 2, 3]
        frame = np.linalg.qr(rng.normal(size=(DIMENSIONS, 6)))[0]
        return waves @ frame.T + noise / np.sqrt(DIMENSIONS) * rng.normal(size=(frames, DIMENSIONS))

    return draw


def verdict(points: Points) -> tuple[bool, bool]:
    """Whether the longest bar is significant, and whether its coordinate is periodic."""
    barcode = persistent_cohomology(points)
    if not len(barcode):
        return False, False
    runs = [(0, len(points))]
    try:
        coordinate = circular_coordinate(barcode, runs=runs)
    except LiftError:
        return False, False
    return bool(p_values(barcode)[0] <= LEVEL), periodicity(coordinate.phase, runs).is_periodic


def cases() -> Iterator[tuple[str, bool, Callable[[np.random.Generator, int], Points]]]:
    yield "independent points", False, independent
    yield "random walk", False, random_walk
    yield "Ornstein-Uhlenbeck", False, ornstein_uhlenbeck
    for noise in NOISES:
        yield f"closed curve, noise {noise}", True, closed_curve(noise)


def measure(runs: int, frames: int) -> list[dict[str, object]]:
    rows: list[dict[str, object]] = []
    for name, is_periodic, draw in cases():
        seen = np.array([verdict(draw(np.random.default_rng(k), frames)) for k in range(runs)])
        bar, time = seen.mean(axis=0)
        rows.append(
            {"case": name, "periodic": is_periodic, "bar": bar, "time": time,
             "both": seen.all(axis=1).mean()}
        )  # fmt: skip
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description="false positives and power of the tests")
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--quick", action="store_true", help="20 runs")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    rows = measure(20 if options.quick else options.runs, options.frames)
    if options.json:
        print(json.dumps(rows))
        return
    print(f"{'share found':28} {'bar':>6} {'time':>6} {'both':>6}")
    for row in rows:
        print(f"{row['case']!s:28} {row['bar']:6.3f} {row['time']:6.3f} {row['both']:6.3f}")


if __name__ == "__main__":
    main()
