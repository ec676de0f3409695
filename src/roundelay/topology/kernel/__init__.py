"""The compiled kernel, or its NumPy twin where the binary is missing or cannot be loaded.

Both offer the same four functions, described in :class:`Engine`, and give the same results;
the twin is slower.
"""

from __future__ import annotations

import functools
import warnings
from typing import Protocol

from roundelay.topology.kernel.compiled import Compiled
from roundelay.topology.kernel.reduction import F32, F64, I32, I64, U64, Reduction
from roundelay.topology.kernel.twin import Twin

__all__ = ["Engine", "engine"]


class Engine(Protocol):
    """What a kernel does; arrays are C-contiguous, (n, n) ones use their upper triangle."""

    def distances(self, x: F32, y: F32 | None = None) -> F32:
        """Euclidean distances between rows: (m, n), or the upper triangle (m, m) without y."""

    def reduce(self, lengths: F32, *, limit: float, prime: int, longest: int) -> Reduction:
        """Run the filtration up to limit; longest > 0 stops once so many bars are settled."""

    def propagate(self, reduced: Reduction, count: int, on_births: I64, modulus: int) -> I32:
        """Extend a cocycle from the births to the first count edges: (count,)."""

    def harmonic(
        self, keys: U64, values: I32, start: F64, *, close: int, tolerance: float
    ) -> tuple[F64, float]:
        """Minimise the weighted norm of values + dw over the edges.

        Weights are 1 / (rho_i rho_j) with the density rho counted on the first `close` edges,
        or 1 if that is 0. Returns w (n,), from `start` on, and the largest |values + dw|.
        """


@functools.cache
def engine() -> Engine:
    """Return the compiled kernel, or the twin with one warning."""
    try:
        return Compiled()
    except OSError as error:
        warnings.warn(
            f"the compiled topology kernel could not be loaded ({error}); "
            "the NumPy version gives the same results, 10 to 100 times slower",
            RuntimeWarning,
            stacklevel=2,
        )
        return Twin()
