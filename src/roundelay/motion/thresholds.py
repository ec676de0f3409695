"""Thresholds of poses."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = ["FRAME", "GAPS", "POSES"]


@dataclass(frozen=True)
class _Poses(Thresholds):
    """What is made of poses before they are searched."""

    slope: float = constant(
        24.0,
        unit="parts of a period, to either side",
        origin="velocity over a twelfth of a period: long against noise, short against the motion",
    )
    rest_step: float = constant(
        5.0,
        unit="times the largest other step",
        origin="frames of a movement are never so far apart; " + BY_EYE,
    )
    rest_frames: int = constant(200, unit="frames", origin="steps that are looked at; " + BY_EYE)
    rest_fewest: int = constant(3, unit="steps", origin="fewer tell nothing; " + BY_EYE)
    shown: float = constant(
        0.5, unit="share of all joints", origin="known in a frame in which the body is seen"
    )


POSES = _Poses()


@dataclass(frozen=True)
class _Frame(Thresholds):
    """Which points are the trunk, and how the others hang on it."""

    frames: int = constant(
        200, unit="frames", origin="of a take from which the trunk's shape is learned; for speed"
    )
    rounds: int = constant(5, unit="rounds", origin="of shapes; they change no more")
    off: float = constant(
        5.0,
        unit="times its usual distance",
        origin="a point of the trunk that lies so far off its place carries no weight; " + BY_EYE,
    )
    line: float = constant(
        0.1, unit="width for the length", origin="a trunk no wider is a line; " + BY_EYE
    )
    lowest: float = constant(
        0.05, unit="quantile of the points", origin="is the lowest of a body; one may be wrong"
    )
    tail: float = constant(
        0.05, unit="share of the frames", origin="at either end that may be outliers; " + BY_EYE
    )
    noise: float = constant(
        0.005,
        unit="longest distance of points",
        origin="distances that change no more change by noise, some 8 mm of a person",
    )
    loose: float = constant(
        2.0,
        unit="times the third least change of a distance to the middle",
        origin="points whose distance changes no more are the trunk; " + BY_EYE,
    )
    nearness: float = constant(
        0.1,
        unit="change of a distance for its length",
        origin="of points that move together the nearer are linked; " + BY_EYE,
    )


FRAME = _Frame()


@dataclass(frozen=True)
class _Gaps(Thresholds):
    """What is put where points were not seen."""

    error: float = constant(
        0.04,
        unit="body sizes",
        origin="a gap is open if it would be filled with a larger error; some 7 cm of a person",
    )
    seen: float = constant(
        0.2, unit="share of the frames", origin="a point seen less often is left out; " + BY_EYE
    )
    likely: float = constant(
        0.6, unit="likelihood", origin="a keypoint less likely is missing: DeepLabCut's pcutoff"
    )
    outer: float = constant(
        0.8, unit="quantile of the points", origin="by which a body's size is told; " + BY_EYE
    )
    tries: int = constant(6, unit="gaps", origin="made to compare the ways of filling; for speed")
    speed: float = constant(
        0.05, unit="seconds", origin="to either side: speeds of limbs above the noise of markers"
    )
    shown: float = constant(
        0.35, unit="share of all points", origin="seen during a gap to tell what is missing"
    )
    nearest: int = constant(4, unit="frames", origin="most alike, whose mean is taken; " + BY_EYE)
    poses: int = constant(2000, unit="frames", origin="that are looked through; for speed")
    short: int = constant(
        3, unit="frames", origin="are filled by a line where nothing can be compared; " + BY_EYE
    )
    reach: int = constant(2, unit="frames", origin="to either side of one that may be an outlier")
    usual: float = constant(
        10.0, unit="times the usual distance", origin="of an outlier from the median around it"
    )
    apart: float = constant(
        0.03, unit="body sizes", origin="an outlier lies so far off at least; " + BY_EYE
    )


GAPS = _Gaps()
