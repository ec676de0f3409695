"""Takes that are one period already: closed loops, as people cut them by hand."""

from __future__ import annotations

from collections.abc import Iterator

from roundelay.base.spans import Spans
from roundelay.timeline.proposals.proposal import Proposal
from roundelay.timeline.search import Search
from roundelay.timeline.thresholds import CLOSED

__all__ = ["Closed"]


class Closed:
    """Propose all frames as one period, if they are not too many."""

    name = "closed"

    def propose(self, search: Search) -> Iterator[Proposal]:
        """Propose the span that is looked at."""
        if search.n_frames <= CLOSED.longest * search.fps:
            yield Proposal(Spans([search.span]), float(search.n_frames), closed=True)
