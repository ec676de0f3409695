"""What a filtration needs of memory, checked before any work."""

from __future__ import annotations

from pathlib import Path

from roundelay.base.errors import TooLarge

__all__ = ["available_memory", "check_memory"]

MOST_POINTS = 65535
BYTES_PER_PAIR = 16

_ADVICE = "use landmarks (roundelay.topology.choose_landmarks) and extend the coordinate to all"


def check_memory(n: int) -> None:
    """Raise TooLarge, before any work, if n points would not fit: lengths, keys, fills, values."""
    if n > MOST_POINTS:
        raise TooLarge(f"{n} points are more than the {MOST_POINTS} of one filtration: {_ADVICE}")
    needed, free = BYTES_PER_PAIR * n * n, available_memory()
    if free is not None and needed > free:
        raise TooLarge(
            f"{n} points need about {needed / 1e9:.1f} GB, {free / 1e9:.1f} GB are free: {_ADVICE}"
        )


def available_memory() -> int | None:
    """Return the bytes of memory that are free for use, or None where the system does not say."""
    try:
        with Path("/proc/meminfo").open() as lines:
            return next(1024 * int(line.split()[1]) for line in lines if "MemAvailable" in line)
    except (OSError, StopIteration, ValueError):
        return None
