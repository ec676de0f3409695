"""Segmentation and the main job together: which behaviours repeat themselves, and how fast."""

from __future__ import annotations

from dataclasses import replace

from roundelay.cycles.cycle import Cycle
from roundelay.errors import NoPeriod, TooShort
from roundelay.motion import Motion
from roundelay.pipeline import Options, find_cycles, find_periodic
from roundelay.progress import Progress, report
from roundelay.segmentation.result import Segmentation

__all__ = ["cycles_in_segments", "with_periods"]


def with_periods(
    found: Segmentation,
    motion: Motion,
    options: Options | None = None,
    *,
    progress: Progress | None = None,
) -> Segmentation:
    """Tell of each segment whether it is periodic, and its period.

    Parameters
    ----------
    found : Segmentation
    motion : Motion
        The capture that was cut.
    options : Options, optional
        Of the search inside each segment; `roundelay.find_cycles` takes the same.
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Returns
    -------
    Segmentation
        With `Segment.period` in seconds, of the motion that fills most of the segment.

    Raises
    ------
    ValueError
        If the motion has another number of frames.
    Cancelled
        If `progress` returned False.
    """
    segments = []
    for number, (segment, clip) in enumerate(zip(found.segments, found.clips(motion), strict=True)):
        report(progress, number / len(found), "looking for periods")
        segments.append(replace(segment, period=_period(clip, options)))
    return replace(found, segments=tuple(segments))


def cycles_in_segments(
    found: Segmentation,
    motion: Motion,
    options: Options | None = None,
    *,
    progress: Progress | None = None,
) -> list[Cycle]:
    """Make the cycles of every segment by itself, in order.

    Parameters
    ----------
    found : Segmentation
    motion : Motion
        The capture that was cut.
    options : Options, optional
        As for `roundelay.find_cycles`, which is given each segment's frames in turn.
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Returns
    -------
    list of Cycle
        At least one.

    Raises
    ------
    NoPeriod
        If no segment is periodic; the error carries the evidence of the last.
    Cancelled
        If `progress` returned False.
    """
    cycles: list[Cycle] = []
    refused = NoPeriod("no segment is long enough to repeat anything")
    for number, segment in enumerate(found.segments):
        report(progress, number / len(found), "fitting cycles")
        inside = replace(options or Options(), frames=(segment.start, segment.stop))
        try:
            cycles += find_cycles(motion, inside)
        except NoPeriod as refusal:
            refused = refusal
        except TooShort:
            continue
    if not cycles:
        raise refused
    return cycles


def _period(clip: Motion, options: Options | None) -> float | None:
    steady = replace(options or Options(), gestures=False)
    try:
        return find_periodic(clip, steady)[0].period * clip.frame_time
    except (NoPeriod, TooShort):
        return None
