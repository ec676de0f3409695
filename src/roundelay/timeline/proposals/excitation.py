"""Circular coordinates of a whole capture, and where each of them turns ([A] 4.6, 6.4).

A capture of several motions has several classes. The coordinate of each rests on most frames
and turns where its own motion is shown: in its *excitation regions*.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.errors import TooShort
from roundelay.base.spans import Spans
from roundelay.base.threads import one_thread
from roundelay.motion.poses import with_velocity
from roundelay.phase.unwrap import unwrap
from roundelay.timeline.cloud import joined_in_time, variance_normalised
from roundelay.timeline.options import PoseMetric
from roundelay.timeline.thresholds import EXCITATION
from roundelay.topology.coordinate import CircularCoordinate, circular_coordinate
from roundelay.topology.distances import FEWEST_POINTS
from roundelay.topology.landmarks import Landmarks, choose_landmarks
from roundelay.topology.rips import Barcode, persistent_cohomology
from roundelay.topology.significance import p_values

__all__ = ["Excitation", "Excitations", "Region", "excitations", "regions_of"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Region:
    """A stretch of frames in which a coordinate turns.

    Attributes
    ----------
    start, stop : int
        Half-open range of frames.
    net, total : float
        Turns forward minus backward, and their sum.
    """

    start: int
    stop: int
    net: float
    total: float


@dataclass(frozen=True, eq=False)
class Excitation:
    """One class of a capture.

    Attributes
    ----------
    coordinate : CircularCoordinate
        Of the frames looked at, with the life of the class and its place in the barcode.
    p_value : float
        Chance of such a bar in noise, times the number of bars.
    turns : (F,) ndarray
        Unwrapped coordinate of every frame, in turns, forward on the whole.
    regions : tuple of Region
        Where it turns, in order of time.
    """

    coordinate: CircularCoordinate = field(repr=False)
    p_value: float
    turns: Array = field(repr=False)
    regions: tuple[Region, ...]


@dataclass(frozen=True, eq=False)
class Excitations:
    """The classes of a capture.

    Attributes
    ----------
    barcode : Barcode
        Of the landmarks.
    classes : tuple of Excitation
        The significant ones, least p-value first.
    """

    barcode: Barcode = field(repr=False)
    classes: tuple[Excitation, ...]


@one_thread
def excitations(
    points: ArrayLike,
    fps: float,
    *,
    metric: PoseMetric = "euclidean",
    period: float = 1.0,
    classes: int | None = None,
    prime: int = 47,
) -> Excitations:
    """Find the classes of a capture and the frames in which the coordinate of each turns.

    Classes are taken by their p-value, which looks at death over birth, not by the length of
    their bars: a small motion then counts as much as a large one, each at its own scale.

    Parameters
    ----------
    points : (F, d) array_like
        One pose a frame, as from `roundelay.point_cloud`.
    fps : float
        Frames a second.
    metric : {"euclidean", "variance", "adjacent"}
        Distance of poses: Euclidean, the same with every column divided by its standard
        deviation ([A] 6.4), or Euclidean with consecutive landmarks at distance 0 ([A] 3.2),
        which finds motions passed through once and quickly too, and more that is none.
    period : float
        Seconds of a typical period, by which velocity is weighed; 0 for poses alone, as in [A].
    classes : int, optional
        How many; by default all with a corrected p-value of at most .05.
    prime : int
        Coefficients modulo this prime.

    Returns
    -------
    Excitations

    Raises
    ------
    ValueError
        If an option is out of range, or all poses are equal.
    TooShort
        If there are fewer than 4 frames.
    LiftError
        If a class lifts to no integer cocycle.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> found = rl.excitations(rl.point_cloud(walk), walk.fps)
    >>> found.barcode
    Barcode(8 bars of 429 points, mod 47)
    """
    x = np.asarray(points, float)
    _check(x, fps, metric, period, classes)
    step = max(1, min(-(-len(x) // EXCITATION.frames), round(fps / EXCITATION.rate)))
    cloud = _cloud(x, metric, period * fps)[::step]
    landmarks = choose_landmarks(cloud, count=EXCITATION.landmarks, method="greedy")
    barcode = _barcode(landmarks, metric, prime)
    chances = p_values(barcode)
    order = np.lexsort((np.arange(len(chances)), chances))
    chosen = order[chances[order] <= EXCITATION.level] if classes is None else order[:classes]
    coordinates = [
        circular_coordinate(barcode, k=k, runs=[(0, len(cloud))], landmarks=landmarks)
        for k in chosen.tolist()
    ]
    turns = [_all_frames(coordinate.phase, len(x), step) for coordinate in coordinates]
    found = [
        _excitation(coordinate, values, float(chances[coordinate.class_index]), fps)
        for coordinate, values in zip(coordinates, turns, strict=True)
    ]
    return Excitations(barcode, tuple(found))


def _excitation(
    coordinate: CircularCoordinate, turns: Array, p_value: float, fps: float
) -> Excitation:
    """Turn a coordinate forward and find its regions."""
    regions = regions_of(turns, fps)
    if sum(region.net for region in regions) < 0.0:
        turns = -turns
        regions = tuple(replace(region, net=-region.net) for region in regions)
    return Excitation(coordinate, p_value, turns, regions)


def _check(points: Array, fps: float, metric: str, period: float, classes: int | None) -> None:
    if metric not in get_args(PoseMetric):
        raise ValueError(f"expected a metric among {get_args(PoseMetric)}, found {metric!r}")
    if not fps > 0.0 or not period >= 0.0:
        raise ValueError(f"expected fps above 0 and period from 0, found {fps:g} and {period:g}")
    if classes is not None and classes < 1:
        raise ValueError(f"expected at least one class, found {classes}")
    if len(points) < FEWEST_POINTS:
        raise TooShort(f"a loop needs at least {FEWEST_POINTS} frames, found {len(points)}")
    if not np.ptp(points, axis=0).any():
        raise ValueError(f"all {len(points)} poses are equal: there is no shape to find a loop in")


def _cloud(points: Array, metric: PoseMetric, period: float) -> Array:
    """Return points (F, d or 2 d) in the metric's columns, with velocities if period > 0."""
    if metric == "variance":
        points = variance_normalised(points)
    return with_velocity(points, [(0, len(points))], period) if period > 0.0 else points


