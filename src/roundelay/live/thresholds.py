"""Thresholds of what is told frame by frame."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = ["FIND", "TRACK"]


@dataclass(frozen=True)
class _Track(Thresholds):
    """The phase of a known cycle."""

    phases: int = constant(120, unit="phases a period", origin="compared; a step between is told")
    modes: int = constant(12, unit="components", origin="of the poses of a cycle; for speed")
    looks: int = constant(
        60, unit="times a period", origin="all phases are looked at; more at low rates, for speed"
    )
    delay: float = constant(
        0.05, unit="periods", origin="over which the speed of a pose is taken; " + BY_EYE
    )
    phase_gain: float = constant(
        0.05, unit="periods", origin="in which an error of the phase is taken back; " + BY_EYE
    )
    memory: float = constant(
        0.35, unit="periods", origin="over which poses tell the phase of who is found; " + BY_EYE
    )
    posture: float = constant(
        2.0, unit="periods", origin="over which another posture is learnt; " + BY_EYE
    )
    sure: float = constant(
        0.25, unit="periods", origin="over which confidence is averaged; " + BY_EYE
    )
    lost: float = constant(0.5, unit="confidence", origin="below it is lost; " + BY_EYE)
    better: float = constant(
        0.15,
        unit="mean squared error over the spread of poses",
        origin="by which another phase must fit better to go there; " + BY_EYE,
    )
    rate: float = constant(
        0.02,
        unit="share",
        origin="by which a motion's rate may differ from the one told; " + BY_EYE,
    )
    still: float = constant(
        1e-4, unit="body sizes", origin="a cycle whose poses spread less does not move"
    )
    pace: float = constant(
        2.5, unit="times", origin="the cycle's pace that is followed, faster or slower; " + BY_EYE
    )


TRACK = _Track()


@dataclass(frozen=True)
class _Find(Thresholds):
    """A period of no cycle that is known."""

    rate: float = constant(30.0, unit="frames a second", origin="looked at; for speed")
    signals: int = constant(
        24, unit="signals", origin="random mixtures that keep distances of poses; for speed"
    )
    shortest: float = constant(0.3, unit="seconds", origin="period; " + BY_EYE)
    longest: float = constant(5.0, unit="seconds", origin="period; for speed")
    like: float = constant(
        0.2,
        unit="mean squared distance over that of poses at random",
        origin="of three repetitions from each other; walks of truth have .03 to .17, random "
        "motion seldom below .4",
    )
    unlike: float = constant(
        0.6, unit="of the same", origin="of poses a part of the period apart; " + BY_EYE
    )
    near: float = constant(
        0.15, unit="share of the period", origin="by which one that goes on may change; " + BY_EYE
    )
    moves: float = constant(
        0.01, unit="body sizes", origin="spread of poses below which nothing moves; " + BY_EYE
    )


FIND = _Find()
