"""Thresholds of what is found in a take: search, proposals, evidence, verdict."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = [
    "CLOSED",
    "CLOUD",
    "EVIDENCE",
    "EXCITATION",
    "GESTURES",
    "RECURRENCE",
    "SEARCH",
    "VERDICT",
]


@dataclass(frozen=True)
class _Search(Thresholds):
    """How closely a take is looked at."""

    fewest: int = constant(8, unit="frames", origin=BY_EYE)
    still: float = constant(1e-9, unit="body sizes", origin="rounding of positions")
    rate: float = constant(
        60.0, unit="frames a second", origin="against .3 s cycles, for speed; " + BY_EYE
    )
    long_rate: float = constant(30.0, unit="frames a second", origin=BY_EYE)
    long: float = constant(
        15.0, unit="seconds", origin="longer takes are thinned to long_rate, for speed; " + BY_EYE
    )


SEARCH = _Search()


@dataclass(frozen=True)
class _Cloud(Thresholds):
    """The cloud of poses that topology sees."""

    landmarks: int = constant(
        500, unit="points", origin="exact topology of so many takes about 20 ms"
    )
    pool: int = constant(2000, unit="points", origin=BY_EYE)
    rests: float = constant(
        1e-6,
        unit="share of the largest standard deviation",
        origin="a column that varies less rests; [A] 6.4 says nothing of it",
    )


CLOUD = _Cloud()


@dataclass(frozen=True)
class _Recurrence(Thresholds):
    """Which stretches are proposed because their poses come back."""

    longest: float = constant(10.0, unit="seconds", origin="longest period; " + BY_EYE)
    shortest: float = constant(
        0.25, unit="seconds", origin="shortest period: the fastest cycles take .3 s"
    )
    returned: float = constant(
        0.2,
        unit="share of the largest squared distance on the way",
        origin="a pose that comes so near is back; " + BY_EYE,
    )
    window: float = constant(
        0.1,
        unit="seconds to either side",
        origin="long enough to tell a leg going forward from one going back, short against .3 s",
    )
    drift: float = constant(
        1.6, unit="factor of the median lag", origin="how far the tempo may drift; " + BY_EYE
    )
    jump: int = constant(2, unit="frames of lag a frame", origin=BY_EYE)
    gap: int = constant(3, unit="frames", origin=BY_EYE)
    fewest: int = constant(3, unit="frames of a return", origin=BY_EYE)
    least_repeat: float = constant(0.2, unit="periods along the path of poses", origin=BY_EYE)
    close: float = constant(
        0.05,
        unit="share of the largest squared distance on the way",
        origin="how near a return must be where nothing is seen twice; " + BY_EYE,
    )
    closeness: float = constant(
        0.15,
        unit="the same, a period seen again",
        origin="fewer returns must be nearer; " + BY_EYE,
    )
    overlap: float = constant(
        0.25, unit="periods", origin="a part with less of its own is no other motion; " + BY_EYE
    )
    alike: float = constant(
        0.1,
        unit="share of the loop's squared width",
        origin="how near poses with velocities of one motion are in two parts; " + BY_EYE,
    )
    alike_period: float = constant(
        0.67, unit="share of the mean period", origin="how far two periods may differ; " + BY_EYE
    )
    compared: int = constant(200, unit="poses of each part", origin="speed; " + BY_EYE)
    prominent_limbs: float = constant(
        4.0,
        unit="times the next bar",
        origin="where some limbs alone decide, more is asked of their loop; " + BY_EYE,
    )


RECURRENCE = _Recurrence()


@dataclass(frozen=True)
class _Closed(Thresholds):
    """Which takes are proposed as one closed period."""

    longest: float = constant(
        10.0, unit="seconds", origin="a longer capture that ends as it began is a take; " + BY_EYE
    )


CLOSED = _Closed()


@dataclass(frozen=True)
class _Excitation(Thresholds):
    """Where the coordinates of a whole capture turn."""

    landmarks: int = constant(500, unit="points", origin="as for the cloud of one motion")
    frames: int = constant(1000, unit="frames", origin="a longer capture is thinned; " + BY_EYE)
    rate: float = constant(24.0, unit="frames a second", origin="thinned to no fewer; " + BY_EYE)
    level: float = constant(
        0.05, unit="corrected p-value", origin="the usual level; Bobrowski and Skraba 2023"
    )
    share: float = constant(
        0.8,
        unit="share of a coordinate's variation",
        origin="[A] 4.6 takes regions of large variation without a number; " + BY_EYE,
    )
    slower: float = constant(
        0.5,
        unit="share of that rate",
        origin="so that a region with slower frames stays one; " + BY_EYE,
    )
    least: float = constant(0.3, unit="turns", origin=BY_EYE)
    window: float = constant(
        0.5, unit="seconds", origin="shorter rests do not divide a region; " + BY_EYE
    )


EXCITATION = _Excitation()


@dataclass(frozen=True)
class _Gestures(Thresholds):
    """Which excitation regions are occurrences of a gesture."""

    whole: float = constant(0.75, unit="turns", origin=BY_EYE)
    margin: float = constant(0.1, unit="share of a turn's time", origin=BY_EYE)
    gap: float = constant(0.25, unit="share of a turn's time", origin=BY_EYE)
    new: float = constant(
        0.5,
        unit="share of frames",
        origin="a class with fewer of its own is no other gesture; " + BY_EYE,
    )
    rate: float = constant(60.0, unit="frames a second", origin="as for short takes")
    often: int = constant(
        3, unit="occurrences", origin="fewest that are reported without being asked for; " + BY_EYE
    )


GESTURES = _Gestures()


@dataclass(frozen=True)
class _Evidence(Thresholds):
    """What is measured of one motion."""

    often: float = constant(
        4.0, unit="turns", origin="from so many on a class may have companions; " + BY_EYE
    )
    nearly: float = constant(
        1.5, unit="factor of bars and of turns", origin="how unlike companions may be; " + BY_EYE
    )
    same_phase: float = constant(0.25, unit="turns", origin=BY_EYE)
    sample: int = constant(128, unit="frames", origin="8128 pairs stand for any two; " + BY_EYE)
    again: float = constant(
        2.0,
        unit="a turn beyond the first",
        origin="what is seen half again counts in full for the confidence; " + BY_EYE,
    )
    cells: int = constant(
        8, unit="cells of a turn", origin="where pauses are looked for; " + BY_EYE
    )
    pause: float = constant(
        0.35, unit="periods", origin="a pause lasts longer than this in one cell; " + BY_EYE
    )
    slower: float = constant(
        1.0,
        unit="usual times of a cell, in addition",
        origin="a pause takes twice as long as usual; " + BY_EYE,
    )
    whole: float = constant(
        0.75, unit="turns", origin="what pauses leave must show so much; " + BY_EYE
    )


EVIDENCE = _Evidence()


@dataclass(frozen=True)
class _Verdict(Thresholds):
    """What a periodic motion must show."""

    least_turns: float = constant(
        1.02, unit="turns", origin="more than one, so that something is seen twice"
    )
    steady: float = constant(
        0.8,
        unit="net turns over all turns",
        origin="with enough turns, brings false positives on noise to 0-2 %: measured on an "
        "Ornstein-Uhlenbeck process",
    )
    enough_turns: float = constant(
        1.5, unit="turns", origin="the same measurement, where little of the take shows the motion"
    )
    share: float = constant(
        0.3,
        unit="share of the frames searched",
        origin="in a long take something comes back once by chance; " + BY_EYE,
    )
    unique_turns: float = constant(1.3, unit="turns", origin=BY_EYE)
    unique: float = constant(
        10.0, unit="times the next bar", origin="a loop that stands out so is no chance; " + BY_EYE
    )
    beyond: float = constant(
        0.5,
        unit="times the next bar, a turn beyond the first",
        origin="the less is seen twice, the more the loop must stand out; " + BY_EYE,
    )
    prominent: float = constant(
        1.5,
        unit="times the next bar",
        origin="enough for few turns, and for ends that meet; " + BY_EYE,
    )
    chance: float = constant(
        4.0,
        unit="prominence to the power of the turns",
        origin="chance of the confidence's formula at most a quarter; " + BY_EYE,
    )
    apart: float = constant(
        0.85,
        unit="share of the mean distance of any two poses",
        origin="motions that repeat lie below .72 in all captures looked at",
        margin="down to .72",
    )
    wider: float = constant(
        8.0, unit="times the gap between the ends", origin="width of a closed loop; " + BY_EYE
    )
    chosen_steps: float = constant(
        4.0, unit="usual steps", origin="gap of ends where frames were chosen by hand; " + BY_EYE
    )
    median_steps: float = constant(
        1.5, unit="median steps", origin="a usual step is no less than this; " + BY_EYE
    )
    usual: int = constant(
        95, unit="percentile of steps", origin="a usual step is no less than this; " + BY_EYE
    )


VERDICT = _Verdict()
