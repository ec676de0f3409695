"""Rotations as unit quaternions (w, x, y, z) in arrays of shape (..., 4).

Quaternions act on column vectors, q and -q are the same rotation, and
``multiply(a, b)`` applies ``b`` first. Angles are in radians.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "angle_between",
    "axis_to_y",
    "conjugate",
    "continuous",
    "from_euler",
    "from_matrix",
    "from_rotation_vector",
    "identity",
    "is_continuous",
    "mean",
    "multiply",
    "normalize",
    "rotate",
    "slerp",
    "to_euler",
    "to_matrix",
    "to_rotation_vector",
    "twist",
    "vector_between",
]

Array = NDArray[np.float64]

_AXES = {"X": 0, "Y": 1, "Z": 2}
# Below this angle (radians) sine and cosine quotients are taken from their series.
_SMALL = 1e-4
# Nearer than this to gimbal lock only the sum or difference of two Euler angles is defined.
_LOCK = 1e-10


def identity(*shape: int) -> Array:
    """Return identity rotations (..., 4) of a shape."""
    result = np.zeros((*shape, 4))
    result[..., 0] = 1.0
    return result


def normalize(quaternions: ArrayLike) -> Array:
    """Scale quaternions (..., 4) to unit length.

    Raises
    ------
    ValueError
        If one of them is zero.
    """
    q = np.asarray(quaternions, float)
    norm = np.linalg.norm(q, axis=-1, keepdims=True)
    if np.any(norm == 0.0):
        raise ValueError("expected nonzero quaternions, found one of length 0")
    return q / norm


def multiply(first: ArrayLike, second: ArrayLike) -> Array:
    """Compose rotations (..., 4): ``second`` is applied first."""
    a, b = np.asarray(first, float), np.asarray(second, float)
    aw, ax, ay, az = np.moveaxis(a, -1, 0)
    bw, bx, by, bz = np.moveaxis(b, -1, 0)
    result = np.empty(np.broadcast_shapes(a.shape, b.shape))
    result[..., 0] = aw * bw - ax * bx - ay * by - az * bz
    result[..., 1] = aw * bx + ax * bw + ay * bz - az * by
    result[..., 2] = aw * by - ax * bz + ay * bw + az * bx
    result[..., 3] = aw * bz + ax * by - ay * bx + az * bw
    return result


def conjugate(quaternions: ArrayLike) -> Array:
    """Return the inverse rotations of unit quaternions (..., 4)."""
    return np.asarray(quaternions, float) * np.array([1.0, -1.0, -1.0, -1.0])


def rotate(quaternions: ArrayLike, vectors: ArrayLike) -> Array:
    """Rotate vectors (..., 3) by unit quaternions (..., 4)."""
    q, v = np.asarray(quaternions, float), np.asarray(vectors, float)
    w, axis = q[..., :1], q[..., 1:]
    # v + 2 w (axis x v) + 2 axis x (axis x v), with the inner product shared.
    twice = 2.0 * _cross(axis, v)
    return v + w * twice + _cross(axis, twice)


def _cross(a: Array, b: Array) -> Array:
    # np.cross is several times slower on small last axes.
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1)


def from_euler(angles: ArrayLike, order: str | Sequence[str]) -> Array:
    """Compose rotations from intrinsic Euler angles.

    Parameters
    ----------
    angles : (..., len(order)) array_like
        Radians, one column for each letter of `order`.
    order : str
        Axes in the order in which a BVH lists its channels: "ZXY" means R = Rz Rx Ry.
        Any number of axes, also repeated ones, is allowed.

    Returns
    -------
    (..., 4) ndarray
    """
    half = 0.5 * np.moveaxis(np.asarray(angles, float), -1, 0)
    cosine, sine = np.cos(half), np.sin(half)
    axes = [_axis(letter) for letter in order]
    if len(set(axes)) == len(axes) > 0:
        rest = [axis for axis in range(3) if axis not in axes]
        still = [1.0] * len(rest), [0.0] * len(rest)
        return _from_three_axes([*cosine, *still[0]], [*sine, *still[1]], axes + rest)
    result = identity(*half.shape[1:])
    for c, s, axis in zip(cosine, sine, axes, strict=True):
        turn = np.zeros_like(result)
        turn[..., 0] = c
        turn[..., 1 + axis] = s
        result = multiply(result, turn)
    return result


def _from_three_axes(cosine: Sequence[Any], sine: Sequence[Any], axes: Sequence[int]) -> Array:
    """Multiply out three turns about different axes, from cosines and sines of half angles."""
    (ci, cj, ck), (si, sj, sk) = cosine, sine
    if (axes[1] - axes[0]) % 3 == 2:
        # An odd order mirrors an even one: the last turn changes its sense.
        sk = -sk
    result = np.empty((*ci.shape, 4))
    cc, ss, cs, sc = ci * cj, si * sj, ci * sj, si * cj
    result[..., 0] = cc * ck - ss * sk
    result[..., 1 + axes[0]] = sc * ck + cs * sk
    result[..., 1 + axes[1]] = cs * ck - sc * sk
    result[..., 1 + axes[2]] = cc * sk + ss * ck
    if (axes[1] - axes[0]) % 3 == 2:
        result[..., 1 + axes[2]] *= -1.0
    return result


def to_euler(quaternions: ArrayLike, order: str) -> Array:
    """Decompose rotations (..., 4) into intrinsic Euler angles (..., 3).

    Parameters
    ----------
    quaternions : (..., 4) array_like
        Unit quaternions.
    order : str
        Three different axes, as in `from_euler`.

    Returns
    -------
    (..., 3) ndarray
        Radians; first and third in (-pi, pi], second in [-pi/2, pi/2]. At gimbal lock the
        third angle is 0.
    """
    i, j, k = (_axis(letter) for letter in order)
    if {i, j, k} != {0, 1, 2}:
        raise ValueError(f"expected three different axes, found {order!r}")
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    q = np.asarray(quaternions, float)
    w, a, b, c = q[..., 0], q[..., 1 + i], q[..., 1 + j], sign * q[..., 1 + k]
    # With half angles: w + b and a + c are (cos j + sin j) times cosine and sine of i + k,
    # w - b and a - c are (cos j - sin j) times those of i - k. No digits are lost at the poles.
    upper, lower = np.hypot(w + b, a + c), np.hypot(w - b, a - c)
    total, difference = np.arctan2(a + c, w + b), np.arctan2(a - c, w - b)
    total = np.where(upper < _LOCK, difference, total)
    difference = np.where(lower < _LOCK, total, difference)
    second = 0.5 * np.pi - 2.0 * np.arctan2(lower, upper)
    result = np.stack([total + difference, second, sign * (total - difference)], axis=-1)
    result = np.where(result > np.pi, result - 2.0 * np.pi, result)
    return np.where(result <= -np.pi, result + 2.0 * np.pi, result)


def _axis(letter: str) -> int:
    try:
        return _AXES[letter.upper()]
    except KeyError:
        raise ValueError(f"expected an axis X, Y or Z, found {letter!r}") from None


def from_rotation_vector(vectors: ArrayLike) -> Array:
    """Return the rotations about vectors (..., 3) by their length in radians."""
    v = np.asarray(vectors, float)
    angle = np.linalg.norm(v, axis=-1)
    small = angle < _SMALL
    safe = np.where(small, 1.0, angle)
    scale = np.where(small, 0.5 - angle**2 / 48.0, np.sin(0.5 * safe) / safe)
    result = np.empty((*v.shape[:-1], 4))
    result[..., 0] = np.cos(0.5 * angle)
    result[..., 1:] = scale[..., None] * v
    return result


def to_rotation_vector(quaternions: ArrayLike) -> Array:
    """Return axis times angle (..., 3), angle in [0, pi], of unit quaternions (..., 4)."""
    q = np.asarray(quaternions, float)
    q = np.where(q[..., :1] < 0.0, -q, q)
    length = np.linalg.norm(q[..., 1:], axis=-1)
    small = length < _SMALL
    safe = np.where(small, 1.0, length)
    scale = np.where(small, 2.0 + length**2 / 3.0, 2.0 * np.arctan2(safe, q[..., 0]) / safe)
    return np.asarray(scale[..., None] * q[..., 1:])


def axis_to_y(axis: int) -> Array:
    """Return the rotation (4,) that turns an axis, 0, 1 or 2, to Y."""
    turns = ([0.0, 0.0, np.pi / 2], [0.0, 0.0, 0.0], [-np.pi / 2, 0.0, 0.0])
    return from_rotation_vector(turns[axis])


def from_matrix(matrices: ArrayLike) -> Array:
    """Return unit quaternions (..., 4) of rotation matrices (..., 3, 3)."""
    m = np.asarray(matrices, float)
    trace = np.trace(m, axis1=-2, axis2=-1)
    diagonal = np.diagonal(m, axis1=-2, axis2=-1)
    # Four times the squared components; dividing by the largest is always stable.
    squares = np.concatenate([1 + trace[..., None], 1 + 2 * diagonal - trace[..., None]], -1)
    x = m[..., 2, 1] - m[..., 1, 2]
    y = m[..., 0, 2] - m[..., 2, 0]
    z = m[..., 1, 0] - m[..., 0, 1]
    xy, xz, yz = (m[..., i, j] + m[..., j, i] for i, j in ((0, 1), (0, 2), (1, 2)))
    w2, x2, y2, z2 = np.moveaxis(squares, -1, 0)
    rows = np.stack(
        [
            np.stack([w2, x, y, z], -1),
            np.stack([x, x2, xy, xz], -1),
            np.stack([y, xy, y2, yz], -1),
            np.stack([z, xz, yz, z2], -1),
        ],
        -2,
    )
    largest = np.argmax(squares, axis=-1)[..., None, None]
    return normalize(np.take_along_axis(rows, largest, axis=-2)[..., 0, :])


def to_matrix(quaternions: ArrayLike) -> Array:
    """Return rotation matrices (..., 3, 3) of unit quaternions (..., 4)."""
    q = np.asarray(quaternions, float)
    return np.stack([rotate(q, axis) for axis in np.eye(3)], axis=-1)


def twist(quaternions: ArrayLike, axis: ArrayLike) -> Array:
    """Return the part of rotations (..., 4) that turns about a unit axis (3,).

    The swing-twist decomposition q = swing * twist; where the rotation turns the axis
    upside down the twist is not defined and the identity is returned.
    """
    q, direction = np.asarray(quaternions, float), np.asarray(axis, float)
    result = np.empty(q.shape)
    result[..., 0] = q[..., 0]
    result[..., 1:] = (q[..., 1:] @ direction)[..., None] * direction
    degenerate = np.linalg.norm(result, axis=-1) < 1e-12
    result[degenerate] = (1.0, 0.0, 0.0, 0.0)
    return normalize(result)


def is_continuous(quaternions: ArrayLike) -> bool:
    """Tell whether neighbours (F, ..., 4) along the first axis lie in one hemisphere."""
    q = np.asarray(quaternions, float)
    return not np.any(np.einsum("...i,...i->...", q[1:], q[:-1]) < 0.0)


def continuous(quaternions: ArrayLike, axis: int = 0) -> Array:
    """Choose signs so that neighbours along `axis` lie in one hemisphere.

    Parameters
    ----------
    quaternions : (..., 4) array_like
    axis : int
        The axis of time.
    """
    q = np.moveaxis(np.asarray(quaternions, float), axis, 0)
    flips = np.einsum("...i,...i->...", q[1:], q[:-1]) < 0.0
    result = q.copy()
    if np.any(flips):
        turned = np.logical_xor.accumulate(flips, axis=0)
        np.negative(q[1:], out=result[1:], where=turned[..., None])
    return result if axis == 0 else np.moveaxis(result, 0, axis)


def mean(quaternions: ArrayLike, weights: ArrayLike | None = None) -> Array:
    """Average rotations (n, ..., 4) over the first axis, whatever their signs.

    The eigenvector of the largest eigenvalue of sum w q q^T (Markley et al. 2007), which
    minimises the sum of squared chordal distances.

    Parameters
    ----------
    quaternions : (n, ..., 4) array_like
    weights : (n,) array_like, optional
        Not negative; uniform by default.
    """
    q = np.asarray(quaternions, float)
    w = np.ones(len(q)) if weights is None else np.asarray(weights, float)
    outer = np.einsum("n,n...i,n...j->...ij", w, q, q)
    largest = np.linalg.eigh(outer)[1][..., :, -1]
    return np.where(largest[..., :1] < 0.0, -largest, largest)


def slerp(first: ArrayLike, second: ArrayLike, fraction: ArrayLike) -> Array:
    """Interpolate on the shorter great arc between rotations (..., 4).

    Parameters
    ----------
    first, second : (..., 4) array_like
    fraction : (...) array_like
        0 gives `first`, 1 gives `second`.
    """
    a, b = np.asarray(first, float), np.asarray(second, float)
    t = np.asarray(fraction, float)[..., None]
    return multiply(a, from_rotation_vector(t * vector_between(a, b)))


def vector_between(first: ArrayLike, second: ArrayLike) -> Array:
    """Return the rotation vectors (..., 3) that lead from rotations (..., 4) to others.

    In radians, by the shorter way, in the axes of `first`: `second` is
    ``multiply(first, from_rotation_vector(vectors))``.
    """
    return to_rotation_vector(multiply(conjugate(first), second))


def angle_between(first: ArrayLike, second: ArrayLike) -> Array:
    """Return the angle (...) in radians, in [0, pi], between rotations (..., 4)."""
    a, b = np.asarray(first, float), np.asarray(second, float)
    difference = multiply(conjugate(a), b)
    length = np.linalg.norm(difference[..., 1:], axis=-1)
    return np.asarray(2.0 * np.arctan2(length, np.abs(difference[..., 0])))
