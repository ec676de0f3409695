"""A behaviour that a person told: its frames, and if wished its period and its limbs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from roundelay.base.progress import Progress
from roundelay.base.spans import Span, Spans
from roundelay.base.threads import one_thread
from roundelay.motion.motion import Motion
from roundelay.motion.poses import Poses
from roundelay.timeline.assembly import cyclic, timeline_of
from roundelay.timeline.behaviours import Behaviour, Timeline
from roundelay.timeline.limbs import Body, body_of
from roundelay.timeline.options import Options
from roundelay.timeline.prediction import Predicted, predict_all, within
from roundelay.timeline.proposals import Candidate, proposed
from roundelay.timeline.tempo import refined, without_pauses

__all__ = ["groups_of", "timeline_by_hand"]


@one_thread
def timeline_by_hand(
    take: Motion | Poses,
    spans: Iterable[Span],
    *,
    period: float | None = None,
    limbs: str | None = None,
    progress: Progress | None = None,
) -> Timeline:
    """Return a timeline of one behaviour, in frames that a person chose.

    Frames among them that do not show the repetition are left out.

    Parameters
    ----------
    take : Motion or Poses
    spans : iterable of (int, int)
        Half-open ranges of frames, in order of time.
    period : float, optional
        Seconds of a repetition, roughly; found by default.
    limbs : str, optional
        The group of limbs that repeats, as `groups_of` names it; found by default.
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Returns
    -------
    Timeline
        Without a behaviour where nothing in these frames repeats so.

    Raises
    ------
    TooShort
        If they are fewer than 8.
    ValueError
        If they are not all there, or there is no such group of limbs.
    Cancelled
        If `progress` returned False.
    """
    spans = Spans(spans)
    if not spans:
        raise ValueError("expected a range of frames or more, found none")
    longest = max(spans, key=lambda span: span[1] - span[0])
    told = timeline_of(take, Options(frames=longest), progress)
    likely = _likeliest(told, longest)
    by_itself = period is None and limbs is None
    if by_itself and (len(spans) == 1 or likely is None or likely.kind == "closed"):
        return replace(told, behaviours=() if likely is None else (likely,))
    body = body_of(take, (spans[0][0], spans[-1][1]))
    if period is None and likely is not None:
        period = likely.period
    found = _as_told(body, spans, period, limbs)
    return replace(told, behaviours=() if found is None else (found,))


def groups_of(take: Motion | Poses) -> tuple[str, ...]:
    """Return the names of the groups of limbs that may repeat by themselves."""
    return tuple(body_of(take).groups())


def _likeliest(told: Timeline, span: Span) -> Behaviour | None:
    """Return what fills most of the frames, the surer first; one closed pass where none does."""
    closed = [each for each in told.behaviours if each.kind == "closed"]
    return max(
        (*told.cyclic, *told.uncertain),
        key=lambda each: each.spans.within(range(*span)) * (each.probability or 0.0),
        default=closed[0] if closed else None,
    )


def _as_told(body: Body, spans: Spans, period: float | None, limbs: str | None) -> Behaviour | None:
    """Lay the frames around one template, of that period and of those limbs."""
    groups = body.groups()
    group = next(iter(groups)) if limbs is None else limbs
    if group not in groups:
        raise ValueError(f"expected limbs as one of {', '.join(groups)}, found {group!r}")
    if period is None:
        candidates = [one for one in proposed(body) if one.group == group]
    else:
        candidates = [Candidate(group, 0, len(body), period * body.rate)]
    inside = (_inside(body, one, spans) for one in predict_all(body, candidates))
    found = [one for one in inside if one is not None and one.seen > 0.0]
    if not found:
        return None
    best = without_pauses(_claiming(max(found, key=lambda one: one.nats), groups[group]))
    return cyclic(body, refined(body, best))


def _inside(body: Body, one: Predicted, spans: Spans) -> Predicted | None:
    """Measure what was predicted within these frames alone; None where too little is left."""
    ours = [((a - body.span[0]) / body.step, (b - body.span[0]) / body.step) for a, b in spans]
    pairs = ((max(a, c), min(b, d)) for a, b in one.runs for c, d in ours)
    runs = [(a, b) for a, b in pairs if b > a]
    return within(body, one, runs) if runs else None


def _claiming(one: Predicted, members: tuple[int, ...]) -> Predicted:
    """Return the same as a repetition of these limbs: a person says that they repeat."""
    claimed = np.zeros(len(one.claimed), bool)
    claimed[list(members)] = True
    return replace(one, claimed=claimed)
