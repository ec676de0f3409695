"""The process that reads a USD file by usd-core and leaves an NPZ; see `formats.usd`.

Usage: python -m roundelay.formats.usd_child FILE NPZ SKELETON, "-" for the first
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

from roundelay.formats.clock import common_clock

__all__ = ["main"]

# Bytes.
_MEMORY = 8 << 30


def main() -> None:
    """Read the file and write what it holds; the last line of standard error says what is wrong."""
    given, written, skeleton = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3]
    _limit_memory()
    try:
        np.savez(written, **_read(given, skeleton))
    except Exception as error:
        told = " ".join(str(error).split()) or type(error).__name__
        sys.exit(told[:500])


def _limit_memory() -> None:
    try:
        import resource
    except ImportError:  # not on Windows
        return
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))


def _read(path: Path, wanted: str) -> dict[str, Any]:
    """Return the arrays of an NPZ: of one skeleton, and the names of all."""
    from pxr import Usd, UsdGeom, UsdSkel

    stage = Usd.Stage.Open(str(path))
    found = [prim for prim in stage.Traverse() if prim.IsA(UsdSkel.Skeleton)]
    if not found:
        raise ValueError("expected a skeleton, found none")
    names = [prim.GetName() for prim in found]
    cache, chosen = UsdSkel.Cache(), found[names.index(wanted) if wanted in names else 0]
    for prim in stage.Traverse():
        if prim.IsA(UsdSkel.Root):
            cache.Populate(UsdSkel.Root(prim), Usd.TraverseInstanceProxies())
    query = cache.GetSkelQuery(UsdSkel.Skeleton(chosen))
    animation = query.GetAnimQuery()
    if not animation:
        raise ValueError(f"expected an animation of skeleton {chosen.GetName()!r}, found none")
    samples = np.array(animation.GetJointTransformTimeSamples() or [0.0])
    rate = stage.GetTimeCodesPerSecond()
    clock = common_clock([samples / rate], path, straight=True, rate=rate)
    times = [Usd.TimeCode(float(second * rate)) for second in clock.times]
    local = np.array([query.ComputeJointLocalTransforms(time) for time in times])
    world = [UsdGeom.XformCache(time).GetLocalToWorldTransform(chosen) for time in times]
    order = [str(joint) for joint in query.GetJointOrder()]
    return {
        "skeletons": np.array(names),
        "joints": np.array(order),
        "parents": np.array([query.GetTopology().GetParent(n) for n in range(len(order))]),
        "rest": np.array(query.ComputeJointLocalTransforms(times[0], True)),
        "local": local,
        "world": np.array(world),
        "step": np.array(clock.step),
        "metres": np.array(float(UsdGeom.GetStageMetersPerUnit(stage))),
        "up": np.array(str(UsdGeom.GetStageUpAxis(stage))),
    }


if __name__ == "__main__":
    main()
