"""Processes that die, raise, or are told to stop."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from roundelay.library.workers import Limits, spread


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


def test_a_task_that_takes_too_long_costs_itself_only():
    limits = Limits(seconds=10.0)  # a process may take some to start
    found = spread(slow, [1, 0, 0], 1, lost=lambda task: "lost", limits=limits, late=str)
    assert list(found) == ["1", 0, 0]
    assert multiprocessing.active_children() == []


def hungry(number: int) -> str:
    try:
        bytearray(number)
    except MemoryError:
        return "out of memory"
    return "done"


@pytest.mark.skipif(os.name == "nt", reason="Windows sets no such limit")
def test_a_task_has_no_more_memory_than_it_is_given():
    limits = Limits(memory=3 * 10**9)
    sizes = [10, 4 * 10**9, 10]
    found = spread(hungry, sizes, 1, lost=lambda task: "lost", limits=limits)
    assert list(found) == ["done", "out of memory", "done"]


@pytest.mark.parametrize("wrong", [{"seconds": 0.0}, {"memory": -1}, {"seconds": float("nan")}])
def test_limits_are_more_than_nothing(wrong):
    with pytest.raises(ValueError, match="of more than 0, found"):
        Limits(**wrong)


ORPHANS = """
import os, sys, time
from roundelay.library.workers import spread
from tests.library.test_workers import told

if __name__ == "__main__":
    results = spread(told, [(sys.argv[1], n) for n in (1, 2)], 2, lost=str)
    next(results)
"""


def told(task: tuple[str, int]) -> None:
    folder, number = task
    with open(f"{folder}/{number}.pid", "w") as file:
        file.write(f"{os.getpid()}\n")
    time.sleep(600.0)


def is_running(pid: int) -> bool:
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="the system does not tell")
def test_processes_end_when_the_first_is_killed(tmp_path):
    script = tmp_path / "orphans.py"
    script.write_text(ORPHANS)
    environment = os.environ | {"PYTHONPATH": os.getcwd()}
    first = subprocess.Popen([sys.executable, script, tmp_path], env=environment)
    until = time.monotonic() + 60.0
    files = [tmp_path / "1.pid", tmp_path / "2.pid"]
    while time.monotonic() < until and not all(f.exists() and f.read_text() for f in files):
        time.sleep(0.02)
    children = [int(file.read_text()) for file in files]
    assert all(map(is_running, children))
    first.kill()
    first.wait()
    while time.monotonic() < until and any(map(is_running, children)):
        time.sleep(0.02)
    assert not any(map(is_running, children))
