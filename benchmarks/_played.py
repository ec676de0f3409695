"""Measures of what a player shows of a loop, against the motion that was written."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from benchmarks._players import Played

__all__ = ["Shown", "largest_step", "shown"]

Array = NDArray[np.float64]

# Below this, a turn in a period is none, in radians.
_STRAIGHT = 1e-4


@dataclass(frozen=True)
class Shown:
    """What was measured of one file in one player.

    Parameters
    ----------
    join : float
        The largest acceleration at the join over the largest elsewhere.
    step : float
        The largest step of a joint about the hips, lengths of the written motion a second.
    height : float
        Of the first frame, in the player's unit.
    travel : float
        By how much the way in a period differs from the one written, in body sizes.
    apart : float
        How far joints are from where the written motion has them, at most, in body sizes.
    seconds : float
        By how much a round is longer than the period written.
    looped : bool or None
    """

    join: float
    step: float
    height: float
    travel: float
    apart: float
    seconds: float
    looped: bool | None


def shown(played: Played, whole: rl.Motion, *, joined: tuple[float, float] | None = None) -> Shown:
    """Measure.

    Parameters
    ----------
    played : Played
    whole : Motion
        What was written, up to the frame that repeats the first; lengths in its own unit.
    joined : pair of float, optional
        The seconds where motions are joined in one that is no loop; by default where it repeats.
    """
    seen, wanted = _matched(played, whole)
    size, period = whole.skeleton.size, (len(whole) - 1) * whole.frame_time
    a_frame = played.rate * whole.frame_time
    keys = np.round(np.arange(len(whole) - 1) * a_frame).astype(int)
    scale, turn, shift = _similarity(seen[keys].reshape(-1, 3), wanted[:-1].reshape(-1, 3))
    back = (seen - shift) @ turn / scale
    times = played.start + np.arange(len(back)) / played.rate
    # The last moment before it starts again, and where the hips should be then.
    end = keys[-1]
    gone = (back[end] - back[0]) - (wanted[-2] - wanted[0])
    still = back if joined else _along(back, times, period, _screw(wanted, whole.up))
    where = joined or (period - 1.01 * whole.frame_time, period + 0.51 * whole.frame_time)
    return Shown(
        join=_join(still, times, where, period),
        step=largest_step(back[keys], whole.skeleton, whole.fps),
        height=_height(seen[0], whole, turn),
        travel=float(np.linalg.norm(gone.mean(axis=0))) / size,
        apart=float(np.linalg.norm(back[keys] - wanted[:-1], axis=-1).max()) / size,
        seconds=abs(played.duration - period),
        looped=played.looped,
    )


def _height(points: Array, whole: rl.Motion, turn: Array) -> float:
    """Return how high the body (J, 3) reaches in the player's world, turned as it is there."""
    up = int(np.argmax(np.abs(turn[:, whole.up])))
    return float(np.ptp(np.delete(points[:, up], whole.skeleton.trunk[:-1])))


def largest_step(points: Array, skeleton: rl.Skeleton, fps: float) -> float:
    """Return the largest step of a joint about the hips, in lengths a second.

    A step takes a thirtieth of a second, or a frame: within less, captures show noise. What
    lies above the hips is no part of the body.
    """
    *above, body = skeleton.trunk
    about = np.delete(points - points[:, body : body + 1], above, axis=1)
    lag = max(1, round(fps / 30.0))
    steps = np.linalg.norm(about[lag:] - about[:-lag], axis=-1)
    return float(steps.max(initial=0.0)) * fps / lag


def _matched(played: Played, whole: rl.Motion) -> tuple[Array, Array]:
    """Return the joints that the player has, as seen (T, J, 3) and as written (F, J, 3)."""
    places = {_plain(name): number for number, name in enumerate(played.names)}
    names = [_plain(name) for name in whole.skeleton.names]
    missing = [name for name in names if name not in places]
    if missing:
        raise ValueError(f"the player lacks the joints {', '.join(missing[:4])}")
    return played.places[:, [places[name] for name in names]], whole.positions()


def _plain(name: str) -> str:
    """Return a name without what players change in it."""
    return re.sub(r"[^a-z0-9]", "", name.lower())


def _similarity(there: Array, here: Array) -> tuple[float, Array, Array]:
    """Return scale, rotation and shift that take points here to those there (Umeyama)."""
    middle, goal = here.mean(axis=0), there.mean(axis=0)
    left, weights, right = np.linalg.svd((there - goal).T @ (here - middle))
    sign = np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
    turn = left @ sign @ right
    scale = float(np.trace(np.diag(weights) @ sign) / np.sum((here - middle) ** 2))
    return scale, turn, goal - scale * turn @ middle


@dataclass(frozen=True)
class _Screw:
    """What takes the first frame to the last: a turn about a point in the plane, and a way."""

    up: int
    angle: float
    middle: complex
    way: complex
    climb: float


def _screw(points: Array, up: int) -> _Screw:
    """Fit the screw from the first frame (J, 3) to the last."""
    start, end = _plane(points[0], up), _plane(points[-1], up)
    angle = float(np.angle(np.vdot(start - start.mean(), end - end.mean())))
    climb = float(np.mean(points[-1, :, up] - points[0, :, up]))
    if abs(angle) < _STRAIGHT:
        return _Screw(up, 0.0, 0j, complex(end.mean() - start.mean()), climb)
    turn = np.exp(1j * angle)
    middle = (end.mean() - turn * start.mean()) / (1.0 - turn)
    return _Screw(up, angle, complex(middle), 0j, climb)


def _plane(points: Array, up: int) -> NDArray[np.complex128]:
    return points[..., (up + 1) % 3] + 1j * points[..., (up + 2) % 3]


def _along(points: Array, times: Array, period: float, screw: _Screw) -> Array:
    """Return points for one who travels and turns along, and starts again with the loop."""
    # A moment before it starts again, rounding must not take it for a moment after.
    phase = ((times / period + 1e-9) % 1.0)[:, None]
    turned = np.exp(-1j * screw.angle * phase)
    plane = _plane(points, screw.up) - screw.middle - screw.way * phase
    plane = plane * turned
    result = points.copy()
    result[..., (screw.up + 1) % 3], result[..., (screw.up + 2) % 3] = plane.real, plane.imag
    result[..., screw.up] -= screw.climb * phase
    return result


def _join(points: Array, times: Array, where: tuple[float, float], period: float) -> float:
    """Return the largest acceleration in a range of seconds over the largest elsewhere."""
    changes = np.linalg.norm(np.diff(points, n=2, axis=0), axis=-1).max(axis=1)
    middle = times[1:-1]
    inside = (middle > where[0]) & (middle < where[1])
    # The samples at the very ends stand for those at the join.
    outside = ~inside & (middle > 0.51 * (where[1] - where[0])) & (middle < 2 * period - 1e-6)
    if not inside.any() or not outside.any():
        return float("nan")
    return float(changes[inside].max() / max(changes[outside].max(), 1e-12))


def record(one: Shown) -> dict[str, Any]:
    """Return the figures as plain data, rounded."""
    return {
        key: value if isinstance(value, bool | None) else float(f"{value:.4g}")
        for key, value in vars(one).items()
    }
