"""Compact signatures of cycles, and the distances between thousands of them at once.

A cycle is kept as the mean and the first harmonics of its joints' positions. The product of two
cycles at all offsets in phase is the Fourier sum of their cross-spectrum, so that
`roundelay.compare.distances.cycle_distance` becomes two products of matrices.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.brief import brief
from roundelay.base.errors import SkeletonMismatch
from roundelay.base.numeric import SMALL
from roundelay.base.spans import Span
from roundelay.compare.person import POINTS, Person, person_of
from roundelay.compare.thresholds import SPECTRA
from roundelay.cycles.cycle import Cycle
from roundelay.geometry.skeleton import Skeleton
from roundelay.geometry.symmetry import lateral_axis, partners, reflection
from roundelay.motion.features import point_cloud
from roundelay.motion.motion import Motion

Array = NDArray[np.float64]

__all__ = ["Body", "Spectra", "best_products", "least_distances", "point_count"]

# Pairs of cycles compared at once: 16 MB.
_PAIRS = 1 << 17


@dataclass(frozen=True)
class Body:
    """The joints that cycles are compared by.

    Attributes
    ----------
    joints : tuple of str
        Names of a person's points, or of all joints but the root, in alphabetical order.
    partners : tuple of int
        The joint on the other side; itself where the sides of the skeleton cannot be told.
    """

    joints: tuple[str, ...]
    partners: tuple[int, ...]

    @classmethod
    def of(cls, skeleton: Skeleton) -> Body:
        """Return the body of a skeleton, whatever the order of its joints.

        That of a person is the same on all skeletons.
        """
        if person_of(skeleton) is not None:
            sides = {"left": "right", "right": "left"}
            swapped = [" ".join(sides.get(word, word) for word in x.split(" ")) for x in POINTS]
            return cls(POINTS, tuple(map(POINTS.index, swapped)))
        order = _alphabetical(skeleton)
        place = {joint: number for number, joint in enumerate(order)}
        try:
            others = partners(skeleton)
        except SkeletonMismatch:
            others = np.arange(skeleton.n_joints)
        names = tuple(skeleton.names[joint] for joint in order)
        return cls(names, tuple(place[int(others[joint])] for joint in order))

    def shared(self, other: Body) -> list[str]:
        """Return the joints that both have, both sides of each.

        None if they are less than half of the joints of the body that has fewer.
        """
        known = set(self.joints) & set(other.joints)
        paired = [
            joint
            for joint, partner in zip(self.joints, self.partners, strict=True)
            if {joint, self.joints[partner]} <= known
        ]
        enough = 2 * len(paired) >= min(len(self.joints), len(other.joints))
        return paired if enough else []


def _alphabetical(skeleton: Skeleton) -> list[int]:
    return sorted(range(1, skeleton.n_joints), key=lambda joint: skeleton.names[joint])


@dataclass(frozen=True, eq=False)
class Spectra:
    """Signatures of n cycles of one body.

    Attributes
    ----------
    body : Body
    means : (n, J, 3) ndarray of float32
        Mean positions of the joints relative to the root, without its rotation, in body sizes.
    waves : (n, H, J, 3) ndarray of complex64
        Their harmonics 1 to H.
    reflections : (n, 3) ndarray of float32
        -1 for the axis from side to side, else 1.
    """

    body: Body
    means: NDArray[np.float32]
    waves: NDArray[np.complex64]
    reflections: NDArray[np.float32]

    __repr__ = brief

    def __len__(self) -> int:
        return len(self.means)

    @classmethod
    def of(cls, cycles: Sequence[Cycle]) -> Spectra:
        """Return the signatures of at least one cycle, all of one skeleton."""
        phases = np.arange(SPECTRA.phases) / SPECTRA.phases
        return cls._of([cycle.at(phases, frame_time=1.0) for cycle in cycles])

    @classmethod
    def of_stretches(cls, motion: Motion, spans: Sequence[Span]) -> Spectra:
        """Return the signatures of at least one stretch of a motion that does not repeat.

        Each is taken as a cycle there and back: what is done at another speed is alike.
        """
        half = SPECTRA.phases // 2
        there = np.arange(half + 1) / half
        back = np.concatenate([there, there[-2:0:-1]])
        return cls._of([motion.at(a + back * max(b - a - 1, 0)) for a, b in spans])

    @classmethod
    def _of(cls, shown: Sequence[Motion]) -> Spectra:
        skeleton = shown[0].skeleton
        person = person_of(skeleton)
        points = [_points(one, person) for one in shown]
        values = np.stack([_harmonics(one) for one in points])
        body, across = Body.of(skeleton), np.ones(3)
        if person is not None:
            across = reflection(2)
        elif body.partners != tuple(range(len(body.joints))):
            across = reflection(lateral_axis(skeleton, partners(skeleton)))
        return cls(
            body,
            values[:, 0].real.astype(np.float32),
            values[:, 1:].astype(np.complex64),
            np.tile(across.astype(np.float32), (len(shown), 1)),
        )

    @classmethod
    def joined(cls, parts: Sequence[Spectra]) -> Spectra:
        """Put signatures of one body behind each other."""
        return cls(
            parts[0].body,
            np.concatenate([part.means for part in parts]),
            np.concatenate([part.waves for part in parts]),
            np.concatenate([part.reflections for part in parts]),
        )

    def __getitem__(self, rows: slice) -> Spectra:
        return Spectra(self.body, self.means[rows], self.waves[rows], self.reflections[rows])

    def by(self, joints: Sequence[str]) -> Spectra:
        """Return the signatures by some of the joints."""
        if tuple(joints) == self.body.joints:
            return self
        rows = [self.body.joints.index(joint) for joint in joints]
        place = {row: number for number, row in enumerate(rows)}
        partners = tuple(place.get(self.body.partners[row], place[row]) for row in rows)
        means, waves = self.means[:, rows], self.waves[:, :, rows]
        return Spectra(Body(tuple(joints), partners), means, waves, self.reflections)

    def mirrored(self) -> Spectra:
        """Return the signatures of the cycles with left and right exchanged."""
        others = list(self.body.partners)
        return Spectra(
            self.body,
            self.means[:, others] * self.reflections[:, None],
            self.waves[:, :, others] * self.reflections[:, None, None],
            self.reflections,
        )


def _points(shown: Motion, person: Person | None) -> Array:
    """Return points (n, J, 3): a person's, or all joints but the root, against the root."""
    if person is not None:
        return person.seen(shown.positions(), shown.up)
    order = np.array(_alphabetical(shown.skeleton)) - 1
    return point_cloud(shown.with_root_motion()).reshape(len(shown), -1, 3)[:, order]


