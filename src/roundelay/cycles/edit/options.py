"""What a user may choose of blends and transitions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from roundelay.base.options import Checked, option
from roundelay.cycles.edit.align import Criterion

__all__ = ["AlignOptions", "AmountOptions", "BlendOptions", "TransitionOptions", "VaryOptions"]


@dataclass(frozen=True)
class AlignOptions(Checked):
    """Choices of how cycles are brought into phase with each other.

    Parameters
    ----------
    by : {"poses", "contacts"}
        What shall agree at equal phases; see `roundelay.cycles.edit.align.align`.
    mirror : bool
        Exchange left and right of a cycle where that fits better.
    """

    by: Criterion = option(
        "poses", "What agrees at equal phases: poses, or contacts of the feet.", flag="align"
    )
    mirror: bool = option(
        False, "Exchange left and right where that fits better.", flag="align-mirror"
    )


@dataclass(frozen=True)
class BlendOptions(AlignOptions):
    """Choices of a blend.

    Parameters
    ----------
    shares : tuple of float, optional
        One a cycle, with a sum of 1; equal by default.
    """

    title: ClassVar[str] = "How cycles are blended"

    shares: tuple[float, ...] | None = option(
        None,
        "One share a capture, with a sum of 1; equal by default.",
        least=0,
        form="SHARE,SHARE,...",
    )


@dataclass(frozen=True)
class TransitionOptions(AlignOptions):
    """Choices of a transition from one cycle to another.

    Parameters
    ----------
    seconds : float
        How long it lasts.
    before, after : float
        Seconds of the first cycle before it, and of the second after it.
    """

    title: ClassVar[str] = "How cycles follow each other"

    seconds: float = option(0.5, "How long the transition lasts.", unit="seconds", above=0, most=60)
    before: float = option(
        1.0, "How long the first cycle is shown before it.", unit="seconds", least=0, most=3600
    )
    after: float = option(
        1.0, "How long the second cycle is shown after it.", unit="seconds", least=0, most=3600
    )


@dataclass(frozen=True)
class AmountOptions(Checked):
    """How much of a difference is laid on a cycle: of a style, or of repetitions.

    Parameters
    ----------
    amount : float
        1 as in the captures, 0 not at all.
    """

    title: ClassVar[str] = "How much of a difference is laid on a cycle"

    amount: float = option(
        1.0, "How much of a style or of variation: 1 as in the captures, 0 none.", least=0, most=3
    )


@dataclass(frozen=True)
class VaryOptions(AmountOptions):
    """Choices of repetitions that are drawn anew.

    Parameters
    ----------
    repetitions : int
        How many different ones follow each other before the first comes again.
    seed : int
        Another seed draws others.
    """

    title: ClassVar[str] = "How repetitions vary"

    repetitions: int = option(
        4, "How many follow each other before the first comes again.", least=1, most=1000
    )
    seed: int = option(0, "Another seed draws others.", least=0)
