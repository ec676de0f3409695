"""From a take to its strides."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from roundelay.base.checks import chosen
from roundelay.base.errors import NoPeriod, TooShort
from roundelay.base.progress import Progress
from roundelay.base.spans import Spans
from roundelay.base.threads import one_thread
from roundelay.gait.events import StepEvent, step_events
from roundelay.gait.feet import Foot, Walker, feet_of_motion, walker_of
from roundelay.gait.options import Rule, StrideOptions
from roundelay.gait.result import Difference, Strides
from roundelay.gait.spread import Spread, spread_of
from roundelay.gait.table import QUANTITIES, Stride, strides_of
from roundelay.gait.thresholds import SPREAD, STEPS
from roundelay.loops.units import Lengths
from roundelay.motion.budget import require_budget
from roundelay.motion.floating import as_motion
from roundelay.motion.motion import Motion
from roundelay.motion.points import Points
from roundelay.timeline.assembly import timeline_of
from roundelay.timeline.behaviours import Timeline
from roundelay.timeline.options import Options
from roundelay.timeline.thresholds import SEARCH

__all__ = ["strides"]

Array = NDArray[np.float64]


@one_thread
def strides(
    take: Motion | Points,
    options: StrideOptions | None = None,
    *,
    search: Options | None = None,
    timeline: Timeline | None = None,
    rng: int | np.random.Generator = 0,
    progress: Progress | None = None,
) -> Strides:
    """Tell when each foot comes down and leaves the ground, and the strides between.

    Parameters
    ----------
    take : Motion or Points
        Of a body with a left and a right foot, or more pairs.
    options : StrideOptions, optional
        Automatic by default.
    search : Options, optional
        Frames to look at, and what the timeline looks for.
    timeline : Timeline, optional
        The take's, by `understand`, where it is known already.
    rng : int or numpy.random.Generator
        Draws the bootstrap.
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Returns
    -------
    Strides
        Its `notes` say what is missing.

    Raises
    ------
    SkeletonMismatch
        If there is no left and right foot.
    NoPeriod
        If the legs repeat nothing, or no foot comes down in the frames.
    TooShort
        If there are fewer than 8 frames.
    TooLarge
        If less memory is free than the search would take.
    ValueError
        If an option is out of range, or the timeline is another take's.
    Cancelled
        If `progress` returned False.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> found = rl.strides(walk)
    >>> sorted({event.foot for event in found.events})
    ['left', 'right']
    """
    options, search, motion = (
        chosen(StrideOptions, options),
        chosen(Options, search),
        as_motion(take),
    )
    first, last = search.span(len(motion)) or (0, len(motion))
    if last - first < SEARCH.fewest:
        raise TooShort(f"expected {SEARCH.fewest} frames or more, found {last - first}")
    require_budget(motion, (first, last))
    feet = feet_of_motion(motion)
    if options.everywhere:
        spans = _seen_spans(feet, first, last)
    else:
        known = timeline_of(motion, search, progress) if timeline is None else timeline
        spans = _gait(known.checked(len(motion)), feet)
    frames = np.zeros(len(motion), bool)
    frames[spans.frames] = True
    if not frames.any():
        raise NoPeriod("no foot is seen in any frame")
    walker = walker_of(motion, feet, frames)
    events, rule = step_events(walker, spans, options.rule)
    events = sorted(_seen(events, walker), key=lambda one: (one.frame, one.foot))
    if not any(one.kind == "strike" for one in events):
        raise NoPeriod(f"no foot comes down in frames {spans}; {_try(options)}")
    return _result(motion, walker, events, rule, spans, options, np.random.default_rng(rng))


def _result(
    motion: Motion,
    walker: Walker,
    events: list[StepEvent],
    rule: Rule,
    spans: Spans,
    options: StrideOptions,
    draw: np.random.Generator,
) -> Strides:
    """Put moments together with the strides between them and their spread."""
    metres = Lengths.of(motion.skeleton).metres
    told = strides_of(walker, events, metres or 1.0)
    summary = {foot.name: _spreads(told, foot.name, options, draw) for foot in walker.feet}
    return Strides(
        events=tuple(events),
        strides=tuple(told),
        summary=summary,
        differences=_differences(walker, summary),
        spans=spans,
        rule=rule,
        ground="belt" if walker.belt else "still",
        backward=walker.backward,
        unit="" if metres is None else "m",
        notes=tuple(_notes(walker, events, told, spans, metres)),
        level=options.level,
        fps=motion.fps,
        name=motion.name,
    )


def _seen_spans(feet: list[Foot], first: int, last: int) -> Spans:
    """Return the frames of a range in which a foot is seen."""
    seen = np.any([foot.seen for foot in feet], axis=0)
    seen[:first] = seen[last:] = False
    return Spans.of_mask(seen)


def _gait(known: Timeline, feet: list[Foot]) -> Spans:
    """Return the frames in which legs repeat what they do.

    Raises
    ------
    NoPeriod
        If there are none.
    """
    joints = {joint for foot in feet for joint in foot.joints}
    walks = [each.spans for each in known.cyclic if joints & set(each.joints)]
    if not walks:
        # What else the reason advises is for loops.
        why = known.reason.partition("; ")[0] or "what repeats is none of the legs'"
        raise NoPeriod(f"no gait found: {why}; --everywhere looks for steps in all frames")
    return Spans.union(sorted(span for spans in walks for span in spans))


def _try(options: StrideOptions) -> str:
    other = "another --rule" if options.everywhere else "another --rule or --everywhere"
    return f"if there are steps, try {other}"


def _seen(events: list[StepEvent], walker: Walker) -> list[StepEvent]:
    """Return the moments at which their foot was seen or could be told from the rest."""
    seen = {foot.name: foot.seen for foot in walker.feet}
    return [one for one in events if seen[one.foot][round(one.frame)]]


def _spreads(
    told: list[Stride], foot: str, options: StrideOptions, draw: np.random.Generator
) -> dict[str, Spread]:
    return {
        name: spread_of(
            _values(told, foot, name), level=options.level, resamples=options.resamples, rng=draw
        )
        for name in QUANTITIES
    }


def _values(told: list[Stride], foot: str, name: str) -> Array:
    return np.array([stride.value(name) for stride in told if stride.foot == foot], float)


def _differences(
    walker: Walker, summary: dict[str, dict[str, Spread]]
) -> dict[str, list[Difference]]:
    pairs = [(a.name, b.name) for a, b in zip(walker.feet[::2], walker.feet[1::2], strict=True)]
    return {
        name: [_difference(a, b, summary[a][name], summary[b][name]) for a, b in pairs]
        for name in QUANTITIES
    }


def _difference(left: str, right: str, one: Spread, other: Spread) -> Difference:
    away, both = one.mean - other.mean, one.mean + other.mean
    # Errors of two means add as squares.
    reach = 0.5 * float(np.hypot(one.high - one.low, other.high - other.low))
    share = 2 * away / both if both else float("nan")
    return Difference(left, right, away, away - reach, away + reach, share)


def _notes(
    walker: Walker,
    events: list[StepEvent],
    told: list[Stride],
    spans: Spans,
    metres: float | None,
) -> list[str]:
    notes = []
    for foot in walker.feet:
        strides_seen = sum(stride.foot == foot.name for stride in told)
        missing = float(foot.gaps[spans.frames].mean())
        if missing > STEPS.unseen:
            notes.append(
                f"{foot.name}: {', '.join(foot.joints)} missing in {missing:.0%} of the frames; "
                "its steps are told from what was filled"
            )
        if not any(one.foot == foot.name for one in events):
            notes.append(f"{foot.name}: never comes down, no step told")
        elif not strides_seen:
            notes.append(f"{foot.name}: no whole stride")
        elif strides_seen == 1:
            notes.append(f"{foot.name}: one stride, no spread and no interval")
        elif strides_seen < SPREAD.fewest:
            notes.append(f"{foot.name}: {strides_seen} strides, too few for an interval")
    for left, right in zip(walker.feet[::2], walker.feet[1::2], strict=True):
        if _together(events, left.name, right.name):
            notes.append(f"{left.name} and {right.name} come down together: jumps, not steps")
    if metres is None:
        notes.append("lengths are in the file's unit: it tells no unit and is no person's size")
    return notes


def _together(events: list[StepEvent], left: str, right: str) -> bool:
    """Tell whether two feet come down at about the same phase of their strides."""
    own, other = (
        [one.frame for one in events if (one.foot, one.kind) == (foot, "strike")]
        for foot in (left, right)
    )
    phases = [(x - a) / (b - a) for a, b in pairwise(own) for x in other if a <= x < b]
    return bool(phases) and float(np.median([min(x, 1 - x) for x in phases])) < STEPS.together
