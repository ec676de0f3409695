"""From raw motion capture to clean behaviours and seamless, loopable, blendable cycles.

Names are loaded when first used, so that the command line answers at once.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from roundelay.version import __version__ as __version__

if TYPE_CHECKING:
    from roundelay.behaviours import with_periods
    from roundelay.cloud import TopologyOptions
    from roundelay.cycles.blend import CycleSpace, blend, transition
    from roundelay.cycles.cycle import Cycle
    from roundelay.errors import (
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
    from roundelay.excitation import excitations
    from roundelay.formats import read, write
    from roundelay.library import Library, LoopOptions, Match, build_library
    from roundelay.motion import Motion, concatenate
    from roundelay.periodicity import Evidence
    from roundelay.pipeline import Options, find_cycles, find_periodic, make_cycle
    from roundelay.poses import point_cloud
    from roundelay.quality import Quality
    from roundelay.segmentation import Segmentation, segment
    from roundelay.signature import (
        bottleneck_distance,
        cluster,
        cycle_distance,
        distance_matrix,
        wasserstein_distance,
    )
    from roundelay.skeleton import Skeleton

_HOMES = {
    "behaviours": ("with_periods",),
    "cloud": ("TopologyOptions",),
    "cycles.blend": ("CycleSpace", "blend", "transition"),
    "cycles.cycle": ("Cycle",),
    "errors": (
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
    "excitation": ("excitations",),
    "formats": ("read", "write"),
    "library": ("Library", "LoopOptions", "Match", "build_library"),
    "motion": ("Motion", "concatenate"),
    "periodicity": ("Evidence",),
    "pipeline": ("Options", "find_cycles", "find_periodic", "make_cycle"),
    "poses": ("point_cloud",),
    "quality": ("Quality",),
    "segmentation": ("Segmentation", "segment"),
    "signature": (
        "bottleneck_distance",
        "cluster",
        "cycle_distance",
        "distance_matrix",
        "wasserstein_distance",
    ),
    "skeleton": ("Skeleton",),
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
