"""When limbs swing against each other: relative phase of two joints, repetition by repetition.

Each joint's place in the body, seen along the level line on which both go to and fro most, has a
phase on the cycle's clock: that of its first harmonic in each repetition. Their difference is an
angle, so its mean, spread and interval are those of directions (Fisher 1993, "Statistical analysis
of circular data").
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import asin, nan, sqrt
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.brief import brief
from roundelay.base.checks import as_numbers, chosen, expected
from roundelay.base.errors import SkeletonMismatch, TooShort
from roundelay.base.numeric import ROUNDING, SMALL
from roundelay.base.threads import one_thread
from roundelay.compare.options import CompareOptions
from roundelay.cycles.repetitions import Repetitions
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics

__all__ = ["RelativePhase", "circular_mean", "relative_phase"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RelativePhase:
    """By how much one joint swings later than another.

    Attributes
    ----------
    each : (R,) ndarray
        Of each repetition, in turns, from -.5 to .5.
    mean : float
        0 in phase, .5 or -.5 against each other.
    resultant : float
        Length of the mean direction: 1 always the same, 0 all over the circle.
    low, high : float
        Interval of the mean, in turns; NaN where directions are too few or too far apart.
    first, second : (R, P) ndarray
        Places of both joints along the line, in body sizes, for a coordination diagram.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> own = rl.repetitions(rl.find_cycles(walk)[0], walk)
    >>> rl.relative_phase(own, "LeftFoot", "RightFoot").each.shape
    (5,)
    """

    each: Array
    mean: float
    resultant: float
    low: float
    high: float
    first: Array = field(repr=False)
    second: Array = field(repr=False)

    __repr__ = brief


@one_thread
def relative_phase(
    own: Repetitions, first: str, second: str, options: CompareOptions | None = None
) -> RelativePhase:
    """Tell by how much a joint swings later than another.

    Parameters
    ----------
    own : Repetitions
        Of a skeleton, as from `roundelay.repetitions`.
    first, second : str
        Joints, such as the hand of one side and the foot of the other.
    options : CompareOptions, optional
        The level of the interval of the mean.

    Returns
    -------
    RelativePhase
        Positive where the first swings later.

    Raises
    ------
    SkeletonMismatch
        If there is no such joint, or the repetitions are of points.
    TooShort
        If there is one repetition only.
    ValueError
        If one of them does not move.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> own = rl.repetitions(rl.find_cycles(walk)[0], walk)
    >>> told = rl.relative_phase(own, "LeftFoot", "RightFoot")
    >>> round(abs(told.mean), 1), round(told.resultant, 2)
    (0.5, 1.0)
    """
    skeleton = expected(Repetitions, own).cycle.skeleton
    if skeleton.free:
        raise SkeletonMismatch("expected repetitions of a skeleton, found some of points")
    if len(own) < 2:
        raise TooShort(f"expected two whole repetitions or more, found {len(own)}")
    places = _to_and_fro(own, [skeleton.index(first), skeleton.index(second)])
    waves = np.exp(-2j * np.pi * np.arange(places.shape[1]) / places.shape[1])
    harmonics = np.einsum("rpk,p->rk", places, waves)
    for name, sizes in zip((first, second), np.abs(harmonics).T, strict=True):
        if sizes.max() <= ROUNDING * places.shape[1]:
            raise ValueError(f"expected joints that swing, found {name} at rest")
    # What swings later has its first harmonic behind.
    each = -np.angle(harmonics[:, 0] * np.conj(harmonics[:, 1])) / (2 * np.pi)
    mean, resultant, reach = circular_mean(each, chosen(CompareOptions, options).level)
    return RelativePhase(
        each, mean, resultant, mean - reach, mean + reach, places[..., 0], places[..., 1]
    )


def circular_mean(turns: ArrayLike, level: float) -> tuple[float, float, float]:
    """Return mean, resultant length and half the interval of the mean of directions in turns.

    Parameters
    ----------
    turns : (n,) array_like
    level : float
        Of the interval; it is NaN where n is below 2 or directions lie too far apart.

    Raises
    ------
    ValueError
        If there are none, one is not finite, or the level is not between 0 and 1.
    """
    values = np.asarray(as_numbers(turns, "turns"), float)
    if not values.size or not np.isfinite(values).all():
        raise ValueError("expected finite directions, found none or others")
    if not 0.0 < level < 1.0:
        raise ValueError(f"expected a level between 0 and 1, found {level:g}")
    around = np.exp(2j * np.pi * values)
    total = complex(around.mean())
    resultant, mean = abs(total), float(np.angle(total))
    second = float(np.mean(np.cos(2 * (2 * np.pi * values - mean))))
    error = sqrt(max(1.0 - second, 0.0) / (2 * len(values) * max(resultant**2, SMALL)))
    sine = NormalDist().inv_cdf((1.0 + level) / 2) * error
    reach = asin(sine) / (2 * np.pi) if len(values) > 1 and sine < 1.0 else nan
    return mean / (2 * np.pi), resultant, reach


def _to_and_fro(own: Repetitions, joints: list[int]) -> Array:
    """Return places (R, P, k) of joints in the body along the line on which they move most."""
    cycle, inside = own.cycle, (own.phase >= 0.0) & (own.phase < 1.0)
    mean = cycle.rotations(own.phase[inside])
    local = rot.multiply(mean, rot.from_rotation_vector(own.turns[:, inside]))
    rows = local.reshape(-1, cycle.skeleton.n_joints, 4)
    places = forward_kinematics(cycle.skeleton, rows, np.zeros((len(rows), 3)))[0][:, joints]
    level = np.delete(places, cycle.up, axis=2) / cycle.skeleton.size
    level = level - level.mean(axis=0)
    line = np.linalg.svd(level.reshape(-1, 2), full_matrices=False)[2][0]
    return np.asarray((level @ line).reshape(*local.shape[:2], len(joints)))
