"""The linear algebra has one thread inside, and the caller's setting comes back."""

from __future__ import annotations

import subprocess
import sys
import threading

import pytest

import roundelay as rl
from roundelay import synth
from roundelay.base import threads
from roundelay.base.threads import OneThread, one_thread


class Library:
    """A stand-in that remembers what it was told."""

    def __init__(self, count: int | None = 4) -> None:
        self.count, self.told = count, []

    def get_num_threads(self) -> int | None:
        return self.count

    def set_num_threads(self, count: int) -> None:
        self.count = count
        self.told.append(count)


@pytest.fixture
def library(monkeypatch):
    found = Library()
    monkeypatch.setattr(threads, "_find_libraries", lambda: [found])
    return found


def test_inside_it_is_one_and_afterwards_what_it_was(library):
    with OneThread():
        assert library.count == 1
    assert library.told == [1, 4]


def test_after_an_error_it_is_what_it_was(library):
    with pytest.raises(KeyError), OneThread():
        raise KeyError
    assert library.told == [1, 4]


def test_nested_use_sets_nothing_again(library):
    one = OneThread()
    with one, one, one:
        pass
    assert library.told == [1, 4]


def test_a_decorated_function_is_itself(library):
    @OneThread()
    def told(number: int) -> list[int]:
        """Say what was told."""
        return [number, library.count]

    assert told(7) == [7, 1]
    assert (told.__name__, told.__doc__, library.count) == ("told", "Say what was told.", 4)


def test_of_two_threads_the_last_to_leave_restores(library):
    one, inside, leave = OneThread(), threading.Event(), threading.Event()

    def work() -> None:
        with one:
            inside.set()
            leave.wait(10)

    with one:
        other = threading.Thread(target=work)
        other.start()
        assert inside.wait(10)
    assert library.count == 1
    leave.set()
    other.join()
    assert library.told == [1, 4]


def test_many_threads_at_once_leave_the_setting(library):
    one, seen = OneThread(), []

    def work() -> None:
        for _ in range(300):
            with one:
                seen.append(library.count)

    workers = [threading.Thread(target=work) for _ in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert (set(seen), library.count) == ({1}, 4)


def test_a_library_of_one_or_no_thread_is_left_alone(monkeypatch):
    found = [Library(1), Library(None)]
    monkeypatch.setattr(threads, "_find_libraries", lambda: found)
    with OneThread():
        pass
    assert [library.told for library in found] == [[], []]


def test_a_library_loaded_later_is_found(monkeypatch):
    found = [Library()]
    monkeypatch.setattr(threads, "_find_libraries", lambda: list(found))
    one = OneThread()
    with one:
        pass
    found.append(Library())
    monkeypatch.setitem(sys.modules, "a_module_loaded_later", threads)
    with one:
        assert [library.count for library in found] == [1, 1]


# In a process of its own: that of the tests may be limited from outside.
COUNTS = """
import os
for library in ("OPENBLAS", "MKL", "OMP"):
    os.environ[f"{library}_NUM_THREADS"] = "2"
import threadpoolctl
import roundelay as rl
from roundelay import synth
def counts():
    return [one["num_threads"] for one in threadpoolctl.threadpool_info()]
seen = []
def told(fraction, stage):
    seen.append(counts())
"""


def shown(code: str) -> list[str]:
    command = [sys.executable, "-c", COUNTS + code]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.split("\n")


@pytest.mark.skipif(not threads._find_libraries(), reason="no library with threads is loaded")
@pytest.mark.parametrize("block", ["", "import sys; sys.modules['threadpoolctl'] = None"])
def test_the_callers_setting_is_as_before_with_and_without_threadpoolctl(block):
    code = f"""
{block}
walk, before = synth.gait("walk").motion, counts()
rl.find_cycles(walk, progress=told)
print(max(map(max, seen)), max(before), counts() == before)
def stop(fraction, stage):
    return False
try:
    rl.find_cycles(walk, progress=stop)
except rl.Cancelled:
    print(counts() == before)
"""
    assert shown(code)[:2] == ["1 2 True", "True"]


def test_importing_roundelay_does_not_import_threadpoolctl():
    code = "import sys, roundelay, roundelay.pipeline; print('threadpoolctl' in sys.modules)"
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


DOORS = {
    "find_cycles": lambda motion, cycle: rl.find_cycles(motion),
    "find_periodic": lambda motion, cycle: rl.find_periodic(motion),
    "make_cycle": lambda motion, cycle: rl.make_cycle(motion, cycle.evidence),
    "segment": lambda motion, cycle: rl.segment(motion),
    "quality": lambda motion, cycle: rl.quality(cycle, motion),
    "blend": lambda motion, cycle: rl.blend([cycle, cycle], [0.5, 0.5]),
    "excitations": lambda motion, cycle: rl.excitations(rl.point_cloud(motion)[:60], motion.fps),
    "point_cloud": lambda motion, cycle: rl.point_cloud(motion),
    "sample": lambda motion, cycle: cycle.sample(30),
}


@pytest.fixture(scope="module")
def walk():
    motion = synth.gait("walk").motion
    return motion, rl.find_cycles(motion)[0]


@pytest.mark.parametrize("door", DOORS)
def test_every_door_enters(door, walk, monkeypatch):
    """The first thing that a door does is to find and limit the libraries."""
    entered = []
    monkeypatch.setattr(OneThread, "_limit", lambda self: entered.append(door))
    monkeypatch.setattr(OneThread, "_restore", lambda self: entered.append(door))
    DOORS[door](*walk)
    assert entered[:2] == [door, door]
    assert len(entered) % 2 == 0
    assert one_thread._inside == 0
