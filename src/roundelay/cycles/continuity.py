"""Poses of several repetitions made comparable: heading, signs, glitches, runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import TINY
from roundelay.base.spans import Span, Spans
from roundelay.cycles.thresholds import CONTINUITY
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import heading
from roundelay.motion.motion import Motion
from roundelay.phase.harmonic import HarmonicCurve, fit_harmonic

__all__ = ["Followed", "fit_poses", "followed_poses"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Followed:
    """Hold poses that can be averaged over the repetitions.

    Attributes
    ----------
    local : (F, J, 4) ndarray
        Local rotations in every run, followed in sign through time and from run to run; the
        root's without the drift of its heading.
    odd : (J,) ndarray of bool
        Joints whose sign changes from repetition to repetition.
    jumps : (J,) ndarray of bool
        Joints that turn too far between two frames to be followed in sign.
    drift : (F,) ndarray
        Heading in radians that was taken from the root.
    turning : float
        Mean gain of the heading in radians a frame.
    """

    local: Array
    odd: NDArray[np.bool_]
    jumps: NDArray[np.bool_]
    drift: Array
    turning: float

    def steps(self, motion: Motion) -> Array:
        """Return the root's steps (F - 1, 3) from frame to frame in the drifting heading."""
        middle = 0.5 * (self.drift[1:] + self.drift[:-1])
        back = rot.from_rotation_vector(-middle[:, None] * motion.up_vector)
        return rot.rotate(back, np.diff(motion.root_path, axis=0))


def followed_poses(motion: Motion, turns: Array, runs: Sequence[Span], harmonics: int) -> Followed:
    """Free the poses of a motion's frames from what keeps them from being averaged.

    Parameters
    ----------
    motion : Motion
    turns : (F,) ndarray
        Unwrapped phase of every frame in a run.
    runs : sequence of (start, stop)
    harmonics : int
        At most so many tell how other runs lie to the longest.
    """
    returns = [_returns(turns, run) for run in runs]
    closed = not any(len(first) for first, _ in returns)
    if closed:
        # One closed period: its ends are the pair.
        returns = [(np.array([start]), np.array([stop - 1])) for start, stop in runs]
    drift, rate = _heading_drift(motion, turns, returns, runs)
    local = motion.rotations.copy()
    back = rot.from_rotation_vector(-drift[:, None] * motion.up_vector)
    local[:, 0] = rot.multiply(back, local[:, 0])
    odd, jumps = _signed(local, returns, runs)
    if closed:
        _close(local[slice(*runs[0])], turns[slice(*runs[0])])
    if len(runs) > 1:
        drift = drift + _align_runs(local, turns, runs, odd, harmonics, motion.up)
    return Followed(local, odd, jumps, drift, rate)


def _returns(turns: Array, run: Span) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Pair frames of a run with the first ones at least a turn later."""
    rising = np.maximum.accumulate(turns[run[0] : run[1]])
    later = np.searchsorted(rising, rising + 1.0)
    first = np.flatnonzero(later < len(rising))
    return run[0] + first, run[0] + later[first]


def _heading_drift(
    motion: Motion,
    turns: Array,
    returns: list[tuple[NDArray[np.intp], NDArray[np.intp]]],
    runs: Sequence[Span],
) -> tuple[Array, float]:
    """Integrate the turning from period to period: a heading without the gait's own sway.

    Comparing a pose with the one a period later needs no upright body, and leaves whole turns
    within a period to the pose. Returns the heading (F,) and its mean rate in radians a frame.
    """
    root, drift = motion.rotations[:, 0], np.zeros(len(motion))
    rates = []
    for (first, later), (start, stop) in zip(returns, runs, strict=True):
        if len(first) == 0:
            continue
        # What spins turns far in the part of a frame by which a pair is more than a turn apart.
        beyond = np.maximum(turns[later] - turns[first] - 1.0, 0.0)
        part = np.minimum(beyond / np.maximum(turns[later] - turns[later - 1], TINY), 1.0)
        end = rot.slerp(root[later], root[later - 1], part)
        gain = np.unwrap(heading(rot.multiply(end, rot.conjugate(root[first])), motion.up))
        middle, rate = 0.5 * (first + later - part), gain / (later - part - first)
        rates.append(rate)
        steps = np.interp(np.arange(start, stop), middle, rate)
        drift[start:stop] = np.cumsum(steps) - steps
    return drift, float(np.mean(np.concatenate(rates)))


def _signed(
    local: Array, returns: list[tuple[NDArray[np.intp], NDArray[np.intp]]], runs: Sequence[Span]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Choose signs of quaternions (F, J, 4) in place; tell the joints (J,) that are odd, that jump.

    Signs follow a joint through time, and it is odd if most of its poses come back with the
    other sign: it makes an odd number of whole turns a period. A joint that jumps cannot be
    followed: if it keeps to one side of the sphere but for a few frames, it takes the signs of
    that side, and those few are bridged.
    """
    agreement = [np.einsum("fjq,fjq->fj", local[a], local[b]) > 0.0 for a, b in returns]
    odd = np.concatenate(agreement).mean(axis=0) < 0.5
    follows = [
        np.abs(np.einsum("fjq,fjq->fj", local[a + 1 : b], local[a : b - 1])) for a, b in runs
    ]
    jumps = np.concatenate(follows).min(axis=0, initial=1.0) < CONTINUITY.jump
    inside = Spans(runs).frames
    for joint in np.flatnonzero(jumps):
        values = local[inside, joint]
        side = values @ rot.mean(values)
        away = np.abs(side) <= CONTINUITY.one_side
        if away.mean() < CONTINUITY.glitches:
            # A glitch begins and ends a few frames beside its worst.
            around = np.convolve(away, np.ones(2 * CONTINUITY.beside + 1), mode="same") > 0.5
            sound = np.flatnonzero(~around)
            local[inside, joint] = _bridged(values * np.sign(side)[:, None], sound)
            odd[joint] = False
    return odd, jumps


