"""Cases that every binary of the kernel must answer alike, to the bit, on whatever processor.

Points come from whole numbers by sums, products and quotients, so that they are the same
everywhere, too. `RECORDED` are hashes of the answers of a build by gcc for x86_64.
"""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.topology.kernel import Engine
from roundelay.topology.kernel.reduction import F32, Reduction, bit_labels, ends

__all__ = ["CASES", "RECORDED", "Case", "answered", "asked", "hashed"]

LANES = 16
TOLERANCE = 1e-10


@dataclass(frozen=True)
class Case:
    """One run of all functions on a cloud (n, a multiple of 16)."""

    points: F32
    limit: float
    prime: int
    longest: int
    modulus: int


def _noise(count: int, seed: int) -> NDArray[np.float64]:
    """Numbers from -1 to 1 by a linear congruence."""
    state, made = seed, np.empty(count)
    for k in range(count):
        state = (state * 1103515245 + 12345) % 2**31
        made[k] = state / 2**30 - 1
    return made


def _circle(n: int, noise: float, turns: int = 1) -> F32:
    """Points of a circle by half-angle tangents, and noise."""
    tangent = np.tile(np.linspace(-4, 4, n // turns), turns)
    on_it = np.column_stack((1 - tangent**2, 2 * tangent)) / (1 + tangent**2)[:, None]
    return _padded(on_it + noise * _noise(2 * len(on_it), n).reshape(-1, 2))


def _padded(points: NDArray[np.float64]) -> F32:
    return np.pad(points, ((0, 0), (0, -points.shape[1] % LANES))).astype(np.float32)


CASES = {
    "circle": Case(_circle(60, 0.1), 2.5, 47, 0, 0),
    "two turns": Case(_circle(400, 0.05, 2), 2.0, 47, 2, 47),
    "ties": Case(_padded(np.argwhere(np.ones((8, 8))).astype(float)), 6.0, 3, 0, 3),
    "cloud": Case(_padded(_noise(90 * 35, 7).reshape(90, 35)), 9.0, 32749, 0, 32749),
    "repeated": Case(np.repeat(_circle(40, 0.2), 2, axis=0), 3.0, 2, 1, 2),
}
RECORDED = {
    "circle": "caae24ed66622b8a",
    "two turns": "e6a0505fbca8d73a",
    "ties": "0cce8ce35ceb27bf",
    "cloud": "f1d1ce4e00bce307",
    "repeated": "f8edc2b720e6fbfb",
}


def asked(case: Case) -> bytes:
    """Return a case as the program that loads binaries reads it."""
    n, d = case.points.shape
    head = struct.pack("<5q2d", n, d, case.prime, case.longest, case.modulus, case.limit, TOLERANCE)
    return head + case.points.tobytes() + bit_labels(n).tobytes()


def hashed(answer: bytes) -> str:
    """Return what stands in `RECORDED`."""
    return hashlib.sha256(answer).hexdigest()[:16]


def answered(engine: Engine, case: Case) -> bytes:
    """Return the answers of all functions, one after the other, little-endian."""
    lengths = engine.distances(case.points)
    run = engine.reduce(lengths, limit=case.limit, prime=case.prime, longest=case.longest)
    on_births = np.arange(len(run.births)) % 2
    values = engine.propagate(run, len(run.keys), on_births, case.modulus)
    start, close = np.zeros(len(lengths)), len(run.keys) // 2
    w, largest = engine.harmonic(run.keys, values, start, close=close, tolerance=TOLERANCE)
    arrays = (lengths, *_read(run), values, w, np.array([largest]))
    return b"".join(np.ascontiguousarray(array).tobytes() for array in arrays)


def _read(run: Reduction) -> Iterator[NDArray[np.generic]]:
    i, j = ends(run.keys)
    yield from (run.keys, run.fill[i, j], run.merges, run.births, run.deaths, run.killer)
    for columns in (run.relations, run.reduced):
        yield from (columns.start, columns.index, columns.value, columns.time)