def _barcode(landmarks: Landmarks, metric: PoseMetric, prime: int) -> Barcode:
    distances = landmarks._distances[landmarks.indices]
    distances = np.minimum(distances, distances.T)
    np.fill_diagonal(distances, 0.0)
    if metric == "adjacent":
        distances = joined_in_time(distances, [(0, len(distances))])
    return persistent_cohomology(distances, metric="precomputed", prime=prime)


def _all_frames(phase: Array, frames: int, step: int) -> Array:
    """Unwrap the phase of every step-th frame, and interpolate it on all."""
    turns = unwrap(phase, [(0, len(phase))])
    return np.interp(np.arange(frames), np.arange(len(turns)) * step, turns)


def regions_of(turns: ArrayLike, fps: float) -> tuple[Region, ...]:
    """Return the connected stretches with most of a coordinate's variation ([A] 4.6).

    Parameters
    ----------
    turns : (F,) array_like
        Unwrapped coordinate, in turns.
    fps : float
        Frames a second.

    Returns
    -------
    tuple of Region
        The frames where the variation, averaged over half a second, is largest, so many that
        they hold 80 % of it; stretches of less than .3 turns are left out.
    """
    x = np.asarray(turns, float)
    moved = np.diff(x, prepend=x[0])
    reach = min(max(1, round(0.5 * EXCITATION.window * fps)), (len(x) - 1) // 2)
    rate = np.convolve(np.abs(moved), np.ones(2 * reach + 1), mode="same")
    falling = np.sort(rate)[::-1]
    held = np.cumsum(falling)
    if held[-1] <= 0.0:
        return ()
    # A share of that, so that a region with some slower frames stays one.
    least = EXCITATION.slower * falling[np.searchsorted(held, EXCITATION.share * held[-1])]
    found = [
        Region(a, b, float(moved[a:b].sum()), float(np.abs(moved[a:b]).sum()))
        for a, b in Spans.of_mask(rate >= least)
    ]
    return tuple(region for region in found if region.total >= EXCITATION.least)
