"""Work spread over processes: one that dies costs its task alone, and all stop when told."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from itertools import islice
from multiprocessing.connection import Connection, wait
from typing import Any, Generic, NoReturn, TypeVar

from roundelay.base.threads import one_thread

__all__ = ["spread"]

Task = TypeVar("Task")
Result = TypeVar("Result")

# Windows can wait for 63 handles at once; `concurrent.futures` stops at 61 processes, too.
_MOST = 61 if os.name == "nt" else sys.maxsize


def spread(
    work: Callable[[Task], Result],
    tasks: Iterable[Task],
    jobs: int,
    lost: Callable[[Task], Result],
) -> Generator[Result]:
    """Yield ``work(task)`` of every task as it is done.

    Closing the iterator ends the processes.

    Parameters
    ----------
    work : callable
        A function of a module. What it raises is raised here.
    tasks : iterable
    jobs : int
        How many processes, of which Windows allows 61; 1 for this one.
    lost : callable
        Gives the result of a task whose process died, for instance for want of memory.
    """
    jobs = min(jobs, _MOST)
    if jobs == 1:
        yield from map(work, tasks)
        return
    waiting = iter(tasks)
    workers: dict[Any, _Worker[Task, Result]] = {}
    try:
        for task in islice(waiting, jobs):
            worker = _Worker(work, task)
            workers[worker.pipe] = worker
        while workers:
            for pipe in wait(list(workers)):
                result = workers[pipe].result(lost)
                worker = workers.pop(pipe)
                try:
                    busy = worker.given(next(waiting))
                    workers[busy.pipe] = busy
                except StopIteration:
                    worker.end()
                yield result
    finally:
        for worker in workers.values():
            worker.end()


class _Worker(Generic[Task, Result]):
    """A process and the task it is at."""

    def __init__(self, work: Callable[[Task], Result], task: Task) -> None:
        # Not forked: threads of this process, such as a progress bar's, would not go along.
        context = multiprocessing.get_context("spawn")
        self.work = work
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(work, theirs), daemon=True)
        with _one_thread_each(), _uninterrupted():
            self.process.start()
        theirs.close()
        self.alive = self._sent(task)

    def given(self, task: Task) -> _Worker[Task, Result]:
        """Return a worker that is at the task: this one, or another if it is dead."""
        return self if self.alive and self._sent(task) else _Worker(self.work, task)

    def _sent(self, task: Task) -> bool:
        """Send the task, and tell whether the process lives to get it."""
        self.task = task
        try:
            self.pipe.send(task)
        except OSError:
            return False
        return True

    def result(self, lost: Callable[[Task], Result]) -> Result:
        try:
            result = self.pipe.recv()
        except (EOFError, OSError):
            self.alive = False
            return lost(self.task)
        if isinstance(result, Exception):
            raise result
        return result

    def end(self) -> None:
        self.process.terminate()
        self.process.join()


@one_thread
def _serve(work: Callable[[Task], Result], pipe: Connection) -> None:
    # Ctrl-C reaches all processes of a terminal; the first one decides.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _leave)
    while True:
        try:
            task = pipe.recv()
        except EOFError:
            return
        try:
            pipe.send(work(task))
        except Exception as error:
            pipe.send(error)


def _leave(*_: object) -> NoReturn:
    """End as by an exception, so that no half-written file stays."""
    sys.exit()


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Keep Ctrl-C from processes begun here before they know what to do with it."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Let processes begun here load the linear algebra without a pool of threads.

    They never use one, and a pool a process is many threads where there are many processors.
    """
    names = [f"{library}_NUM_THREADS" for library in ("OPENBLAS", "MKL", "OMP")]
    ours = [name for name in names if name not in os.environ]
    os.environ.update(dict.fromkeys(ours, "1"))
    try:
        yield
    finally:
        for name in ours:
            del os.environ[name]
