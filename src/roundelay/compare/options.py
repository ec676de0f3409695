"""What a user may choose of comparisons."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roundelay.base.options import Checked, option

__all__ = ["CompareOptions"]


@dataclass(frozen=True)
class CompareOptions(Checked):
    """Choices of comparisons along the phase.

    Parameters
    ----------
    level : float
        How often nothing is told to differ where nothing does.
    permutations : int
        Of the repetitions, drawn where not all can be tried.

    Examples
    --------
    >>> rl.CompareOptions(level=0.99).permutations
    5000
    """

    title: ClassVar[str] = "Comparisons along the phase"

    level: float = option(
        0.95,
        "How often nothing is told to differ where nothing does.",
        above=0.0,
        below=1.0,
        flag="sure",
    )
    permutations: int = option(
        5000,
        "Permutations of the repetitions, drawn where not all can be tried.",
        least=100,
        most=1_000_000,
    )
