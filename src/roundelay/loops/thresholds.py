"""Thresholds of what is said of loops."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = ["FIT", "QUALITY", "UNITS", "VERDICT"]


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


@dataclass(frozen=True)
class _Units(Thresholds):
    """Units in which a body is a person's."""

    metres: tuple[float, ...] = constant(
        (1.0, 0.1, 0.01, 0.001, 0.0254, 0.0254 / 0.45),
        unit="metres",
        origin="m, dm (MakeHuman), cm, mm, inches, the unit of CMU's skeletons",
    )
    shortest: float = constant(
        1.7,
        unit="metres from hand to foot",
        origin="measured: people of 1.4 to 2.1 m, 1.2 to 1.37 times that along their bones",
    )
    longest: float = constant(2.8, unit="metres from hand to foot", origin="as the shortest")


UNITS = _Units()


@dataclass(frozen=True)
class _Verdict(Thresholds):
    """When a loop is not good."""

    jerks: float = constant(
        2.0,
        unit="times the largest acceleration elsewhere",
        origin="measured: at most 1.5 in 86 loops of captures; 1.6 to 16, in the median 4.5, where "
        "a period of a walk is repeated as it was cut out",
    )
    breaks: float = constant(
        4.0, unit="times the largest acceleration elsewhere", origin="half of such cuts are above"
    )
    slides: float = constant(
        0.015,
        unit="body sizes a period, more than in the capture",
        origin="some 3 cm; measured: 8 of 86 loops of captures are above, and by `worse`",
    )
    worse: float = constant(
        1.5, unit="times what slides in the capture", origin="less is the capture's own; " + BY_EYE
    )
    skids: float = constant(
        0.06,
        unit="body sizes a period, more than in the capture",
        origin="some 13 cm; measured: 1 of 86 loops of captures is above",
    )
    kept: float = constant(
        0.7,
        unit="share of a limb's amplitude in the usual repetition",
        origin="measured: 2 of 86 loops of captures are below",
    )
    lost: float = constant(
        0.4,
        unit="share of a limb's amplitude in the usual repetition",
        origin="measured: no loop of 86 captures is below",
    )
    moves: float = constant(
        0.02,
        unit="body sizes, RMS",
        origin="of a limb that moves by less no part is missed; " + BY_EYE,
    )
    repetitions: float = constant(
        2.0, unit="repetitions", origin="fewer were not averaged all around; two were"
    )


VERDICT = _Verdict()
