"""What the checks share: how they complain, wait, and compare."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from threading import Thread
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from roundelay.motion.motion import Motion

__all__ = ["SECONDS", "Subject", "check_suffixes", "padded", "same_motion"]

Array = NDArray[np.float64]
Result = TypeVar("Result")

SECONDS = 30.0
"""What takes longer than this is said to hang."""


@dataclass(frozen=True)
class Subject:
    """What is checked, as complaints name it.

    Parameters
    ----------
    kind : str
        In words: "reader".
    item : object
    """

    kind: str
    item: Any

    def expect(self, holds: bool, expected: str, found: object) -> None:
        """Complain unless something holds.

        Raises
        ------
        AssertionError
            What was expected and what was found.
        """
        if not holds:
            name = getattr(self.item, "name", self.item)
            raise AssertionError(f"{self.kind} {name!r}: expected {expected}, found {found}")

    def expect_parts(self, *methods: str) -> None:
        """Complain unless there is a name, and methods that can be called."""
        name = getattr(self.item, "name", None)
        self.expect(isinstance(name, str) and bool(name), "a name", repr(name))
        for method in methods:
            lacks = not callable(getattr(self.item, method, None))
            self.expect(not lacks, f"a method {method}", "none")

    def within(self, seconds: float, work: Callable[[], Result], what: str) -> Result:
        """Return what work gives, or raise what it raises; complain if it takes too long."""
        done: list[Result] = []
        raised: list[BaseException] = []

        def run() -> None:
            try:
                done.append(work())
            except BaseException as error:
                raised.append(error)

        # A daemon: what hangs must not keep the program from ending.
        thread = Thread(target=run, daemon=True)
        thread.start()
        thread.join(seconds)
        self.expect(bool(done or raised), f"an end within {seconds:g} s of {what}", "none")
        if raised:
            raise raised[0]
        return done[0]


def check_suffixes(subject: Subject) -> None:
    """Complain unless suffixes are in small letters, with one dot in front."""
    suffixes = getattr(subject.item, "suffixes", None)
    fits = isinstance(suffixes, tuple) and len(suffixes) > 0
    subject.expect(fits, "suffixes as a tuple, at least one", repr(suffixes))
    for suffix in suffixes or ():
        plain = suffix[:1] == "." and "." not in suffix[1:] and suffix == suffix.lower() != "."
        subject.expect(plain, 'suffixes like ".abc", in small letters', repr(suffix))


def same_motion(first: Motion, second: Motion) -> bool:
    """Tell whether two motions are the same in every number and name."""
    return (
        first.skeleton.names == second.skeleton.names
        and first.frame_time == second.frame_time
        and np.array_equal(first.rotations, second.rotations)
        and np.array_equal(first.root_path, second.root_path)
        and np.array_equal(first.positions(), second.positions())
    )


def padded(values: Array, before: int) -> Array:
    """Put so many frames of NaN before values (F,)."""
    return np.concatenate([np.full(before, np.nan), values])
