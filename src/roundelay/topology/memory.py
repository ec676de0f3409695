"""What a filtration needs of memory, checked before any work."""

from __future__ import annotations

from roundelay.base.errors import TooLarge
from roundelay.base.memory import require_room

__all__ = ["check_memory"]

MOST_POINTS = 65535
BYTES_PER_PAIR = 16

_ADVICE = "use landmarks (roundelay.topology.choose_landmarks) and extend the coordinate to all"


def check_memory(n: int) -> None:
    """Raise TooLarge, before any work, if n points would not fit: lengths, keys, fills, values."""
    if n > MOST_POINTS:
        raise TooLarge(f"{n} points are more than the {MOST_POINTS} of one filtration: {_ADVICE}")
    require_room(BYTES_PER_PAIR * n * n, f"{n} points", _ADVICE)
