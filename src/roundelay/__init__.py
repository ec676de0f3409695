"""From raw motion capture to clean behaviours and seamless, loopable, blendable cycles."""

from roundelay.cycles.cycle import Cycle
from roundelay.errors import (
    Cancelled,
    FormatError,
    LiftError,
    NoPeriod,
    RoundelayError,
    SkeletonMismatch,
    TooLarge,
    TooShort,
)
from roundelay.formats import read, write
from roundelay.motion import Motion, concatenate
from roundelay.periodicity import Evidence, TopologyOptions
from roundelay.pipeline import Options, find_cycles
from roundelay.skeleton import Skeleton

__version__ = "0.1.0"

__all__ = [
    "Cancelled",
    "Cycle",
    "Evidence",
    "FormatError",
    "LiftError",
    "Motion",
    "NoPeriod",
    "Options",
    "RoundelayError",
    "Skeleton",
    "SkeletonMismatch",
    "TooLarge",
    "TooShort",
    "TopologyOptions",
    "concatenate",
    "find_cycles",
    "read",
    "write",
]
