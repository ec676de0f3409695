"""Cycles of points made alike: the same points, hanging on each other in the same way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import SkeletonMismatch
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.edit.align import mapped
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.floating import PointsLayout

__all__ = ["of_common_points"]

Array = NDArray[np.float64]


def of_common_points(cycles: Sequence[Cycle]) -> list[Cycle]:
    """Return cycles of the points that all have, hung as in the first; others as they are.

    Which point hangs on which is told from each take by itself, and says nothing of the motion.

    Parameters
    ----------
    cycles : sequence of Cycle

    Raises
    ------
    SkeletonMismatch
        If they have no point in common.
    ValueError
        If their lengths are in different units.
    """
    if not all(cycle.skeleton.free for cycle in cycles) or len(cycles) < 2:
        return list(cycles)
    _check_units(cycles)
    common = set.intersection(*(set(cycle.skeleton.names[1:]) for cycle in cycles))
    if not common:
        raise SkeletonMismatch("expected takes with points in common, found none")
    onto = _part(cycles[0].skeleton, common)
    same = (onto.names, onto.parents)
    alike = [(cycle.skeleton.names, cycle.skeleton.parents) == same for cycle in cycles]
    return [c if known else _hung(c, onto) for c, known in zip(cycles, alike, strict=True)]


def _check_units(cycles: Sequence[Cycle]) -> None:
    layouts = [cycle.skeleton.layout for cycle in cycles]
    units = sorted({one.units for one in layouts if isinstance(one, PointsLayout)})
    if len(units) > 1:
        raise ValueError(f"expected one unit of length, found {' and '.join(units)}")


def _part(skeleton: Skeleton, kept: set[str]) -> Skeleton:
    """Return some points of a skeleton; each hangs on the nearest above it that is kept."""
    chosen = [0, *(j for j, name in enumerate(skeleton.names) if j and name in kept)]
    parents = [-1]
    for joint in chosen[1:]:
        above = skeleton.parents[joint]
        while above not in chosen:
            above = skeleton.parents[above]
        parents.append(chosen.index(above))
    names = tuple(skeleton.names[joint] for joint in chosen)
    offsets = _rehung(skeleton.offsets[None], skeleton, names, parents)[0]
    layout = skeleton.layout
    if isinstance(layout, PointsLayout):
        layout = layout.part(names[1:])
    return replace(skeleton, names=names, parents=tuple(parents), offsets=offsets, layout=layout)


def _hung(cycle: Cycle, onto: Skeleton) -> Cycle:
    """Return a cycle with the points of a skeleton, hung as there."""
    own = cycle.skeleton
    places = own.indices([own.names[0], *onto.names[1:]])

    def turned(values: Array) -> Array:
        return values.reshape(len(values), -1, 4)[:, places].reshape(len(values), -1)

    def moved(values: Array) -> Array:
        local = values.reshape(len(values), -1, 3)
        found = _rehung(local, own, (own.names[0], *onto.names[1:]), onto.parents)
        return found.reshape(len(values), -1)

    offsets = _rehung(own.offsets[None], own, (own.names[0], *onto.names[1:]), onto.parents)[0]
    return replace(
        cycle,
        skeleton=replace(onto, offsets=offsets),
        pose=mapped(cycle.pose, turned),
        odd_pose=cycle.odd_pose and mapped(cycle.odd_pose, turned),
        translations=cycle.translations and mapped(cycle.translations, moved),
    )


def _rehung(
    local: Array, skeleton: Skeleton, names: Sequence[str], parents: Sequence[int]
) -> Array:
    """Return places (n, K, 3) of points on other parents, from those (n, J, 3) on their own.

    A linear map: the points themselves do not turn.
    """
    inside = np.zeros_like(local)
    for joint, above in enumerate(skeleton.parents[1:], 1):
        inside[:, joint] = inside[:, above] + local[:, joint]
    chosen = inside[:, skeleton.indices(names)]
    result = chosen - chosen[:, [max(above, 0) for above in parents]]
    result[:, 0] = local[:, 0]
    return np.asarray(result)
