"""Strides as a table: from one strike of a foot to its next."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import ROUNDING
from roundelay.gait.events import StepEvent
from roundelay.gait.feet import Foot, Walker

__all__ = ["QUANTITIES", "Stride", "strides_of"]

Array = NDArray[np.float64]

QUANTITIES = {
    "time": "s",
    "length": "m",
    "width": "m",
    "speed": "m/s",
    "cadence": "steps/min",
    "stance": "s",
    "swing": "s",
    "stance_share": "",
    "double_support": "s",
}
"""What is told of a stride, with its unit; metres are the file's unit where that is not known."""


@dataclass(frozen=True)
class Stride:
    """A stride: from one strike of a foot to its next.

    Attributes
    ----------
    foot : str
    start : float
        Seconds of the take.
    time, stance, swing, double_support : float
        Seconds: of all of it, with the foot on the ground, off it, and with its partner on the
        ground, too. NaN where a moment lies outside of the frames.
    stance_share : float
        Of its time.
    length, width : float
        Of the foot over the ground, and how far beside its line the partner comes down.
    speed : float
        Length over time.
    cadence : float
        Steps a minute: two of such a stride.
    """

    foot: str
    start: float
    time: float
    length: float
    width: float
    speed: float
    cadence: float
    stance: float
    swing: float
    stance_share: float
    double_support: float

    def value(self, name: str) -> float:
        """Return one of `QUANTITIES`."""
        return float(asdict(self)[name])


def strides_of(walker: Walker, events: Sequence[StepEvent], scale: float) -> list[Stride]:
    """Make strides of the moments of steps.

    Parameters
    ----------
    walker : Walker
    events : sequence of StepEvent
    scale : float
        Metres of the motion's unit, or 1.

    Returns
    -------
    list of Stride
        In order of their starts; only those whose foot leaves the ground once, between.
    """
    found = []
    for place, foot in enumerate(walker.feet):
        partner = walker.feet[place ^ 1]
        own, other = (_moments(events, one.name) for one in (foot, partner))
        for first, second, third in _triples(own):
            support = _double(first.frame, second.frame, third.frame, other)
            steps = [one for one in other if one.kind == "strike"]
            beside = [one.frame for one in steps if first.frame < one.frame < third.frame]
            length, width = _ways(walker, foot, partner, first.frame, third.frame, beside)
            frames = third.frame - first.frame
            found.append(
                _stride(
                    foot.name,
                    np.array([first.frame, frames, second.frame - first.frame, support])
                    / walker.fps,
                    scale * length,
                    scale * width,
                )
            )
    return sorted(found, key=lambda stride: (stride.start, stride.foot))


def _moments(events: Sequence[StepEvent], foot: str) -> list[StepEvent]:
    return sorted((one for one in events if one.foot == foot), key=lambda one: one.frame)


def _triples(own: list[StepEvent]) -> Iterator[tuple[StepEvent, StepEvent, StepEvent]]:
    for three in zip(own, own[1:], own[2:], strict=False):
        if [one.kind for one in three] == ["strike", "off", "strike"]:
            yield three


def _stride(foot: str, seconds: Array, length: float, width: float) -> Stride:
    start, time, stance, support = map(float, seconds)
    return Stride(
        foot=foot,
        start=start,
        time=time,
        length=length,
        width=width,
        speed=length / time,
        cadence=120 / time,
        stance=stance,
        swing=time - stance,
        stance_share=stance / time,
        double_support=support,
    )


def _double(strike: float, off: float, end: float, other: list[StepEvent]) -> float:
    """Return in how many frames of a stride both feet stand; NaN where the other is not known."""
    inside = [one for one in other if strike < one.frame < end]
    if [one.kind for one in inside] not in (["off", "strike"], ["strike", "off"]):
        return float("nan")
    kinds = {one.kind: one.frame for one in inside}
    # The other foot swings once, from its off to its strike, and may run on over an end.
    if kinds["off"] < kinds["strike"]:
        both = max(0.0, kinds["off"] - strike) + max(0.0, off - kinds["strike"])
        return min(both, off - strike)
    return max(0.0, min(off, kinds["off"]) - kinds["strike"])


def _ways(
    walker: Walker, foot: Foot, partner: Foot, first: float, last: float, beside: list[float]
) -> tuple[float, float]:
    """Return length and width of a stride in the motion's unit."""
    heel = foot.heel
    level = np.arange(3) != walker.up
    a, b = _at(heel, first)[level], _at(heel, last)[level]
    length = float(np.linalg.norm(b - a))
    if not beside or length < ROUNDING * walker.size:
        return length, float("nan")
    aside = _at(partner.heel, beside[0])[level] - a
    along = (b - a) / length
    return length, float(abs(along[0] * aside[1] - along[1] * aside[0]))


def _at(places: Array, frame: float) -> Array:
    """Return where (3,) a point is between two frames."""
    before = min(int(frame), len(places) - 2)
    share = frame - before
    return places[before] * (1.0 - share) + places[before + 1] * share
