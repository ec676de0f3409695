"""The typical trajectory of [A] 4.4: centroids of the poses nearest in phase.

Kept beside the harmonic default for those who want [A]'s own method; it needs no model of the
curve, but its centroids jitter where repetitions lie apart.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import ROUNDING
from roundelay.cycles.continuity import followed_poses
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.models.regression import fit_cycle
from roundelay.cycles.thresholds import CENTROID
from roundelay.geometry import rotations as rot
from roundelay.motion.motion import Motion
from roundelay.phase.harmonic import HarmonicCurve, highest_harmonic
from roundelay.phase.mixture import fit_circular_mixture
from roundelay.timeline.evidence import Evidence
from roundelay.timeline.options import Options

__all__ = ["Centroid", "centroid_cycle"]

Array = NDArray[np.float64]


class Centroid:
    """The model of [A] 4.4: centroids of poses."""

    name = "centroid"

    def fit(self, motion: Motion, phase: Array, evidence: Evidence, options: Options) -> Cycle:
        """Fit the cycle; see `roundelay.cycles.models.CycleModel`."""
        runs, count = evidence.runs, options.harmonics
        cycle = fit_cycle(motion, phase, runs, harmonics=count, evidence=evidence)
        return centroid_cycle(
            cycle, motion, neighbours=options.neighbours, gaussian=options.gaussian
        )


def centroid_cycle(
    cycle: Cycle,
    motion: Motion,
    *,
    samples: int | None = None,
    neighbours: int | None = None,
    gaussian: bool = False,
) -> Cycle:
    """Replace the poses of a cycle by centroids of the capture's nearest poses in phase.

    1. The density of the cycle's phase is a Gaussian mixture of 30 components; `samples` phases
       part it into equal shares.
    2. At each, the `neighbours` frames nearest in phase are averaged: rotations on the sphere, the
       root's without the drift of its heading.
    3. The closed polygon of centroids is gone along evenly in phase, so that the poses keep in
       step with the travel, and interpolated by its Fourier series.

    Travel, height and period stay those of the cycle ([A] leaves them out).

    Parameters
    ----------
    cycle : Cycle
        Found in the capture, with its evidence and phase.
    motion : Motion
        The capture.
    samples, neighbours : int, optional
        500 and 10 by default, as in [A] 6.1.
    gaussian : bool
        Weigh neighbours by a Gaussian of their distance in phase instead of equally.

    Returns
    -------
    Cycle
        With as many harmonics as the samples determine.

    Raises
    ------
    ValueError
        If the cycle carries no evidence, or there are fewer frames than neighbours.
    """
    if cycle.evidence is None or cycle.phase is None:
        raise ValueError("expected a cycle found in a capture, with its evidence and phase")
    samples = CENTROID.samples if samples is None else samples
    neighbours = CENTROID.neighbours if neighbours is None else neighbours
    frames = cycle.evidence.runs.frames
    if not 1 <= neighbours <= len(frames):
        raise ValueError(f"expected 1 to {len(frames)} neighbours, found {neighbours}")
    theta = cycle.phase[frames] % 1.0
    harmonics = highest_harmonic(cycle.period)
    followed = followed_poses(
        motion.with_root_motion(), cycle.phase, cycle.evidence.runs, harmonics
    )
    local = followed.local[frames]
    places = fit_circular_mixture(theta).quantiles(samples)
    centroids = np.stack([_centroid(local, theta, place, neighbours, gaussian) for place in places])
    closed = rot.continuous(centroids)
    flips = np.sum(closed[0] * closed[-1], axis=-1) < 0.0
    if flips.any():
        names = [cycle.skeleton.names[joint] for joint in np.flatnonzero(flips)]
        raise ValueError(f"joints that make whole turns have no centroid: {', '.join(names)}")
    even = _evenly(places, closed.reshape(samples, -1))
    pose = HarmonicCurve.through(even)
    return replace(cycle, pose=pose, odd_pose=None)


def _evenly(places: Array, values: Array) -> Array:
    """Return values (n, d) at phases 0, 1 / n, ... on the polygon through those at places."""
    phase = np.arange(len(places)) / len(places)
    columns = [np.interp(phase, places, column, period=1.0) for column in values.T]
    return np.stack(columns, axis=-1)


def _centroid(local: Array, theta: Array, place: float, neighbours: int, gaussian: bool) -> Array:
    apart = np.abs((theta - place + 0.5) % 1.0 - 0.5)
    nearest = np.argpartition(apart, neighbours - 1)[:neighbours]
    weights = None
    if gaussian:
        width = max(float(apart[nearest].max()) / 2.0, ROUNDING)
        weights = np.exp(-0.5 * (apart[nearest] / width) ** 2)
    return rot.mean(local[nearest], weights)
