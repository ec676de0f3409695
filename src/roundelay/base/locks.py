"""One process at a time: a lock on a folder that no crash leaves behind."""

from __future__ import annotations

import json
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from errno import EACCES, EAGAIN, EWOULDBLOCK
from pathlib import Path

from roundelay.base.errors import Locked

__all__ = ["locked"]

_HELD = (EACCES, EAGAIN, EWOULDBLOCK)


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Keep other processes out of what a lock file stands for.

    The system holds the lock, and lets go of it when the process ends, however it ends: a file
    that a crash left is taken over. It tells who is at work.

    Parameters
    ----------
    path : Path
        Of the lock file; it is gone afterwards.

    Raises
    ------
    Locked
        If another process, here or on another machine, holds it.
    OSError
        If it cannot be written, or the file system knows no locks.
    """
    descriptor = _taken(path)
    try:
        _sign(descriptor, path)
        yield
    finally:
        # Windows lets nobody remove what is open: the empty file is taken over next time.
        with suppress(OSError):
            path.unlink()
        os.close(descriptor)


def _sign(descriptor: int, path: Path) -> None:
    """Write into a lock file who holds it."""
    try:
        os.ftruncate(descriptor, 0)
        os.write(descriptor, json.dumps(_own()).encode())
    except OSError as error:
        error.filename = str(path)
        raise


def _taken(path: Path) -> int:
    """Open and lock the file; again if its last holder removed it in between."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            _lock(descriptor)
            if _is_still(path, descriptor):
                return descriptor
        except OSError as error:
            os.close(descriptor)
            if error.errno in _HELD:
                raise Locked(_told(path)) from None
            error.filename = str(path)
            raise
        os.close(descriptor)


def _is_still(path: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(path.stat(), os.fstat(descriptor))
    except FileNotFoundError:
        return False


def _lock(descriptor: int) -> None:
    if os.name == "nt":
        import msvcrt

        # Beyond what the file tells, so that others can read it.
        os.lseek(descriptor, 1 << 20, os.SEEK_SET)
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]
        os.lseek(descriptor, 0, os.SEEK_SET)
    else:
        import fcntl

        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _own() -> dict[str, object]:
    return {"pid": os.getpid(), "host": socket.gethostname()}


def _told(path: Path) -> str:
    """Say who holds a lock, as far as its file tells."""
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
        who = f" (process {held['pid']} on {held['host']})"
    except (OSError, ValueError, KeyError, TypeError):
        who = ""
    return (
        f"expected {path.parent} for this run alone, found another run{who} at work on it; "
        "wait until it is done, or give another folder"
    )
