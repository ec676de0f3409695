"""Fit a cycle to the phased frames of a motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from roundelay.base.spans import Span, Spans
from roundelay.base.threads import one_thread
from roundelay.cycles.continuity import Followed, fit_poses, followed_poses
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.thresholds import CYCLE
from roundelay.motion.motion import Motion
from roundelay.phase.harmonic import (
    HarmonicCurve,
    crossfade_weights,
    fit_harmonic,
    highest_harmonic,
)
from roundelay.phase.period import line_period
from roundelay.timeline.evidence import Evidence
from roundelay.timeline.options import Options

__all__ = ["Harmonic", "fit_cycle"]

Array = NDArray[np.float64]


class Harmonic:
    """The default model: harmonic regression of quaternions."""

    name = "harmonic"

    def fit(self, motion: Motion, phase: Array, evidence: Evidence, options: Options) -> Cycle:
        """Fit the cycle; see `roundelay.cycles.models.CycleModel`."""
        runs, count = evidence.runs, options.harmonics
        return fit_cycle(motion, phase, runs, harmonics=count, evidence=evidence)


@one_thread
def fit_cycle(
    motion: Motion,
    turns: Array,
    runs: Sequence[Span],
    *,
    harmonics: int | None = None,
    evidence: Evidence | None = None,
) -> Cycle:
    """Fit a closed curve of poses and its travel by harmonic regression.

    Parameters
    ----------
    motion : Motion
    turns : (F,) ndarray
        Unwrapped phase of every frame in a run, proportional to time on average.
    runs : sequence of (start, stop)
    harmonics : int, optional
        K of [C] eq. 3.6; by default as many as the period can need.
    evidence : Evidence, optional
        Kept with the cycle.

    Returns
    -------
    Cycle

    Raises
    ------
    TooShort
        If the runs hold no whole period.
    """
    period = line_period(turns, runs) * motion.frame_time
    count = highest_harmonic(period) if harmonics is None else harmonics
    poses = followed_poses(motion, turns, runs, count)
    weights = crossfade_weights(turns, list(runs))
    kept = np.flatnonzero(weights)
    even_pose, odd_pose = fit_poses(turns[kept], poses.local[kept], poses.odd, count, weights[kept])
    velocity, height = _fit_path(motion, turns, runs, poses, weights, count)
    moved = None
    if motion.translations is not None:
        values = motion.translations[kept].reshape(len(kept), -1)
        moved = fit_harmonic(turns[kept], values, count, weights=weights[kept])
    return Cycle(
        skeleton=motion.skeleton,
        period=period,
        pose=even_pose,
        odd_pose=odd_pose,
        velocity=velocity,
        height=height,
        turning=poses.turning * period / motion.frame_time,
        up=motion.up,
        fps=motion.fps,
        translations=moved,
        name=motion.name,
        evidence=evidence,
        phase=_within(turns, runs),
    )


def _within(turns: Array, runs: Sequence[Span]) -> Array:
    """Return the phase (F,) of the frames in runs, NaN elsewhere."""
    inside = Spans(runs).frames
    phase = np.full(len(turns), np.nan)
    phase[inside] = turns[inside]
    return phase


def _fit_path(
    motion: Motion, turns: Array, runs: Sequence[Span], poses: Followed, weights: Array, count: int
) -> tuple[HarmonicCurve, HarmonicCurve]:
    """Fit the root's velocity by phase, in the drifting heading, and its height."""
    pairs = np.concatenate([np.arange(start, stop - 1) for start, stop in runs])
    advance = np.maximum(turns[pairs + 1] - turns[pairs], CYCLE.advance)
    middle = 0.5 * (turns[pairs] + turns[pairs + 1])
    # Weights by advance make the mean velocity the displacement over the turns made.
    weight = 0.5 * (weights[pairs] + weights[pairs + 1]) * advance
    used = weight > 0.0
    rate = poses.steps(motion)[pairs[used]] / advance[used, None]
    velocity = fit_harmonic(middle[used], rate, count, weights=weight[used])
    kept = np.flatnonzero(weights)
    height = motion.root_path[kept, motion.up]
    keep_vertical = np.ones(3)
    if abs(velocity.constant[motion.up]) > CYCLE.climbs * motion.skeleton.size:
        height = np.full(len(kept), float(np.mean(height)))
    else:
        keep_vertical[motion.up] = 0.0
    curve = fit_harmonic(turns[kept], height[:, None], count, weights=weights[kept])
    return _scaled(velocity, keep_vertical), curve


def _scaled(curve: HarmonicCurve, factor: Array) -> HarmonicCurve:
    return HarmonicCurve(
        curve.frequencies, curve.constant * factor, curve.sine * factor, curve.cosine * factor
    )
