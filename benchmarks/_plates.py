"""When force plates say that a foot came down and left: the truth of trials in C3D files."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from roundelay.formats.analog import Analog, Plate
from roundelay.formats.c3d import C3dLayout

Array = NDArray[np.float64]

# Of the largest force: about 20 N of a person of 75 kg.
LEAST = 0.025
# Seconds: a foot stands longer, and a plate is empty before and behind.
SHORTEST, EMPTY = 0.3, 0.05
# Share of the longer side of a plate by which the foot may move in the middle of its step.
STILL = 0.1


@dataclass(frozen=True)
class PlateStep:
    """A foot that came down on a plate and left it, in seconds of the trial."""

    side: str
    strike: float
    off: float


def plate_steps(points: rl.Points, feet: dict[str, list[str]]) -> Iterator[PlateStep]:
    """Tell the steps on the plates of a trial whose whole foot is on one plate, alone.

    Parameters
    ----------
    points : Points
        Of a C3D file.
    feet : dict
        Names of the markers of the foot of each side.
    """
    layout = points.layout
    if not isinstance(layout, C3dLayout) or layout.analog is None:
        return
    for plate in layout.plates:
        force = _force(layout.analog, plate)
        if force is None:
            continue
        for start, stop in _loaded(force, layout.analog.rate):
            times = np.array([start, stop]) / layout.analog.rate
            sides = [side for side, names in feet.items() if _stands(points, names, plate, times)]
            if len(sides) == 1:
                yield PlateStep(sides[0], float(times[0]), float(times[1]))


def _force(analog: Analog, plate: Plate) -> Array | None:
    """Return how hard a plate is pressed (S,), in its unit; None where it tells nothing."""
    channels = analog.values[:, list(plate.channels)].astype(float)
    if plate.kind in (1, 2) and channels.shape[1] == 6:
        force = channels[:, 2]
    elif plate.kind == 3 and channels.shape[1] == 8:
        force = channels[:, 4:].sum(axis=1)
    elif plate.kind == 4 and channels.shape[1] == 6 and plate.matrix is not None:
        force = channels @ plate.matrix[2]
    else:
        return None
    # What it shows with nobody on it: that is most of the time, or its least.
    force = np.abs(force - np.median(force))
    return force if np.isfinite(force).all() and force.max() > 0.0 else None


def _loaded(force: Array, rate: float) -> Iterator[tuple[int, int]]:
    """Yield the ranges of samples in which somebody stands on a plate that was empty before."""
    on = force > LEAST * force.max()
    edges = np.flatnonzero(np.diff(np.concatenate([[False], on, [False]]).astype(int)))
    ranges = [(int(a), int(b)) for a, b in edges.reshape(-1, 2) if b - a > 0.01 * rate]
    for place, (start, stop) in enumerate(ranges):
        before = ranges[place - 1][1] if place else 0
        behind = ranges[place + 1][0] if place + 1 < len(ranges) else len(force)
        alone = start - before > EMPTY * rate and behind - stop > EMPTY * rate
        if alone and stop - start > SHORTEST * rate and force[start:stop].max() > 0.5 * force.max():
            yield start, stop


def _stands(points: rl.Points, names: list[str], plate: Plate, times: Array) -> bool:
    """Tell whether the whole foot stands still above the plate in the middle of a step."""
    middle = times[0] + np.array([0.3, 0.5]) * (times[1] - times[0])
    first, last = (np.clip(middle * points.fps, 0, len(points) - 1)).astype(int)
    corners = plate.corners
    axes = np.stack([corners[0] - corners[1], corners[0] - corners[3]])
    lengths = np.linalg.norm(axes, axis=1)
    if not (lengths > 0.0).all() or not names:
        return False
    columns = [points.names.index(name) for name in names]
    seen = points.seen[first:last, columns]
    places = points.positions[first:last, columns]
    if not seen.any(axis=0).all():
        return False
    where = np.stack([places[seen[:, k], k].mean(axis=0) for k in range(len(columns))])
    moved = max(np.ptp(places[seen[:, k], k], axis=0).max() for k in range(len(columns)))
    inside = abs((where - corners.mean(axis=0)) @ (axes / lengths[:, None]).T) < 0.5 * lengths
    return bool(inside.all() and moved < STILL * lengths.max())
