"""What a user may choose of steps and strides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from roundelay.base.options import Checked, option

__all__ = ["Rule", "StrideOptions"]

Rule = Literal["auto", "velocity", "zeni", "contacts"]


@dataclass(frozen=True)
class StrideOptions(Checked):
    """Choices of steps and strides.

    Parameters
    ----------
    rule : {"auto", "velocity", "zeni", "contacts"}
        How moments are told, see `roundelay.gait.events`.
    everywhere : bool
        Also outside of what the timeline takes for gait.
    level : float
        Of the intervals of means.
    resamples : int
        Draws of the bootstrap.

    Raises
    ------
    ValueError
        If a value is out of range.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> found = rl.strides(walk, rl.StrideOptions(rule="zeni"))
    >>> found.rule
    'zeni'
    """

    title: ClassVar[str] = "Steps and strides"

    rule: Rule = option(
        "auto",
        "How the moments of a step are told: by the speed of heel and toe against the ground, by "
        "where the foot is farthest ahead and behind (Zeni et al. 2008), by low and slow feet; "
        "auto takes the first of these that fits.",
    )
    everywhere: bool = option(
        False, "Look for steps in all frames, not only where the legs repeat what they do."
    )
    level: float = option(
        0.95, "Level of the intervals of means.", above=0.0, below=1.0, flag="interval"
    )
    resamples: int = option(1000, "Draws of the bootstrap.", least=100, most=100_000)
