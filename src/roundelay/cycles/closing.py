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
    "closing_curve",
    "closing_squares",
    "padded",
    "padded_rotations",
]

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

# Mean squares of B1 and B2 / 2 over [0, 1].
_BY_VALUE, _BY_VELOCITY = 1 / 12, 1 / 720


def padded(values: Array, reach: int) -> Array:
    """Go on with values at their speed at the ends.

    Parameters
    ----------
    values : (n, ...) ndarray
        Of two frames or more.
    reach : int
        How many frames are put before; behind comes one more.

    Returns
    -------
    (n + 2 reach + 1, ...) ndarray
    """
    span = min(reach, len(values) - 1)
    slopes = (values[span] - values[0]) / span, (values[-1] - values[-1 - span]) / span
    before = [values[0] - k * slopes[0] for k in range(reach, 0, -1)]
    behind = [values[-1] + k * slopes[1] for k in range(1, reach + 2)]
    return np.concatenate([before, values, behind])


def padded_rotations(local: Array, reach: int) -> Array:
    """Go on with rotations as `padded` does with values.

    Parameters
    ----------
    local : (n, ..., 4) ndarray
        Of two frames or more.
    reach : int
        How many frames are put before; behind comes one more.

    Returns
    -------
    (n + 2 reach + 1, ..., 4) ndarray
    """
    span = min(reach, len(local) - 1)
    starting, ending = (local[0], local[span]), (local[-1 - span], local[-1])
    slopes = rot.vector_between(*starting) / span, rot.vector_between(*ending) / span
    before = [_moved(local[0], -k * slopes[0]) for k in range(reach, 0, -1)]
    behind = [_moved(local[-1], k * slopes[1]) for k in range(1, reach + 2)]
    return np.concatenate([before, local, behind])


def _moved(rotations: Array, vectors: Array) -> Array:
    return rot.multiply(rotations, rot.from_rotation_vector(vectors))


def about(start: int, stop: int, reach: int) -> slice:
    """Return where frames are in padded values, with those before and behind them.

    Parameters
    ----------
    start, stop : int
        The frames, half-open, counted before the values were padded.
    reach : int
        In frames, as in `padded`.

    Returns
    -------
    slice
        Of stop - start + 2 reach + 1 places.
    """
    return slice(start, stop + 2 * reach + 1)


def closing_squares(values: Array, starts: Indices, stops: Indices, reach: int) -> Array:
    """Return by how much closing changes repetitions (k,): the sum over columns of mean squares.

    Parameters
    ----------
    values : (n, d) ndarray
    starts, stops : (k,) ndarray of int
        Of the repetitions, in frames; a stop may be n.
    reach : int
        In frames, as in `padded`.

    Returns
    -------
    (k,) ndarray
        In the values' unit, squared.
    """
    whole = padded(values, reach)
    lack = whole[starts + reach] - whole[stops + reach]
    speeds = (whole[2 * reach :] - whole[: -2 * reach]) / (2 * reach)
    slower = (speeds[starts] - speeds[stops]) * (stops - starts)[:, None]
    squares = _BY_VALUE * lack**2 + _BY_VELOCITY * slower**2
    return np.asarray(squares.sum(axis=1))


def closed_curve(values: Array, reach: int) -> HarmonicCurve:
    """Close the values of a repetition and go through all of them.

    Parameters
    ----------
    values : (n + 2 reach + 1, d) ndarray
        The n frames of the repetition, with those before and behind it.
    reach : int
        In frames, as in `padded`.

    Returns
    -------
    HarmonicCurve
        Of d values; the repetition's first frame has the phase 0.
    """
    count = len(values) - 2 * reach - 1
    first, last = values[: 2 * reach + 1], values[count:]
    slower = (first[-1] - first[0] - last[-1] + last[0]) * count / (2 * reach)
    closing = closing_curve(first[reach] - last[reach], slower, np.arange(count) / count)
    return HarmonicCurve.through(values[reach : reach + count] + closing)


def closed_rotations(local: Array, reach: int) -> tuple[HarmonicCurve, HarmonicCurve | None]:
    """Close the rotations of a repetition and go through all of them.

    Parameters
    ----------
    local : (n + 2 reach + 1, J, 4) ndarray
        Those of the n frames of the repetition, with those before and behind it.
    reach : int
        In frames, as in `padded`.

    Returns
    -------
    even, odd : HarmonicCurve, HarmonicCurve or None
        Of 4 J values; the first frame has the phase 0. Joints that end with the other sign are odd:
        0 in the first curve, as the others are in the second. None where there are none.
    """
    count = len(local) - 2 * reach - 1
    first, last = local[: 2 * reach + 1], local[count:]
    faster = rot.vector_between(first[0], first[-1]) - rot.vector_between(last[0], last[-1])
    lack = rot.vector_between(last[reach], first[reach])
    closing = closing_curve(lack, faster * count / (2 * reach), np.arange(count) / count)
    closed = _moved(local[reach : reach + count], closing).reshape(count, -1)
    odd = np.repeat(np.einsum("jq,jq->j", first[reach], last[reach]) < 0.0, 4)
    even_part = HarmonicCurve.through(np.where(odd, 0.0, closed))
    if not odd.any():
        return even_part, None
    return even_part, HarmonicCurve.through(np.where(odd, closed, 0.0), odd=True)


def closed_steps(steps: Array, reach: int) -> HarmonicCurve:
    """Close the steps from frame to frame of a repetition, their mean kept.

    Parameters
    ----------
    steps : (n + 2 reach, d) ndarray
        From the first frame before the repetition on, up to the one to the last frame behind it.
    reach : int
        In frames, as in `padded`.

    Returns
    -------
    HarmonicCurve
        The velocity, in the steps' unit a period, d values.
    """
    count = len(steps) - 2 * reach
    rates = steps * count
    lack = rates[: 2 * reach].mean(axis=0) - rates[count:].mean(axis=0)
    x = (np.arange(count) + 0.5) / count
    closed = rates[reach : reach + count] + lack * (x - 0.5)[:, None]
    # A step is the velocity in its middle.
    return HarmonicCurve.through(closed).shifted(-0.5 / count)


def closing_curve(lack: Array, slower: Array, x: Array) -> Array:
    """Return the curve that closes a repetition: what is to be added to its values.

    Parameters
    ----------
    lack : (...) ndarray
        The first value less the one a period later.
    slower : (...) ndarray
        Likewise of the speeds, a period.
    x : (n,) ndarray
        Phases, in turns from the first value on.

    Returns
    -------
    (n, ...) ndarray
        In the unit of `lack`; of rotation vectors, what is to be turned.
    """
    x = x.reshape(-1, *[1] * lack.ndim)
    return np.asarray(lack * (x - 0.5) + slower * (0.5 * (x * x - x) + _BY_VALUE))