def _harmonics(points: Array) -> NDArray[np.complex128]:
    """Return mean and harmonics (1 + H, J, 3) of a closed curve of points (n, J, 3)."""
    kept = SPECTRA.harmonics + 1
    return np.asarray(np.fft.rfft(points, axis=0)[:kept] / len(points))


def least_distances(first: Spectra, second: Spectra) -> NDArray[np.float32]:
    """Return the distances (m, n) of all pairs, at the best offset, mirrored or not.

    Parameters
    ----------
    first, second : Spectra

    Returns
    -------
    (m, n) ndarray of float32
        RMS over joints and phases in body sizes, as `roundelay.cycle_distance`, by the joints that
        both bodies have; infinite if those are too few.
    """
    joints = first.body.shared(second.body)
    result = np.full((len(first), len(second)), np.inf, np.float32)
    if not joints:
        return result
    ours, theirs = first.by(joints), second.by(joints)
    squares = np.minimum(_squares(ours, theirs), _squares(ours.mirrored(), theirs))
    return np.sqrt(np.maximum(squares, 0.0) / np.float32(point_count(joints)))


def point_count(joints: Sequence[str]) -> int:
    """Return how many points a distance is the mean over: the root counts, if it is not told."""
    return len(joints) + (POINTS[0] not in joints)


def _squares(first: Spectra, second: Spectra) -> NDArray[np.float32]:
    """Mean over phases of the squared distances (m, n), by Parseval's theorem."""
    power, other = _power(first), _power(second)
    means, others = (s.means.reshape(len(s), -1).astype(float) for s in (first, second))
    waves = first.waves.reshape(*first.waves.shape[:2], -1).swapaxes(0, 1).conj()
    columns = second.waves.reshape(*second.waves.shape[:2], -1).transpose(1, 2, 0)
    result = np.empty((len(first), len(second)), np.float32)
    rows = max(1, _PAIRS // len(second))
    for start in range(0, len(first), rows):
        block = slice(start, start + rows)
        products = means[block] @ others.T + _best_products(waves[:, block], columns)
        result[block] = power[block, None] + other - 2.0 * products
    return result


def _power(spectra: Spectra) -> NDArray[np.float64]:
    """Mean over phases of the squared lengths (n,)."""
    waves = np.sum(np.abs(spectra.waves) ** 2, axis=(1, 2, 3), dtype=float)
    return np.asarray(np.sum(spectra.means**2, axis=(1, 2), dtype=float) + 2.0 * waves)


def _best_products(
    rows: NDArray[np.complex64], columns: NDArray[np.complex64]
) -> NDArray[np.float32]:
    """Largest mean products (m, n), over all offsets, of curves (H, m, d) and (H, d, n)."""
    cross = np.matmul(rows, columns).reshape(len(rows), -1)
    return 2.0 * best_products(cross).reshape(rows.shape[1], -1)


def best_products(cross: NDArray[np.complex64]) -> NDArray[np.float32]:
    """Return the largest sums (n,), over all offsets, of products (H, n) of harmonics."""
    offsets = np.arange(SPECTRA.offsets) / SPECTRA.offsets
    angles = 2 * np.pi * np.outer(offsets, np.arange(1, len(cross) + 1))
    turning = np.hstack([np.cos(angles), -np.sin(angles)]).astype(np.float32)
    return _highest(turning @ np.vstack([cross.real, cross.imag]))


def _highest(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the maxima (n,) of closed curves (offsets, n), by parabolas through three values."""
    best, columns = values.argmax(axis=0), np.arange(values.shape[1])
    before, here, after = (values[(best + step) % len(values), columns] for step in (-1, 0, 1))
    bend = np.minimum(before - 2.0 * here + after, -SMALL)
    return here - (before - after) ** 2 / (8 * bend)
