# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in slices: at once where it is scripted, between redraws where it is clicked."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator
from concurrent.futures import ThreadPoolExecutor, wait
from typing import Any, ClassVar, TypeVar

import bpy

from roundelay import RoundelayError

from .compat import Context, State

Result = TypeVar("Result")
Steps = Generator[tuple[float, str], None, Result]
Progress = Callable[[float, str], bool]

_SLICE = 0.03


def threaded(call: Callable[[Progress], Result]) -> Steps[Result]:
    """Run a function that touches no Blender data in a thread, yielding its progress.

    Closing the generator lets the function's next report of progress cancel it.
    """
    state: tuple[float, str] = (0.0, "")
    running = True

    def progress(fraction: float, stage: str) -> bool:
        nonlocal state
        state = fraction, stage
        return running

    with ThreadPoolExecutor(1) as pool:
        future = pool.submit(call, progress)
        try:
            while wait([future], timeout=_SLICE).not_done:
                yield state
        finally:
            running = False
        return future.result()


def aside(call: Callable[[], Result]) -> Generator[float, None, Result]:
    """Run a function in a thread likewise; what is yielded says that it is nearly done."""
    steps = threaded(lambda _: call())
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value
        yield 0.99


class LongOperator:
    """Drive the generator `steps` of an operator to its end, a slice at a time, or cancel it.

    A subclass has `steps(context)`, which yields the fraction done with a text and returns one
    line for the panel.
    """

    busy: ClassVar[bool] = False
    _steps: Steps[str]
    _timer: Any = None

    def steps(self, context: Context) -> Steps[str]:
        """Do the work."""
        raise NotImplementedError

    def execute(self, context: Context) -> State:
        """Do all of it at once."""
        self._steps = self.steps(context)
        while (state := self._advance(context)) is None:
            pass
        return state

    def invoke(self, context: Context, event: bpy.types.Event) -> State:
        """Start the slices."""
        if bpy.app.background:
            return self.execute(context)
        LongOperator.busy = True
        self._steps = self.steps(context)
        self._timer = context.window_manager.event_timer_add(_SLICE, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: Context, event: bpy.types.Event) -> State:
        """Do one slice, or stop."""
        if event.type == "ESC":
            self.cancel(context)
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        state = self._advance(context)
        return {"RUNNING_MODAL"} if state is None else state

    def cancel(self, context: Context) -> None:
        """Stop the work; Blender calls this, too, when it loads another file."""
        self._steps.close()
        self._finish(context, "Cancelled")

    def _advance(self, context: Context) -> State | None:
        """Work for a slice; None as long as there is more."""
        until = time.monotonic() + _SLICE
        try:
            while time.monotonic() < until:
                self._show(context, *next(self._steps))
        except StopIteration as end:
            self._finish(context, end.value)
            return {"FINISHED"}
        except (RoundelayError, ValueError, OSError, RuntimeError) as error:
            message = (str(error).strip() or type(error).__name__).splitlines()[0]
            self._finish(context, message)
            self.report({"ERROR"}, message)  # type: ignore[attr-defined]
            return {"CANCELLED"}
        except BaseException:
            # A fault of the program is Blender's to show, but must not leave the buttons greyed.
            self._finish(context, "Stopped by a fault of the program")
            raise
        return None

    def _show(self, context: Context, fraction: float, text: str) -> None:
        settings = context.scene.roundelay
        settings.progress, settings.message = fraction, text
        _redraw(context)

    def _finish(self, context: Context, message: str) -> None:
        LongOperator.busy = False
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
        self._show(context, 0.0, message)


def _redraw(context: Context) -> None:
    for area in context.screen.areas if context.screen else ():
        area.tag_redraw()
