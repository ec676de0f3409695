"""The principal ways in which the repetitions of a cycle differ, as many as predict.

Functional principal components (Ramsay, Silverman 2005): each repetition is a curve over the phase,
what turns the mean's joints into its own, with the root's way and height. Turns count by how far
they move what hangs on a joint. How many modes there are is told by prediction: each repetition is
left out in turn, modes are found from the others, its own share of each is told from its first
half, and its second half is predicted by them. The number that predicts best is taken; predictions
are drawn towards the mean as far as that makes them better.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from roundelay.base.brief import brief
from roundelay.base.checks import expected
from roundelay.base.errors import TooShort
from roundelay.base.numeric import ROUNDING, SMALL
from roundelay.base.threads import one_thread
from roundelay.cycles.repetitions import Repetitions
from roundelay.cycles.thresholds import VARIATION
from roundelay.motion.motion import Motion

__all__ = ["Chosen", "Fit", "Modes", "chosen_modes", "curves", "modes"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Chosen:
    """How many modes predict best.

    Attributes
    ----------
    count : int
        0 where the mean alone predicts best.
    shrink : float
        What predictions are multiplied by, from 0 to 1.
    error : float
        Squared error of left-out repetitions, over that of the mean alone; 1 without modes.
    """

    count: int
    shrink: float
    error: float


@dataclass(frozen=True, eq=False)
class Modes:
    """The principal ways in which repetitions differ.

    Attributes
    ----------
    source : Repetitions
    count : int
        How many predict best; 0 where a left-out repetition is predicted best by the mean.
    error : float
        Squared error of the second halves of left-out repetitions, over that of the mean alone.
    shares : (R - 1,) ndarray
        Of the whole variance, of all modes, the largest first.
    scores : (R, R - 1) ndarray
        Of each repetition, in standard deviations.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> ways = rl.modes(rl.repetitions(rl.find_cycles(walk)[0], walk))
    >>> ways.scores.shape  # five repetitions, each by four modes
    (5, 4)
    """

    source: Repetitions = field(repr=False)
    count: int
    error: float
    shares: Array
    scores: Array = field(repr=False)

    __repr__ = brief

    @one_thread
    def loop(
        self, number: int, amount: float = 2.0, *, fps: float | None = None, foot_lock: bool = True
    ) -> Motion:
        """Return the mean changed along one mode, as a loop.

        Parameters
        ----------
        number : int
            From 0, the mode of the largest share.
        amount : float
            Standard deviations; negative the other way.
        fps : float, optional
            Frames a second; the capture's by default.
        foot_lock : bool
            Hold standing feet still.

        Raises
        ------
        ValueError
            If there is no such mode, or the frame rate is not positive.
        """
        known = self.scores.shape[1]
        if not 0 <= number < known:
            raise ValueError(f"expected a mode from 0 to {known - 1}, found {number}")
        mixture = amount * self.scores[:, number] / (len(self.source) - 1)
        return self.source.mixed(mixture[None], fps=fps, foot_lock=foot_lock)


@one_thread
def modes(source: Repetitions) -> Modes:
    """Find the principal ways in which repetitions differ, and how many of them predict.

    Parameters
    ----------
    source : Repetitions
        As from `roundelay.repetitions`.

    Raises
    ------
    TooShort
        If there are fewer than four: none can be left out.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> ways = rl.modes(rl.repetitions(rl.find_cycles(walk)[0], walk))
    >>> len(ways.loop(0, 2.0))
    66
    """
    source = expected(Repetitions, source)
    if len(source) < VARIATION.fewest:
        raise TooShort(
            f"expected {VARIATION.fewest} whole repetitions or more for modes, found {len(source)}"
        )
    values, early = curves(source)
    chosen = chosen_modes(values, early)
    found = Fit.of(values)
    total = max(float(found.variances.sum()), SMALL)
    scores = found.scores(values)
    return Modes(source, chosen.count, chosen.error, found.variances / total, scores)


def curves(source: Repetitions) -> tuple[Array, Mask]:
    """Return repetitions as vectors (R, D) in body sizes, and which values (D,) are the first half.

    Parameters
    ----------
    source : Repetitions
    """
    inside = (source.phase >= 0.0) & (source.phase < 1.0)
    phase, size = source.phase[inside], source.cycle.skeleton.size
    reach = source.cycle.skeleton.reaches / size
    way = np.cumsum(source.velocity[:, inside], axis=1) / (len(phase) * size)
    told = [
        source.turns[:, inside] * reach[:, None],
        way[:, :, None],
        source.height[:, inside, None, None] / size,
    ]
    if source.moved is not None:
        told.append(source.moved[:, inside] / size)
    count = len(source)
    values = np.concatenate([one.reshape(count, len(phase), -1) for one in told], axis=2)
    early = np.repeat(phase < 0.5, values.shape[2])
    return values.reshape(count, -1), early


def chosen_modes(values: Array, early: Mask) -> Chosen:
    """Choose the number of modes that predicts best the late part of left-out curves.

    Parameters
    ----------
    values : (R, D) ndarray
        Four curves or more.
    early : (D,) ndarray of bool
        The part of a curve that is known when the rest is predicted.
    """
    most = min(VARIATION.modes, len(values) - 3)
    fits = [Fit.of(np.delete(values, left, axis=0)) for left in range(len(values))]
    away = np.array([one - fit.mean for one, fit in zip(values, fits, strict=True)])
    late = away[:, ~early]
    none = float(np.sum(late**2))
    shrinks, errors = [0.0], [np.sum(late**2, axis=1)]
    for count in range(1, most + 1 if none > 0.0 else 0):
        told = np.array([f.told(x, early, count) for f, x in zip(fits, away, strict=True)])
        shrink = float(np.clip(np.sum(told * late) / max(np.sum(told**2), SMALL), 0.0, 1.0))
        shrinks.append(shrink)
        errors.append(np.sum((late - shrink * told) ** 2, axis=1))
    sums = np.array(errors).sum(axis=1) / (none or 1.0)
    count = int(np.argmax(sums <= sums.min() + VARIATION.gain))
    return Chosen(count, shrinks[count], float(sums[count]) if none else 1.0)


@dataclass(frozen=True, eq=False)
class Fit:
    """Mean (D,), modes (K, D) of length 1 and their variances (K,), of curves."""

    mean: Array
    modes: Array
    variances: Array

    @classmethod
    def of(cls, values: Array) -> Fit:
        """Fit some curves (R, D)."""
        mean, freedom = values.mean(axis=0), len(values) - 1
        _, lengths, rows = np.linalg.svd(values - mean, full_matrices=False)
        return cls(mean, rows[:freedom], lengths[:freedom] ** 2 / freedom)

    def told(self, away: Array, early: Mask, count: int) -> Array:
        """Return the late part of what a curve (D,) is away from the mean, from its early part.

        Its shares of the modes are those most likely if what is left is white (probabilistic
        principal components; Tipping, Bishop 1999).
        """
        variances = self.variances[:count]
        noise = max(float(self._left[count]) / len(away), ROUNDING * float(variances[0]), SMALL)
        seen = self.modes[:count, early]
        matrix = variances[:, None] * (seen @ seen.T) + noise * np.eye(count)
        shares = np.linalg.solve(matrix, variances * (seen @ away[early]))
        return np.asarray(shares @ self.modes[:count, ~early])

    def scores(self, values: Array) -> Array:
        """Return the shares (R, K) of curves in standard deviations."""
        spread = np.sqrt(np.maximum(self.variances, SMALL))
        return np.asarray((values - self.mean) @ self.modes.T / spread)

    @cached_property
    def _left(self) -> Array:
        """Variance beyond the first 0, 1, ... modes."""
        return np.asarray(self.variances.sum() - np.append(0.0, np.cumsum(self.variances)))
