"""When a foot comes down and when it leaves the ground.

A step is told by place: along the way of the body a foot turns where it is farthest ahead of the
pelvis, and where it is farthest behind (Zeni, Richards, Higginson 2008, "Two simple methods for
determining gait events during treadmill and overground walking using kinematic data"). Between
these it swings. Its moments are told by speed where feet stand: the heel comes down where, after
its fastest, it is slow against the ground; the toe leaves where, before its fastest, it was slow.
Who goes backward lands on the toe and leaves with the heel. Where feet do not go to and fro along a
way, contacts that are low and slow are steps (`roundelay.geometry.contacts`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from roundelay.base.spans import Spans
from roundelay.gait.feet import Foot, Walker, velocity
from roundelay.gait.options import Rule
from roundelay.gait.thresholds import STEPS
from roundelay.geometry.contacts import contacts
from roundelay.geometry.thresholds import CONTACTS
from roundelay.phase.tempo import lowest_between

__all__ = ["StepEvent", "step_events"]

Array = NDArray[np.float64]
Kind = Literal["strike", "off"]


@dataclass(frozen=True)
class StepEvent:
    """A moment of a step.

    Attributes
    ----------
    foot : str
        Its name: "left", "right fore".
    kind : {"strike", "off"}
        The foot comes down, or leaves the ground.
    frame : float
        Of the take, from 0; between two where it lies there.
    """

    foot: str
    kind: Kind
    frame: float


def step_events(walker: Walker, spans: Spans, rule: Rule) -> tuple[list[StepEvent], Rule]:
    """Tell the moments of all steps, and by which rule they were told.

    Parameters
    ----------
    walker : Walker
    spans : Spans
        Frames in which steps are looked for, each range by itself.
    rule : {"auto", "velocity", "zeni", "contacts"}

    Returns
    -------
    events : list of StepEvent
        Foot by foot, in order of time.
    rule : {"velocity", "zeni", "contacts"}
    """
    if rule == "contacts":
        return list(_by_contacts(walker, spans)), rule
    placed = list(_by_place(walker, spans))
    if rule == "auto" and not placed:
        return list(_by_contacts(walker, spans)), "contacts"
    if rule == "zeni":
        return placed, rule
    timed = list(_by_speed(walker, placed))
    if rule == "velocity":
        return [one for one in timed if one is not None], rule
    # What speed does not tell of a few steps, place does.
    if sum(one is not None for one in timed) < STEPS.told * len(placed):
        return placed, "zeni"
    return [b if a is None else a for a, b in zip(timed, placed, strict=True)], "velocity"


def _by_place(walker: Walker, spans: Spans) -> Iterator[StepEvent]:
    inside = np.zeros(len(walker.way), bool)
    inside[spans.frames] = True
    for foot in walker.feet:
        front, back = _ends(walker, foot)
        for start, stop in Spans.of_mask(inside & foot.seen):
            part = slice(start, stop)
            ahead = np.sum((front - foot.pelvis)[part] * walker.way[part], axis=1)
            behind = np.sum((back - foot.pelvis)[part] * walker.way[part], axis=1)
            for kind, place in _turns(ahead, behind, STEPS.least * walker.size):
                yield StepEvent(foot.name, kind, start + place)


def _ends(walker: Walker, foot: Foot) -> tuple[Array, Array]:
    """Return what of a foot lands and what leaves: heel and toe, of who goes backward the toe."""
    return (foot.toe, foot.heel) if walker.backward else (foot.heel, foot.toe)


def _turns(ahead: Array, behind: Array, least: float) -> Iterator[tuple[Kind, float]]:
    """Yield where a foot is farthest ahead and farthest behind, in turn, inside the frames."""
    if len(ahead) < 3 or np.ptp(ahead) < least:
        return
    middle = 0.5 * (ahead + behind - np.mean(behind - ahead))
    back = max(STEPS.turn * float(np.ptp(middle)), 0.5 * least)
    found = list(_turning_points(middle, back))
    places = [0, *(place for _, place in found), len(ahead) - 1]
    for number, (rising, _) in enumerate(found):
        # Heel and toe turn at other frames than their middle, between its turns beside.
        first, last = places[number], places[number + 2]
        values = ahead if rising else -behind
        top = first + int(np.argmax(values[first : last + 1]))
        if 0 < top < len(values) - 1:
            between = lowest_between(-values[top - 1 : top + 2])
            yield ("strike" if rising else "off"), top + between


def _turning_points(values: Array, back: float) -> Iterator[tuple[bool, int]]:
    """Yield maxima (True) and minima (False) in turn, each followed by a way back of so much."""
    high = low = 0
    rising: bool | None = None
    for place, value in enumerate(values):
        high = place if value > values[high] else high
        low = place if value < values[low] else low
        if rising is not False and values[high] - value > back:
            yield True, high
            rising, low = False, place
        elif rising is not True and value - values[low] > back:
            yield False, low
            rising, high = True, place


def _by_speed(walker: Walker, placed: list[StepEvent]) -> Iterator[StepEvent | None]:
    """Yield for each moment by place that by speed, or None where there is none near."""
    feet = {foot.name: foot for foot in walker.feet}
    speeds = {
        name: [np.linalg.norm(velocity(end, walker.fps, CONTACTS.reach), axis=1) for end in ends]
        for name, ends in ((name, _ends(walker, foot)) for name, foot in feet.items())
    }
    for place, event in enumerate(placed):
        lands = event.kind == "strike"
        if lands is walker.backward and not feet[event.foot].whole:
            # An ankle tells nothing of the toe, which leaves its place much later.
            yield event
            continue
        other = _swing_end(placed, place, -1 if lands else 1)
        speed = speeds[event.foot][0 if lands else 1]
        share = STEPS.heel if lands is not walker.backward else STEPS.toe
        frame = _slow(speed, event.frame, other, walker.fps, share, lands)
        yield None if frame is None else StepEvent(event.foot, event.kind, frame)


def _swing_end(placed: list[StepEvent], place: int, step: int) -> float | None:
    """Return where the swing that a moment ends or begins has its other end."""
    event, near = placed[place], place + step
    if 0 <= near < len(placed) and placed[near].foot == event.foot:
        return placed[near].frame if placed[near].kind != event.kind else None
    return None


def _slow(
    speed: Array, frame: float, other: float | None, fps: float, share: float, lands: bool
) -> float | None:
    """Return where a foot gets slow after the fastest of its swing, or was slow before it."""
    stray = round(STEPS.stray * fps)
    # Of a swing that is not whole, half of the usual one is looked at.
    far = frame + (-2 if lands else 2) * stray if other is None else other
    start, stop = sorted((round(frame), round(far)))
    start, stop = max(0, start), min(len(speed), stop + 1)
    if stop - start < 3:
        return None
    fastest = start + int(np.argmax(speed[start:stop]))
    limit = share * speed[fastest]
    way = speed[fastest:] if lands else speed[fastest::-1]
    slow = np.flatnonzero(way < limit)
    if not len(slow):
        return None
    before, here = way[slow[0] - 1], way[slow[0]]
    moved = slow[0] - (limit - here) / (before - here)
    found = fastest + (moved if lands else -moved)
    return float(found) if abs(found - frame) <= stray else None


def _by_contacts(walker: Walker, spans: Spans) -> Iterator[StepEvent]:
    toes = np.stack([foot.toe for foot in walker.feet], axis=1)
    for foot, stands in zip(
        walker.feet,
        contacts(toes, fps=walker.fps, size=walker.size, up=walker.up).T,
        strict=True,
    ):
        for start, stop in spans:
            for first, end in Spans.of_mask(stands[start:stop]):
                if first > 0:
                    yield StepEvent(foot.name, "strike", float(start + first))
                if end < stop - start:
                    yield StepEvent(foot.name, "off", float(start + end - 1))
