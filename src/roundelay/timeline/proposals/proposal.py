"""What a proposer gives: a stretch of frames in which some limbs may repeat."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from roundelay.timeline.limbs import Body

__all__ = ["Candidate", "Proposer"]


@dataclass(frozen=True, eq=False)
class Candidate:
    """A stretch in which a group of limbs may repeat.

    Parameters
    ----------
    group : str
        As `Body.groups` names it.
    start, stop : int
        Half-open range of samples.
    period : float
        In samples.
    turns : (n,) ndarray, optional
        Unwrapped phase of every sample of the take in turns, NaN where it is not shown: for what
        recurs with something else between. By default the repetitions are aligned.
    """

    group: str
    start: int
    stop: int
    period: float
    turns: NDArray[np.float64] | None = field(default=None, repr=False)


class Proposer(Protocol):
    """Propose what may repeat in a take."""

    @property
    def name(self) -> str:
        """How `Options.proposers` names it."""
        ...

    def propose(self, body: Body) -> Iterable[Candidate]:
        """Propose stretches, the most promising first.

        Parameters
        ----------
        body : Body
            The limbs of the frames that are looked at, at the clock of the search.
        """
        ...
