"""Signatures of cycles as rows of numbers, whose distances are products.

A pose is told by coordinates that mirroring keeps (*even*) and by those that it turns round
(*odd*). Of two cycles both products, of the even and of the odd ones, are taken at all offsets at
once; their sum is that of the cycles as they are, their difference that of one mirrored.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.brief import brief
from roundelay.compare.spectra import Body, Spectra, best_products, point_count
from roundelay.compare.thresholds import SPECTRA

__all__ = ["Packed", "pair_distances", "unpacked"]

Rows = NDArray[np.intp]
Numbers = NDArray[np.float32]

# Pairs of cycles compared at once: 70 MB.
_PAIRS = 1024


@dataclass(frozen=True, eq=False)
class Packed:
    """Signatures of n cycles of one body as rows of numbers.

    Attributes
    ----------
    body : Body
    values : (n, 3 J (1 + 2 H)) ndarray of float32
        Means of 3 J coordinates, then the real parts of their harmonics, then the imaginary ones.
        Their lengths are such that the distance of rows is that of cycles at this offset.
    """

    body: Body
    values: Numbers

    __repr__ = brief

    def __len__(self) -> int:
        return len(self.values)

    @classmethod
    def of(cls, spectra: Spectra) -> Packed:
        """Pack signatures."""
        count, joints = len(spectra), len(spectra.body.joints)
        wide = 3 * joints
        values = np.empty((count, wide * (1 + 2 * SPECTRA.harmonics)), np.float32)
        scale = 1.0 / np.sqrt(point_count(spectra.body.joints))
        for across in np.unique(spectra.reflections, axis=0):
            rows = np.flatnonzero((spectra.reflections == across).all(axis=1))
            turn = _turn(spectra.body, across)
            values[rows, :wide] = scale * spectra.means[rows].reshape(len(rows), wide) @ turn
            waves = spectra.waves[rows].reshape(len(rows), -1, wide) @ turn.astype(np.complex64)
            parts = np.stack([waves.real, waves.imag], axis=1).reshape(len(rows), -1)
            values[rows, wide:] = np.sqrt(2.0) * scale * parts
        return cls(spectra.body, values)

    def __getitem__(self, rows: slice | Rows) -> Packed:
        return Packed(self.body, self.values[rows])

    def vectors(self) -> Numbers:
        """Return vectors (n, 6 J) that are the same wherever a cycle begins, mirrored or not.

        They are no farther apart than the cycles: mean and strength of each coordinate.
        """
        means, waves = _parts(self.body, np.asarray(self.values))
        strength = np.sqrt(np.sum(waves**2, axis=(1, 2)))
        even = _even(self.body)
        return np.hstack([means[:, :even], np.abs(means[:, even:]), strength])

    def weighted(self, weights: NDArray[np.float64]) -> Packed:
        """Return the signatures with every point (J,) weighed; partners weigh alike."""
        factors = np.sqrt(_of_coordinates(self.body, weights)).astype(np.float32)
        means, waves = _parts(self.body, np.asarray(self.values))
        flat = (waves * factors).reshape(len(self), -1)
        return Packed(self.body, np.hstack([means * factors, flat]))


def _parts(body: Body, values: Numbers) -> tuple[Numbers, Numbers]:
    """Return means (n, 3 J) and harmonics (n, 2, H, 3 J), real and imaginary parts, of rows."""
    wide = 3 * len(body.joints)
    return values[:, :wide], values[:, wide:].reshape(len(values), 2, -1, wide)


def _even(body: Body) -> int:
    """Return how many coordinates mirroring keeps.

    Of a joint in the middle these are two of three, of a pair three of six; all where sides cannot
    be told.
    """
    joints = np.arange(len(body.joints))
    own = int(np.sum(joints == np.array(body.partners)))
    if own == len(joints):
        return 3 * own
    return 2 * own + 3 * (len(joints) - own) // 2


def _turn(body: Body, across: NDArray[np.float32]) -> Numbers:
    """Return the rotation (3 J, 3 J) from coordinates to even, then odd ones."""
    eye = np.eye(3 * len(body.joints)).reshape(-1, len(body.joints), 3)
    mirrored = eye[:, list(body.partners)] * across
    flat, other = (one.reshape(len(one), -1) for one in (eye, mirrored))
    found: tuple[list[NDArray[np.float64]], list[NDArray[np.float64]]] = ([], [])
    for number, (row, image) in enumerate(zip(flat, other, strict=True)):
        place = int(np.argmax(np.abs(image)))
        if place < number:
            continue
        for sign, kept in zip((1.0, -1.0), found, strict=True):
            half = row + sign * image
            if np.any(half):
                kept.append(half / np.linalg.norm(half))
    return np.array([*found[0], *found[1]], np.float32).T


def _of_coordinates(body: Body, weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the weight (3 J,) of every coordinate, of weights (J,) of points."""
    across = np.array([1.0, 1.0, -1.0], np.float32)
    whole = body.partners == tuple(range(len(body.joints)))
    turn = _turn(body, np.ones(3, np.float32) if whole else across)
    both = 0.5 * (weights + weights[list(body.partners)])
    return np.asarray((turn.astype(float) ** 2).T @ np.repeat(both, 3))


