"""Thresholds of poses."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = ["POSES"]


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


POSES = _Poses()
