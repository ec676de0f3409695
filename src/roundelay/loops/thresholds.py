"""Thresholds of what is said of loops."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = ["FIT", "QUALITY"]


@dataclass(frozen=True)
class _Fit(Thresholds):
    """How a loop is laid against its capture."""

    phases: int = constant(256, unit="phases", origin="tried; " + BY_EYE)
    frames: int = constant(4096, unit="frames of a run", origin="that decide; for speed")


FIT = _Fit()


@dataclass(frozen=True)
class _Quality(Thresholds):
    """Figures of a loop."""

    cells: int = constant(32, unit="cells of a turn", origin="looked for in the capture; " + BY_EYE)
    usual: int = constant(
        95, unit="percentile of changes of velocity", origin="the capture's; " + BY_EYE
    )


QUALITY = _Quality()
