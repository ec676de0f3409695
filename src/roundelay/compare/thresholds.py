"""Thresholds of comparing cycles."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import Thresholds, constant

__all__ = ["GROUPS", "SPECTRA"]


@dataclass(frozen=True)
class _Spectra(Thresholds):
    """What is kept of a cycle to compare it."""

    harmonics: int = constant(
        8,
        unit="harmonics",
        origin="what is left out has an RMS of some .0005 body sizes in captured cycles, and "
        "enters squared",
    )
    phases: int = constant(128, unit="phases", origin="a cycle is taken at for its harmonics")
    offsets: int = constant(
        32,
        unit="offsets",
        origin="tried before a parabola finds the best: four for a wave of the last harmonic",
    )


SPECTRA = _Spectra()


@dataclass(frozen=True)
class _Groups(Thresholds):
    """Alike cycles of a library."""

    alike: float = constant(
        0.05,
        unit="body sizes, mean distance",
        origin="captured walks of six people, fast and slow, are joined below .047, runs of five "
        "people below .044; the walks and runs of CMU would be joined at .06 and .074",
        margin="from .047 to .06",
    )
    far: float = constant(
        1e6, unit="body sizes", origin="between cycles that cannot be compared: beyond all others"
    )


GROUPS = _Groups()
