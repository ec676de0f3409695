"""Points as a motion: a body's frame with points that float in it.

A motion of points has a skeleton that is `free`: its root is the frame of the trunk and no point;
its joints are the points. They hang on each other along lines to draw and move freely, so that all
that is done with motions can be done with points.

::

    Points -> outliers out -> frame of the trunk -> gaps filled in it -> tree of lines -> Motion
"""

from __future__ import annotations

import warnings
from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.checks import expected
from roundelay.base.errors import GapsFilled, TooShort
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.axes import upright_turn, upward
from roundelay.motion.frame import Frame, trunk_frame
from roundelay.motion.gaps import Gap, fill_gaps, gaps_in_words, outliers, straight
from roundelay.motion.lines import Links, links_of, symmetric_tree, tree_of, trunk_of
from roundelay.motion.motion import Motion
from roundelay.motion.points import Points
from roundelay.motion.poses import Mask
from roundelay.motion.thresholds import GAPS

__all__ = ["BODY", "PointsLayout", "as_motion", "motion_of_points", "points_of_motion"]

Array = NDArray[np.float64]

BODY = "(body)"
"""The root of a skeleton of points: the frame of the trunk, not a point."""


@dataclass(frozen=True)
class PointsLayout:
    """What points have that a motion has not, for the way back.

    Attributes
    ----------
    names : tuple of str
        Of the points, in their order.
    dimensions : int
        2 or 3.
    units, image, links, source
        As of `Points`; `source` is its layout.
    gaps : tuple of Gap
        What was missing, and how it was filled.
    """

    names: tuple[str, ...]
    dimensions: int
    units: str
    image: bool
    links: Links
    source: Any
    gaps: tuple[Gap, ...]

    def part(self, names: Collection[str]) -> PointsLayout:
        """Return the layout of some of the points; what the file held besides is of all."""
        places = [place for place, name in enumerate(self.names) if name in names]
        new = {old: number for number, old in enumerate(places)}
        return replace(
            self,
            names=tuple(self.names[place] for place in places),
            links=tuple((new[a], new[b]) for a, b in self.links if a in new and b in new),
            gaps=tuple(gap for gap in self.gaps if gap.point in names),
        )


def as_motion(take: Motion | Points) -> Motion:
    """Return a motion, or that of points; see `motion_of_points`.

    Raises
    ------
    TooShort
        If there is no frame in which enough points are seen.
    TypeError
        If it is neither.
    """
    return motion_of_points(take) if isinstance(take, Points) else expected(Motion, take)


def motion_of_points(points: Points, *, fill: bool = True, max_gap: float | None = None) -> Motion:
    """Make a motion of points.

    Parameters
    ----------
    points : Points
    fill : bool
        Whether gaps are filled as the rest of the body tells; else by straight lines.
    max_gap : float, optional
        Longest gap in seconds that is filled so; all that can be predicted by default.

    Returns
    -------
    Motion
        Of a free skeleton, lengths in the unit of the points. What was missing is told by a
        warning, `GapsFilled`, and stands in the skeleton's layout.

    Raises
    ------
    TooShort
        If there is no frame in which enough points are seen.
    ValueError
        If the longest gap is negative.
    """
    if max_gap is not None and not max_gap >= 0.0:
        raise ValueError(f"expected a longest gap of 0 seconds or more, found {max_gap:g}")
    points = _well_seen(_beside_origin(_likely(expected(Points, points))))
    planar, positions = points.dimensions == 2, _in_space(points)
    size = _extent(positions, points.seen)
    seen = points.seen & ~outliers(positions, points.seen, size)
    trunk = trunk_of(points.names, positions, seen)
    # In the frame of the body points move less, so that smaller jumps are seen.
    frame = trunk_frame(positions, seen, trunk, planar=planar)
    seen &= ~outliers(frame.inside(positions), seen, size)
    frame = trunk_frame(positions, seen, trunk, planar=planar)
    longest = None if max_gap is None else round(max_gap * points.fps)
    inside, gaps = fill_gaps(
        frame.inside(positions),
        seen,
        points.names,
        size=size,
        reach=max(1, round(GAPS.speed * points.fps)),
        longest=longest if fill else 0,
    )
    if gaps:
        told = gaps_in_words(gaps, len(points), len(points.names))
        warnings.warn(GapsFilled(told), stacklevel=2)
    links = points.links or links_of(points.names)
    layout = PointsLayout(
        points.names, points.dimensions, points.units, points.image, links, points.layout, gaps
    )
    tree = symmetric_tree(tree_of(positions, seen, frame.trunk, links), points.names)
    return _floating(points, frame, inside, tree, layout)


def _likely(points: Points) -> Points:
    """Return points without what its detector held for unlikely."""
    if points.likelihoods is None:
        return points
    return replace(points, missing=~points.seen | ~(points.likelihoods >= GAPS.likely))


def _beside_origin(points: Points) -> Points:
    """Return points without zeros that stand for gaps.

    A point that jumps to the origin and back is not there; nor are several that never leave it. One
    that never does is where the places of the others are measured from.
    """
    zero = points.seen & ~points.positions.any(axis=2)
    if not zero.any():
        return points
    elsewhere = points.seen & ~zero
    never = ~elsewhere.any(axis=0)
    size = _extent(points.positions, elsewhere)
    places = straight(points.positions, elsewhere | never)
    usual = np.median(np.linalg.norm(np.diff(places, axis=0), axis=2), axis=0)
    far = np.linalg.norm(places, axis=2) > np.maximum(GAPS.apart * size, GAPS.usual * usual)
    return replace(points, missing=~points.seen | zero & (far | (never & (never.sum() > 1))))


