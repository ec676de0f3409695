"""Processes that die, raise, or are told to stop."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time

import pytest

from roundelay.library.workers import spread


def doubled(number: int) -> int:
    if number == 3:
        os._exit(1)
    if number == 5:
        raise OSError(28, "No space left on device")
    return 2 * number


def last(number: int) -> int:
    threading.Timer(0.1, os._exit, (1,)).start()
    return number


def blocked(_: int) -> bool:
    return signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ())


def process(_: int) -> int:
    return os.getpid()


def slow(number: int) -> int:
    time.sleep(0.0 if number == 0 else 600.0)
    return number


def test_a_process_that_dies_costs_its_task_only():
    found = spread(doubled, [1, 2, 3, 4, 6, 7], 2, lost=lambda task: -task)
    assert sorted(found) == [-3, 2, 4, 8, 12, 14]


def test_a_process_that_dies_between_tasks_costs_none():
    results = []
    for result in spread(last, [1, 2, 3, 4], 2, lost=lambda task: -task):
        results.append(result)
        if len(results) == 1:
            # By then the other process has sent its result and is gone.
            time.sleep(1.0)
    assert sorted(map(abs, results)) == [1, 2, 3, 4]
    assert {1, 2, 3} < set(results)


def test_no_more_processes_than_the_system_can_wait_for(monkeypatch):
    monkeypatch.setattr("roundelay.library.workers._MOST", 2)
    assert len(set(spread(process, range(6), 6, lost=lambda task: -task))) <= 2


def test_what_work_raises_is_raised():
    with pytest.raises(OSError, match="No space left"):
        list(spread(doubled, [1, 5], 2, lost=lambda task: -task))
    assert multiprocessing.active_children() == []


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="Windows has no signal masks")
def test_processes_begin_with_interrupts_blocked():
    masks = spread(blocked, [1, 2], 2, lost=lambda task: False)
    assert list(masks) == [True, True]
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())


def test_closing_ends_the_processes():
    found = spread(slow, [0, 1, 2], 2, lost=lambda task: -task)
    assert next(found) == 0
    found.close()
    assert multiprocessing.active_children() == []
