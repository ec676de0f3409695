"""The process that reads takes and makes loops, and how it is asked.

What strangers' files do to it costs the job alone: it has limits of memory and time, and where it
dies another one is begun with the next job.
"""

from __future__ import annotations

import multiprocessing
import signal
import time
import warnings
from collections.abc import AsyncGenerator, Iterator
from contextlib import aclosing
from multiprocessing.connection import Connection
from pathlib import Path
from threading import Thread
from typing import Any

import anyio
from anyio import to_thread

from roundelay.base.errors import Cancelled, in_one_line, input_errors
from roundelay.base.threads import one_thread
from roundelay.library.workers import Limits, end_with_parent, limit_memory, one_thread_each

__all__ = ["Analyst", "serve"]

# Seconds in which a job that was cancelled may end by itself, before its process is ended: another
# one would have to read and search the take again.
_PATIENCE = 4.0
# Seconds between two looks at the process, and between two tellings of progress.
_LOOK, _TOLD = 0.02, 0.1
_LIMITS = Limits(seconds=900.0, memory=8 << 30)
Event = dict[str, Any]


class Analyst:
    """Ask a process for jobs of `roundelay.studio.desk.Desk`, one at a time.

    Parameters
    ----------
    limits : Limits, optional
        What a job may take.
    """

    def __init__(self, limits: Limits | None = None) -> None:
        self._limits = limits or _LIMITS
        self._turn = anyio.Lock()
        self._begin()

    def _begin(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._stop = context.Event()
        # A daemon, which ends with this one.
        self._process = context.Process(
            target=serve, args=(theirs, self._stop, self._limits.memory), daemon=True
        )
        with one_thread_each():
            self._process.start()
        theirs.close()

    @property
    def pid(self) -> int | None:
        """The number of the process."""
        return self._process.pid

    def end(self) -> None:
        """End the process."""
        self._process.terminate()
        self._killed()
        self._pipe.close()

    async def asked(self, job: str, *arguments: Any) -> AsyncGenerator[Event]:
        """Have a job done; leaving the iterator cancels it.

        Parameters
        ----------
        job : str
            A method of `Desk`.
        *arguments
            Plain data.

        Yields
        ------
        dict
            The job's events, ``progress`` with the fraction done and the ``stage``, and ``error``,
            one line, where it failed.
        """
        async with self._turn:
            if not self._process.is_alive():
                self.end()
                self._begin()
            done = False
            try:
                self._stop.clear()
                self._pipe.send((job, arguments))
                async with aclosing(self._events()) as events:
                    async for event in events:
                        done = "done" in event or "error" in event
                        if "done" not in event:
                            yield event
            finally:
                if not done:
                    with anyio.CancelScope(shield=True):
                        await to_thread.run_sync(self._cancel)

    async def _events(self) -> AsyncGenerator[Event]:
        ends = time.monotonic() + (self._limits.seconds or float("inf"))
        while time.monotonic() < ends:
            try:
                # Looked at, not waited for: a browser that goes away must be heard.
                if not self._pipe.poll():
                    await anyio.sleep(_LOOK)
                    continue
                event = self._pipe.recv()
            except (EOFError, OSError):
                yield {"error": self._lost()}
                return
            yield event
            if "done" in event or "error" in event:
                return
        await to_thread.run_sync(self._killed)
        seconds = self._limits.seconds or 0.0
        yield {"error": f"expected an answer in {seconds:g} s, found none; give a shorter take"}

    def _lost(self) -> str:
        self._process.join(_PATIENCE)
        code = self._process.exitcode
        return (
            f"the process that reads takes ended (exit code {code}): it was killed, or memory was "
            "short; your work is kept, try again"
        )

    def _cancel(self) -> None:
        """Tell the job to stop; end a process that does not listen."""
        self._stop.set()
        ends = time.monotonic() + _PATIENCE
        try:
            while time.monotonic() < ends:
                if self._pipe.poll(_LOOK):
                    event = self._pipe.recv()
                    if "done" in event or "error" in event:
                        return
        except (EOFError, OSError):
            pass
        self._killed()

    def _killed(self) -> None:
        # Joined, so that nobody takes it for alive.
        self._process.kill()
        self._process.join()


def serve(pipe: Connection, stop: Any, memory: int | None) -> None:
    """Do the work of the process: jobs as they come, until the other end is gone."""
    for name in ("SIGINT", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    Thread(target=end_with_parent, daemon=True).start()
    limit_memory(memory)
    warnings.simplefilter("ignore")
    from roundelay.studio.desk import Desk

    told = 0.0

    def progress(fraction: float, stage: str) -> bool:
        nonlocal told
        if time.monotonic() - told > _TOLD:
            told = time.monotonic()
            pipe.send({"progress": fraction, "stage": stage})
        return not stop.is_set()

    desk = Desk(progress)
    with one_thread:
        while True:
            try:
                job, arguments = pipe.recv()
            except EOFError:
                return
            for event in _answers(desk, job, arguments):
                pipe.send(event)


def _answers(desk: Any, job: str, arguments: tuple[Any, ...]) -> Iterator[Event]:
    """Yield the events of a job; what it raises is told in one line."""
    try:
        yield from getattr(desk, job)(*arguments)
    except Cancelled:
        yield {"error": "stopped"}
    except input_errors() as error:
        line = " ".join(in_one_line(error).split())
        # The browser's user knows the file by its name, not by where it is kept.
        for path in (one for one in arguments if isinstance(one, str) and one):
            line = line.replace(str(Path(path)), Path(path).name)
        yield {"error": line}
    except Exception as error:
        yield {"error": f"a fault of roundelay, please report it: {type(error).__name__}: {error}"}
    else:
        yield {"done": True}
