"""From raw motion capture to clean behaviours and seamless, loopable, blendable cycles.

Names are loaded when first used, so that the command line answers at once.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from roundelay.base.version import __version__ as __version__

if TYPE_CHECKING:
    from roundelay.base.errors import (
        Cancelled,
        FormatError,
        LiftError,
        NoPeriod,
        RoundelayError,
        RoundelayWarning,
        SkeletonMismatch,
        TooLarge,
        TooShort,
    )
    from roundelay.compare.distances import (
        bottleneck_distance,
        cluster,
        cycle_distance,
        distance_matrix,
        wasserstein_distance,
    )
    from roundelay.cycles.cycle import Cycle
    from roundelay.cycles.edit.blend import CycleSpace, blend, transition
    from roundelay.formats import read, write
    from roundelay.geometry.skeleton import Skeleton
    from roundelay.library import Library, Match, build_library
    from roundelay.loops.options import LoopOptions
    from roundelay.loops.quality import Quality, quality
    from roundelay.motion.features import point_cloud
    from roundelay.motion.motion import Motion, concatenate
    from roundelay.pipeline import find_cycles, find_periodic, make_cycle, with_periods
    from roundelay.segmentation import Segmentation, segment
    from roundelay.timeline.evidence import Evidence
    from roundelay.timeline.options import Options, TopologyOptions
    from roundelay.timeline.proposals.excitation import excitations

_HOMES = {
    "cycles.edit.blend": ("CycleSpace", "blend", "transition"),
    "cycles.cycle": ("Cycle",),
    "base.errors": (
        "Cancelled",
        "FormatError",
        "LiftError",
        "NoPeriod",
        "RoundelayError",
        "RoundelayWarning",
        "SkeletonMismatch",
        "TooLarge",
        "TooShort",
    ),
    "timeline.proposals.excitation": ("excitations",),
    "formats": ("read", "write"),
    "library": ("Library", "Match", "build_library"),
    "loops.options": ("LoopOptions",),
    "motion.motion": ("Motion", "concatenate"),
    "timeline.evidence": ("Evidence",),
    "pipeline": ("find_cycles", "find_periodic", "make_cycle", "with_periods"),
    "timeline.options": ("Options", "TopologyOptions"),
    "motion.features": ("point_cloud",),
    "loops.quality": ("Quality", "quality"),
    "segmentation": ("Segmentation", "segment"),
    "compare.distances": (
        "bottleneck_distance",
        "cluster",
        "cycle_distance",
        "distance_matrix",
        "wasserstein_distance",
    ),
    "geometry.skeleton": ("Skeleton",),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [
    "Cancelled",
    "Cycle",
    "CycleSpace",
    "Evidence",
    "FormatError",
    "Library",
    "LiftError",
    "LoopOptions",
    "Match",
    "Motion",
    "NoPeriod",
    "Options",
    "Quality",
    "RoundelayError",
    "RoundelayWarning",
    "Segmentation",
    "Skeleton",
    "SkeletonMismatch",
    "TooLarge",
    "TooShort",
    "TopologyOptions",
    "blend",
    "bottleneck_distance",
    "build_library",
    "cluster",
    "concatenate",
    "cycle_distance",
    "distance_matrix",
    "excitations",
    "find_cycles",
    "find_periodic",
    "make_cycle",
    "point_cloud",
    "quality",
    "read",
    "segment",
    "transition",
    "wasserstein_distance",
    "with_periods",
    "write",
]


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(f"roundelay.{_HOME[name]}"), name)
    try:
        return import_module(f"roundelay.{name}")
    except ModuleNotFoundError as error:
        if error.name != f"roundelay.{name}":
            raise
        raise AttributeError(f"module 'roundelay' has no attribute {name!r}") from None


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
