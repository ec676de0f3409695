"""A yardstick that imports nothing of the search: how well joints come back after a period.

Joints are seen from the hips, in the direction in which these look; what comes back is measured
by the correlation of their places with those a lag later.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

import roundelay as rl

Array = NDArray[np.float64]
Spans = Sequence[tuple[int, int]]

LEAST, NEARLY = 0.6, 0.05
# Samples a period: more tell nothing.
_FINE = 64
_FEET = re.compile(r"foot(_[lr])?$", re.IGNORECASE)
_HANDS = re.compile(r"hand(_[lr])?$", re.IGNORECASE)
# The least share of the feet's or the hands' motion that named limbs must hold.
_MOST = 0.6


@dataclass(frozen=True, eq=False)
class Body:
    """The joints of a capture, seen from its hips."""

    names: tuple[str, ...]
    parents: tuple[int, ...]
    hips: int
    places: Array
    fps: float

    @cached_property
    def feet(self) -> list[list[int]]:
        """The joints of each leg, its foot first."""
        return self._limbs(_FEET)

    @cached_property
    def hands(self) -> list[list[int]]:
        """The joints of each arm, its hand first."""
        return self._limbs(_HANDS)

    def _limbs(self, pattern: re.Pattern[str]) -> list[list[int]]:
        ends = [i for i, name in enumerate(self.names) if pattern.search(name)]
        above = {end: self.above(end) for end in ends}
        limbs = []
        for end in ends:
            others = {joint for other in ends if other != end for joint in above[other]}
            chain = [joint for joint in above[end] if joint not in others]
            limbs.append([end, *sorted(set(self._below(chain[-1])) - {end})])
        return limbs

    def above(self, joint: int) -> list[int]:
        """A joint and all it hangs on, up to the root."""
        chain = [joint]
        while self.parents[chain[-1]] >= 0:
            chain.append(self.parents[chain[-1]])
        return chain

    def _below(self, joint: int) -> list[int]:
        found = {joint}
        for other, parent in enumerate(self.parents):
            if parent in found:
                found.add(other)
        return sorted(found)

    def indices(self, joints: Iterable[str]) -> list[int]:
        known = {name: i for i, name in enumerate(self.names)}
        return [known[name] for name in joints if name in known]

    def share(self, limbs: str, joints: Iterable[str], span: tuple[int, int]) -> float:
        """Return how much of the feet's or hands' motion the limbs hold that joints are of."""
        named = set(self.indices(joints))
        parts = self.feet if limbs == "feet" else self.hands
        moved = [float(self.places[slice(*span), part[0]].var(axis=0).sum()) for part in parts]
        held = [m for part, m in zip(parts, moved, strict=True) if named & set(part)]
        return sum(held) / max(sum(moved), 1e-300)

    def shows(self, limbs: str, joints: Iterable[str], span: tuple[int, int]) -> bool:
        """Tell whether joints are those of the feet or hands that move in some frames."""
        return self.share(limbs, joints, span) >= _MOST


def body(motion: rl.Motion) -> Body:
    """See a motion from its hips: fore-aft, height, sideways."""
    skeleton, placed = motion.skeleton, motion.positions()
    children = np.bincount(np.array(skeleton.parents[1:], int), minlength=skeleton.n_joints)
    hips = int(np.argmax(children > 1)) if (children > 1).any() else 0
    seen = placed - placed[:, [hips]]
    unturned = Body(skeleton.names, skeleton.parents, hips, seen, motion.fps)
    if len(unturned.feet) < 2:
        return unturned
    return replace(unturned, places=_ahead(seen, _side(unturned), motion.up))


def _side(body: Body) -> Array:
    """Return the way (F, 3) from one thigh, two joints above the foot, to the other."""
    thighs = [body.above(leg[0])[:3][-1] for leg in body.feet[:2]]
    return body.places[:, thighs[1]] - body.places[:, thighs[0]]


def _ahead(seen: Array, side: Array, up: int) -> Array:
    """Turn places so that the way from thigh to thigh is the last axis, and up the second."""
    across = side * (1.0 - np.eye(3)[up])
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12)
    vertical = np.broadcast_to(np.eye(3)[up], across.shape)
    axes = np.stack((np.cross(vertical, across), vertical, across), axis=1)
    return np.einsum("fab,fjb->fja", axes, seen)


@dataclass(frozen=True)
class Measured:
    """Correlations at half, once and twice a period; NaN where too little was seen."""

    half: float
    once: float
    twice: float

    @property
    def passes(self) -> bool:
        better = max(self.half, self.twice) if self.twice == self.twice else self.half
        return self.once >= LEAST and not better > self.once + NEARLY


def measured(body: Body, joints: Iterable[str], spans: Spans, period: float) -> Measured:
    """Measure how joints come back, by fore-aft and height or all three coordinates.

    Parameters
    ----------
    body : Body
    joints : iterable of str
        Those above the hips are left out.
    spans : sequence of (start, stop)
        In frames.
    period : float
        In seconds.
    """
    chosen = [joint for joint in body.indices(joints) if joint not in body.above(body.hips)]
    step = max(1, int(period * body.fps / _FINE))
    parts = [body.places[start:stop:step, chosen] for start, stop in spans]
    lag = period * body.fps / step
    seen = [_measured([part[:, :, :axes] for part in parts], lag) for axes in (2, 3)]
    return max(seen, key=lambda each: (each.passes, np.nan_to_num(each.once, nan=-1.0)))


def _measured(parts: list[Array], period: float) -> Measured:
    rows = [part.reshape(len(part), -1) for part in parts]
    if sum(max(0.0, len(row) - period) for row in rows) < 0.5 * period:
        # Repetitions with something else between: one after the other.
        rows = [np.concatenate(rows)] if rows else []
    return Measured(*(_correlation(rows, many * period, period) for many in (0.5, 1.0, 2.0)))


def _correlation(rows: list[Array], lag: float, period: float) -> float:
    """Return the correlation of rows with those a lag later, all of them; NaN for too few."""
    counts = [max(0, int(len(row) - lag)) for row in rows]
    # Twice a period is told only where it is seen for a whole period.
    if sum(counts) < (0.95 if lag > period else 0.3) * period:
        return float("nan")
    covariance = norm = 0.0
    for row, count in zip(rows, counts, strict=True):
        if count > 1:
            now, then = _centred(row[:count]), _centred(_later(row, lag, count))
            covariance += float((now * then).sum())
            norm += float(np.sqrt((now**2).sum() * (then**2).sum()))
    return covariance / max(norm, 1e-300)


def _later(row: Array, lag: float, count: int) -> Array:
    whole, part = int(lag), lag % 1.0
    after = row[whole + 1 : whole + 1 + count] if part else row[whole : whole + count]
    return (1.0 - part) * row[whole : whole + count] + part * after


def _centred(row: Array) -> Array:
    return row - row.mean(axis=0)


def ends_apart(body: Body, joints: Iterable[str], span: tuple[int, int]) -> tuple[float, float]:
    """Return how far poses at both ends are apart over their deviation, and velocities."""
    places = body.places[slice(*span), body.indices(joints)].reshape(span[1] - span[0], -1)
    reach = max(1, round(body.fps / 30))
    if len(places) < 4 * reach or not places.size:
        return float("inf"), float("inf")
    speed = np.diff(places[::reach], axis=0)
    first, last = places[reach] - places[0], places[-1] - places[-1 - reach]
    # The loop's own step from its last frame to its first may be whole, or none.
    gap = places[-1] + np.linspace(0.0, 1.0, 5)[:, None] * last / reach - places[0]
    moved = max(float(np.sqrt(places.var(axis=0).sum())), 1e-12)
    usual = max(float(np.sqrt((speed**2).sum(axis=1).mean())), 1e-12)
    return float(np.linalg.norm(gap, axis=1).min()) / moved, float(
        np.linalg.norm(last - first)
    ) / usual
