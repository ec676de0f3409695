"""What a profile must do."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np

from roundelay import synth
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.edit.separate import Mended
from roundelay.loops.options import LoopOptions
from roundelay.loops.profiles import Profile
from roundelay.pipeline import find_cycles
from roundelay.testing.expecting import SECONDS, Subject

__all__ = ["check_profile"]

_WRITTEN = (
    LoopOptions(),
    LoopOptions(fps=24.0, periods=3, repeat_first=True),
    LoopOptions(fps=30.0, in_place=True),
)
_MENDED = Mended(("LeftHand", "LeftUpLeg"), ((0.1, 0.2),), 0.05)


def check_profile(profile: Profile) -> None:
    """Check that a profile tells of every loop as plain data.

    It is given a walk that turns and jumping jacks, sampled in several ways.

    - It has a name, and gives a dict that JSON can hold, without NaN, and that is not empty.
    - The same loop gives the same record.

    Parameters
    ----------
    profile : Profile

    Raises
    ------
    AssertionError
        If it does not.
    """
    subject = Subject("profile", profile)
    subject.expect_parts("record")
    for cycle in _cycles():
        for written in _WRITTEN:
            for mended in ((), (_MENDED,)):
                record = _record(subject, cycle, written, mended)
                again = _record(subject, cycle, written, mended)
                subject.expect(record == again, "the same record again", "another")


def _cycles() -> Iterator[Cycle]:
    yield find_cycles(synth.gait("walk", turning=0.3, fps=60.0).motion)[0]
    yield find_cycles(synth.gait("jacks", fps=60.0).motion)[0]


def _record(
    subject: Subject, cycle: Cycle, written: LoopOptions, mended: tuple[Mended, ...]
) -> dict[str, Any]:
    before = cycle.pose(np.zeros(1))
    record = subject.within(
        SECONDS, lambda: subject.item.record(cycle, written, mended), "telling of a loop"
    )
    subject.expect(isinstance(record, dict) and bool(record), "a dict", repr(record))
    try:
        plain = json.loads(json.dumps(record, allow_nan=False))
    except (TypeError, ValueError) as error:
        raise AssertionError(
            f"profile {subject.item.name!r}: expected JSON, found {error}"
        ) from None
    subject.expect(plain == record, "plain data: text keys, lists, numbers", record)
    same = np.array_equal(before, cycle.pose(np.zeros(1)))
    subject.expect(same, "a cycle left as it is", "a changed one")
    return plain