def _well_seen(points: Points) -> Points:
    """Return the points that are seen often enough to tell anything.

    Raises
    ------
    TooShort
        If there is none.
    """
    shares = points.seen.mean(axis=0) if len(points) else np.zeros(len(points.names))
    kept = [name for name, share in zip(points.names, shares, strict=True) if share > GAPS.seen]
    if not kept:
        least = f"in {GAPS.seen:.0%} of the frames"
        raise TooShort(f"expected a point that is seen {least}, found none of {len(shares)}")
    if len(kept) == len(points.names):
        return points
    gone = sorted(set(points.names) - set(kept))
    listed = ", ".join(gone[:5]) + (f" and {len(gone) - 5} others" if len(gone) > 5 else "")
    warnings.warn(GapsFilled(f"left out, for they are hardly seen: {listed}"), stacklevel=3)
    return points.select(kept)


def _in_space(points: Points) -> Array:
    """Return positions (F, J, 3): those of a plane lie in X and Y, Y upward."""
    if points.dimensions == 3:
        return points.positions
    flat = points.positions * (1.0, -1.0 if points.image else 1.0)
    return np.concatenate([flat, np.zeros((*flat.shape[:2], 1))], axis=2)


def _extent(positions: Array, seen: Mask) -> float:
    """Return about how large a body is: twice the distance of its outer points to its middle."""
    shown = np.where(seen[..., None], positions, np.nan)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        middle = np.nanmedian(shown, axis=1, keepdims=True)
        apart = np.nanmedian(np.linalg.norm(shown - middle, axis=2), axis=0)
    return 2.0 * float(np.nanquantile(apart, GAPS.outer)) or 1.0


def _floating(
    points: Points, frame: Frame, inside: Array, tree: list[int], layout: PointsLayout
) -> Motion:
    """Hang points (F, J, 3) in a frame on each other, and name the axis that points up."""
    planar = points.dimensions == 2
    up = points.up
    if up is None:
        up = upward(frame, inside, planar=planar)
    turn = rot.identity() if planar else upright_turn(frame, points.names, up)
    frame, inside = frame.aligned(turn), rot.rotate(turn, inside)
    order = _parents_first(tree)
    place = {point: number for number, point in enumerate(order, 1)}
    parents = (-1, *(place.get(tree[point], 0) for point in order))
    local = np.zeros((len(inside), len(order) + 1, 3))
    for number, point in enumerate(order, 1):
        above = tree[point]
        local[:, number] = inside[:, point] - (0.0 if above < 0 else inside[:, above])
    names = (_free_name(points.names), *(points.names[point] for point in order))
    skeleton = Skeleton(names, parents, np.median(local, axis=0), layout=layout, free=True)
    rotations = np.zeros((len(inside), len(names), 4))
    rotations[..., 0] = 1.0
    rotations[:, 0] = frame.turns
    return Motion(
        skeleton,
        rotations,
        frame.places,
        1.0 / points.fps,
        local,
        name=points.name,
        up=up,
        missing=_open(layout.gaps, names, len(local)),
    )


def _open(gaps: tuple[Gap, ...], names: tuple[str, ...], frames: int) -> Mask:
    """Return what (F, J) was not seen and could not be told from the rest."""
    missing, place = np.zeros((frames, len(names)), bool), {n: i for i, n in enumerate(names)}
    for gap in gaps:
        if gap.way == "open":
            missing[gap.start : gap.stop, place[gap.point]] = True
    return missing


def _free_name(names: tuple[str, ...]) -> str:
    name = BODY
    while name in names:
        name += "'"
    return name


def _parents_first(tree: list[int]) -> list[int]:
    """Return points in an order in which each comes after the one it hangs on."""
    order: list[int] = []
    waiting = [point for point, parent in enumerate(tree) if parent < 0]
    while waiting:
        order += waiting
        waiting = [point for point, parent in enumerate(tree) if parent in waiting]
    return order


def points_of_motion(motion: Motion) -> Points:
    """Return the joints of a motion as points; those of points as they were given.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    Points
        In the world, none missing.
    """
    skeleton, layout = expected(Motion, motion).skeleton, motion.skeleton.layout
    places, _ = forward_kinematics(
        skeleton, motion.rotations, motion.root_path, translations=motion.translations
    )
    if not isinstance(layout, PointsLayout):
        # The frame of a body is no point.
        first = 1 if skeleton.free else 0
        pairs = enumerate(skeleton.parents)
        lines = tuple((above - first, joint - first) for joint, above in pairs if above >= first)
        return Points(
            skeleton.names[first:], places[:, first:], motion.fps, links=lines, name=motion.name
        )
    positions = places[:, skeleton.indices(layout.names), : layout.dimensions].copy()
    if layout.dimensions == 2 and layout.image:
        positions[..., 1] *= -1.0
    return Points(
        layout.names,
        positions,
        motion.fps,
        units=layout.units,
        links=layout.links,
        image=layout.image,
        name=motion.name,
        layout=layout.source,
    )
