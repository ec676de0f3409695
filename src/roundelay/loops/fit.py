"""How like its capture a loop is: laid against it, compared in angles and in frequencies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.numeric import SMALLEST
from roundelay.base.spans import Span
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.models.constrained import finite_differences
from roundelay.geometry import rotations as rot
from roundelay.loops.thresholds import FIT
from roundelay.motion.features import joint_turns
from roundelay.motion.motion import Motion

__all__ = ["Laid", "lay", "npss", "rmse"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Laid:
    """Hold a run of a capture and the loop repeated beside it at one tempo.

    Attributes
    ----------
    phase : (n,) ndarray
        Of the loop at each frame, in turns.
    capture, loop : (n, J - 1, 4) ndarray
        Rotations of all joints but the root.
    """

    phase: Array
    capture: Array
    loop: Array

    @property
    def apart(self) -> Array:
        """Rotations from loop to capture (n, 3 (J - 1)) as vectors, in radians."""
        return rot.vector_between(self.loop, self.capture).reshape(len(self.phase), -1)


def lay(cycle: Cycle, motion: Motion, run: Span) -> Laid:
    """Lay a cycle, repeated at its tempo, against frames of a capture where it fits best.

    Best means the least sum over frames of distances ([C] eq. 4.4, with angles of rotation for
    differences of Euler angles).
    """
    capture = joint_turns(motion[slice(*run)])[:, 1:]
    grid = _turns(cycle, np.arange(FIT.phases) / FIT.phases)
    steps = np.arange(len(capture)) / (cycle.period * motion.fps)
    shown = np.linspace(0, len(capture) - 1, min(len(capture), FIT.frames)).astype(np.intp)
    squares = np.zeros((len(shown), FIT.phases))
    for joint in range(capture.shape[1]):
        cosine = np.abs(capture[shown, joint] @ grid[:, joint].T)
        squares += (2.0 * np.arccos(np.minimum(cosine, 1.0))) ** 2
    distance, rows = np.sqrt(squares), np.arange(len(shown))
    nearest = np.round(steps[shown] * FIT.phases).astype(np.intp)
    sums = [distance[rows, (nearest + shift) % FIT.phases].sum() for shift in range(FIT.phases)]
    phase = steps + int(np.argmin(sums)) / FIT.phases
    return Laid(phase, capture, _turns(cycle, phase))


def _turns(cycle: Cycle, phase: Array) -> Array:
    """Return how far the joints but the root are turned, (n, J - 1, 4), at phases (n,)."""
    if not cycle.skeleton.free:
        return cycle.rotations(phase)[:, 1:]
    return joint_turns(cycle.at(phase, frame_time=1.0 / cycle.fps))[:, 1:]


def rmse(laid: Sequence[Laid], fps: float) -> tuple[float, float, float]:
    """Return RMS differences of rotations, velocities and accelerations ([C] eq. 4.1-4.3).

    Without [C]'s weights, in radians, radians a second and radians a second squared;
    derivatives by eq. 3.23 and 3.24. Runs of fewer than 9 frames have none; NaN if all are.
    """
    apart = [part.apart for part in laid]
    derived = [finite_differences(values, fps) for values in apart if len(values) > 8]
    orders = [apart, [velocity for velocity, _ in derived], [second for _, second in derived]]
    first, second, third = (_root_mean_square(parts) for parts in orders)
    return first, second, third


def _root_mean_square(parts: list[Array]) -> float:
    squares = [np.sum(values**2, axis=1) for values in parts]
    return float(np.sqrt(np.mean(np.concatenate(squares)))) if squares else float("nan")


def npss(truth: ArrayLike, other: ArrayLike, *, shift_invariant: bool = False) -> float:
    """Return the normalised power spectrum similarity of two sequences (0: alike).

    For every channel the power spectra, each of sum 1, are compared by the earth mover's
    distance (the sum of differences of their running sums); channels are weighted by the power
    of the truth (Gopalakrishnan et al. 2019, "A neural temporal model for human motion
    prediction", eq. 5-8).

    Parameters
    ----------
    truth, other : (n, d) array_like
        Channels over time.
    shift_invariant : bool
        Leave out the channels' means and look through a Hann window: where a channel is zero,
        and at what phase of its motion a sequence begins, then does not count.
    """
    powers = [_power(np.asarray(values, float), shift_invariant) for values in (truth, other)]
    totals = [power.sum(axis=0) for power in powers]
    shares = [p / np.maximum(t, SMALLEST) for p, t in zip(powers, totals, strict=True)]
    moved = np.abs(np.cumsum(shares[0], axis=0) - np.cumsum(shares[1], axis=0)).sum(axis=0)
    return float(moved @ totals[0] / max(float(totals[0].sum()), SMALLEST))


def _power(values: Array, shift_invariant: bool) -> Array:
    """Return the power (n, d) at every frequency of the discrete Fourier transform."""
    if shift_invariant:
        values = (values - values.mean(axis=0)) * np.hanning(len(values))[:, None]
    return np.asarray(np.abs(np.fft.fft(values, axis=0)) ** 2)
