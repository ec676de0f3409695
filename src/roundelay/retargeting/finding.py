"""Find the canonical body on a skeleton: by names first, by the tree and lengths of bones then."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import SkeletonMismatch
from roundelay.geometry.skeleton import Skeleton
from roundelay.retargeting.canonical import ARM, LEG, SIDES, SPINE, TAIL, Kind
from roundelay.retargeting.mapping import BodyMap
from roundelay.retargeting.thresholds import FINDING
from roundelay.retargeting.words import words_of

__all__ = ["named_body"]

_ADVICE = "name the joints in a map (--map, on the command line)"


def named_body(skeleton: Skeleton, kind: Kind | None = None) -> tuple[BodyMap, bool]:
    """Return the canonical body that a skeleton's names, tree and bones tell.

    Parameters
    ----------
    skeleton : Skeleton
    kind : {"biped", "quadruped"}, optional
        What it is taken for; a quadruped where its front legs are called so, by default.

    Returns
    -------
    body : BodyMap
    tailed : bool
        Whether it has a tail.

    Raises
    ------
    SkeletonMismatch
        If limbs are missing, or two fit equally well; the message says which.
    """
    found = _Search(skeleton)
    limbs = {
        f"{side} {part}": joint
        for side in SIDES
        for one in (found.limb(side, ARM), found.limb(side, LEG))
        for part, joint in one.items()
    }
    missing = [f"{side} {end}" for side in SIDES for end in ("upper arm", "upper leg")
               if f"{side} {end}" not in limbs]  # fmt: skip
    if missing:
        what = ", ".join(name.replace("upper ", "") for name in missing)
        told = f"expected a body with two arms and two legs, found no {what}"
        raise SkeletonMismatch(f"{told} among joints {_listed(skeleton.names)}; {_ADVICE}")
    middle = found.middle(limbs)
    told_kind: Kind = kind or ("quadruped" if found.has_front_legs else "biped")
    if told_kind == "biped":
        middle = {name: joint for name, joint in middle.items() if name not in TAIL}
    names = {name: skeleton.names[joint] for name, joint in (middle | limbs).items()}
    return BodyMap(told_kind, names), bool(found.tail())


def _listed(names: Sequence[str]) -> str:
    few = ", ".join(map(repr, names[: FINDING.told]))
    return few if len(names) <= FINDING.told else f"{few} and {len(names) - FINDING.told} more"


@dataclass(frozen=True)
class _Fit:
    """Joints of a limb, and how well they fit it."""

    score: float
    joints: dict[str, int]


class _Search:
    """A skeleton and what its names say."""

    def __init__(self, skeleton: Skeleton) -> None:
        self.skeleton, self.words = skeleton, words_of(skeleton.names)
        self.lengths = np.linalg.norm(skeleton.offsets, axis=1)
        self.lengths[0] = 0.0
        self.has_front_legs = any(word.front for word in self.words)

    def above(self, joint: int) -> list[int]:
        """Return a joint and those above it, from the top."""
        chain = [joint]
        while (joint := self.skeleton.parents[joint]) >= 0:
            chain.append(joint)
        return chain[::-1]

    def limb(self, side: str, parts: Sequence[str]) -> dict[str, int]:
        """Return the joints of a limb by its parts; none where there is no such limb.

        Raises
        ------
        SkeletonMismatch
            If two fit equally well.
        """
        fits = [fit for chain in self._chains(side, parts) for fit in self._fits(chain, parts)]
        if not fits:
            return {}
        best = max(fits, key=lambda fit: fit.score)
        end = parts[-1] if parts is ARM else parts[2]
        rivals = {
            fit.joints[end]
            for fit in fits
            if end in fit.joints and fit.score > best.score - FINDING.equal
        }
        apart = [one for one in rivals if not self._on_one_way(one, best.joints.get(end, one))]
        if apart:
            names = [self.skeleton.names[joint] for joint in (best.joints[end], apart[0])]
            what = f"{side} {'arm' if parts is ARM else 'leg'}"
            told = f"expected one {what}, found two that fit equally well, ending in"
            raise SkeletonMismatch(f"{told} {names[0]!r} and {names[1]!r}; {_ADVICE}")
        return best.joints

    def _on_one_way(self, first: int, second: int) -> bool:
        return first in self.above(second) or second in self.above(first)

    def _chains(self, side: str, parts: Sequence[str]) -> Iterator[list[int]]:
        """Yield the ways to the ends that a limb may have: joints of its side, from the middle."""
        for joint, word in enumerate(self.words):
            if word.side == side and any(part in word.weights for part in parts[1:]):
                chain = [one for one in self.above(joint) if self.words[one].side == side]
                yield [one for one in chain if not self.words[one].odd][-FINDING.longest :]

    def _fits(self, chain: list[int], parts: Sequence[str]) -> Iterator[_Fit]:
        """Yield every way to name the joints of a chain, its last joint being the last part."""
        named, told = [], set[str]()
        for joint in chain:
            word = self.words[joint]
            # Of names alike in line the first: those behind it share its twist.
            again = FINDING.again if word.told in told else 1.0
            named.append({part: again * x for part, x in word.weights.items() if part in parts})
            told.add(word.told)
        able = [k for k, weights in enumerate(named) if weights]
        for first, last in _ranges(parts):
            wanted = parts[first:last]
            for places in combinations(able[:-1], len(wanted) - 1):
                joints = [*places, able[-1]] if able else []
                if len(joints) != len(wanted) or able[-1] != len(chain) - 1:
                    continue
                weights = [named[k].get(part, 0.0) for k, part in zip(joints, wanted, strict=True)]
                if min(weights) > 0.0:
                    taken = {part: chain[k] for k, part in zip(joints, wanted, strict=True)}
                    yield _Fit(sum(weights) + self._proportion(taken, parts), taken)

    def _proportion(self, taken: dict[str, int], parts: Sequence[str]) -> float:
        """Return how much two bones of a limb speak against it by their lengths; 0 for alike."""
        upper, lower, end = (parts[1], parts[2], parts[3]) if parts is ARM else parts[:3]
        one = self._way(taken[upper], taken[lower])
        two = self._way(taken[lower], taken[end]) if end in taken else self._reach(taken[lower])
        least = FINDING.least * self.skeleton.size
        if one < least or two < least:
            return -FINDING.unlike
        depth = FINDING.depth * sum(len(self.above(joint)) for joint in taken.values())
        return -abs(float(np.log(one / two))) - depth

    def _way(self, upper: int, lower: int) -> float:
        """Return the length of the bones from a joint to one below it."""
        total, joint = 0.0, lower
        while joint != upper and joint >= 0:
            total += float(self.lengths[joint])
            joint = self.skeleton.parents[joint]
        return total

    def _reach(self, joint: int) -> float:
        ends = [float(np.linalg.norm(end)) for on, end in self.skeleton.end_sites if on == joint]
        below = [float(self.lengths[k]) for k, p in enumerate(self.skeleton.parents) if p == joint]
        return max([*ends, *below], default=0.0)

    def meeting(self, joints: Sequence[int]) -> int:
        """Return the lowest joint that all of these hang on."""
        shared = set(self.above(joints[0]))
        for joint in joints[1:]:
            shared &= set(self.above(joint))
        return max(shared, key=lambda joint: len(self.above(joint)))

    def middle(self, limbs: dict[str, int]) -> dict[str, int]:
        """Return hips, spine, neck, head and tail by the limbs that hang on them."""
        hips = self.meeting([limbs["left upper leg"], limbs["right upper leg"]])
        arms = [limbs.get(f"{side} shoulder", limbs[f"{side} upper arm"]) for side in SIDES]
        top = self.meeting(arms)
        found = {"hips": hips}
        spine = [j for j in self.above(top) if j not in self.above(hips) and not self.words[j].side]
        found |= dict(zip(SPINE, _spread(spine, len(SPINE)), strict=False))
        head = self._head(top, set(limbs.values()))
        if head is not None:
            between = [j for j in self.above(head)[:-1] if j not in self.above(top)]
            found["head"] = head
            if between:
                found["neck"] = between[0]
        return found | dict(zip(TAIL, self.tail(), strict=False))

    def _head(self, top: int, limbs: set[int]) -> int | None:
        """Return what is called a head, or the end of what goes on above the arms."""
        parents, words = self.skeleton.parents, self.words
        called = [j for j, word in enumerate(words) if "head" in word.weights and not word.odd]
        if called:
            return min(called, key=lambda joint: len(self.above(joint)))
        joint, head = top, None
        while True:
            ahead = [j for j, above in enumerate(parents) if above == joint and self._goes_on(j)]
            below = [j for j in ahead if not limbs.intersection(self.skeleton.descendants(j))]
            if not below:
                return head
            head = joint = max(below, key=lambda j: len(self.skeleton.descendants(j)))

    def _goes_on(self, joint: int) -> bool:
        """Tell whether a joint may be a neck or a head by its name."""
        word = self.words[joint]
        return (
            word.side is None and not word.odd and not {"tail", "hips"}.intersection(word.weights)
        )

    def tail(self) -> list[int]:
        """Return the first and the last joint of a tail; none without one."""
        called = [j for j, word in enumerate(self.words) if "tail" in word.weights]
        return called[:1] if len(called) < 2 else [called[0], called[-1]]


def _ranges(parts: Sequence[str]) -> tuple[tuple[int, int], ...]:
    """Return which parts of a limb may be told: what is outermost may be missing."""
    return ((0, 4), (1, 4), (0, 3), (1, 3)) if parts is ARM else ((0, 4), (0, 3))


def _spread(chain: list[int], count: int) -> list[int]:
    """Return at most so many joints of a chain, the first and the last among them."""
    if len(chain) <= count:
        return chain
    places: NDArray[np.intp] = np.linspace(0, len(chain) - 1, count).round().astype(np.intp)
    return [chain[place] for place in places]
