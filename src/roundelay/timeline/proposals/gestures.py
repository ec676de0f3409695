"""Gestures: motions that recur with something else between, from excitation regions ([A] 4.6).

A punch thrown now and again has no period at which its poses come back; but the coordinate of
its class turns once each time. The regions in which it does are cut out and analysed by
themselves, as [A] does.
"""

from __future__ import annotations

from collections.abc import Iterator

from roundelay.base.errors import LiftError, NoPeriod
from roundelay.base.spans import Span, Spans
from roundelay.timeline.proposals.excitation import Excitation, excitations
from roundelay.timeline.proposals.proposal import Proposal
from roundelay.timeline.search import Search
from roundelay.timeline.thresholds import GESTURES

__all__ = ["Gestures", "gesture_runs", "turn_time"]


class Gestures:
    """Propose what recurs, with or without something else between.

    The most significant class comes first. If the user did not ask for gestures, those shown in
    few stretches are left out.
    """

    name = "gestures"

    def propose(self, search: Search) -> Iterator[Proposal]:
        """Propose the regions in which each significant class turns.

        Raises
        ------
        NoPeriod
            If a class lifts to no integer cocycle.
        """
        fewest = 1 if search.options.gestures else GESTURES.often
        points, prime = search.points[slice(*search.span)], search.options.topology.prime
        try:
            classes = excitations(points, search.fps, prime=prime).classes
        except LiftError as error:
            raise NoPeriod(f"no gesture recurs; {error}") from error
        for excited in classes:
            runs = gesture_runs(excited, search.span)
            if len(runs) >= fewest:
                yield Proposal(runs, turn_time(excited), fresh=GESTURES.new, rate=GESTURES.rate)


def gesture_runs(excited: Excitation, span: Span) -> Spans:
    """Return the regions in which a coordinate makes a whole turn forward, with margins.

    Parameters
    ----------
    excited : Excitation
        Of the frames of `span`.
    span : (start, stop)

    Returns
    -------
    Spans
        Frames of the capture; regions with hardly a gap between are one.
    """
    (first, last), turn, runs = span, turn_time(excited), list[Span]()
    margin = round(GESTURES.margin * turn)
    for region in excited.regions:
        if region.net < GESTURES.whole:
            continue
        start = max(first, first + region.start - margin)
        stop = min(last, first + region.stop + margin)
        if runs and start - runs[-1][1] < GESTURES.gap * turn:
            start = runs.pop()[0]
        runs.append((start, stop))
    return Spans(runs)


def turn_time(excited: Excitation) -> float:
    """Mean time of a turn in the regions that make whole ones, in frames."""
    whole = [region for region in excited.regions if region.net >= GESTURES.whole]
    turns = sum(region.net for region in whole)
    return sum(region.stop - region.start for region in whole) / max(turns, GESTURES.whole)
