"""Find what the joints above the hips did in a capture; see `roundelay.cycles.above`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import SIX_DIGITS
from roundelay.cycles.above import Above
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.thresholds import ABOVE
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics, heading
from roundelay.motion.motion import Motion

__all__ = ["as_captured", "as_shown"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def as_captured(cycle: Cycle, motion: Motion) -> Cycle:
    """Tell a cycle which joint carried the body in its capture, and what those above it did.

    Parameters
    ----------
    cycle : Cycle
        Made from the capture with the body's motion in the root, with its evidence and phase.
    motion : Motion
        The capture as it is.

    Returns
    -------
    Cycle
        The one given where the capture's own root carried the body.

    Raises
    ------
    ValueError
        If the cycle carries no evidence or no phase.
    """
    if cycle.evidence is None or cycle.phase is None:
        raise ValueError("expected a cycle found in a capture, with its evidence and phase")
    phase, runs = cycle.phase, cycle.evidence.runs
    start, stop = max(runs, key=lambda run: phase[run[1] - 1] - phase[run[0]])
    return as_shown(cycle, motion[start:stop], phase[start:stop])


def as_shown(cycle: Cycle, shown: Motion, phase: Array) -> Cycle:
    """Tell a cycle the same of a motion that shows it from beginning to end.

    Parameters
    ----------
    cycle : Cycle
        Made from the motion with the body's motion in the root.
    shown : Motion
        As it is.
    phase : (F,) ndarray
        Of its frames, in turns, growing with time.

    Returns
    -------
    Cycle
        The one given where the motion's own root carried the body.
    """
    places, turns = _trunk(shown)
    count = _carrier(places, turns, shown.up, shown.skeleton.size)
    if count == 0:
        return cycle
    lag = max(1, min(round(cycle.period * shown.fps), len(shown) - 1))
    facing = np.unwrap(heading(rot.multiply(turns, rot.conjugate(turns[0])), shown.up), axis=0)
    travels = _goes_along(places, lag)[:count]
    turning = _goes_along(facing[..., None], lag)[:count]
    laid = _laid(cycle, shown[:lag], phase[:lag] - np.floor(phase[0]), count)
    return replace(cycle, above=_steady(cycle, *laid, travels, turning))


def _trunk(motion: Motion) -> tuple[Array, Array]:
    """Return places (F, k, 3) and turns (F, k, 4) in the world, from root to first branching."""
    joints = list(motion.skeleton.trunk)
    places, turns = forward_kinematics(
        motion.skeleton, motion.rotations, motion.root_path, translations=motion.translations
    )
    return places[:, joints], turns[:, joints]


def _carrier(places: Array, turns: Array, up: int, size: float) -> int:
    """Return the first joint that rises and tilts as the last does, the first from above."""
    upright = rot.rotate(rot.conjugate(turns[0]), np.eye(3)[up])
    tilt = np.sqrt(rot.rotate(turns, upright).var(axis=0).sum(axis=-1))
    moves = tilt > ABOVE.share * tilt[-1] + SIX_DIGITS
    rise = _detrended(places[..., up]).std(axis=0)
    moves |= rise > ABOVE.share * rise[-1] + SIX_DIGITS * size
    moves[-1] = True
    return int(np.argmax(moves))


def _detrended(values: Array) -> Array:
    """Take lines of time out of values (F, k): what climbs does not bob."""
    time = np.arange(len(values)) - 0.5 * (len(values) - 1)
    slope = time @ values / max(float(time @ time), 1.0)
    return values - time[:, None] * slope


def _goes_along(values: Array, lag: int) -> Mask:
    """Tell of joints (k,) whether values (F, k, d) gain in a period what the last one's do."""
    gained = values[lag:] - values[:-lag]
    along = np.sum(gained * gained[:, -1:], axis=(0, 2))
    return np.asarray(along > ABOVE.share * along[-1])


def _laid(cycle: Cycle, shown: Motion, phase: Array, count: int) -> tuple[Array, Array, Array]:
    """Lay a period of the capture on the loop: phases, turns and places of the joints above."""
    places, turns = _trunk(shown)
    body, loop = shown.with_root_motion(), cycle.at(phase, frame_time=shown.frame_time)
    away = rot.multiply(loop.rotations[:, 0], rot.conjugate(body.rotations[:, 0]))
    onto = rot.from_rotation_vector(heading(away, shown.up)[:, None] * shown.up_vector)[:, None]
    there = rot.rotate(onto, places[:, :count] - body.root_path[:, None])
    there += loop.root_path[:, None]
    if cycle.velocity.constant[shown.up] == 0.0:
        there[..., shown.up] = places[:, :count, shown.up]
    return phase, rot.multiply(onto, turns[:, :count]), there


def _steady(
    cycle: Cycle, phase: Array, turns: Array, places: Array, travels: Mask, turning: Mask
) -> Above:
    """Average what is left of turns (F, n, 4) and places (F, n, 3) without the steady motion."""
    axis = np.eye(3)[cycle.up]
    back = rot.from_rotation_vector(-cycle.heading(phase)[:, None] * axis)[:, None]
    left = places - np.where(travels[:, None], cycle.steady_path(phase)[:, None], 0.0)
    turned = turning[:, None]
    return Above(
        rot.mean(np.where(turned, rot.multiply(back, turns), turns)),
        np.where(turned, rot.rotate(back, left), left).mean(axis=0),
        travels,
        turning,
    )
