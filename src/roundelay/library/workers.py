"""Work spread over processes: one that dies costs its task alone, and all stop when told."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import islice
from multiprocessing.connection import Connection, wait
from typing import Any, Generic, NoReturn, TypeVar

from roundelay.base.threads import one_thread

__all__ = ["Limits", "end_with_parent", "in_child", "limit_memory", "one_thread_each", "spread"]

Task = TypeVar("Task")
Result = TypeVar("Result")

# Windows can wait for 63 handles at once; `concurrent.futures` stops at 61 processes, too.
_MOST = 61 if os.name == "nt" else sys.maxsize
# Seconds in which a process clears away what it was writing before it is ended hard.
_PATIENCE = 5.0


@dataclass(frozen=True)
class Limits:
    """What a task may take.

    Parameters
    ----------
    seconds : float, optional
        Of time; an hour by default, None for as long as it takes.
    memory : int, optional
        Bytes of addresses, where the system can limit them: not on Windows.
    """

    seconds: float | None = 3600.0
    memory: int | None = None

    def __post_init__(self) -> None:
        for what, value in (("seconds", self.seconds), ("memory", self.memory)):
            if value is not None and not value > 0:
                raise ValueError(f"expected {what} of more than 0, found {value:g}")


def spread(
    work: Callable[[Task], Result],
    tasks: Iterable[Task],
    jobs: int,
    lost: Callable[[Task], Result],
    *,
    limits: Limits | None = None,
    late: Callable[[Task], Result] | None = None,
) -> Generator[Result]:
    """Yield ``work(task)`` of every task as it is done.

    Closing the iterator ends the processes.

    Parameters
    ----------
    work : callable
        A function of a module. What it raises is raised here.
    tasks : iterable
    jobs : int
        How many processes, of which Windows allows 61; 1 without limits for this one.
    lost : callable
        Gives the result of a task whose process died, for instance for want of memory.
    limits : Limits, optional
        What a task may take.
    late : callable, optional
        Gives the result of a task that took longer; that of `lost` by default.
    """
    jobs = min(jobs, _MOST)
    if jobs == 1 and limits is None:
        yield from map(work, tasks)
        return
    limits, waiting = limits or Limits(), iter(tasks)
    workers: dict[Any, _Worker[Task, Result]] = {}
    try:
        for task in islice(waiting, jobs):
            worker = _Worker(work, task, limits)
            workers[worker.pipe] = worker
        while workers:
            for pipe in _ready(workers):
                result = workers[pipe].result(lost, late or lost)
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


_KEPT = threading.local()


def in_child(
    work: Callable[[Task], Result],
    task: Task,
    lost: Callable[[Task], Result],
    *,
    limits: Limits,
    late: Callable[[Task], Result],
) -> Result:
    """Return ``work(task)``, done in a child of this process, which is kept for the next task.

    Parameters
    ----------
    work : callable
        A function of a module, the same every time. What it raises is raised here.
    task
    lost : callable
        Gives the result if the child died.
    limits : Limits
        What the task may take, the same every time.
    late : callable
        Gives the result of a task that took longer.
    """
    # Processes that serve others may be told to have no children; this one ends its child itself.
    vars(multiprocessing.current_process())["_config"]["daemon"] = False
    kept: _Worker[Task, Result] | None = getattr(_KEPT, "worker", None)
    worker = _Worker(work, task, limits) if kept is None else kept.given(task)
    _KEPT.worker = worker
    _ready({worker.pipe: worker})
    return worker.result(lost, late)


class _Worker(Generic[Task, Result]):
    """A process and the task it is at."""

    def __init__(self, work: Callable[[Task], Result], task: Task, limits: Limits) -> None:
        # Not forked: threads of this process, such as a progress bar's, would not go along.
        context = multiprocessing.get_context("spawn")
        self.work, self.limits = work, limits
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(
            target=_serve, args=(work, theirs, limits.memory), daemon=True
        )
        with one_thread_each(), _uninterrupted():
            self.process.start()
        theirs.close()
        self.alive = self._sent(task)

    def given(self, task: Task) -> _Worker[Task, Result]:
        """Return a worker that is at the task: this one, or another if it is dead."""
        if self.alive and self._sent(task):
            return self
        return _Worker(self.work, task, self.limits)

    def _sent(self, task: Task) -> bool:
        """Send the task, and tell whether the process lives to get it."""
        self.task = task
        self.ends = time.monotonic() + (self.limits.seconds or float("inf"))
        try:
            self.pipe.send(task)
        except OSError:
            return False
        return True

    @property
    def left(self) -> float:
        """Seconds that its task still has."""
        return self.ends - time.monotonic()

    def result(self, lost: Callable[[Task], Result], late: Callable[[Task], Result]) -> Result:
        """Take the result that is there; one that is not, in its time, is late."""
        if not self.pipe.poll() and self.process.is_alive():
            self.alive = False
            self.end()
            return late(self.task)
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
        self.process.join(_PATIENCE)
        self.process.kill()
        self.process.join()


def _ready(workers: dict[Any, _Worker[Task, Result]]) -> list[Any]:
    """Wait until some have a result, died, or have no time left."""
    left = min(worker.left for worker in workers.values())
    ready = wait(list(workers), None if left == float("inf") else max(0.0, left))
    return ready or [pipe for pipe, worker in workers.items() if worker.left <= 0.0]


@one_thread
def _serve(work: Callable[[Task], Result], pipe: Connection, memory: int | None) -> None:
    # Ctrl-C and the terminal's end reach all processes of a terminal; the first one decides.
    for name in ("SIGINT", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _leave)
    threading.Thread(target=end_with_parent, daemon=True).start()
    limit_memory(memory)
    while True:
        try:
            task = pipe.recv()
        except EOFError:
            return
        try:
            result: Any = work(task)
        except Exception as error:
            result = error
        pipe.send(result)


def end_with_parent() -> None:
    """End this process when the first one is gone, however it went."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


def limit_memory(memory: int | None) -> None:
    """Let this process have no more memory than that, where the system can see to it."""
    if memory is None or os.name == "nt":
        return
    import resource

    # A limit that was set from outside, and is lower, stays.
    with suppress(ValueError):
        resource.setrlimit(resource.RLIMIT_AS, (memory, resource.getrlimit(resource.RLIMIT_AS)[1]))


def _leave(*_: object) -> NoReturn:
    """End as by an exception, so that no half-written file stays."""
    sys.exit()


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Keep Ctrl-C from processes begun here before they know what to do with it."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def one_thread_each() -> Iterator[None]:
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
