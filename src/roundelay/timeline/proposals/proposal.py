"""What a proposer gives: frames that may show one motion again and again."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

from roundelay.base.spans import Spans
from roundelay.timeline.search import Search

__all__ = ["Proposal", "Proposer"]


@dataclass(frozen=True)
class Proposal:
    """Frames that may show one motion.

    Parameters
    ----------
    runs : Spans
        The frames.
    period : float
        Rough period in frames.
    limbs : str
        The limbs that show it, as `Search.of` takes them; empty for the whole body.
    least_prominence : float
        How many times the next bar its own must be, at least.
    closed : bool
        The frames are one period whose ends meet.
    apart : tuple of Proposal
        What to ask about, one by one, if all frames together are refused.
    fresh : float
        The share of its frames that must not be in anything accepted before.
    rate : float, optional
        Frames a second that topology looks at; by default as for the whole take.
    """

    runs: Spans
    period: float
    limbs: str = ""
    least_prominence: float = 0.0
    closed: bool = False
    apart: tuple[Proposal, ...] = ()
    fresh: float = 0.0
    rate: float | None = None


class Proposer(Protocol):
    """Propose what may repeat in a take."""

    @property
    def name(self) -> str:
        """How `Options.proposers` names it."""
        ...

    def propose(self, search: Search) -> Iterable[Proposal]:
        """Propose frames, the most promising first.

        Parameters
        ----------
        search : Search
            The points of all frames, the span to look at, and what the user chose.
        """
        ...
