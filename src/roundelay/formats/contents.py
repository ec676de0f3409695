"""What a file holds to choose from, and how it means its numbers."""

from __future__ import annotations

from dataclasses import dataclass, field

__all__ = ["Contents"]


@dataclass(frozen=True)
class Contents:
    """List what a file holds.

    Parameters
    ----------
    animations : tuple of str
        Names for `ReadOptions.animation`; empty where the format has one motion a file.
    characters : tuple of str
        Names of the roots of its skeletons, for `ReadOptions.character`.
    conventions : dict of str to str
        What the file says of its axes, its unit and its program, as in ``{"up": "Y"}``.
    """

    animations: tuple[str, ...] = ()
    characters: tuple[str, ...] = ()
    conventions: dict[str, str] = field(default_factory=dict)
