"""Thresholds of gait: steps, their moments, and what may not be known of them."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = ["SPREAD", "STEPS"]

_PLATES = "about the median moment at which the force plates of benchmarks.strides tell it"


@dataclass(frozen=True)
class _Steps(Thresholds):
    """Steps: which way a foot goes, and when it comes down and leaves."""

    least: float = constant(
        0.06,
        unit="body sizes",
        origin="a foot that goes to and fro by less makes no step; " + BY_EYE,
    )
    turn: float = constant(
        0.12,
        unit="share of the way of the foot to and fro",
        origin="by which it turns back at a step; " + BY_EYE,
    )
    travels: float = constant(
        0.3,
        unit="share of the speed of standing feet",
        origin="a body that is slower walks on a belt or in place; " + BY_EYE,
    )
    slow: float = constant(
        0.05, unit="body sizes a second", origin="a body that is slower goes nowhere; " + BY_EYE
    )
    steady: float = constant(
        0.5,
        unit="share of the speed of the ground",
        origin="by which low feet may differ from it; " + BY_EYE,
    )
    low: float = constant(
        0.3, unit="quantile of a foot's heights", origin="below it stands; " + BY_EYE
    )
    heel: float = constant(0.08, unit="share of its highest speed in a swing", origin=_PLATES)
    toe: float = constant(0.24, unit="share of its highest speed in a swing", origin=_PLATES)
    behind: float = constant(
        0.25,
        unit="share of the way from the ankle to the ball",
        origin="by which a heel lies behind the ankle; " + BY_EYE,
    )
    told: float = constant(
        0.8, unit="share of steps", origin="so many must be told by speed; " + BY_EYE
    )
    stray: float = constant(
        0.15,
        unit="seconds",
        origin="a moment by speed farther from that by place is none; Zeni's is early by up to "
        "60 ms on the plates",
    )
    together: float = constant(
        0.15,
        unit="share of a stride",
        origin="feet that come down so near to each other jump; " + BY_EYE,
    )
    unseen: float = constant(
        0.5, unit="share of the frames", origin="a foot that is seen less is told; " + BY_EYE
    )


STEPS = _Steps()


@dataclass(frozen=True)
class _Spread(Thresholds):
    """How sure a mean is."""

    related: float = constant(
        0.8,
        unit="correlation of neighbours",
        origin="a larger one of few strides is chance; " + BY_EYE,
    )
    blocks: int = constant(
        8, unit="blocks", origin="of fewer a draw tells no spread of its own; " + BY_EYE
    )
    fewest: int = constant(
        5, unit="strides", origin="with fewer the interval covers too little or all; " + BY_EYE
    )


SPREAD = _Spread()
