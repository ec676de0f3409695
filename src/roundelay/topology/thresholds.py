"""Thresholds of topology: coordinates, significance, lattices."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = ["COORDINATE", "LATTICE", "SIGNIFICANCE"]


@dataclass(frozen=True)
class _Coordinate(Thresholds):
    """At which scale a class becomes a coordinate, and how exactly."""

    life: float = constant(
        0.7,
        unit="share of the life of a class",
        origin="[A] 4.2 takes high scales by eye; low ones wind only the first repetition, high "
        "ones add jitter",
    )
    largest_step: float = constant(
        0.45, unit="turns along an edge", origin="a coordinate is sound below .5"
    )
    highest: float = constant(
        0.95, unit="share of the life of a class", origin="the first scale tried; " + BY_EYE
    )
    lowest: float = constant(
        0.15, unit="share of the life of a class", origin="the last scale tried; " + BY_EYE
    )
    scales: int = constant(
        8, unit="scales tried", origin="single scales can be bad; about 8 did on 61 walks and runs"
    )
    slack: float = constant(
        0.1,
        unit="turns",
        origin="scales so near to the best count as good; " + BY_EYE,
    )
    scouts: int = constant(
        256, unit="points", origin="enough to compare scales; chosen for speed in the first version"
    )
    scouting: float = constant(
        1e-3, unit="relative residual", origin="of the solver while scales are compared; for speed"
    )
    tolerance: float = constant(
        1e-9, unit="relative residual", origin="of the solver: rounding, far below any use"
    )


COORDINATE = _Coordinate()


@dataclass(frozen=True)
class _Significance(Thresholds):
    """Which bars are more than noise."""

    level: float = constant(
        0.05, unit="corrected p-value", origin="the usual level; Bobrowski and Skraba 2023"
    )


SIGNIFICANCE = _Significance()


@dataclass(frozen=True)
class _Lattice(Thresholds):
    """Reduction of lattices."""

    lovasz: float = constant(
        0.99, unit="1", origin="Lenstra, Lenstra, Lovasz 1982 allow .25 to 1; .99 is usual"
    )
    life: float = constant(
        0.7, unit="share of the time that classes live together", origin="as for one class"
    )


LATTICE = _Lattice()
