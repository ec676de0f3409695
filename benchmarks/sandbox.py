"""Run a function on many inputs in a process of its own, with limits on time and memory."""

from __future__ import annotations

import multiprocessing
import resource
from collections.abc import Callable, Iterable, Iterator
from multiprocessing.connection import Connection
from typing import Any

__all__ = ["run"]

MEMORY = 4 << 30


def run(work: Callable[[Any], str], inputs: Iterable[Any], seconds: float) -> Iterator[str]:
    """Yield what `work` makes of each input; "hang" if it takes longer, "crash" if it dies."""
    worker: _Worker | None = None
    for one in inputs:
        worker = worker or _Worker(work)
        outcome = worker.ask(one, seconds)
        if outcome in ("hang", "crash"):
            worker.end()
            worker = None
        yield outcome
    if worker:
        worker.end()


class _Worker:
    def __init__(self, work: Callable[[Any], str]) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, there = context.Pipe()
        self.process = context.Process(target=_serve, args=(work, there), daemon=True)
        self.process.start()
        there.close()
        # Imports are not part of the first input's time.
        self.pipe.recv()

    def ask(self, one: Any, seconds: float) -> str:
        self.pipe.send(one)
        try:
            return self.pipe.recv() if self.pipe.poll(seconds) else "hang"
        except EOFError:
            return "crash"

    def end(self) -> None:
        self.process.kill()
        self.process.join()


def _serve(work: Callable[[Any], str], pipe: Connection) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    pipe.send("ready")
    while True:
        pipe.send(work(pipe.recv()))
