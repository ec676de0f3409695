"""How much memory is free: what would not fit is refused before work starts."""

from __future__ import annotations

from pathlib import Path

from roundelay.base.errors import TooLarge

__all__ = ["available_memory", "require_room"]


def available_memory() -> int | None:
    """Return the bytes of memory that are free for use, or None where the system does not say."""
    try:
        with Path("/proc/meminfo").open() as lines:
            return next(1024 * int(line.split()[1]) for line in lines if "MemAvailable" in line)
    except (OSError, StopIteration, ValueError):
        return None


def require_room(needed: int, what: str, advice: str) -> None:
    """Check that there is as much memory as something needs.

    Parameters
    ----------
    needed : int
        Bytes.
    what : str
        That needs them, in the plural.
    advice : str
        What to do where there are not.

    Raises
    ------
    TooLarge
        If less is free.
    """
    free = available_memory()
    if free is not None and needed > free:
        told = f"{what} need about {needed / 1e9:.1f} GB, {free / 1e9:.1f} GB are free"
        raise TooLarge(f"{told}: {advice}")
