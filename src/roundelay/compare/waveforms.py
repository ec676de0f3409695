"""Whether repetitions of two recordings differ along the phase: two persons, before and after.

At every phase stands a two-sample t; its largest size over all phases and joints is set against
those of repetitions that change places (a permutation test by the maximum; Nichols, Holmes 2002),
so that a level holds for all phases and joints together. Left is set against right by the recording
in a mirror. What is told to differ is these recordings, beyond the spread of their repetitions; how
persons differ is told by one mean curve a person.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import comb
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.brief import brief
from roundelay.base.checks import as_numbers, chosen, expected
from roundelay.base.errors import SkeletonMismatch, TooShort
from roundelay.base.numeric import ROUNDING, SMALL
from roundelay.base.spans import Spans
from roundelay.base.threads import one_thread
from roundelay.compare.options import CompareOptions
from roundelay.compare.thresholds import WAVEFORMS
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.edit.align import align, mirrored, shifted
from roundelay.cycles.events import events_of
from roundelay.cycles.repetitions import Repetitions, repetitions
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.geometry.symmetry import sides
from roundelay.motion.motion import Motion

__all__ = ["Comparison", "compare_curves", "compare_repetitions", "compare_sides"]

Array = NDArray[np.float64]
_Rng = int | np.random.Generator


@dataclass(frozen=True, eq=False)
class Comparison:
    """Curves of two groups along the phase, and where they differ.

    Attributes
    ----------
    names : tuple of str
        Of the curves: joints.
    phase : (P,) ndarray
        From 0 to below 1.
    first, second : (n, J, P), (m, J, P) ndarray
        Each repetition; of joints in degrees, from the mean pose of both about the axis about
        which the joint turns most.
    difference : (J, P) ndarray
        Mean of the first less that of the second.
    low, high : (J, P) ndarray
        Band of the difference, for all phases and joints together.
    t : (J, P) ndarray
    limit : float
        Beyond it, either way, t tells a difference.
    p : (J,) ndarray
        How often the largest t over all joints and phases is as large by chance.
    level : float
    count : int
        Permutations, the one that was seen among them.
    labels : tuple of two str
        What the first and the second are called.
    movement : bool
        Whether curves are movements about each one's own mean pose: where the axes of joints
        differ, postures cannot be compared.

    Examples
    --------
    >>> found = rl.compare_curves([[0.0, 1.0], [0.0, 1.1], [0.1, 1.0]], [[0.0, 2.0], [0.1, 2.1]])
    >>> found.difference.round(2)
    array([[-0.02, -1.02]])
    """

    names: tuple[str, ...]
    phase: Array
    first: Array = field(repr=False)
    second: Array = field(repr=False)
    difference: Array = field(repr=False)
    low: Array = field(repr=False)
    high: Array = field(repr=False)
    t: Array = field(repr=False)
    limit: float
    p: Array = field(repr=False)
    level: float
    count: int
    labels: tuple[str, str] = ("first", "second")
    movement: bool = False

    __repr__ = brief

    @property
    def notes(self) -> tuple[str, ...]:
        """What cannot be told, and why."""
        told = []
        if self.count * (1.0 - self.level) < 1.0:
            told.append(
                f"{len(self.first)} and {len(self.second)} repetitions: their {self.count} "
                f"permutations are too few for a level of {self.level:g}"
            )
        if self.movement:
            told.append("the axes of joints differ: movements are compared, postures are not")
        return tuple(told)

    def differing(self, name: str) -> list[tuple[float, float]]:
        """Return the ranges of the phase in which a curve differs.

        Raises
        ------
        ValueError
            If there is no curve of that name.
        """
        if name not in self.names:
            raise ValueError(f"expected a curve among {', '.join(self.names)}, found {name!r}")
        far = np.abs(self.t[self.names.index(name)]) > self.limit
        count = len(self.phase)
        return [(start / count, stop / count) for start, stop in Spans.of_mask(far)]

    def rows(self) -> Iterator[dict[str, Any]]:
        """Yield a row a curve: mean and largest difference, where it is, p, where they differ."""
        for number, name in enumerate(self.names):
            away = self.difference[number]
            largest = int(np.argmax(np.abs(away)))
            yield {
                "name": name,
                "mean_difference": float(away.mean()),
                "largest_difference": float(away[largest]),
                "at_phase": float(self.phase[largest]),
                "p": float(self.p[number]),
                "differs_at": self.differing(name),
            }

    def to_dict(self) -> dict[str, Any]:
        """Return the table and the curves as plain data."""
        return {
            "labels": list(self.labels),
            "repetitions": [len(self.first), len(self.second)],
            "level": self.level,
            "permutations": self.count,
            "limit": self.limit,
            "notes": list(self.notes),
            "curves": [
                row
                | {
                    "first": self.first[:, number].mean(axis=0).tolist(),
                    "second": self.second[:, number].mean(axis=0).tolist(),
                    "difference": self.difference[number].tolist(),
                    "low": self.low[number].tolist(),
                    "high": self.high[number].tolist(),
                }
                for number, row in enumerate(self.rows())
            ],
        }

    def to_csv(self) -> str:
        """Return a table: a row a curve and phase."""
        lines = ["name,phase,first,second,difference,low,high,t"]
        first, second = self.first.mean(axis=0), self.second.mean(axis=0)
        for j, name in enumerate(self.names):
            shown = (first, second, self.difference, self.low, self.high, self.t)
            table = np.column_stack([self.phase, *(one[j] for one in shown)])
            lines += [f"{name}," + ",".join(f"{x:.5f}" for x in row) for row in table]
        return "\n".join([*lines, ""])


@one_thread
def compare_curves(
    first: ArrayLike,
    second: ArrayLike,
    options: CompareOptions | None = None,
    *,
    names: Iterable[str] = ("curve",),
    labels: tuple[str, str] = ("first", "second"),
    rng: _Rng = 0,
) -> Comparison:
    """Compare curves of two groups along the phase, such as one mean curve a person.

    Parameters
    ----------
    first, second : (n, P) or (n, J, P), (m, P) or (m, J, P) array_like
        At the same phases, two of each group or more.
    options : CompareOptions, optional
    names : iterable of str
        Of the J curves.
    labels : tuple of two str
        What the groups are called.
    rng : int or numpy.random.Generator
        Draws permutations where not all can be tried.

    Raises
    ------
    TooShort
        If a group has fewer than two.
    ValueError
        If the shapes do not go together, or a value is not finite.

    Examples
    --------
    >>> draw = np.random.default_rng(0)
    >>> before, after = draw.normal(size=(8, 20)), draw.normal(size=(8, 20))
    >>> after[:, 10:] += 5.0
    >>> rl.compare_curves(before, after).differing("curve")
    [(0.5, 1.0)]
    """
    options, names = chosen(CompareOptions, options), tuple(names)
    one, other = (_curves(values, len(names)) for values in (first, second))
    if one.shape[1:] != other.shape[1:]:
        raise ValueError(f"expected curves of one shape, found {one.shape} and {other.shape}")
    for label, group in zip(labels, (one, other), strict=True):
        if len(group) < 2:
            raise TooShort(f"expected two repetitions or more of {label}, found {len(group)}")
    values = np.concatenate([one, other]).reshape(len(one) + len(other), -1)
    t, error = _t_of(values, np.arange(len(one))[None])
    largest = _largest(values, len(one), options.permutations, np.random.default_rng(rng))
    limit = float(np.quantile(largest, options.level, method="higher"))
    shape = one.shape[1:]
    difference = one.mean(axis=0) - other.mean(axis=0)
    t, reach = t[0].reshape(shape), limit * error[0].reshape(shape)
    # What was seen is one of the permutations; rounding must not tell them apart.
    seen = np.abs(t).max(axis=1)[:, None] * (1.0 - ROUNDING)
    return Comparison(
        names=names,
        phase=np.arange(shape[1]) / shape[1],
        first=one,
        second=other,
        difference=difference,
        low=difference - reach,
        high=difference + reach,
        t=t,
        limit=limit,
        p=np.mean(largest >= seen, axis=1),
        level=options.level,
        count=len(largest),
        labels=labels,
    )


@one_thread
def compare_repetitions(
    first: Repetitions,
    second: Repetitions,
    options: CompareOptions | None = None,
    *,
    joints: Iterable[str] | None = None,
    labels: tuple[str, str] = ("first", "second"),
    rng: _Rng = 0,
) -> Comparison:
    """Compare how joints turn along the phase in two recordings.

    Both begin where their cycles do: at the left foot's contact, where feet step.

    Parameters
    ----------
    first, second : Repetitions
        Of one skeleton, two or more each, as from `roundelay.repetitions`.
    options : CompareOptions, optional
    joints : iterable of str, optional
        By default all that turn, but for the root.
    labels : tuple of two str
        What the recordings are called.
    rng : int or numpy.random.Generator
        Draws permutations where not all can be tried.

    Raises
    ------
    SkeletonMismatch
        If the skeletons differ, are of points, or have no such joint.
    TooShort
        If one has fewer than two repetitions.

    Examples
    --------
    >>> takes = [rl.read(f"{name}.bvh") for name in ("walk", "run")]
    >>> groups = [rl.repetitions(rl.find_cycles(take)[0], take) for take in takes]
    >>> found = rl.compare_repetitions(*groups, joints=["LeftLeg"], labels=("walk", "run"))
    >>> bool(found.p[0] < 0.01)
    True
    """
    skeleton = expected(Repetitions, first).cycle.skeleton
    skeleton.require_same(expected(Repetitions, second).cycle.skeleton)
    if skeleton.free:
        raise SkeletonMismatch("expected skeletons whose joints turn, found points")
    asked = _turning(first) if joints is None else list(skeleton.indices(joints))
    if not asked:
        raise SkeletonMismatch("expected joints that turn, found none")
    turned = [_turned(one, asked) for one in (first, second)]
    alike = _same_axes(skeleton, second.cycle.skeleton) and _same_poses(*turned)
    names = [skeleton.names[joint] for joint in asked]
    return _compared(turned, alike, options, names, labels, rng)


@one_thread
def compare_sides(
    cycle: Cycle, motion: Motion, options: CompareOptions | None = None, *, rng: _Rng = 0
) -> Comparison:
    """Compare the left joints of a recording with the right ones, half a cycle apart.

    The recording in a mirror is brought into phase with itself; its left is the right.

    Parameters
    ----------
    cycle : Cycle
        As from `roundelay.find_cycles`.
    motion : Motion
        The capture given to it.
    options : CompareOptions, optional
    rng : int or numpy.random.Generator
        Draws permutations where not all can be tried.

    Returns
    -------
    Comparison
        Named by the left joints.

    Raises
    ------
    SkeletonMismatch
        If left and right are not told by the names of joints.
    TooShort
        If there are fewer than two repetitions.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> found = rl.compare_sides(rl.find_cycles(walk)[0], walk)
    >>> found.labels, found.names[:2]
    (('left', 'right'), ('LeftShoulder', 'LeftArm'))
    """
    left, right = sides(expected(Cycle, cycle).skeleton)
    if not len(left):
        raise SkeletonMismatch("expected joints of a left and a right side, found none")
    own, other = repetitions(cycle, motion), mirrored(cycle)
    turning = set(_turning(own))
    pairs = [(j, k) for j, k in zip(left, right, strict=True) if turning & {int(j), int(k)}]
    ours, theirs = ([int(pair[side]) for pair in pairs] for side in (0, 1))
    names, labels = [cycle.skeleton.names[j] for j in ours], ("left", "right")
    if _same_axes(cycle.skeleton, other.skeleton):
        other = shifted(other, align(cycle, other).offset)
        seen = _turned(repetitions(other, motion.mirror()), ours)
        return _compared([_turned(own, ours), seen], True, options, names, labels, rng)
    later = repetitions(shifted(cycle, _other_step(cycle)), motion)
    turned = [_turned(own, ours), _turned(later, theirs)]
    return _compared(turned, False, options, names, labels, rng)


def _other_step(cycle: Cycle) -> float:
    """Return how much later than the left foot the right one comes down, half a cycle if none."""
    found = {event.name: event.phase for event in events_of(cycle)}
    both = found.get("left contact"), found.get("right contact")
    return 0.5 if both[0] is None or both[1] is None else (both[1] - both[0]) % 1.0


def _compared(
    turned: list[Array],
    alike: bool,
    options: CompareOptions | None,
    names: list[str],
    labels: tuple[str, str],
    rng: _Rng,
) -> Comparison:
    """Compare turns (n, P, J, 4) of two groups; of other axes, as movements about their means."""
    angles = _about_main_axes(*turned) if alike else _movements(*turned)
    found = compare_curves(*angles, options, names=names, labels=labels, rng=rng)
    return replace(found, movement=not alike)


def _curves(values: ArrayLike, count: int) -> Array:
    """Return curves (n, J, P)."""
    found = np.asarray(as_numbers(values, "curves"), float)
    found = found[:, None] if found.ndim == 2 else found
    if found.ndim != 3 or found.shape[1] != count or not found.shape[2]:
        raise ValueError(f"expected curves of shape (n, {count}, P), found {found.shape}")
    if not np.isfinite(found).all():
        raise ValueError("expected finite curves, found others")
    return found


def _turning(own: Repetitions) -> list[int]:
    """Return the joints below the trunk that turn in a cycle."""
    skeleton = own.cycle.skeleton
    rotations = own.cycle.rotations(own.phase)
    spread = np.ptp(rotations, axis=0).max(axis=1)
    spread[list(skeleton.trunk)] = 0.0
    return [int(j) for j in np.flatnonzero(spread > ROUNDING)]


def _same_axes(one: Skeleton, other: Skeleton) -> bool:
    """Tell whether bones lie alike in the axes of their joints, so that turns mean the same."""
    ours, theirs = (np.delete(skeleton.offsets, one.trunk, axis=0) for skeleton in (one, other))
    long = np.linalg.norm(ours, axis=1) > WAVEFORMS.bone * one.size
    if not long.any():
        return True
    cosines = np.sum(ours * theirs, axis=1) / np.maximum(
        np.linalg.norm(ours, axis=1) * np.linalg.norm(theirs, axis=1), SMALL
    )
    return bool(cosines[long].min() > WAVEFORMS.alike)


def _same_poses(one: Array, other: Array) -> bool:
    """Tell whether mean poses are near enough for the axes of joints to be the same."""
    ours, theirs = (rot.mean(x.reshape(-1, *x.shape[2:])) for x in (one, other))
    apart = np.linalg.norm(rot.vector_between(ours, theirs), axis=1)
    return bool(np.median(np.degrees(apart)) < WAVEFORMS.turned)


def _turned(own: Repetitions, joints: list[int]) -> Array:
    """Return how joints are turned on their parents (R, P, J, 4)."""
    inside = (own.phase >= 0.0) & (own.phase < 1.0)
    mean = own.cycle.rotations(own.phase[inside])[:, joints]
    return rot.multiply(mean, rot.from_rotation_vector(own.turns[:, inside][:, :, joints]))


def _about_main_axes(one: Array, other: Array) -> tuple[Array, Array]:
    """Return angles (n, J, P), (m, J, P) in degrees about the main axis common to both."""
    angles = _about_main_axis(np.concatenate([one, other]))
    return angles[: len(one)], angles[len(one) :]


def _movements(one: Array, other: Array) -> tuple[Array, Array]:
    """Return angles about the mean pose and the main axis of each, the same way round in both."""
    ours, theirs = _about_main_axis(one), _about_main_axis(other)
    along = np.sum(ours.mean(axis=0) * theirs.mean(axis=0), axis=1)
    return ours, theirs * np.where(along < 0.0, -1.0, 1.0)[:, None]


def _about_main_axis(turned: Array) -> Array:
    """Return angles (n, J, P) in degrees about the axis about which each joint turns most."""
    middle = rot.mean(turned.reshape(-1, *turned.shape[2:]))
    vectors = rot.vector_between(middle, turned)
    rows = vectors.reshape(-1, *vectors.shape[2:]).transpose(1, 0, 2)
    axes = np.linalg.svd(rows, full_matrices=False)[2][:, 0]
    largest = np.take_along_axis(axes, np.argmax(np.abs(axes), axis=1)[:, None], axis=1)
    axes = axes * np.where(largest < 0.0, -1.0, 1.0)
    return np.degrees(np.einsum("rpjd,jd->rjp", vectors, axes))


def _t_of(values: Array, groups: NDArray[np.intp]) -> tuple[Array, Array]:
    """Return t (B, D) of values (N, D) with rows (B, n) in the first group, and its error."""
    total, count = len(values), groups.shape[1]
    chosen = np.zeros((len(groups), total))
    np.put_along_axis(chosen, groups, 1.0, axis=1)
    # About their mean, lest squares lose digits.
    away = values - values.mean(axis=0)
    one = chosen @ away / count
    other = -count * one / (total - count)
    squares = np.sum(away**2, axis=0) - count * one**2 - (total - count) * other**2
    freedom = max(total - 2, 1)
    # Curves all alike differ by rounding alone.
    least = (ROUNDING * np.abs(values).max()) ** 2 + SMALL
    error = np.sqrt(np.maximum(squares / freedom, least) * (1 / count + 1 / (total - count)))
    return (one - other) / error, error


def _largest(values: Array, count: int, wanted: int, draw: np.random.Generator) -> Array:
    """Return the largest size of t over all values for permutations, the one seen first."""
    tried = _chunks(_groups(len(values), count, wanted, draw))
    return np.concatenate([np.abs(_t_of(values, groups)[0]).max(axis=1) for groups in tried])


def _groups(
    total: int, count: int, wanted: int, draw: np.random.Generator
) -> Iterator[NDArray[np.intp]]:
    """Yield the rows of first groups: all there are, or so many drawn, what was seen first."""
    if comb(total, count) <= wanted:
        yield from (np.array(one, np.intp) for one in combinations(range(total), count))
        return
    yield np.arange(count)
    for _ in range(wanted - 1):
        yield draw.permutation(total)[:count]


def _chunks(groups: Iterator[NDArray[np.intp]]) -> Iterator[NDArray[np.intp]]:
    held: list[NDArray[np.intp]] = []
    for group in groups:
        held.append(group)
        if len(held) == WAVEFORMS.chunk:
            yield np.array(held)
            held = []
    if held:
        yield np.array(held)
