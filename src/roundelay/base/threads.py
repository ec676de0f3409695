"""One thread for the linear algebra while roundelay computes; the caller's setting comes back.

The matrices here are small: threads would only wait for each other.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Iterator
from contextlib import ContextDecorator
from pathlib import Path
from threading import Lock
from typing import Any, Protocol

import numpy as np

__all__ = ["OneThread", "one_thread"]


class _Library(Protocol):
    """A linear algebra library (BLAS) that this process has loaded."""

    def get_num_threads(self) -> int | None: ...
    def set_num_threads(self, num_threads: int, /) -> object: ...


class OneThread(ContextDecorator):
    """Keep the linear algebra to one thread: ``with one_thread:`` or ``@one_thread``.

    It may be nested and used from several threads at once: the first to enter sets, the last to
    leave restores, also after an error. The libraries are found by threadpoolctl; where that is
    not installed, only the OpenBLAS that a wheel of NumPy brings is found. They are looked for
    again when modules were imported since: SciPy loads a library of its own.
    """

    def __init__(self) -> None:
        self._lock, self._inside = Lock(), 0
        self._libraries: list[_Library] = []
        self._modules = 0
        self._before: list[tuple[_Library, int]] = []

    def __enter__(self) -> None:
        with self._lock:
            if not self._inside:
                self._limit()
            self._inside += 1

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._inside -= 1
            if not self._inside:
                self._restore()

    def _limit(self) -> None:
        if self._modules != len(sys.modules):
            self._libraries = _find_libraries()
            self._modules = len(sys.modules)
        found = ((library, library.get_num_threads()) for library in self._libraries)
        self._before = [(library, count) for library, count in found if count and count > 1]
        for library, _ in self._before:
            library.set_num_threads(1)

    def _restore(self) -> None:
        for library, count in self._before:
            library.set_num_threads(count)


def _find_libraries() -> list[_Library]:
    try:
        from threadpoolctl import ThreadpoolController
    except ImportError:
        return list(_of_numpy())
    found: list[_Library] = ThreadpoolController().select(user_api="blas").lib_controllers
    return found


def _of_numpy() -> Iterator[_Library]:
    """Find the OpenBLAS beside NumPy. It is loaded already: opening its file gives that one."""
    package = Path(np.__file__).parent
    for folder in (package.parent / "numpy.libs", package / ".dylibs"):
        for path in folder.glob("*openblas*"):
            library = ctypes.CDLL(str(path))
            for name in ("scipy_openblas_{}64_", "openblas_{}64_", "openblas_{}"):
                if hasattr(library, name.format("set_num_threads")):
                    yield _OpenBLAS(library, name)
                    break


class _OpenBLAS:
    def __init__(self, library: Any, name: str) -> None:
        self.get_num_threads = getattr(library, name.format("get_num_threads"))
        self.set_num_threads = getattr(library, name.format("set_num_threads"))


one_thread = OneThread()
