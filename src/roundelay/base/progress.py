"""Progress of long work: one callback type, whose False cancels."""

from __future__ import annotations

from collections.abc import Callable

from roundelay.base.errors import Cancelled

__all__ = ["Progress", "report"]

Progress = Callable[[float, str], bool | None]
"""``progress(fraction, stage)`` with the fraction done in [0, 1]; returning False cancels."""


def report(progress: Progress | None, fraction: float, stage: str) -> None:
    """Tell the callback how far the work is.

    Raises
    ------
    Cancelled
        If the callback returns False.
    """
    if progress is not None and progress(fraction, stage) is False:
        raise Cancelled(f"cancelled during {stage} ({fraction:.0%} done)")
