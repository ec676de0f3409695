"""What a take shows, behaviour by behaviour: the type that all commands read."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from roundelay.base.spans import Spans

__all__ = ["ASIDE", "Behaviour", "Kind", "Test", "Timeline"]

Array = NDArray[np.float64]
Kind = Literal["cyclic", "closed", "neutral", "unseen"]
ASIDE = ("neutral", "unseen")
"""Kinds of frames that are no movement."""
_FAULTS = {
    "comes_back": "poses a period apart are hardly alike",
    "chance": "random motion of these limbs would repeat as well somewhere in the take",
    "above_half": "poses half a period apart are more alike",
    "above_twice": "poses two periods apart are more alike",
}


@dataclass(frozen=True)
class Test:
    """A named test of a behaviour.

    Attributes
    ----------
    name : str
        What was measured.
    value, limit : float
        What was found, and the least that passes.
    """

    name: str
    value: float
    limit: float

    @property
    def passed(self) -> bool:
        """Whether the value reaches the limit."""
        return self.value >= self.limit


@dataclass(frozen=True, eq=False)
class Behaviour:
    """A stretch of a take in which some limbs do one thing.

    Attributes
    ----------
    kind : {"cyclic", "closed", "neutral", "unseen"}
        Repeating; one pass whose ends meet; a pose that an exporter put before or behind the
        movement; frames in which the body is not seen.
    spans : Spans
        The frames.
    limbs, joints : tuple of str
        Names of the limbs and of their joints.
    whole : bool
        All limbs that move do it.
    period : float
        Seconds of a repetition, or of the pass; NaN for a neutral pose and what is unseen.
    repetitions : float
        How many were seen, parts of one counted.
    probability : float or None
        That it repeats, in [0, 1]; None where nothing was seen twice.
    tempo : (n, 2) ndarray
        Times in seconds of the take, and how long the repetition that passes then lasts.
    tests : tuple of Test
        What the probability rests on.
    phrase : Behaviour or None
        What it is a beat of: the same limbs, with a longer period that predicts them better.
    paused : Spans
        Frames between those of `spans` in which it pauses.
    passages : (R, n) ndarray
        When each repetition passes each of n phases, in frames of the take; NaN where it does
        not. Rows that follow each other without a gap are one run.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> behaviour = rl.understand(walk).behaviours[0]
    >>> behaviour.kind, behaviour.limbs, round(behaviour.period, 2)
    ('cyclic', ('left arm', 'right arm', 'left leg', 'right leg'), 1.1)
    """

    kind: Kind
    spans: Spans
    limbs: tuple[str, ...]
    joints: tuple[str, ...] = field(repr=False)
    whole: bool
    period: float
    repetitions: float
    probability: float | None
    tempo: Array = field(repr=False)
    tests: tuple[Test, ...] = field(repr=False)
    phrase: Behaviour | None = field(default=None, repr=False)
    paused: Spans = field(default_factory=lambda: Spans([]))
    passages: Array = field(default_factory=lambda: np.zeros((0, 0)), repr=False)

    @property
    def certainty(self) -> float:
        """How surely and how often it was seen: what behaviours are ordered by."""
        return (self.probability or 0.0) * self.repetitions


@dataclass(frozen=True, eq=False)
class Timeline:
    """What a take shows.

    Attributes
    ----------
    n_frames : int
    fps : float
        Frames a second.
    limbs : tuple of str
        The limbs that were looked at.
    behaviours : tuple of Behaviour
        What is more likely than not, surest and most often repeated first; no limb is in two
        of them at the same time.
    uncertain : tuple of Behaviour
        What may repeat, but rather does not.
    name : str
        Of the take.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> told = rl.understand(walk)
    >>> told.limbs, len(told.cyclic)
    (('left arm', 'right arm', 'left leg', 'right leg', 'trunk'), 1)
    """

    n_frames: int
    fps: float
    limbs: tuple[str, ...]
    behaviours: tuple[Behaviour, ...]
    uncertain: tuple[Behaviour, ...]
    name: str = ""

    def __repr__(self) -> str:
        shown = f"{len(self.behaviours)} behaviours, {len(self.uncertain)} uncertain"
        return f"Timeline({self.name!r}, {self.n_frames} frames at {self.fps:.4g} fps, {shown})"

    @property
    def cyclic(self) -> tuple[Behaviour, ...]:
        """The behaviours that repeat."""
        return tuple(each for each in self.behaviours if each.kind == "cyclic")

    def checked(self, n_frames: int) -> Timeline:
        """Return itself for a take of so many frames.

        Raises
        ------
        ValueError
            If it has another number.
        """
        if n_frames != self.n_frames:
            raise ValueError(
                f"expected the timeline of a take of {n_frames} frames, found one of "
                f"{self.n_frames}"
            )
        return self

    def passing(self, limb: str) -> Spans:
        """Return the frames in which nothing is known of a limb but that it passes.

        Raises
        ------
        ValueError
            If there is no such limb.
        """
        if limb not in self.limbs:
            raise ValueError(f"expected a limb among {self.limbs}, found {limb!r}")
        known = np.zeros(self.n_frames, bool)
        for behaviour in self.behaviours:
            if limb in behaviour.limbs:
                known[behaviour.spans.frames] = True
        return Spans.of_mask(~known)

    @property
    def reason(self) -> str:
        """Why no behaviour repeats, and what to try; empty where one does."""
        if any(each.kind not in ASIDE for each in self.behaviours):
            return ""
        if not self.limbs:
            return "nothing moves against the root"
        if not self.uncertain:
            return (
                "no pose comes back after a while; if the frames are one period, give them by "
                "--frames START:STOP"
            )
        best = max(self.uncertain, key=lambda each: each.probability or 0.0)
        faults = " and ".join(_FAULTS[test.name] for test in best.tests if not test.passed)
        why = faults or "too little of it is seen again"
        return (
            f"frames {best.spans} may repeat after {best.period:.2f} s, but with "
            f"{best.probability:.0%} rather do not: {why}; --uncertain takes them all the same"
        )

    def to_dict(self) -> dict[str, Any]:
        """Return all of it as plain data."""
        return {
            "name": self.name,
            "frames": self.n_frames,
            "fps": self.fps,
            "limbs": list(self.limbs),
            "behaviours": [_plain(each) for each in self.behaviours],
            "uncertain": [_plain(each) for each in self.uncertain],
            "reason": self.reason or None,
            "passing": {limb: [list(span) for span in self.passing(limb)] for limb in self.limbs},
        }

    def to_csv(self) -> str:
        """Return a table of behaviours: a row a span, times in seconds."""
        rows = ["start,end,kind,limbs,period,repetitions,probability"]
        for each in (*self.behaviours, *self.uncertain):
            sure = "" if each.probability is None else f"{each.probability:.4f}"
            period = "" if np.isnan(each.period) else f"{each.period:.4f}"
            limbs = " + ".join(each.limbs)
            rows += [
                f"{start / self.fps:.4f},{stop / self.fps:.4f},{each.kind},{limbs},"
                f"{period},{each.repetitions:.2f},{sure}"
                for start, stop in each.spans
            ]
        return "\n".join([*rows, ""])


def _plain(one: Behaviour) -> dict[str, Any]:
    return {
        "kind": one.kind,
        "spans": [list(span) for span in one.spans],
        "paused": [list(span) for span in one.paused],
        "limbs": list(one.limbs),
        "joints": list(one.joints),
        "whole": one.whole,
        "period_seconds": None if np.isnan(one.period) else one.period,
        "repetitions": one.repetitions,
        "probability": one.probability,
        "tempo": np.round(one.tempo, 4).tolist(),
        "tests": _tests(one.tests),
        "phrase": None if one.phrase is None else _plain(one.phrase),
    }


def _tests(tests: Iterable[Test]) -> list[dict[str, Any]]:
    return [
        {"name": test.name, "value": test.value, "limit": test.limit, "passed": test.passed}
        for test in tests
    ]
