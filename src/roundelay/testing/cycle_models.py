"""What a cycle model must do."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from roundelay import synth
from roundelay.base.errors import TooShort
from roundelay.base.spans import Spans
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.models import CycleModel
from roundelay.geometry import rotations as rot
from roundelay.loops.quality import quality
from roundelay.motion.features import point_cloud
from roundelay.motion.motion import Motion, concatenate
from roundelay.phase.tempo import time_phase
from roundelay.pipeline import find_periodic
from roundelay.testing.expecting import SECONDS, Subject, padded
from roundelay.timeline.evidence import Evidence
from roundelay.timeline.options import Options

__all__ = ["check_cycle_model"]

Array = NDArray[np.float64]

_RATE = 60.0
# Shares by which a period may miss the truth, and of the error of a still pose that is allowed.
_PERIOD, _LIKE = 0.05, 0.5
# How much larger than any other step of the loop the step across the seam may be.
_SEAM = 2.0
# Radians that count as none, and the frames put before a capture.
_CLOSE, _BEFORE = 1e-6, 45


@dataclass(frozen=True, eq=False)
class _Given:
    """What a model is given."""

    motion: Motion
    phase: Array
    evidence: Evidence


def check_cycle_model(model: CycleModel) -> None:
    """Check that a model makes closed cycles that are like their captures.

    Captures are made whose period is known: a walk that turns, and jumping jacks.

    - It has a name, and gives a `Cycle` of the capture's skeleton that carries the evidence.
    - The period is within 5 % of the truth.
    - A sampled period ends where the next begins: the step across the seam is no more than twice
      the largest elsewhere, and the root has moved by the cycle's travel.
    - It differs from the capture by less than half of what a still pose does.
    - The same input gives the same cycle; whole turns added to the phase, and frames that do
      not count, change nothing.
    - A phase that stands still is `TooShort`; so may be less than a period, and nothing else.

    Parameters
    ----------
    model : CycleModel

    Raises
    ------
    AssertionError
        If it does not.
    """
    subject = Subject("cycle model", model)
    subject.expect_parts("fit")
    walk = synth.gait("walk", repetitions=4.3, turning=0.3, fps=_RATE)
    jacks = synth.gait("jacks", repetitions=2.3, fps=_RATE)
    for made in (walk, jacks):
        given = _given(made.motion)
        cycle = _fitted(subject, given)
        away = abs(cycle.period / made.period - 1.0)
        found = f"{cycle.period:.3f} s"
        subject.expect(away < _PERIOD, f"a period near {made.period:.3f} s", found)
        _check_closed(subject, cycle)
        _check_like(subject, cycle, given)
    _check_same(subject, cycle, given)
    _check_short(subject, given)


def _given(motion: Motion) -> _Given:
    motion = motion.with_root_motion()
    evidence = find_periodic(motion)[0]
    points, runs = point_cloud(motion), evidence.runs
    phase = time_phase(points, evidence.turns, runs, frame_time=motion.frame_time)
    return _Given(motion, phase, evidence)


def _fitted(subject: Subject, given: _Given) -> Cycle:
    phase = given.phase.copy()

    def work() -> object:
        return subject.item.fit(given.motion, phase, given.evidence, Options())

    cycle = subject.within(SECONDS, work, "fitting")
    subject.expect(isinstance(cycle, Cycle), "a Cycle", repr(cycle))
    assert isinstance(cycle, Cycle)
    same = np.array_equal(phase, given.phase, equal_nan=True)
    subject.expect(same, "a phase left as it is", "a changed one")
    names, evidence = cycle.skeleton.names, cycle.evidence
    subject.expect(names == given.motion.skeleton.names, "the capture's joints", names)
    subject.expect(evidence is given.evidence, "the evidence in the cycle", repr(evidence))
    return cycle


def _check_closed(subject: Subject, cycle: Cycle) -> None:
    loop = cycle.sample(in_place=True, repeat_first=True, foot_lock=False)
    steps = rot.angle_between(loop.rotations[1:], loop.rotations[:-1])
    most = float(steps[:-1].max())
    seam = float(rot.angle_between(loop.rotations[0], loop.rotations[-1]).max())
    subject.expect(seam < _CLOSE, "a last pose that is the first again", f"{seam:.2g} rad apart")
    subject.expect(
        float(steps[-1].max()) <= _SEAM * most,
        f"a step across the seam of at most {_SEAM:g} times the largest elsewhere, {most:.2g} rad",
        f"{steps[-1].max():.2g} rad",
    )
    path = cycle.sample(repeat_first=True).root_path
    away = float(np.abs(path[-1] - path[0] - cycle.travel).max())
    close = away < _CLOSE * max(1.0, cycle.skeleton.size)
    subject.expect(close, "a root that moves by the travel", f"{away:.2g} off")


def _check_like(subject: Subject, cycle: Cycle, given: _Given) -> None:
    error = quality(cycle, given.motion).template_error
    capture = given.motion.rotations[given.evidence.runs.frames, 1:]
    still = rot.angle_between(capture, rot.mean(capture))
    limit = _LIKE * float(np.sqrt(np.mean(np.sum(still**2, axis=1))))
    subject.expect(error < limit, f"a template error below {limit:.2g} rad", f"{error:.2g}")


def _check_same(subject: Subject, cycle: Cycle, given: _Given) -> None:
    others = {
        "of the same input": given,
        "of a phase three turns on": replace(given, phase=given.phase + 3.0),
        "with other frames before": _later(given),
    }
    grid = np.linspace(0.0, 1.0, 64, endpoint=False)
    for what, other in others.items():
        again = _fitted(subject, other)
        turned = rot.angle_between(cycle.rotations(grid), again.rotations(grid))
        # An angle of one float's rounding is some 1e-8.
        away = max(float(turned.max()), abs(again.period - cycle.period))
        subject.expect(away < _CLOSE, f"the same cycle {what}", f"one {away:.2g} rad or s off")


def _later(given: _Given) -> _Given:
    before = synth.wander(_BEFORE / _RATE, fps=_RATE).motion[:_BEFORE]
    before = before.with_root_motion()
    shifted = [(start + _BEFORE, stop + _BEFORE) for start, stop in given.evidence.runs]
    turns = padded(given.evidence.turns, _BEFORE)
    return _Given(
        concatenate([before, given.motion]),
        padded(given.phase, _BEFORE),
        replace(given.evidence, runs=Spans(shifted), turns=turns),
    )


def _check_short(subject: Subject, given: _Given) -> None:
    start = given.evidence.runs[0][0]
    run = (start, start + round(0.4 * given.evidence.period))
    inside = np.zeros(len(given.motion), bool)
    inside[slice(*run)] = True
    turns = np.where(inside, given.evidence.turns, np.nan)
    evidence = replace(given.evidence, runs=Spans([run]), turns=turns)
    part = _Given(given.motion, np.where(inside, given.phase, np.nan), evidence)
    _refused(subject, part, "less than a period")
    still = replace(given, phase=np.where(np.isfinite(given.phase), 0.25, np.nan))
    refused = _refused(subject, still, "a phase that stands still")
    subject.expect(refused, "TooShort for a phase that stands still", "a cycle")


def _refused(subject: Subject, given: _Given, what: str) -> bool:
    """Tell whether the model says TooShort, and complain if it says anything else."""
    try:
        _fitted(subject, given)
    except TooShort:
        return True
    except AssertionError:
        raise
    except Exception as error:
        subject.expect(False, f"a cycle or TooShort for {what}", repr(error))
    return False
