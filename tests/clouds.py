"""Point clouds for the tests: random ones with every kind of trouble, and known curves."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

PRIMES = (2, 3, 5, 7, 11, 47, 32749)


def random_clouds(count: int, largest: int = 40) -> Iterator[Points]:
    """Clouds with ties, duplicate points, several components, outliers and flat directions."""
    for seed in range(count):
        rng = np.random.default_rng(seed)
        n, d = int(rng.integers(4, largest)), int(rng.integers(1, 6))
        points = rng.normal(size=(n, d))
        kind = seed % 6
        if kind == 1:
            points = np.round(2 * points)
        elif kind == 2:
            points[n // 2 :] += 20
        elif kind == 3:
            points[n // 2 :] = points[: n - n // 2]
        elif kind == 4:
            points[0] *= 1000
        elif kind == 5:
            points = noisy_circle(n, noise=0.1, seed=seed)
        if np.ptp(points, axis=0).any():
            yield points


def noisy_circle(n: int, *, noise: float, seed: int = 0, turns: float = 1.0) -> Points:
    rng = np.random.default_rng(seed)
    angle = 2 * np.pi * turns * np.arange(n) / n
    return np.column_stack((np.cos(angle), np.sin(angle))) + noise * rng.normal(size=(n, 2))


def closed_curve(phase: NDArray[np.float64], d: int = 12, seed: int = 0) -> Points:
    """Points of a closed curve in d dimensions, none of whose parts come near each other."""
    rng = np.random.default_rng(seed)
    frame = np.linalg.qr(rng.normal(size=(d, 4)))[0]
    angle = 2 * np.pi * phase
    waves = np.column_stack(
        (np.cos(angle), np.sin(angle), 0.4 * np.cos(2 * angle), 0.4 * np.sin(2 * angle))
    )
    return waves @ frame.T


def torus(n: int, seed: int = 0) -> tuple[Points, Points]:
    """Points of a flat torus and their two phases (2, n)."""
    phases = np.random.default_rng(seed).random((2, n))
    angle = 2 * np.pi * phases
    return np.column_stack((*np.cos(angle), *np.sin(angle))), phases


def full_matrix(lengths: NDArray[np.float32]) -> NDArray[np.float32]:
    upper = np.triu(lengths, 1)
    return upper + upper.T
