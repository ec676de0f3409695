"""Thresholds of cycles: how poses become one, and how one is edited."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = [
    "ABOVE",
    "ALIGNMENT",
    "CENTROID",
    "CONTINUITY",
    "CYCLE",
    "EVENTS",
    "FOOTLOCK",
    "REPAIR",
    "SWINGS",
    "TAKE",
    "VARIATION",
    "WEIGHTED",
]


@dataclass(frozen=True)
class _Continuity(Thresholds):
    """Signs of quaternions over the repetitions."""

    one_side: float = constant(
        0.3,
        unit="cosine of half an angle",
        origin="a pose within 145 degrees of the mean is on its side; " + BY_EYE,
    )
    glitches: float = constant(
        0.05, unit="share of the poses", origin="so few beyond are glitches; " + BY_EYE
    )
    beside: int = constant(
        3, unit="frames", origin="a glitch begins and ends beside its worst; " + BY_EYE
    )
    jump: float = constant(
        0.866,
        unit="cosine of half an angle",
        origin="a turn of more than 60 degrees from frame to frame is a jump; " + BY_EYE,
    )
    harmonics: int = constant(
        8, unit="harmonics", origin="enough to tell how runs lie to each other; " + BY_EYE
    )


CONTINUITY = _Continuity()


@dataclass(frozen=True)
class _Cycle(Thresholds):
    """Where a cycle goes."""

    travels: float = constant(
        0.05, unit="body sizes a period", origin="less is staying where it is; " + BY_EYE
    )
    climbs: float = constant(
        0.05,
        unit="body sizes a period",
        origin="stairs and ladders; less is the drift of a capture's floor; " + BY_EYE,
    )
    advance: float = constant(
        1e-6, unit="turns a frame", origin="keeps rates finite where the phase rests"
    )


CYCLE = _Cycle()


@dataclass(frozen=True)
class _Above(Thresholds):
    """Joints above the one that carries the body."""

    share: float = constant(
        0.5,
        unit="share of the body's rise, tilt, way or turn",
        origin="whoever does the larger part carries it",
    )


ABOVE = _Above()


@dataclass(frozen=True)
class _Events(Thresholds):
    """What happens in a cycle, and where it begins."""

    phases: int = constant(
        360, unit="phases", origin="looked at; a parabola finds the event between"
    )
    steps: float = constant(
        0.05,
        unit="body sizes",
        origin="a foot that goes to and fro by less makes no step; half of loops.gait.reach, which "
        "is of both feet",
    )
    alike: float = constant(
        0.75,
        unit="share of the largest distance from the mean pose",
        origin="poses so far may be the largest event, the highest is; " + BY_EYE,
    )


EVENTS = _Events()


@dataclass(frozen=True)
class _Centroid(Thresholds):
    """The typical trajectory of [A]."""

    samples: int = constant(500, unit="phases", origin="[A] 6.1")
    neighbours: int = constant(10, unit="frames", origin="[A] 6.1")


CENTROID = _Centroid()


@dataclass(frozen=True)
class _Take(Thresholds):
    """One repetition as it was played, and when it is taken."""

    least: float = constant(
        0.75,
        unit="turns",
        origin="what shows less is no repetition, however it is closed; " + BY_EYE,
    )
    reach: float = constant(
        0.04,
        unit="seconds",
        origin="on either side of an end, by which its velocity is told; " + BY_EYE,
    )
    kept: float = constant(
        0.8,
        unit="share of a limb's amplitude in the usual repetition",
        origin="a mean that keeps less has lost its accents; above loops.verdict.kept, below "
        "which a loop is complained about",
    )


TAKE = _Take()


@dataclass(frozen=True)
class _Swings(Thresholds):
    """How far limbs move."""

    moves: float = constant(
        0.02,
        unit="body sizes, RMS",
        origin="of a limb that moves by less no part is missed; " + BY_EYE,
    )


SWINGS = _Swings()


@dataclass(frozen=True)
class _Weighted(Thresholds):
    """The regression of [C]."""

    harmonics: int = constant(20, unit="harmonics", origin="K of [C]'s tables")
    farthest: float = constant(
        -0.95,
        unit="cosine of half an angle",
        origin="beyond 323 degrees the direction of a rotation vector is ill determined; " + BY_EYE,
    )


WEIGHTED = _Weighted()


@dataclass(frozen=True)
class _Alignment(Thresholds):
    """Two cycles in phase with each other."""

    phases: int = constant(128, unit="phases", origin="compared; a parabola finds the best between")


ALIGNMENT = _Alignment()


@dataclass(frozen=True)
class _Footlock(Thresholds):
    """Legs whose feet are held."""

    stretch: float = constant(
        0.9995, unit="share of the leg's length", origin="a leg is never quite straight; " + BY_EYE
    )
    damping: float = constant(
        0.6, unit="sine of the knee's angle", origin="below, a knee would snap; " + BY_EYE
    )


FOOTLOCK = _Footlock()


@dataclass(frozen=True)
class _Repair(Thresholds):
    """Cycles whose limbs are parted."""

    rate: float = constant(120.0, unit="frames a second", origin="at which a cycle is looked at")
    fewest: int = constant(64, unit="frames a period", origin=BY_EYE)
    most: int = constant(480, unit="frames a period", origin="for speed")
    ease: float = constant(
        0.1, unit="seconds", origin="a leg that leaves the ground becomes free to turn; " + BY_EYE
    )


REPAIR = _Repair()


@dataclass(frozen=True)
class _Variation(Thresholds):
    """Repetitions, and new ones drawn."""

    phases: int = constant(
        48, unit="phases a period", origin="at which repetitions are compared; " + BY_EYE
    )
    margin: int = constant(
        6,
        unit="phases",
        origin="to either side of a join over which one repetition fades into the next; " + BY_EYE,
    )
    steps: int = constant(64, unit="steps a period", origin="in which pace is summed; for speed")
    fewest: int = constant(
        4, unit="repetitions", origin="of three, one left out, modes tell nothing of the others"
    )
    modes: int = constant(8, unit="modes", origin="tried at most; for speed")
    gain: float = constant(
        0.01,
        unit="share of the squared error of the mean alone",
        origin="by which modes more must predict better; " + BY_EYE,
    )


VARIATION = _Variation()
