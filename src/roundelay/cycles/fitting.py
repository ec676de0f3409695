"""Fit a cycle to the phased frames of a motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from roundelay.cycles.cycle import Cycle
from roundelay.cycles.harmonic import (
    HarmonicCurve,
    crossfade_weights,
    fit_harmonic,
    highest_harmonic,
)
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import heading
from roundelay.motion import Motion
from roundelay.periodicity import Evidence
from roundelay.timing import Run, line_period

__all__ = ["fit_cycle"]

Array = NDArray[np.float64]

# A cycle climbs if it gains more than this share of the body's size a period (stairs, ladders);
# less is the drift of a capture's floor.
_CLIMB = 0.05
# A joint keeps to one side of its mean if all but a twentieth of its poses lie within 145
# degrees of it, where this is the cosine of half the angle.
_ONE_SIDE, _GLITCHES = 0.3, 0.05
_BESIDE = 3
# It jumps if it turns by more than 60 degrees from a frame to the next: cosine of the half.
_JUMP = 0.866


def fit_cycle(
    motion: Motion,
    turns: Array,
    runs: Sequence[Run],
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
    returns = [_returns(turns, run) for run in runs]
    closed = not any(len(first) for first, _ in returns)
    if closed:
        # One closed period: its ends are the pair.
        returns = [(np.array([start]), np.array([stop - 1])) for start, stop in runs]
    drift, rate = _heading_drift(motion, returns, runs)
    local = motion.rotations.copy()
    back = rot.from_rotation_vector(-drift[:, None] * motion.up_vector)
    local[:, 0] = rot.multiply(back, local[:, 0])
    odd = _signed(local, returns, runs)
    weights = crossfade_weights(turns, list(runs))
    if closed:
        _close(local[slice(*runs[0])], turns[slice(*runs[0])])
    if len(runs) > 1:
        drift = drift + _align_runs(local, turns, runs, odd, count, motion.up)
    kept = np.flatnonzero(weights)
    even_pose, odd_pose = _fit_poses(turns[kept], local[kept], odd, count, weights[kept])
    velocity, height = _fit_path(motion, turns, runs, drift, weights, count)
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
        turning=rate * period / motion.frame_time,
        up=motion.up,
        fps=motion.fps,
        translations=moved,
        name=motion.name,
        evidence=evidence,
    )


def _returns(turns: Array, run: Run) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Pair frames of a run with those one turn later (nearest frame)."""
    rising = np.maximum.accumulate(turns[run[0] : run[1]])
    later = np.searchsorted(rising, rising + 1.0)
    first = np.flatnonzero(later < len(rising))
    return run[0] + first, run[0] + later[first]


def _heading_drift(
    motion: Motion, returns: list[tuple[NDArray[np.intp], NDArray[np.intp]]], runs: Sequence[Run]
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
        gain = np.unwrap(heading(rot.multiply(root[later], rot.conjugate(root[first])), motion.up))
        middle, rate = 0.5 * (first + later), gain / (later - first)
        rates.append(rate)
        steps = np.interp(np.arange(start, stop), middle, rate)
        drift[start:stop] = np.cumsum(steps) - steps
    return drift, float(np.mean(np.concatenate(rates)))


def _signed(
    local: Array, returns: list[tuple[NDArray[np.intp], NDArray[np.intp]]], runs: Sequence[Run]
) -> NDArray[np.bool_]:
    """Choose signs of quaternions (F, J, 4) in place; tell the joints (J,) that are odd.

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
    jumps = np.concatenate(follows).min(axis=0, initial=1.0) < _JUMP
    inside = np.concatenate([np.arange(*run) for run in runs])
    for joint in np.flatnonzero(jumps):
        values = local[inside, joint]
        side = values @ rot.mean(values)
        away = np.abs(side) <= _ONE_SIDE
        if away.mean() < _GLITCHES:
            # A glitch begins and ends a few frames beside its worst.
            around = np.convolve(away, np.ones(2 * _BESIDE + 1), mode="same") > 0.5
            sound = np.flatnonzero(~around)
            local[inside, joint] = _bridged(values * np.sign(side)[:, None], sound)
            odd[joint] = False
    return odd


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
    ahead = (
        rot.multiply(rot.conjugate(local[-2]), last),
        rot.multiply(rot.conjugate(first), local[1]),
    )
    moved = [rot.to_rotation_vector(turn) * (0.5 * left / step) for turn in ahead]
    there = rot.multiply(last, rot.from_rotation_vector(moved[0] + moved[1]))
    lack = rot.to_rotation_vector(rot.multiply(rot.conjugate(there), first))
    share = (turns - turns.mean())[:, None, None]
    local[:] = rot.multiply(local, rot.from_rotation_vector(share * lack))


def _align_runs(
    local: Array, turns: Array, runs: Sequence[Run], odd: NDArray[np.bool_], count: int, up: int
) -> Array:
    """Turn each run to the heading of the longest and give its quaternions the same signs.

    Changes `local`; returns what was added to each frame's heading drift.
    """
    added = np.zeros(len(local))
    longest = max(runs, key=lambda run: turns[run[1] - 1] - turns[run[0]])
    inside = slice(*longest)
    even_part, odd_part = _fit_poses(turns[inside], local[inside], odd, min(count, 8), None)
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


def _fit_poses(
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


def _fit_path(
    motion: Motion, turns: Array, runs: Sequence[Run], drift: Array, weights: Array, count: int
) -> tuple[HarmonicCurve, HarmonicCurve]:
    """Fit the root's velocity by phase, in the drifting heading, and its height."""
    pairs = np.concatenate([np.arange(start, stop - 1) for start, stop in runs])
    advance = np.maximum(turns[pairs + 1] - turns[pairs], 1e-6)
    back = rot.from_rotation_vector(
        -0.5 * (drift[pairs] + drift[pairs + 1])[:, None] * motion.up_vector
    )
    step = rot.rotate(back, np.diff(motion.root_path, axis=0)[pairs])
    middle = 0.5 * (turns[pairs] + turns[pairs + 1])
    # Weights by advance make the mean velocity the displacement over the turns made.
    weight = 0.5 * (weights[pairs] + weights[pairs + 1]) * advance
    used = weight > 0.0
    rate = step[used] / advance[used, None]
    velocity = fit_harmonic(middle[used], rate, count, weights=weight[used])
    kept = np.flatnonzero(weights)
    height = motion.root_path[kept, motion.up]
    climbs = abs(velocity.constant[motion.up]) > _CLIMB * motion.skeleton.size
    keep_vertical = np.ones(3)
    if climbs:
        height = np.full(len(kept), float(np.mean(height)))
    else:
        keep_vertical[motion.up] = 0.0
    curve = fit_harmonic(turns[kept], height[:, None], count, weights=weights[kept])
    return _scaled(velocity, keep_vertical), curve


def _scaled(curve: HarmonicCurve, factor: Array) -> HarmonicCurve:
    return HarmonicCurve(
        curve.frequencies, curve.constant * factor, curve.sine * factor, curve.cosine * factor
    )
