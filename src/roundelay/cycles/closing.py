"""What the ends of a repetition lack to meet, spread over it: the least change that closes it.

Closing adds to a repetition a curve c(x) of its phase x in [0, 1], such that value and velocity
meet at the ends: c(0) - c(1) and c'(0) - c'(1) are what they lack. Of all such curves

    c(x) = d0 B1(x) + d1 B2(x) / 2,    B1 = x - 1/2,    B2 = x^2 - x + 1/6,

bends least and has the mean 0 (Bernoulli polynomials): no part of the repetition is changed more
than need be. Rotations get it in their tangent space.

Velocities are told by some frames on either side, the `reach`, so that noise counts little. Values
of a repetition of n frames come with these, n + 2 reach + 1 in all.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.geometry import rotations as rot
from roundelay.phase.harmonic import HarmonicCurve

__all__ = [
    "about",
    "closed_curve",
    "closed_rotations",
    "closed_steps",
    "closing_squares",
    "padded",
    "padded_rotations",
]

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

# Mean squares of B1 and B2 / 2 over [0, 1].
_BY_VALUE, _BY_VELOCITY = 1 / 12, 1 / 720


def padded(values: Array, reach: int) -> Array:
    """Go on with values (n, ...) at their speed at the ends, by reach before, one more behind."""
    span = min(reach, len(values) - 1)
    slopes = (values[span] - values[0]) / span, (values[-1] - values[-1 - span]) / span
    before = [values[0] - k * slopes[0] for k in range(reach, 0, -1)]
    behind = [values[-1] + k * slopes[1] for k in range(1, reach + 2)]
    return np.concatenate([before, values, behind])


def padded_rotations(local: Array, reach: int) -> Array:
    """Go on with rotations (n, ..., 4) as `padded` does with values."""
    span = min(reach, len(local) - 1)
    slopes = _turn(local[0], local[span]) / span, _turn(local[-1 - span], local[-1]) / span
    before = [_moved(local[0], -k * slopes[0]) for k in range(reach, 0, -1)]
    behind = [_moved(local[-1], k * slopes[1]) for k in range(1, reach + 2)]
    return np.concatenate([before, local, behind])


def _moved(rotations: Array, vectors: Array) -> Array:
    return rot.multiply(rotations, rot.from_rotation_vector(vectors))


def _turn(first: Array, second: Array) -> Array:
    return rot.to_rotation_vector(rot.multiply(rot.conjugate(first), second))


def about(start: int, stop: int, reach: int) -> slice:
    """Return the places in padded values of frames, with those before and behind them."""
    return slice(start, stop + 2 * reach + 1)


def closing_squares(values: Array, starts: Indices, stops: Indices, reach: int) -> Array:
    """Return by how much closing changes repetitions (k,): the sum over columns of mean squares.

    Parameters
    ----------
    values : (n, d) ndarray
    starts, stops : (k,) ndarray of int
        Of the repetitions; a stop may be n.
    reach : int
    """
    whole = padded(values, reach)
    lack = whole[starts + reach] - whole[stops + reach]
    speeds = (whole[2 * reach :] - whole[: -2 * reach]) / (2 * reach)
    slower = (speeds[starts] - speeds[stops]) * (stops - starts)[:, None]
    squares = _BY_VALUE * lack**2 + _BY_VELOCITY * slower**2
    return np.asarray(squares.sum(axis=1))


def closed_curve(values: Array, reach: int) -> HarmonicCurve:
    """Close values (n + 2 reach + 1, d) of a repetition and go through all of them."""
    count = len(values) - 2 * reach - 1
    first, last = values[: 2 * reach + 1], values[count:]
    slower = (first[-1] - first[0] - last[-1] + last[0]) * count / (2 * reach)
    closing = _closing(first[reach] - last[reach], slower, count)
    return HarmonicCurve.through(values[reach : reach + count] + closing)


def closed_rotations(local: Array, reach: int) -> tuple[HarmonicCurve, HarmonicCurve | None]:
    """Close rotations (n + 2 reach + 1, J, 4); joints that end with the other sign are odd."""
    count = len(local) - 2 * reach - 1
    first, last = local[: 2 * reach + 1], local[count:]
    slower = (_turn(first[0], first[-1]) - _turn(last[0], last[-1])) * count / (2 * reach)
    closing = _closing(_turn(last[reach], first[reach]), slower, count)
    closed = _moved(local[reach : reach + count], closing).reshape(count, -1)
    odd = np.repeat(np.einsum("jq,jq->j", first[reach], last[reach]) < 0.0, 4)
    even_part = HarmonicCurve.through(np.where(odd, 0.0, closed))
    if not odd.any():
        return even_part, None
    return even_part, HarmonicCurve.through(np.where(odd, closed, 0.0), odd=True)


def closed_steps(steps: Array, reach: int) -> HarmonicCurve:
    """Close steps (n + 2, d) to the next frame; return them as a velocity a period of that mean.

    Parameters
    ----------
    steps : (n + 2 reach, d) ndarray
        From the first frame before the repetition on, up to the one to the last frame behind it.
    reach : int
    """
    count = len(steps) - 2 * reach
    rates = steps * count
    lack = rates[: 2 * reach].mean(axis=0) - rates[count:].mean(axis=0)
    x = (np.arange(count) + 0.5) / count
    closed = rates[reach : reach + count] + lack * (x - 0.5)[:, None]
    # A step is the velocity in its middle.
    return HarmonicCurve.through(closed).shifted(-0.5 / count)


def _closing(lack: Array, slower: Array, count: int) -> Array:
    """Return the curve (count, ...) that closes, at phases 0, 1 / count, ..."""
    x = (np.arange(count) / count).reshape(-1, *[1] * lack.ndim)
    return np.asarray(lack * (x - 0.5) + slower * (0.5 * (x * x - x) + _BY_VALUE))
