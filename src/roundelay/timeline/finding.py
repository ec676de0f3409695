"""From the timeline of a take to the evidence of each of its motions, as the user chose."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

from roundelay.base.errors import NoPeriod, TooShort
from roundelay.base.progress import Progress, report
from roundelay.base.spans import Spans
from roundelay.motion.motion import Motion
from roundelay.motion.poses import Poses
from roundelay.timeline.assembly import timeline_of
from roundelay.timeline.behaviours import ASIDE, Behaviour, Timeline
from roundelay.timeline.cloud import make_cloud
from roundelay.timeline.evidence import Evidence, follow, measure, measure_closed
from roundelay.timeline.options import Options
from roundelay.timeline.search import Search
from roundelay.timeline.thresholds import EVIDENCE

__all__ = ["find_evidence"]


def find_evidence(
    take: Motion | Poses,
    options: Options,
    progress: Progress | None = None,
    told: Timeline | None = None,
) -> tuple[Search, list[Evidence]]:
    """Measure every motion of a take's timeline.

    Parameters
    ----------
    take : Motion or Poses
    options : Options
    progress : callable, optional
        Called with the fraction done, up to .5, and the stage's name; returning False cancels.
    told : Timeline, optional
        The take's, if it is known.

    Returns
    -------
    Search
        What topology looked at.
    list of Evidence
        The one most often and most surely repeated first.

    Raises
    ------
    NoPeriod
        If there is none, with the reason and the evidence of the best candidate.
    ValueError
        If the timeline is of a take with another number of frames.
    """
    first_half = progress and (lambda done, stage: progress(0.5 * done, stage))
    search = Search.of_take(take, options)
    if told is None:
        told = timeline_of(take, options, first_half)
    told.checked(len(search.points))
    report(progress, 0.5, "computing barcodes")
    if options.topology.classes is not None:
        return search, _classes(search, told, options)
    shown = _shown(told, options)
    if options.motion is not None:
        if options.motion > len(shown):
            raise NoPeriod(f"expected one of {len(shown)} motions, found motion {options.motion}")
        shown = shown[options.motion - 1 : options.motion]
    found, refused = [], []
    for number, behaviour in enumerate(shown[: options.most]):
        try:
            found.append(_measured(search, behaviour, by_hand=number == 0))
        except NoPeriod as refusal:
            refused.append(refusal)
        except TooShort as error:
            refused.append(NoPeriod(f"frames {behaviour.spans}: {error}"))
    if found:
        return search, found
    raise _refusal(search, told, refused)


def _shown(told: Timeline, options: Options) -> list[Behaviour]:
    """Return what repeats or closes, and what rather does not if that was asked for."""
    shown = [each for each in told.behaviours if each.kind not in ASIDE]
    by_hand = options.topology.class_index is not None
    if options.uncertain or (by_hand and not shown):
        shown += told.uncertain
    return [each.phrase or each for each in shown] if options.phrase else shown


def _measured(search: Search, behaviour: Behaviour, *, by_hand: bool) -> Evidence:
    """Measure a behaviour; a class or a scale chosen by hand is that of the first motion."""
    topology = search.options.topology
    if not by_hand:
        plain = replace(topology, class_index=None, scale=None)
        search = replace(search, options=replace(search.options, topology=plain))
    if behaviour.kind == "closed":
        return measure_closed(search, behaviour)
    return measure(search, behaviour, topology.class_index if by_hand else None)


def _classes(search: Search, told: Timeline, options: Options) -> list[Evidence]:
    """Follow the longest bars of all frames, one motion each ([C] 5.3)."""
    wanted, period = options.topology.classes or 1, _usual_period(told)
    start, stop = _looked_at(told, options)
    cloud = make_cloud(search, Spans([(start, stop)]), period * search.fps)
    found, refused = [], []
    for index in range(min(wanted, len(cloud.barcode))):
        try:
            found.append(follow(cloud, index, n_frames=len(search.points)))
        except NoPeriod as refusal:
            refused.append(refusal)
    if not found:
        raise _refusal(search, told, refused)
    return found


def _usual_period(told: Timeline) -> float:
    """Return the seconds by which velocities are weighed where no behaviour says it."""
    periods = [each.period for each in (*told.cyclic, *told.uncertain)]
    return periods[0] if periods else EVIDENCE.usual_period


def _looked_at(told: Timeline, options: Options) -> tuple[int, int]:
    """Return the frames that are looked at, without what is no movement at their ends."""
    start, stop = options.span(told.n_frames) or (0, told.n_frames)
    for each in told.behaviours:
        for first, last in each.spans if each.kind in ASIDE else ():
            start, stop = (last, stop) if first <= start else (start, first)
    return start, stop


def _refusal(search: Search, told: Timeline, refused: list[NoPeriod]) -> NoPeriod:
    """Return why nothing is periodic, with the evidence of the best candidate."""
    if refused:
        return refused[0]
    best = next(_candidates(search, told), None)
    return NoPeriod(f"no periodic motion found: {told.reason}", best)


def _candidates(search: Search, told: Timeline) -> Iterator[Evidence]:
    for behaviour in told.uncertain:
        with suppress(NoPeriod):
            yield measure(search, behaviour)
    with suppress(NoPeriod, ValueError):
        runs = Spans([_looked_at(told, search.options)])
        cloud = make_cloud(search, runs, _usual_period(told) * search.fps)
        yield follow(cloud, 0, n_frames=len(search.points))