def unpacked(packed: Packed, across: NDArray[np.float32]) -> Spectra:
    """Return packed signatures by the joints' positions again.

    Parameters
    ----------
    packed : Packed
    across : (3,) ndarray of float32
        -1 for the axis from side to side, else 1.
    """
    joints = packed.body.joints
    turn, scale = _turn(packed.body, across), np.sqrt(point_count(joints))
    means, waves = _parts(packed.body, np.asarray(packed.values))
    whole = (waves[:, 0] + 1j * waves[:, 1]) @ turn.T * (scale / np.sqrt(2.0))
    return Spectra(
        packed.body,
        (scale * means @ turn.T).reshape(len(packed), len(joints), 3).astype(np.float32),
        whole.reshape(len(packed), -1, len(joints), 3).astype(np.complex64),
        np.tile(across, (len(packed), 1)),
    )


def pair_distances(first: Packed, second: Packed, rows: Rows, others: Rows) -> Numbers:
    """Return the distances (n,) of pairs, at the best offset, mirrored or not.

    Parameters
    ----------
    first, second : Packed
        Of one body.
    rows, others : (n,) ndarray of int
        Of the first and of the second.

    Returns
    -------
    (n,) ndarray of float32
        As by `roundelay.compare.spectra.least_distances`.
    """
    result = np.empty(len(rows), np.float32)
    for start in range(0, len(rows), _PAIRS):
        block = slice(start, start + _PAIRS)
        result[block] = _distances(
            first.body, first.values[rows[block]], second.values[others[block]]
        )
    return result


def _distances(body: Body, ours: Numbers, theirs: Numbers) -> Numbers:
    even, wide = _even(body), 3 * len(body.joints)
    (means, waves), (other, others) = (_parts(body, values) for values in (ours, theirs))
    power = np.einsum("nd,nd->n", ours, ours) + np.einsum("nd,nd->n", theirs, theirs)
    kept = slice(0, even), slice(even, wide)
    steady = [np.einsum("nd,nd->n", means[:, one], other[:, one]) for one in kept]
    cross = [_cross(waves[..., one], others[..., one]) for one in kept]
    straight = steady[0] + steady[1] + best_products(cross[0] + cross[1])
    turned = steady[0] - steady[1] + best_products(cross[0] - cross[1])
    return np.sqrt(np.maximum(power - 2.0 * np.maximum(straight, turned), 0.0))


def _cross(ours: Numbers, theirs: Numbers) -> NDArray[np.complex64]:
    """Return products (H, n) of harmonics (n, 2, H, d), the first ones conjugate."""
    real = np.einsum("nhd,nhd->hn", ours[:, 0], theirs[:, 0])
    real += np.einsum("nhd,nhd->hn", ours[:, 1], theirs[:, 1])
    imaginary = np.einsum("nhd,nhd->hn", ours[:, 0], theirs[:, 1])
    imaginary -= np.einsum("nhd,nhd->hn", ours[:, 1], theirs[:, 0])
    return real + np.complex64(1j) * imaginary
