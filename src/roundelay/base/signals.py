"""Signals that ask a program to end: all are taken as Ctrl-C is."""

from __future__ import annotations

import os
import signal
from types import FrameType
from typing import NoReturn

__all__ = ["end_at_once", "end_by_default", "end_in_order"]

_INTERRUPTED = 130
# Hang-up comes when the terminal is closed; Windows does not know it.
_ASKING = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)


def end_at_once() -> None:
    """End the process at a signal without a word: while it starts, there is nothing to lose."""
    _handled(_leave)


def end_in_order() -> None:
    """Raise KeyboardInterrupt at a signal, so that what is half done is cleared away."""
    _handled(_interrupt)


def end_by_default() -> None:
    """Leave signals to the system: while the process ends, there is nothing left to clear."""
    _handled(signal.SIG_DFL)


def _handled(handler: object) -> None:
    for number in _ASKING:
        # What the caller ignores stays ignored: nohup does so with hang-ups.
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, handler)  # type: ignore[arg-type]


def _leave(number: int, frame: FrameType | None) -> NoReturn:
    os._exit(_INTERRUPTED)


def _interrupt(number: int, frame: FrameType | None) -> NoReturn:
    raise KeyboardInterrupt
