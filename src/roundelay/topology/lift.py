"""Lift of a cocycle mod p to the integers, checked exactly and repaired where it fails."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from roundelay.base.brief import brief
from roundelay.base.errors import LiftError
from roundelay.topology.kernel.reduction import I64, Columns

__all__ = ["Lift", "lift_to_integers"]


@dataclass(frozen=True)
class Lift:
    """An integer cocycle, by its values on the births.

    Attributes
    ----------
    values : (born,) array of int
        The value of each birth edge; edges of the spanning forest have 0.
    multiplier : int
        The class mod p was multiplied by this first; 1 where the plain lift holds.
    divisor : int
        The lifted values were divided by this, their greatest common divisor.
    """

    values: I64
    multiplier: int
    divisor: int

    __repr__ = brief


def lift_to_integers(on_births: I64, prime: int, relations: Columns, death: float) -> Lift:
    """Lift values mod p on the births to an integer cocycle on all edges below the death.

    All other values follow from these, and every triangle is satisfied if and only if every
    relation of the filtration is: so the check is exact. A class that is an integer one times a
    fraction mod p, such as (p + 1) / 2, fails at every prime; then the multiple of it with the
    smallest values that satisfies the relations is taken, and divided by their greatest common
    divisor. Never trust values near p / 2 (Gaukstad, Nordal, Thaule, arXiv 2509.16102).

    Parameters
    ----------
    on_births : (born,) array of int
        Values mod p.
    prime : int
        The modulus.
    relations : Columns
        Relations between births over the integers.
    death : float
        Only relations strictly before this scale count.

    Returns
    -------
    Lift
        The integer cocycle.

    Raises
    ------
    LiftError
        If no multiple of the class lifts.
    """
    below = _below(relations, death)
    plain = _centred(on_births, prime)
    if _satisfies(plain, below):
        return Lift(plain, 1, 1)
    found = min(
        (
            (int(abs(values).max()), multiplier)
            for multiplier in range(2, (prime - 1) // 2 + 1)
            if _satisfies(values := _centred(multiplier * on_births, prime), below)
        ),
        default=None,
    )
    if found is None:
        raise LiftError(
            f"the class mod {prime} lifts to no integer cocycle below its death at {death:g}: "
            f"tried the values centred and their multiples by 2 to {max(1, (prime - 1) // 2)} "
            f"against {len(below.time)} relations; try a larger prime"
        )
    values = _centred(found[1] * on_births, prime)
    divisor = math.gcd(*values.tolist())
    return Lift(values // divisor, found[1], divisor)


def _below(relations: Columns, death: float) -> Columns:
    count = int(np.searchsorted(relations.time, np.float32(death)))
    entries = relations.start[count]
    return Columns(
        relations.start[: count + 1],
        relations.index[:entries],
        relations.value[:entries],
        relations.time[:count],
    )


def _centred(values: I64, prime: int) -> I64:
    """Representatives in (-p/2, p/2]."""
    residues = values % prime
    return np.where(residues > prime // 2, residues - prime, residues)


def _satisfies(values: I64, relations: Columns) -> bool:
    if not len(relations.time):
        return True
    terms = relations.value * values[relations.index]
    return not np.add.reduceat(terms, relations.start[:-1]).any()
