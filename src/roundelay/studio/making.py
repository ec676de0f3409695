"""From the work to its loops, the same with and without a browser."""

from __future__ import annotations

from dataclasses import replace

from roundelay.base.errors import NoPeriod
from roundelay.base.progress import Progress, report
from roundelay.cycles.cycle import Cycle
from roundelay.loops.options import LoopOptions
from roundelay.loops.recipe import Loop, made_loop, numbered
from roundelay.motion.motion import Motion
from roundelay.pipeline import find_cycles, understand
from roundelay.studio.work import Part, Work
from roundelay.timeline.behaviours import ASIDE, Behaviour, Timeline
from roundelay.timeline.by_hand import timeline_by_hand
from roundelay.timeline.options import Options, TopologyOptions

__all__ = ["cycle_of", "loops_of", "motions_of", "part_of", "rendered_as", "understood"]


def loops_of(
    work: Work,
    motion: Motion,
    *,
    told: Timeline | None = None,
    progress: Progress | None = None,
) -> list[Loop]:
    """Make the loop of every part of a work.

    Parameters
    ----------
    work : Work
    motion : Motion
        The take.
    told : Timeline, optional
        The take's, by `roundelay.understand`, where it is known already.
    progress : callable, optional
        Called with the fraction done and the stage's name; returning False cancels.

    Raises
    ------
    NoPeriod
        If a part shows nothing that repeats; the message names it.
    ValueError
        If the take has another number of frames, or a part asks for what there is not.
    Cancelled
        If `progress` returned False.
    """
    if len(motion) != work.frames:
        raise ValueError(f"expected a take of {work.frames} frames, found {len(motion)}")
    if not work.parts:
        raise NoPeriod("the work holds no part to make a loop of")
    told = told or understood(work, motion, progress)
    cycles = []
    for number, part in enumerate(work.parts):
        report(progress, 0.5 + 0.5 * number / len(work.parts), f"making {part.name}")
        cycles.append(cycle_of(part, motion, told))
    return [
        made_loop(cycle, motion, rendered_as(work.render, part))
        for cycle, part in zip(numbered(cycles), work.parts, strict=True)
    ]


def understood(work: Work, motion: Motion, progress: Progress | None = None) -> Timeline | None:
    """Understand a take, if a part of the work is a motion as it was found."""
    if all(part.motion is None for part in work.parts):
        return None
    half = progress and (lambda done, stage: progress(0.5 * done, stage))
    return understand(motion, progress=half)


def cycle_of(part: Part, motion: Motion, told: Timeline | None) -> Cycle:
    """Make the cycle of a part.

    Parameters
    ----------
    part : Part
    motion : Motion
        The take.
    told : Timeline, optional
        The take's; needed for motions as they were found.

    Raises
    ------
    NoPeriod
        If it shows nothing that repeats; the message names the part.
    ValueError
        If it asks for what there is not.
    """
    own = _timeline(part, motion, told)
    options = Options(
        topology=TopologyOptions(class_index=part.class_index), method=part.method, most=1
    )
    try:
        return find_cycles(motion, options, timeline=own)[0]
    except NoPeriod as refusal:
        raise NoPeriod(f"{part.name}: {refusal}", refusal.evidence) from None


def _timeline(part: Part, motion: Motion, told: Timeline | None) -> Timeline:
    """Return a timeline of the part alone."""
    if told is None or part.motion is None or part.period or part.limbs:
        return timeline_by_hand(motion, part.spans, period=part.period, limbs=part.limbs)
    found = motions_of(told)
    if part.motion > len(found):
        raise ValueError(f"expected one of {len(found)} motions, found motion {part.motion}")
    return replace(told, behaviours=(found[part.motion - 1],))


def motions_of(told: Timeline) -> list[Behaviour]:
    """Return what repeats or closes, as `roundelay loop --motion` counts it."""
    return [each for each in told.behaviours if each.kind not in ASIDE]


def part_of(number: int, found: Behaviour) -> Part:
    """Return the part of a motion as it was found, 1 being the first."""
    return Part(f"Motion {number}", tuple(found.spans), number)


def rendered_as(render: LoopOptions, part: Part) -> LoopOptions:
    """Return how the loop of a part is written."""
    return replace(render, start=part.start)
