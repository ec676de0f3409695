"""Thresholds of phase: tempo, curves, mixtures."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = ["CROSSFADE", "HARMONIC", "MIXTURE", "PHASE_MAP", "TEMPO"]


@dataclass(frozen=True)
class _Harmonic(Thresholds):
    """Harmonic regression."""

    least_penalty: float = constant(
        1e-9, unit="strength of the roughness penalty", origin="no smoothing at all"
    )
    largest_penalty: float = constant(
        1e-1, unit="strength of the roughness penalty", origin="hardly more than the mean"
    )
    penalties: int = constant(25, unit="strengths tried", origin=BY_EYE)
    least_freedom: float = constant(
        1e-3,
        unit="frames",
        origin="keeps cross-validation finite where coefficients are as many as frames",
    )
    bandwidth: float = constant(
        15.0,
        unit="Hz",
        origin="people's movement, foot strikes included, lies below: gait laboratories filter "
        "marker paths at 6 to 15 Hz",
    )
    fewest: int = constant(5, unit="harmonics", origin=BY_EYE)
    most: int = constant(60, unit="harmonics", origin="the bandwidth at 4 s; " + BY_EYE)


HARMONIC = _Harmonic()


@dataclass(frozen=True)
class _Crossfade(Thresholds):
    """How the ends of a run blend into each other."""

    shortest: float = constant(0.05, unit="turns", origin=BY_EYE)
    longest: float = constant(
        0.1, unit="turns", origin="where more is seen twice, as much as possible counts in full"
    )
    least: float = constant(
        1e-6, unit="weight", origin="frames at the very ends of a run stay in the regression"
    )


CROSSFADE = _Crossfade()


@dataclass(frozen=True)
class _Mixture(Thresholds):
    """The Gaussian mixture on the circle."""

    components: int = constant(30, unit="components", origin="[A] 6.1")
    iterations: int = constant(100, unit="steps", origin="[A] 6.1")
    least_variance: float = constant(1e-5, unit="turns squared", origin="[A] 6.1")


MIXTURE = _Mixture()


@dataclass(frozen=True)
class _PhaseMap(Thresholds):
    """The way from structure to time."""

    cells: int = constant(128, unit="cells of a turn", origin=BY_EYE)
    covered: float = constant(
        0.95, unit="share of the circle", origin="less than a period has no timing; " + BY_EYE
    )


PHASE_MAP = _PhaseMap()


@dataclass(frozen=True)
class _Tempo(Thresholds):
    """How steady the tempo is taken to be."""

    variance: float = constant(
        0.98, unit="share of the poses' variance", origin="axes that decide; speed; " + BY_EYE
    )
    widths: tuple[float, ...] = constant(
        (1.5, 0.5, 0.15, 0.05), unit="periods", origin="tried from the steadiest on; " + BY_EYE
    )
    tolerance: float = constant(
        0.01,
        unit="share of the poses' variance",
        origin="what a steadier tempo may leave unexplained; " + BY_EYE,
    )
    harmonics: int = constant(12, unit="harmonics", origin="enough to compare tempos; " + BY_EYE)
    reach: float = constant(
        0.06, unit="share of the period", origin="a line is up to 5 % off below two repetitions"
    )
    kernel: float = constant(
        4.0,
        unit="standard deviations",
        origin="where the Gaussian window ends: weights below .0004",
    )


TEMPO = _Tempo()
