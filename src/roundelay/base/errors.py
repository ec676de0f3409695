"""The errors roundelay raises for bad input, as one tree.

::

    RoundelayError
    ├── FormatError        a file that is not what its format says (path, line, column)
    ├── SkeletonMismatch   skeletons or joints that do not fit together
    ├── TooShort           fewer frames than the method needs
    ├── NoPeriod           no periodic motion found (carries the evidence)
    ├── Unsolvable         points that tell no skeleton (what is missing)
    ├── LiftError          a cocycle mod p that is no integer cocycle
    ├── TooLarge           a problem that would not fit in memory
    ├── Locked             a folder that another run is at work on
    └── Cancelled          the caller's progress callback said stop

``RoundelayWarning`` is the category of warnings: the input is used, but not all as it is.
``RateAssumed`` is the one of them for files that tell no frame rate, ``GapsFilled`` that for what
was not seen of a take.

Wrong arguments (a negative frame rate, an unknown option) raise ``ValueError`` or
``TypeError`` as everywhere in Python.
"""

from __future__ import annotations

from os import PathLike
from typing import Any

__all__ = [
    "Cancelled",
    "FormatError",
    "GapsFilled",
    "LiftError",
    "Locked",
    "NoPeriod",
    "RateAssumed",
    "RoundelayError",
    "RoundelayWarning",
    "SkeletonMismatch",
    "TooLarge",
    "TooShort",
    "Unsolvable",
    "in_one_line",
    "input_errors",
]


class RoundelayError(Exception):
    """Base of every error that names a fault of the input rather than of the call.

    Examples
    --------
    >>> try:
    ...     rl.read("nowhere.xyz")
    ... except rl.RoundelayError as error:
    ...     print(type(error).__name__)
    FormatError
    """


class RoundelayWarning(UserWarning):
    """Say that input was used, but not all of it or not as it is.

    Examples
    --------
    >>> import warnings
    >>> warnings.simplefilter("ignore", rl.RoundelayWarning)  # no notes on what was read
    """


class FormatError(RoundelayError):
    """Report a file that is not what its format says.

    Parameters
    ----------
    message : str
        What was expected and what was found.
    path : path-like, optional
        The file.
    line, column : int, optional
        Where, counted from 1.

    Examples
    --------
    >>> try:
    ...     rl.read("broken.bvh")
    ... except rl.FormatError as error:
    ...     print(error)
    broken.bvh:1:1: expected HIERARCHY, found 'no'
    """

    def __init__(
        self,
        message: str,
        *,
        path: str | PathLike[str] | None = None,
        line: int | None = None,
        column: int | None = None,
    ) -> None:
        self.message, self.path, self.line, self.column = message, path, line, column
        place = [str(part) for part in (path, line, column) if part is not None]
        super().__init__(":".join(place) + ": " + message if place else message)


class RateAssumed(RoundelayWarning):
    """Say that a file tells no frame rate, and which is assumed."""


class GapsFilled(RoundelayWarning):
    """Say what was not seen of a take, and how that was filled."""


class SkeletonMismatch(RoundelayError):
    """Report skeletons or joints that do not fit together.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> try:
    ...     rl.find_cycles(walk, rl.Options(joints=("Tail",)))
    ... except rl.SkeletonMismatch as error:
    ...     print("no such joint")
    no such joint
    """


class TooShort(RoundelayError):
    """Report a capture with fewer frames than the method needs.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> try:
    ...     rl.find_cycles(walk[:5])
    ... except rl.TooShort as error:
    ...     print(error)
    a period needs at least 8 frames, found 5
    """


class NoPeriod(RoundelayError):
    """Report that no periodic motion was found.

    Attributes
    ----------
    evidence : object
        What was measured: the barcode and figures of the best candidate, or None.

    Examples
    --------
    >>> still = rl.concatenate([rl.read("walk.bvh")[:1]] * 100)
    >>> try:
    ...     rl.find_cycles(still)
    ... except rl.NoPeriod as error:
    ...     print(error)
    no periodic motion found: nothing moves against the root
    """

    def __init__(self, message: str, evidence: Any = None) -> None:
        super().__init__(message)
        self.evidence = evidence


class Unsolvable(RoundelayError):
    """Report points from which no skeleton can be solved, and what they lack."""


class LiftError(RoundelayError):
    """Report a cocycle mod p that could not be lifted to the integers, and what was tried."""


class TooLarge(RoundelayError):
    """Report a problem whose estimated memory exceeds what is there or allowed."""


class Locked(RoundelayError):
    """Report a folder that another process is at work on, and which process that is."""


class Cancelled(RoundelayError):
    """Report that the progress callback returned False.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> try:
    ...     rl.find_cycles(walk, progress=lambda fraction, stage: False)
    ... except rl.Cancelled:
    ...     print("stopped")
    stopped
    """


def input_errors() -> tuple[type[Exception], ...]:
    """Return the errors that are the input's, or the machine's, and no fault of the program."""
    return RoundelayError, ValueError, OSError, MemoryError


def in_one_line(error: Exception, capture: str | PathLike[str] | None = None) -> str:
    """Tell an error of the input in one line; one that names no file is that of the capture."""
    if isinstance(error, FormatError | ValueError):
        return str(error)
    if isinstance(error, OSError):
        return f"{error.filename or 'file'}: {error.strerror or error}"
    told = "out of memory" if isinstance(error, MemoryError) else str(error)
    return told if capture is None else f"{capture}: {told}"
