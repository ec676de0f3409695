"""Limbs that pass through each other: what is said of them."""

from __future__ import annotations

from typing import Any

from roundelay.commands.common import echo


def print_limbs(record: dict[str, Any]) -> None:
    """Say which bones were moved apart and which may still touch, a line a pair."""
    for one in record.get("mended", ()):  # not every profile tells of limbs
        frames = ", ".join(f"{start}-{stop}" for start, stop in one["frames"])
        echo(
            f"    {' and '.join(one['bones'])} moved apart in frames {frames}, "
            f"by turns of up to {one['largest_degrees']:.1f} deg"
        )
    pairs: dict[str, list[str]] = {}
    for one in record.get("collisions", ()):
        start, stop = one["frames"]
        pairs.setdefault(" and ".join(one["bones"]), []).append(f"{start}-{stop}")
    for bones, spans in pairs.items():
        echo(f"    {bones} may touch in frames {', '.join(spans)}")
