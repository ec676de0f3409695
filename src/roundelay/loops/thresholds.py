"""Thresholds of what is said of loops."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = ["BY_HAND", "FIT", "GAIT", "LINT", "QUALITY", "UNITS", "VERDICT"]


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
    repetitions: float = constant(
        2.0, unit="repetitions", origin="fewer were not averaged all around; two were"
    )


VERDICT = _Verdict()


@dataclass(frozen=True)
class _ByHand(Thresholds):
    """Loops of frames that a person chose."""

    near: float = constant(
        0.15, unit="share of the range", origin="how far its ends may be moved; " + BY_EYE
    )
    shortest: float = constant(
        0.3, unit="seconds", origin="a step of a run lasts as long; nothing shorter is a loop"
    )
    speed: float = constant(
        0.1, unit="seconds", origin="by which speeds are weighed against poses; " + BY_EYE
    )


BY_HAND = _ByHand()


@dataclass(frozen=True)
class _Lint(Thresholds):
    """When a loop has a fault."""

    shortest: int = constant(
        8, unit="frames", origin="a period of fewer is none; as the search; " + BY_EYE
    )
    miscount: float = constant(
        0.65,
        unit="frames",
        origin="clean loops are .34 off in 98 of 100, a frame is 1: benchmark check",
    )
    most: int = constant(8, unit="steps across the join", origin="looked for; " + BY_EYE)
    parts: int = constant(100, unit="parts of a step", origin="tried; fine enough")
    unlike: float = constant(
        1.0,
        unit="steps left over for a step across the join",
        origin="a miscount leaves less, a jump of the pose more; " + BY_EYE,
    )
    slow: float = constant(
        0.05,
        unit="share of the fastest step",
        origin="where hardly anything moves, frames are not counted; " + BY_EYE,
    )
    same: float = constant(
        0.05, unit="steps", origin="a pose that comes again comes exactly; " + BY_EYE
    )
    pop: float = constant(
        2.2,
        unit="times the largest second difference elsewhere",
        origin="loops closed by hand reach 2.0, faults of 3 are found: benchmark check",
    )
    low: float = constant(
        0.025, unit="body sizes above a foot's lowest", origin="as geometry.contacts.begins_below"
    )
    in_place: float = constant(
        0.1,
        unit="share of the speed of standing feet",
        origin="a body slower than this stays in place; " + BY_EYE,
    )
    slide: float = constant(
        0.1,
        unit="body sizes a second",
        origin="98 of 100 clean loops stay below .05, faults of .15 are found: benchmark check",
    )
    climb: float = constant(
        0.03,
        unit="body sizes a period",
        origin="loops closed by hand reach .029, faults of .04 are found: benchmark check",
    )
    level: float = constant(
        0.25,
        unit="share of the climb",
        origin="on stairs standing feet rise less, as toes roll; benchmark check",
    )
    below: float = constant(
        0.9,
        unit="cosine of the angle to the vertical",
        origin="of the way from a root bone on the ground up to the body; " + BY_EYE,
    )
    ground: float = constant(
        0.1, unit="body sizes", origin="a root nearer to the lowest joint lies there; " + BY_EYE
    )
    bob: float = constant(0.005, unit="body sizes", origin="a centimetre for a person; " + BY_EYE)
    smallest: float = constant(
        0.3, unit="metres, or lengths of the file", origin="a cat, nose to tail; " + BY_EYE
    )
    tallest: float = constant(
        4.0, unit="metres", origin="a horse, nose to tail; people are 2; " + BY_EYE
    )
    longest: float = constant(
        3000.0,
        unit="lengths of the file",
        origin="of a person in millimetres, in formats without a unit; " + BY_EYE,
    )
    phase: float = constant(
        0.13,
        unit="turns of a stride",
        origin="in gaits that begin with a contact the foot is so far ahead: benchmark check",
    )
    set_least: int = constant(3, unit="gaits", origin="fewer have no phase in common; " + BY_EYE)


LINT = _Lint()


@dataclass(frozen=True)
class _Gait(Thresholds):
    """Which loops are gaits, and how long a stride may last."""

    share: float = constant(
        0.6, unit="share of power", origin="of one wave in how far the feet part; " + BY_EYE
    )
    reach: float = constant(
        0.1, unit="body sizes", origin="feet that part less do not walk; " + BY_EYE
    )
    shortest: float = constant(
        0.3, unit="seconds a stride", origin="a dog's run takes .37: benchmark check"
    )
    longest_walk: float = constant(
        2.4, unit="seconds a stride", origin="the slowest walk takes 2.3: benchmark check"
    )
    longest_run: float = constant(
        1.4, unit="seconds a stride", origin="runs and long steps take 1.3: benchmark check"
    )
    airborne: float = constant(
        0.56,
        unit="share of frames in which a foot is low",
        origin="lower for runs, whatever the frame rate: benchmark check",
    )
    far: float = constant(
        0.85,
        unit="body sizes a stride",
        origin="who steps so far is no slow walker: benchmark check",
    )


GAIT = _Gait()
