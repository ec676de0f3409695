"""Lay how two cycles differ on a third: the walk of an old man, less his plain walk, on a run.

At equal phases the difference is what turns each joint of the plain cycle into that of the styled
one, seen from the joint's parent; how much higher the root is; by what the period and the way in a
period grow. Turns are rotation vectors, so that any share of them can be laid on another cycle.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.checks import expected
from roundelay.base.threads import one_thread
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.edit.align import Criterion, align, hung_as, mapped, mirrored
from roundelay.cycles.edit.options import AmountOptions
from roundelay.cycles.edit.points import of_common_points
from roundelay.cycles.thresholds import ALIGNMENT
from roundelay.geometry import rotations as rot
from roundelay.phase.harmonic import HarmonicCurve

__all__ = ["Style", "style"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Style:
    """The difference of two cycles, to be laid on others.

    Parameters
    ----------
    styled, neutral : Cycle
        Of one skeleton; bone lengths may differ.
    by : {"poses", "contacts"}
        What shall agree at equal phases; see `roundelay.cycles.edit.align.align`.
    mirror : bool
        Let left and right be exchanged in both where that fits better.

    Examples
    --------
    >>> walk, run = (rl.find_cycles(rl.read(f"{name}.bvh"))[0] for name in ("walk", "run"))
    >>> rl.Style(run, walk)
    Style('run' less 'walk')
    """

    styled: Cycle
    neutral: Cycle
    by: Criterion = "poses"
    mirror: bool = False

    def __repr__(self) -> str:
        return f"Style({self.styled.name!r} less {self.neutral.name!r})"

    @one_thread
    def on(self, cycle: Cycle, amount: float = 1.0) -> Cycle:
        """Lay some of the difference on a cycle.

        What turns the heading stays the cycle's own, as do the joints above the one that carries
        the body. `Cycle.sample` holds standing feet.

        Parameters
        ----------
        cycle : Cycle
            Of the same skeleton.
        amount : float
            1 for all of it, 0 for none, negative the other way; from -3 to 3.

        Returns
        -------
        Cycle
            It begins at the same phase as the one given.

        Raises
        ------
        SkeletonMismatch
            Naming the joints that only one of them has.
        ValueError
            If the amount is out of range, or another axis points up in each.
        """
        AmountOptions(abs(amount))
        cycle, neutral, styled = of_common_points(
            [expected(Cycle, cycle), self.neutral, self.styled]
        )
        neutral, styled = self._in_phase(cycle, neutral, styled)
        turned = _turned(cycle, _turns(neutral, styled), amount)
        share = amount * cycle.skeleton.size / neutral.skeleton.size
        paces = neutral.travels and styled.travels and cycle.travels
        stride = (_stride(styled) / _stride(neutral)) ** amount if paces else 1.0
        return replace(
            turned,
            period=cycle.period * (styled.period / neutral.period) ** amount,
            velocity=mapped(cycle.velocity, lambda v: stride * v),
            height=_added(cycle.height, styled.height, neutral.height, share),
            translations=_moved(cycle, styled, neutral, share),
            evidence=None,
            phase=None,
            method="",
        )

    def _in_phase(self, cycle: Cycle, neutral: Cycle, styled: Cycle) -> tuple[Cycle, Cycle]:
        neutral, styled = (hung_as(one, cycle.skeleton) for one in (neutral, styled))
        found = align(cycle, neutral, by=self.by, mirror=self.mirror)
        styled = mirrored(styled) if found.mirrored else styled
        return found.cycle, align(found.cycle, styled, by=self.by).cycle


def style(styled: Cycle, neutral: Cycle, *, by: Criterion = "poses", mirror: bool = False) -> Style:
    """Return the difference of two cycles as a style; see `Style`.

    Parameters
    ----------
    styled, neutral : Cycle
        Of one skeleton, such as an old man's walk and a plain walk.
    by : {"poses", "contacts"}
        What shall agree at equal phases.
    mirror : bool
        Let left and right be exchanged in both where that fits the cycle it is laid on better.

    Raises
    ------
    SkeletonMismatch
        Naming the joints that only one of them has.

    Examples
    --------
    >>> walk, run = (rl.find_cycles(rl.read(f"{name}.bvh"))[0] for name in ("walk", "run"))
    >>> half = rl.style(run, walk).on(walk, 0.5)
    >>> bool(run.period < half.period < walk.period)
    True
    """
    one, other = of_common_points([expected(Cycle, styled), expected(Cycle, neutral)])
    one.skeleton.require_same(other.skeleton)
    return Style(styled, neutral, by, mirror)


def _turns(neutral: Cycle, styled: Cycle) -> HarmonicCurve:
    """Return what turns each joint, seen from its parent, as rotation vectors, 3 J values."""
    grid = np.arange(ALIGNMENT.phases) / ALIGNMENT.phases
    plain, other = (one.rotations(grid) for one in (neutral, styled))
    vectors = rot.to_rotation_vector(rot.multiply(other, rot.conjugate(plain)))
    return HarmonicCurve.through(vectors.reshape(len(grid), -1))


def _turned(cycle: Cycle, turns: HarmonicCurve, amount: float) -> Cycle:
    def after(curve: HarmonicCurve, *, odd: bool) -> HarmonicCurve:
        # A product of trigonometric polynomials has the harmonics of both together.
        count = 2 * (len(curve.frequencies) + len(turns.frequencies)) + 1
        x = np.arange(count) / count
        added = rot.from_rotation_vector(amount * turns(x).reshape(count, -1, 3))
        values = rot.multiply(added, curve(x).reshape(count, -1, 4))
        return HarmonicCurve.through(values.reshape(count, -1), odd=odd)

    odd_pose = cycle.odd_pose and after(cycle.odd_pose, odd=True)
    return replace(cycle, pose=after(cycle.pose, odd=False), odd_pose=odd_pose)


def _stride(cycle: Cycle) -> float:
    return cycle.speed * cycle.period / cycle.skeleton.size


def _added(
    curve: HarmonicCurve, plus: HarmonicCurve, minus: HarmonicCurve, share: float
) -> HarmonicCurve:
    grid = np.arange(ALIGNMENT.phases) / ALIGNMENT.phases
    return HarmonicCurve.through(curve(grid) + share * (plus(grid) - minus(grid)))


def _moved(cycle: Cycle, styled: Cycle, neutral: Cycle, share: float) -> HarmonicCurve | None:
    """Return where joints are on their parents, if bones of any of the three change length."""
    if styled.translations is None or neutral.translations is None or cycle.translations is None:
        return cycle.translations
    return _added(cycle.translations, styled.translations, neutral.translations, share)
