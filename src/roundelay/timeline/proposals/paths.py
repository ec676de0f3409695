"""The path through the lags that explains a take best, group of limbs by group.

Viterbi's path over the hops of a take, which come in blocks: where the best ways to every lag of
the last hop were one and the same, the path is settled, and its hops are forgotten.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from roundelay.timeline.thresholds import PREDICTABILITY

__all__ = ["best_paths"]

Array = NDArray[np.float64]
Values = NDArray[np.float32]
Paths = NDArray[np.intp]


def best_paths(blocks: Iterable[Values], lags: Array) -> tuple[Paths, Values]:
    """Return the lag that explains each hop best, and how well.

    Parameters
    ----------
    blocks : iterable of (hops, groups, lags) ndarray
        S of every hop, in order of time.
    lags : (lags,) ndarray
        In seconds.

    Returns
    -------
    paths : (groups, hops) ndarray of int
        Places among the lags; -1 where none explains the hop.
    values : (groups, hops) ndarray
        S of these lags; 0 where there is none.
    """
    ways, found = _Ways(lags), list[tuple[Paths, Values]]()
    for block in blocks:
        if len(ways):
            found.append(ways.settled())
        ways.go_on(block)
    found.append(ways.ended())
    paths, values = zip(*found, strict=True)
    return np.concatenate(paths).T, np.ascontiguousarray(np.concatenate(values).T)


class _Ways:
    """The best ways to every lag of the last hop, as far back as they differ."""

    def __init__(self, lags: Array) -> None:
        self._least = PREDICTABILITY.explained + PREDICTABILITY.longer * np.log2(lags / lags[0])
        self._periods = np.sqrt(PREDICTABILITY.hop / lags)
        self._values: Values = np.zeros((0, 0, len(lags)), np.float32)
        self._best, self._none = np.zeros((0, 0, 0)), np.zeros((0, 0))

    def __len__(self) -> int:
        return len(self._best)

    def go_on(self, values: Values) -> None:
        """Go on by the hops of a block."""
        hops, groups, count = values.shape
        reach = PREDICTABILITY.reach
        best = np.full((hops, groups, count + 2 * reach), -np.inf)
        inner = best[:, :, reach:-reach]
        np.multiply(values - self._least, self._periods, out=inner)
        none = np.zeros((hops, groups))
        for hop in range(hops):
            if hop or len(self):
                before = (best, none) if hop else (self._best, self._none)
                reached, none[hop] = _reached(before[0][hop - 1], before[1][hop - 1])
                inner[hop] += reached
        if len(self):
            values = np.concatenate([self._values, values])
            best, none = np.concatenate([self._best, best]), np.concatenate([self._none, none])
        self._values, self._best, self._none = values, best, none

    def settled(self) -> tuple[Paths, Values]:
        """Return the path (hops, groups) that all ways have in common, and its S; forget it."""
        groups, count = self._values.shape[1:]
        lag, hop = np.tile(np.arange(-1, count), (groups, 1)), len(self) - 1
        turns = _turns(self._best, self._none)
        while hop and (lag != lag[:, :1]).any():
            hop -= 1
            lag = _before(lag, self._best[hop], *(own[hop] for own in turns))
        if (lag != lag[:, :1]).any():
            return np.zeros((0, groups), np.intp), self._values[:0, :, 0]
        found = self._path(lag[:, :1], hop)
        left = slice(hop + 1, None)
        self._values, self._best = self._values[left].copy(), self._best[left].copy()
        self._none = self._none[left].copy()
        return found

    def ended(self) -> tuple[Paths, Values]:
        """Return the path (hops, groups) of the best way of all, and its S."""
        best = self._best[-1]
        top = best.argmax(axis=1) - PREDICTABILITY.reach
        lag = np.where(best.max(axis=1) > self._none[-1], top, -1)
        return self._path(lag[:, None], len(self) - 1)

    def _path(self, lag: Paths, last: int) -> tuple[Paths, Values]:
        """Follow the way back from the lag (groups, 1) of a hop."""
        path = np.empty((last + 1, *lag.shape), np.intp)
        path[last] = lag
        turns = _turns(self._best[:last], self._none[:last])
        for hop in range(last - 1, -1, -1):
            path[hop] = _before(path[hop + 1], self._best[hop], *(own[hop] for own in turns))
        known = np.maximum(path, 0)
        values = np.take_along_axis(self._values[: last + 1], known, axis=2)
        return path[:, :, 0], np.where(path >= 0, values, np.float32(0.0))[:, :, 0]


def _reached(best: Array, none: Array) -> tuple[Array, Array]:
    """Return the best way (groups, lags) to each lag from the hop before, and to none."""
    reach, count = PREDICTABILITY.reach, best.shape[1] - 2 * PREDICTABILITY.reach
    stay = best[:, reach:-reach].copy()
    for shift in range(1, reach + 1):
        first, last = (best[:, at : at + count] for at in (reach - shift, reach + shift))
        near = np.maximum(first, last)
        near -= PREDICTABILITY.wobble * shift
        np.maximum(stay, near, out=stay)
    highest = best.max(axis=1)
    np.maximum(stay, np.maximum(*_entering(highest, none))[:, None], out=stay)
    return stay, np.maximum(none, highest - PREDICTABILITY.switch)


def _entering(highest: Array, none: Array) -> tuple[Array, Array]:
    """Return what it comes to to enter a period from none, and from the best other one."""
    other = highest - PREDICTABILITY.other * PREDICTABILITY.switch
    return none - PREDICTABILITY.switch, other


def _turns(best: Array, none: Array) -> tuple[Array, Paths, Paths]:
    """Return what entering a period comes to (hops, groups, 1), from where, and from where none."""
    top, highest = best.argmax(axis=2) - PREDICTABILITY.reach, best.max(axis=2)
    first, other = _entering(highest, none)
    entered = np.where(first >= other, -1, top)
    left = np.where(highest - PREDICTABILITY.switch > none, top, -1)
    return np.maximum(first, other)[..., None], entered[..., None], left[..., None]


def _before(lag: Paths, best: Array, enter: Array, entered: Paths, left: Paths) -> Paths:
    """Return the lags (groups, n) one hop earlier on the best ways to some lags."""
    reach = PREDICTABILITY.reach
    shifts = np.arange(-reach, reach + 1)
    near = lag[:, :, None] + (shifts + reach)
    near += np.arange(0, best.size, best.shape[1])[:, None, None]
    around = best.ravel().take(near) - PREDICTABILITY.wobble * np.abs(shifts)
    source = np.where(enter > around.max(axis=2), entered, lag + around.argmax(axis=2) - reach)
    return np.where(lag < 0, left, source)
