"""A skeleton seen as a canonical body: chains of bones between its joints, and where it stands.

Between two joints of the canonical body a skeleton may have several: those of a spine, or the
joints by which a twist is shared out along an arm.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import SkeletonMismatch
from roundelay.geometry.skeleton import Skeleton
from roundelay.retargeting.canonical import SIDES
from roundelay.retargeting.mapping import BodyMap
from roundelay.retargeting.thresholds import REFERENCE

__all__ = ["Anatomy", "Limb"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Limb:
    """An arm or a leg.

    Attributes
    ----------
    name : str
        "left arm".
    girdle : int or None
        The joint of a shoulder; None for a leg.
    upper, lower : tuple of int
        Joints of the two long bones: the first carries it, others share its twist.
    end : int or None
        The hand or the foot.
    tip : int or None
        The toes.
    """

    name: str
    girdle: int | None
    upper: tuple[int, ...]
    lower: tuple[int, ...]
    end: int | None
    tip: int | None

    @property
    def is_leg(self) -> bool:
        """Whether it is a leg by its bones; the front legs of a quadruped are arms."""
        return self.name.endswith("leg")


@dataclass(frozen=True, eq=False)
class Anatomy:
    """A skeleton with its canonical body.

    Parameters
    ----------
    skeleton : Skeleton
    body : BodyMap

    Raises
    ------
    SkeletonMismatch
        If a joint of the map does not exist, or limbs do not hang as those of a body.
    """

    skeleton: Skeleton
    body: BodyMap

    def __post_init__(self) -> None:
        for limb in self.limbs:
            chain = [limb.upper[0], limb.lower[0], *([limb.end] if limb.end is not None else [])]
            for above, below in pairwise(chain):
                if above not in self.above(below)[:-1]:
                    names = self.skeleton.names
                    told = f"expected {names[below]!r} below {names[above]!r} in the {limb.name}"
                    raise SkeletonMismatch(f"{told}, as the map has them; found it elsewhere")

    def above(self, joint: int) -> list[int]:
        """Return a joint and those above it, from the top."""
        chain = [joint]
        while (joint := self.skeleton.parents[joint]) >= 0:
            chain.append(joint)
        return chain[::-1]

    def _between(self, upper: int, lower: int) -> tuple[int, ...]:
        """Return the joints from one to before another below it."""
        chain = self.above(lower)
        return tuple(chain[chain.index(upper) : -1]) if upper in chain else (upper,)

    @cached_property
    def at(self) -> dict[str, int]:
        """Number of the skeleton's joint for each of the canonical body."""
        return self.body.indices(self.skeleton)

    @cached_property
    def limbs(self) -> tuple[Limb, ...]:
        """Left arm, left leg, right arm, right leg."""
        return tuple(self._limb(side, kind) for side in SIDES for kind in ("arm", "leg"))

    def _limb(self, side: str, kind: str) -> Limb:
        at, ends = self.at, {"arm": "hand", "leg": "foot"}
        upper, lower = at[f"{side} upper {kind}"], at[f"{side} lower {kind}"]
        end = at.get(f"{side} {ends[kind]}")
        return Limb(
            f"{side} {kind}",
            at.get(f"{side} shoulder") if kind == "arm" else None,
            self._between(upper, lower),
            (lower,) if end is None else self._between(lower, end),
            end,
            at.get(f"{side} toes") if kind == "leg" else None,
        )

    @cached_property
    def legs(self) -> tuple[Limb, ...]:
        """The limbs that stand: two of a biped, four of a quadruped."""
        return tuple(x for x in self.limbs if x.is_leg or self.body.kind == "quadruped")

    @cached_property
    def arms(self) -> tuple[Limb, ...]:
        """The limbs that do not stand."""
        return tuple(limb for limb in self.limbs if limb not in self.legs)

    @cached_property
    def hips(self) -> tuple[int, int]:
        """The joints at which left and right leg turn."""
        left, right = (limb.upper[0] for limb in self.limbs if limb.is_leg)
        return left, right

    @cached_property
    def shoulders(self) -> tuple[int, int]:
        """The joints at which left and right arm turn."""
        left, right = (limb.upper[0] for limb in self.limbs if not limb.is_leg)
        return left, right

    @cached_property
    def carrier(self) -> int:
        """The lowest joint that legs and arms hang on: what moves it moves the body."""
        chains = [self.above(joint) for joint in (*self.hips, *self.shoulders)]
        return max(set.intersection(*map(set, chains)), key=lambda joint: len(self.above(joint)))

    @cached_property
    def pelvis(self) -> tuple[int, ...]:
        """The joints that turn with the hips, from the carrier to what both legs hang on."""
        chains = [self.above(joint) for joint in self.hips]
        meeting = max(set.intersection(*map(set, chains)), key=lambda j: len(self.above(j)))
        chain = self.above(meeting)
        return tuple(chain[chain.index(self.carrier) :])

    @cached_property
    def spine(self) -> tuple[int, ...]:
        """The joints from above the carrier to what both arms hang on."""
        tops = [limb.girdle if limb.girdle is not None else limb.upper[0]
                for limb in self.limbs if not limb.is_leg]  # fmt: skip
        shared = set.intersection(*(set(self.above(joint)[:-1]) for joint in tops))
        top = max(shared, key=lambda joint: len(self.above(joint)))
        chain = self.above(top)
        return tuple(chain[chain.index(self.carrier) + 1 :])

    @cached_property
    def heights(self) -> tuple[float, ...]:
        """How far up the trunk the joints of the spine are, from the carrier to the neck, 0 to 1.

        As bones are long, whatever their pose.
        """
        top = self.spine[-1] if self.spine else self.carrier
        ahead = self.neck[:1] or tuple(
            limb.upper[0] if limb.girdle is None else limb.girdle
            for limb in self.limbs
            if not limb.is_leg
        )
        lengths = [float(np.linalg.norm(self.skeleton.offsets[joint])) for joint in self.spine]
        ways = [self.above(joint) for joint in ahead]
        inside = [way[way.index(top) + 1 :] for way in ways]
        last = np.mean([np.linalg.norm(self.skeleton.offsets[way], axis=1).sum() for way in inside])
        total = sum(lengths) + float(last)
        return tuple(np.cumsum(lengths) / total) if total else tuple(np.zeros(len(lengths)))

    @cached_property
    def neck(self) -> tuple[int, ...]:
        """The joints above the spine, the head last."""
        head = self.at.get("head", self.at.get("neck"))
        if head is None:
            return ()
        body = {*self.spine, *self.pelvis, self.carrier, *self.above(self.carrier)}
        return tuple(joint for joint in self.above(head) if joint not in body)

    @cached_property
    def tail(self) -> tuple[int, ...]:
        """The joints of a tail."""
        if "tail" not in self.at:
            return ()
        first, last = self.at["tail"], self.at.get("tail tip", self.at["tail"])
        return tuple(j for j in self.above(last) if first in self.above(j))

    def length(self, limb: Limb) -> float:
        """Return the length of a limb's two long bones."""
        chain = [*limb.upper[1:], *limb.lower, *([limb.end] if limb.end is not None else [])]
        return float(sum(np.linalg.norm(self.skeleton.offsets[joint]) for joint in chain))

    @cached_property
    def leg_length(self) -> float:
        """The mean length of the legs, by which bodies are compared."""
        return float(np.mean([self.length(limb) for limb in self.legs]))

    def tip_of(self, joint: int) -> Array | None:
        """Return where a joint's bone ends (3,), in its own axes; None if nothing tells."""
        ends = [end for on, end in self.skeleton.end_sites if on == joint]
        below = [
            self.skeleton.offsets[k] for k, p in enumerate(self.skeleton.parents) if p == joint
        ]
        named = [*below, *ends]
        long = max(named, key=lambda one: float(np.linalg.norm(one)), default=None)
        if long is None or np.linalg.norm(long) < REFERENCE.least * self.skeleton.size:
            return None
        return np.asarray(long, float)

    def ground(self) -> Iterator[tuple[int, Array]]:
        """Yield what a body can stand on: the joints and ends of its feet, as places on joints."""
        for limb in self.legs:
            if limb.end is not None:
                inside = set(self.skeleton.descendants(limb.end))
                yield from ((joint, np.zeros(3)) for joint in sorted(inside))
                yield from ((on, end) for on, end in self.skeleton.end_sites if on in inside)
