"""How good a cycle is, in figures with units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.cycles.cycle import Cycle
from roundelay.errors import TooShort
from roundelay.geometry import rotations as rot
from roundelay.motion import Motion
from roundelay.poses import point_cloud
from roundelay.timing import Run

__all__ = ["Quality", "jerk", "quality"]

Array = NDArray[np.float64]

# Third derivative, forward, of 4th order (Fornberg 1988; [A] 6.3).
_JERK = np.array([-49 / 8, 29, -461 / 8, 62, -307 / 8, 13, -15 / 8])
# Phases at which a cycle is laid against its capture.
_GRID = 256


@dataclass(frozen=True)
class Quality:
    """Figures of a cycle beside those of the capture it came from.

    Attributes
    ----------
    seam_rotation : float
        Largest rotation of a joint from the last frame to the first, in degrees.
    step_rotation : float
        The largest between neighbouring frames elsewhere in the loop, in degrees.
    seam_velocity : float
        Change of the joints' velocities across the seam (RMS over joints), in body sizes a
        second.
    capture_velocity : float
        The 95th percentile of that change between neighbouring frames of the capture.
    loop_jerk, capture_jerk : float
        Mean length of the joints' third derivative by time, in body sizes a second cubed,
        by 4th-order forward differences ([A] 6.3).
    template_error : float
        RMS over frames of the angles between the capture and the repeated loop at its best
        offset, as the root of the sum of squares over the joints but the root, in radians
        ([C] eq. 4.4, 4.5 with angles of rotation for differences of Euler angles).
    repetitions : float
        Periods seen in the capture.
    frames : int
        Frames of the capture that the cycle was made from.
    """

    seam_rotation: float
    step_rotation: float
    seam_velocity: float
    capture_velocity: float
    loop_jerk: float
    capture_jerk: float
    template_error: float
    repetitions: float
    frames: int


def quality(cycle: Cycle, motion: Motion) -> Quality:
    """Measure a cycle against the capture it was found in.

    Parameters
    ----------
    cycle : Cycle
        As from `find_cycles`.
    motion : Motion
        The capture given to it.

    Returns
    -------
    Quality

    Raises
    ------
    ValueError
        If the cycle carries no evidence of where it was found.
    """
    if cycle.evidence is None:
        raise ValueError("expected a cycle found in a capture, with its evidence")
    motion, runs = motion.with_root_motion(), cycle.evidence.runs
    loop = cycle.sample()
    turned = np.degrees(rot.angle_between(loop.rotations, np.roll(loop.rotations, 1, axis=0)))
    # The root may travel on after the seam: joints are compared without it.
    steps = turned[:, 1:].max(axis=1) if turned.shape[1] > 1 else turned.max(axis=1)
    places, source = point_cloud(loop), point_cloud(motion)
    changes = np.concatenate([_velocity_changes(source[a:b], motion.fps) for a, b in runs])
    around = np.concatenate([places[-2:], places[:2]])
    return Quality(
        seam_rotation=float(steps[0]),
        step_rotation=float(steps[1:].max(initial=0.0)),
        seam_velocity=float(_velocity_changes(around, motion.fps).max()),
        capture_velocity=float(np.percentile(changes, 95)),
        loop_jerk=_mean_jerk(np.concatenate([places, places[:6]]), motion.fps),
        capture_jerk=float(np.mean([_mean_jerk(source[a:b], motion.fps) for a, b in runs])),
        template_error=_template_error(cycle, motion, runs),
        repetitions=cycle.evidence.repetitions,
        frames=sum(b - a for a, b in runs),
    )


def jerk(values: ArrayLike, fps: float) -> Array:
    """Return the third derivative by time, (n - 6, d), of values (n, d) ([A] 6.3).

    Raises
    ------
    TooShort
        If there are fewer than 7 frames.
    """
    x = np.asarray(values, float)
    if len(x) < 7:
        raise TooShort(f"jerk needs at least 7 frames, found {len(x)}")
    windows = np.lib.stride_tricks.sliding_window_view(x, 7, axis=0)
    return np.asarray(windows @ _JERK * fps**3)


def _mean_jerk(points: Array, fps: float) -> float:
    if len(points) < 7:
        return float("nan")
    joints = jerk(points, fps).reshape(len(points) - 6, -1, 3)
    return float(np.linalg.norm(joints, axis=-1).mean())


def _velocity_changes(points: Array, fps: float) -> Array:
    """Return RMS over joints of how much velocity changes at each inner frame."""
    change = np.diff(points, n=2, axis=0).reshape(len(points) - 2, -1, 3) * fps
    return np.asarray(np.sqrt(np.mean(np.sum(change**2, axis=-1), axis=-1)))


def _template_error(cycle: Cycle, motion: Motion, runs: tuple[Run, ...]) -> float:
    """Lay the loop, repeated at a constant tempo, against each run; see `Quality`."""
    grid = cycle.rotations(np.arange(_GRID) / _GRID)
    total = frames = 0.0
    for start, stop in runs:
        apart = np.zeros((stop - start, _GRID))
        for joint in range(1, motion.skeleton.n_joints):
            cosine = np.abs(motion.rotations[start:stop, joint] @ grid[:, joint].T)
            apart += (2.0 * np.arccos(np.minimum(cosine, 1.0))) ** 2
        steps = np.arange(stop - start) / (cycle.period * motion.fps) * _GRID
        tried = [
            float(apart[np.arange(stop - start), (np.round(steps) + k).astype(int) % _GRID].sum())
            for k in range(_GRID)
        ]
        total, frames = total + min(tried), frames + (stop - start)
    return float(np.sqrt(total / frames))
