"""Gestures: what recurs with something else between, from excitation regions ([A] 4.6).

A punch thrown now and again has no period at which its poses come back; but the coordinate of
its class turns once each time, and its regions show where.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import LiftError
from roundelay.base.spans import Span, Spans
from roundelay.timeline.limbs import Body
from roundelay.timeline.proposals.excitation import Excitation, excitations
from roundelay.timeline.proposals.proposal import Candidate
from roundelay.timeline.thresholds import GESTURES, SEARCH

__all__ = ["Gestures", "gesture_runs", "turn_time"]

Array = NDArray[np.float64]


class Gestures:
    """Propose what recurs with something else between, the most significant class first."""

    name = "excitation"

    def propose(self, body: Body) -> Iterator[Candidate]:
        """Propose the frames from the first to the last time that a class turns."""
        if not body.limbs or len(body) < SEARCH.fewest:
            return
        try:
            classes = excitations(body.signals, body.rate).classes
        except LiftError:
            return
        for excited in classes:
            runs = gesture_runs(excited, (0, len(body)))
            if len(runs) < GESTURES.often:
                continue
            turns = _whole_turns(excited.turns, runs)
            shown = np.flatnonzero(np.isfinite(turns))
            lasted = [stop - start for start, stop in Spans.of_mask(np.isfinite(turns))]
            period = float(np.median(lasted))
            yield Candidate("body", int(shown[0]), int(shown[-1]) + 1, period, turns)


def _whole_turns(turns: Array, runs: Spans) -> Array:
    """Return the turns (n,) of the runs, each cut to whole ones; NaN elsewhere.

    All begin at the phase at which the runs do, so that each shows the gesture from its start.
    """
    begins = np.exp(2j * np.pi * np.array([turns[start] for start, _ in runs]))
    begin = float(np.angle(begins.sum())) / (2.0 * np.pi)
    result = np.full(len(turns), np.nan)
    for start, stop in runs:
        own = np.maximum.accumulate(turns[start:stop]) - begin
        first = np.round(own[0])
        count = max(1.0, np.round(own[-1] - own[0]))
        a, b = np.searchsorted(own, (first, first + count))
        result[start + a : min(start + b + 1, stop)] = own[a : b + 1]
    return result


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
