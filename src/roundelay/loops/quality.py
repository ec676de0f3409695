"""How good a cycle is, in figures with units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.checks import expected
from roundelay.base.errors import TooShort
from roundelay.base.spans import Spans
from roundelay.base.threads import one_thread
from roundelay.cycles.cycle import Cycle
from roundelay.geometry import rotations as rot
from roundelay.geometry.contacts import find_feet, skate
from roundelay.loops.fit import Laid, lay, npss, rmse
from roundelay.loops.thresholds import QUALITY
from roundelay.motion.features import joint_turns, point_cloud
from roundelay.motion.feet import touching
from roundelay.motion.motion import Motion

__all__ = ["Quality", "jerk", "quality", "velocity_changes"]

Array = NDArray[np.float64]

# Third derivative, forward, of 4th order (Fornberg 1988; [A] 6.3).
_JERK = np.array([-49 / 8, 29, -461 / 8, 62, -307 / 8, 13, -15 / 8])


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
    seam_length : float
        Longest way of a joint, relative to the root, from the last frame to the first, in the
        skeleton's length unit.
    loop_skate, capture_skate : float
        How far feet slide along the ground in a period, in body sizes
        (`roundelay.geometry.contacts.skate`).
    velocity_error, acceleration_error : float
        The same as the template error of velocities and accelerations, in radians a second and
        a second squared ([C] eq. 4.2, 4.3 without weights).
    npss, npss_shift_invariant : float
        Difference of frequencies of capture and repeated loop (`roundelay.loops.fit.npss`).
    coverage : float
        Share of the circle that the capture shows.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> found = rl.quality(rl.find_cycles(walk)[0], walk)
    >>> found.seam_rotation <= found.step_rotation
    True
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
    seam_length: float
    loop_skate: float
    capture_skate: float
    velocity_error: float
    acceleration_error: float
    npss: float
    npss_shift_invariant: float
    coverage: float


@one_thread
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

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> found = rl.quality(rl.find_cycles(walk)[0], walk)
    >>> found.seam_rotation <= found.step_rotation
    True
    """
    cycle, motion = expected(Cycle, cycle), expected(Motion, motion)
    if cycle.evidence is None:
        raise ValueError("expected a cycle found in a capture, with its evidence")
    motion, runs = motion.with_root_motion(), cycle.evidence.runs
    loop = cycle.sample().with_root_motion()
    turns = joint_turns(loop)
    turned = np.degrees(rot.angle_between(turns, np.roll(turns, 1, axis=0)))
    # The root may travel on after the seam: joints are compared without it.
    steps = turned[:, 1:].max(axis=1) if turned.shape[1] > 1 else turned.max(axis=1)
    places, source = point_cloud(loop), point_cloud(motion)
    changes = np.concatenate([velocity_changes(source[a:b], motion.fps) for a, b in runs])
    around = np.concatenate([places[-2:], places[:2]])
    gap = np.linalg.norm((places[0] - places[-1]).reshape(-1, 3), axis=1)
    laid = [lay(cycle, motion, run) for run in runs]
    template, velocity, acceleration = rmse(laid, motion.fps)
    slid = _skates(cycle, motion, runs)
    return Quality(
        seam_rotation=float(steps[0]),
        step_rotation=float(steps[1:].max(initial=0.0)),
        seam_velocity=float(velocity_changes(around, motion.fps).max()),
        capture_velocity=float(np.percentile(changes, QUALITY.usual)),
        loop_jerk=_mean_jerk(np.concatenate([places, places[:6]]), fps=motion.fps),
        capture_jerk=_mean_jerk(*[source[a:b] for a, b in runs], fps=motion.fps),
        template_error=template,
        repetitions=cycle.evidence.repetitions,
        frames=runs.total,
        seam_length=float(gap.max()) * motion.skeleton.size,
        loop_skate=slid[0],
        capture_skate=slid[1],
        velocity_error=velocity,
        acceleration_error=acceleration,
        npss=_spectral_difference(laid, shift_invariant=False),
        npss_shift_invariant=_spectral_difference(laid, shift_invariant=True),
        coverage=_coverage(laid),
    )


def _skates(cycle: Cycle, motion: Motion, runs: Spans) -> tuple[float, float]:
    """Return how far feet slide in a period, in body sizes, in the loop and in the capture."""
    feet = find_feet(motion.skeleton, motion.positions(), motion.up)
    if not feet:
        return 0.0, 0.0

    def slid(part: Motion) -> float:
        points = touching(part, feet)
        return skate(points, fps=part.fps, size=part.skeleton.size, up=part.up)

    periods = runs.total / (cycle.period * motion.fps)
    # Two periods: the slide across the seam counts.
    return 0.5 * slid(cycle.sample(periods=2, repeat_first=True)), sum(
        slid(motion[a:b]) for a, b in runs
    ) / periods


def _spectral_difference(laid: list[Laid], *, shift_invariant: bool) -> float:
    """Return the spectral difference of joints' turns from their mean, over all runs."""
    middle = rot.mean(laid[0].capture)
    values = []
    for part in laid:
        turns = [
            rot.vector_between(middle, side).reshape(len(part.phase), -1)
            for side in (part.capture, part.loop)
        ]
        values.append(npss(turns[0], turns[1], shift_invariant=shift_invariant))
    return float(np.average(values, weights=[len(part.phase) for part in laid]))


def _coverage(laid: list[Laid]) -> float:
    count = QUALITY.cells
    cells = [np.floor(part.phase * count).astype(int) % count for part in laid]
    return len(np.unique(np.concatenate(cells))) / count


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


def _mean_jerk(*runs: Array, fps: float) -> float:
    """Return the mean over runs (n, 3 J) that are long enough; NaN if none is."""
    joints = [jerk(run, fps).reshape(len(run) - 6, -1, 3) for run in runs if len(run) > 6]
    means = [np.linalg.norm(one, axis=-1).mean() for one in joints]
    return float(np.mean(means)) if means else float("nan")


def velocity_changes(points: Array, fps: float) -> Array:
    """Return RMS over joints of how much velocity changes at each inner frame."""
    change = np.diff(points, n=2, axis=0) * fps
    # Of three values a joint.
    return np.asarray(np.sqrt(3 * np.mean(change**2, axis=1)))