def _bridged(values: Array, sound: NDArray[np.intp]) -> Array:
    """Interpolate unit quaternions (n, 4) between sound ones."""
    frames = np.arange(len(values))
    columns = [np.interp(frames, sound, column) for column in values[sound].T]
    return rot.normalize(np.stack(columns, axis=-1))


def _close(local: Array, turns: Array) -> None:
    """Spread over one period what its ends lack to meet; changes `local` (n, J, 4)."""
    left = turns[0] + 1.0 - turns[-1]
    step = turns[1] - turns[0]
    first, last = local[0], local[-1]
    # Half of the way from end to end at each end's own speed.
    ahead = rot.vector_between(local[-2], last), rot.vector_between(first, local[1])
    moved = [turn * (0.5 * left / step) for turn in ahead]
    there = rot.multiply(last, rot.from_rotation_vector(moved[0] + moved[1]))
    lack = rot.vector_between(there, first)
    share = (turns - turns.mean())[:, None, None]
    local[:] = rot.multiply(local, rot.from_rotation_vector(share * lack))


def _align_runs(
    local: Array, turns: Array, runs: Sequence[Span], odd: NDArray[np.bool_], count: int, up: int
) -> Array:
    """Turn each run to the heading of the longest and give its quaternions the same signs.

    Changes `local`; returns what was added to each frame's heading drift.
    """
    added = np.zeros(len(local))
    longest = max(runs, key=lambda run: turns[run[1] - 1] - turns[run[0]])
    inside = slice(*longest)
    count = min(count, CONTINUITY.harmonics)
    even_part, odd_part = fit_poses(turns[inside], local[inside], odd, count, None)
    for run in runs:
        if run == longest:
            continue
        here = slice(*run)
        model = even_part(turns[here]) + (0.0 if odd_part is None else odd_part(turns[here]))
        model = rot.normalize(model.reshape(-1, local.shape[1], 4))
        apart = heading(rot.multiply(local[here, 0], rot.conjugate(model[:, 0])), up)
        angle = float(np.angle(np.mean(np.exp(1j * apart))))
        added[here] = angle
        back = rot.from_rotation_vector(-angle * np.eye(3)[up])
        local[here, 0] = rot.multiply(back, local[here, 0])
        signs = np.sign(np.einsum("fjq,fjq->j", local[here], model))
        local[here] *= np.where(signs == 0.0, 1.0, signs)[:, None]
    return added


def fit_poses(
    turns: Array, local: Array, odd: NDArray[np.bool_], count: int, weights: Array | None
) -> tuple[HarmonicCurve, HarmonicCurve | None]:
    """Fit quaternions (n, J, 4) as curves of 4 J values, even and odd joints apart."""
    values = local.reshape(len(local), -1)
    column = np.repeat(odd, 4)
    even = fit_harmonic(turns, np.where(column, 0.0, values), count, weights=weights)
    if not odd.any():
        return even, None
    masked = np.where(column, values, 0.0)
    return even, fit_harmonic(turns, masked, count, weights=weights, odd=True)
