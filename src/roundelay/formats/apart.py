"""Read files by native libraries in a process of its own, with limits of time and memory.

What lies below such a library is code that a broken file may bring down. The process is a module
whose main function calls `answer`; it leaves what it read as an NPZ.
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from roundelay.base.errors import FormatError

__all__ = ["Library", "answer", "read_apart"]

# Of the process that reads; its libraries alone take some ten to load.
_SECONDS = 300.0
# Bytes that it may take.
_MEMORY = 8 << 30
# Letters of its last words.
_LONGEST = 500


@dataclass(frozen=True)
class Library:
    """Describe a library that reads files apart.

    Parameters
    ----------
    name : str
        As it is installed.
    module : str
        As it is imported.
    extra : str
        Of roundelay, which brings it.
    child : str
        The module of the process.
    holds : str
        What its files hold, for errors.
    """

    name: str
    module: str
    extra: str
    child: str
    holds: str

    def require(self, path: Path) -> None:
        """Check that the library is installed.

        Raises
        ------
        FormatError
            If it is not; the message says how to install it.
        """
        if importlib.util.find_spec(self.module) is None:
            told = f"expected the library {self.name} for this format, found none"
            raise FormatError(f"{told}: install roundelay[{self.extra}]", path=path)


@contextmanager
def read_apart(
    library: Library, path: Path, data: bytes, suffix: str, words: Sequence[str] = ()
) -> Iterator[Path]:
    """Give the NPZ that another process made of a file, for as long as the context lasts.

    Parameters
    ----------
    library : Library
    path : Path
        The file, for errors.
    data : bytes
        What it holds.
    suffix : str
        By which the library knows it.
    words : sequence of str
        Further arguments of the process.

    Raises
    ------
    FormatError
        If the library is not installed, or cannot read the file, dies or takes too long.
    """
    library.require(path)
    with tempfile.TemporaryDirectory() as folder:
        given, made = Path(folder) / f"given{suffix}", Path(folder) / "read.npz"
        given.write_bytes(data)
        command = [sys.executable, "-m", library.child, str(given), str(made), *words]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=_SECONDS)
        except subprocess.TimeoutExpired:
            told = f"expected a file that is read in {_SECONDS:g} s, found one that takes longer"
            raise FormatError(told, path=path) from None
        if done.returncode or not made.exists():
            lines = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
            # A library may say first where in itself it failed, and then why.
            why = lines[-1].replace(str(given), "the file").rpartition(" : ")[2]
            raise FormatError(f"expected {library.holds}, found: {why}", path=path)
        yield made


def answer(read: Callable[..., dict[str, Any]]) -> None:
    """Do the work of the process: arguments FILE NPZ and further words.

    The last line of standard error says what is wrong.

    Parameters
    ----------
    read : callable
        Takes the path of the file and the further words, and returns the arrays of the NPZ.
    """
    given, written, *words = sys.argv[1:]
    _limit_memory()
    try:
        np.savez(written, **read(Path(given), *words))
    except Exception as error:
        sys.exit((" ".join(str(error).split()) or type(error).__name__)[:_LONGEST])


def _limit_memory() -> None:
    try:
        import resource
    except ImportError:  # not on Windows
        return
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
