"""Numbers and curves that every stage needs for its arithmetic, and that decide nothing.

What decides a result stands in a record of thresholds; see `roundelay.base.thresholds`.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

__all__ = ["GOLDEN", "ROUNDING", "SIX_DIGITS", "SMALL", "SMALLEST", "TINY", "smoothstep"]

SIX_DIGITS = 1e-6
"""By how much numbers of about 1 may differ that a person or a text file gives."""
ROUNDING = 1e-9
"""By how much numbers of about 1 may differ by rounding alone."""
TINY = 1e-12
"""Divisors and squares that are about 1 are kept above this."""
SMALL = 1e-30
"""Squares that can nearly vanish, and divisors of single precision, are kept above this."""
SMALLEST = 1e-300
"""Divisors and arguments of logarithms of any size are kept above this."""
GOLDEN = 0.5 * (sqrt(5.0) - 1.0)
"""The golden section: multiples of it, modulo 1, spread most evenly."""


def smoothstep(share: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return 3 x^2 - 2 x^3: it rises from 0 to 1 over [0, 1], level at both ends."""
    return share * share * (3.0 - 2.0 * share)
