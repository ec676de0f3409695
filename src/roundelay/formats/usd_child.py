"""The process that reads a USD file by usd-core and leaves an NPZ; see `formats.usd`.

Usage: python -m roundelay.formats.usd_child FILE NPZ SKELETON, "-" for the first
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from roundelay.formats.apart import answer
from roundelay.formats.clock import common_clock

__all__ = ["main"]


def main() -> None:
    """Read the file and write what it holds; see `roundelay.formats.apart.answer`."""
    answer(_read)


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
