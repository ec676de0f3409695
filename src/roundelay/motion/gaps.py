"""Gaps: where points were not seen, and what is put there.

Two ways of filling compete. The *line* goes on from either side (cubic, with the slopes there). The
*alike* poses take a point from where it was in the frames in which the rest of the body, its speed
included, was most alike, moved so that it meets both sides: within a cycle these are the same
phases of other repetitions. For each point and length of gap both are tried on gaps of that length
made where the point was seen, and the better is taken. A gap that neither can predict is bridged by
a straight line, and told as open.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import SMALLEST, TINY
from roundelay.base.spans import Spans
from roundelay.motion.poses import Mask
from roundelay.motion.thresholds import GAPS

__all__ = ["Gap", "fill_gaps", "gaps_in_words", "outliers", "straight"]

Array = NDArray[np.float64]
Way = Literal["line", "alike", "open"]


@dataclass(frozen=True)
class Gap:
    """Describe a stretch in which a point was not seen.

    Attributes
    ----------
    point : str
    start, stop : int
        Its frames, half open.
    way : {"line", "alike", "open"}
        How it was filled; an open one is bridged by a straight line.
    """

    point: str
    start: int
    stop: int
    way: Way

    def __len__(self) -> int:
        return self.stop - self.start


def gaps_in_words(gaps: Sequence[Gap], frames: int, points: int) -> str:
    """Tell gaps in one line: how many, how much of all that is, the longest, and what is open.

    Parameters
    ----------
    gaps : sequence of Gap
        At least one.
    frames, points : int
        Of the take.
    """
    share = sum(map(len, gaps)) / (frames * points)
    missed = sorted({gap.point for gap in gaps})
    named = ", ".join(missed[:3]) + (
        f" and {_counted(len(missed) - 3, 'other')}" if len(missed) > 3 else ""
    )
    told = f"{_counted(len(gaps), 'gap')} of {named}, {share:.1%} of all positions, filled"
    longest = max(gaps, key=len)
    told += f"; the longest, {_span(longest)}"
    still = [gap for gap in gaps if gap.way == "open"]
    if still:
        told += f"; {len(still)} of them could not be predicted and count for nothing: "
        told += ", ".join(map(_span, sorted(still, key=len)[:-4:-1]))
        told += " and others" if len(still) > 3 else ""
    return told


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _span(gap: Gap) -> str:
    return f"{gap.point} in frames {gap.start} to {gap.stop - 1}"


def outliers(positions: Array, seen: Mask, size: float) -> Mask:
    """Tell which positions (F, J) jump away from the frames before and after and back again.

    Parameters
    ----------
    positions : (F, J, d) ndarray
    seen : (F, J) ndarray of bool
    size : float
        Of the body, in the unit of the positions.
    """
    jumped = np.zeros(seen.shape, bool)
    for point in range(seen.shape[1]):
        frames = np.flatnonzero(seen[:, point])
        jumped[frames[_jumping(positions[frames, point], size)], point] = True
    return jumped


def _jumping(path: Array, size: float) -> Mask:
    """Tell which places of a path (n, d) lie far off the median of their neighbours.

    The median of a window of the frames to either side, mirrored at the ends.
    """
    reach, count = GAPS.reach, len(path)
    if count < 2 * reach + 1:
        return np.zeros(count, bool)
    padded = np.pad(path, ((reach, reach), (0, 0)), mode="reflect")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1, axis=0)
    middle = np.median(windows, axis=-1)
    off = np.linalg.norm(path - middle, axis=1)
    usual = float(np.median(off[off > 0.0])) if np.any(off > 0.0) else 0.0
    # Where the point moves fast, a place may lie as far off as the steps around it are long.
    steps = np.pad(np.linalg.norm(np.diff(middle, axis=0), axis=1), reach)
    around = np.lib.stride_tricks.sliding_window_view(steps, 2 * reach).max(axis=1)
    return np.asarray(off > np.maximum(GAPS.usual * usual, GAPS.apart * size) + 2.0 * around)


def fill_gaps(
    inside: Array,
    seen: Mask,
    names: Sequence[str],
    *,
    size: float,
    reach: int,
    longest: int | None = None,
) -> tuple[Array, tuple[Gap, ...]]:
    """Fill what is missing of points in the frame of their body.

    Parameters
    ----------
    inside : (F, J, 3) ndarray
        Positions in the frame of the trunk.
    seen : (F, J) ndarray of bool
        Each point in one frame at least.
    names : sequence of str
        Of the points.
    size : float
        Of the body, in the unit of the positions.
    reach : int
        Frames to either side from which speeds are told.
    longest : int, optional
        Longer gaps stay open; by default those that cannot be predicted.

    Returns
    -------
    positions : (F, J, 3) ndarray
    gaps : tuple of Gap
    """
    filled = straight(inside, seen)
    poses = _Poses(filled.copy(), seen, size, reach)
    found: list[Gap] = []
    for point in np.flatnonzero(~seen.all(axis=0)).tolist():
        best: dict[tuple[int, tuple[Way, ...]], Way] = {}
        for start, stop in Spans.of_mask(~seen[:, point]):
            ways = poses.ways(start, stop) if longest is None or stop - start <= longest else ()
            # Gaps of about one length are tried once.
            kind = (int(np.ceil(np.log2(stop - start))), ways)
            if kind not in best:
                best[kind] = poses.best_way(point, stop - start, ways)
            if best[kind] != "open":
                filled[start:stop, point] = poses.filled(point, start, stop, best[kind])
            found.append(Gap(names[point], start, stop, best[kind]))
    return filled, tuple(found)


def straight(inside: Array, seen: Mask) -> Array:
    """Return positions with straight lines where points are missing, level at the ends."""
    result, frames = inside.copy(), np.arange(len(inside))
    for point in np.flatnonzero(~seen.all(axis=0)):
        known = np.flatnonzero(seen[:, point])
        for axis in range(inside.shape[2]):
            result[:, point, axis] = np.interp(frames, known, inside[known, point, axis])
    return result


class _Poses:
    """What the rest of a body tells of a point."""

    def __init__(self, straight: Array, seen: Mask, size: float, reach: int) -> None:
        self._places, self._seen, self._size = straight, seen, size
        frames = np.arange(len(straight))
        ahead, behind = np.minimum(frames + reach, frames[-1]), np.maximum(frames - reach, 0)
        speed = straight[ahead] - straight[behind]
        # A frame's speed counts like its pose.
        speed *= np.sqrt(np.mean(np.var(straight, axis=0)) / max(float(np.mean(speed**2)), TINY))
        # Single precision tells what is alike well enough.
        known = np.stack([seen, seen[ahead] & seen[behind]], axis=2).astype(np.float32)
        values = np.stack([straight - straight.mean(axis=0), speed], axis=2, dtype=np.float32)
        values *= known[..., None]
        squares, flat = np.sum(values**2, axis=-1), values.reshape(*known.shape[:2], -1)
        # Products of a frame's row with those of others are distances; see `_apart`.
        self._asked = np.concatenate([squares, known, -2.0 * flat], axis=2)
        self._known = known
        self._others = np.arange(0, len(frames), max(1, -(-len(frames) // GAPS.poses)))
        theirs = np.concatenate([known, squares, flat], axis=2)[self._others]
        self._theirs = np.ascontiguousarray(theirs.reshape(len(self._others), -1).T)
        self._theirs_known = np.ascontiguousarray(
            known[self._others].reshape(len(self._others), -1).T
        )

    def ways(self, start: int, stop: int) -> tuple[Way, ...]:
        """Return the ways in which a gap can be filled: by what is seen around it and during it."""
        inner = start > 0 and stop < len(self._seen)
        shown = self._seen[start:stop].mean() > GAPS.shown
        return (*(("line",) if inner else ()), *(("alike",) if shown else ()))

    def best_way(self, point: int, length: int, ways: tuple[Way, ...]) -> Way:
        """Return the way that fills gaps of a length best where the point was seen."""
        tries = self._tries(point, length)
        if not (tries and ways):
            return "line" if "line" in ways and length <= GAPS.short else "open"
        errors = {way: self._error(point, tries, way) for way in ways}
        best = min(errors, key=lambda way: errors[way])
        return best if errors[best] <= GAPS.error * self._size else "open"

    def _tries(self, point: int, length: int) -> list[tuple[int, int]]:
        """Return stretches of a length in which a point was seen, spread evenly."""
        found: list[int] = []
        for start, stop in Spans.of_mask(self._seen[:, point]):
            found += range(start + 1, stop - length - 1, max(1, length))
        spread = np.unique(np.linspace(0, len(found) - 1, GAPS.tries).round().astype(int))
        return [(found[place], found[place] + length) for place in spread] if found else []

    def _error(self, point: int, tries: Sequence[tuple[int, int]], way: Way) -> float:
        """Return the root mean square error of a way, in the median over several gaps."""
        errors = []
        for start, stop in tries:
            off = self.filled(point, start, stop, way) - self._places[start:stop, point]
            errors.append(float(np.sqrt(np.mean(np.sum(off**2, axis=1)))))
        return float(np.median(errors))

    def filled(self, point: int, start: int, stop: int, way: Way) -> Array:
        """Return what a way puts into a gap, (n, 3)."""
        if way == "line":
            return self._line(point, start, stop)
        return self._alike(point, start, stop)

    def _line(self, point: int, start: int, stop: int) -> Array:
        """Return a cubic that goes on from either side."""
        first, last = self._places[start - 1, point], self._places[stop, point]
        width = stop - start + 1
        before = first - self._places[max(start - 2, 0), point]
        after = self._places[min(stop + 1, len(self._places) - 1), point] - last
        u = (np.arange(1, width) / width)[:, None]
        h00, h01 = 2 * u**3 - 3 * u**2 + 1, -2 * u**3 + 3 * u**2
        h10, h11 = u**3 - 2 * u**2 + u, u**3 - u**2
        return np.asarray(h00 * first + h10 * width * before + h01 * last + h11 * width * after)

    def _alike(self, point: int, start: int, stop: int) -> Array:
        """Return where the point was in the frames most alike, moved to meet both sides."""
        count = len(self._places)
        ends = [frame for frame in (start - 1, stop) if 0 <= frame < count]
        asked = np.array([*range(start, stop), *ends])
        usable = self._seen[self._others, point]
        usable &= (self._others < start - 1) | (self._others > stop)
        if not usable.any():
            return self._places[start:stop, point]
        guess = self._mean_of_nearest(point, asked, usable)
        inner = guess[: stop - start]
        offsets = [
            self._places[frame, point] - guess[stop - start + number]
            for number, frame in enumerate(ends)
        ]
        if not offsets:
            return inner
        part = (np.arange(1, stop - start + 1) / (stop - start + 1))[:, None]
        early, late = offsets[0], offsets[-1]
        return np.asarray(inner + (1.0 - part) * early + part * late)

    def _mean_of_nearest(self, point: int, asked: NDArray[np.intp], usable: Mask) -> Array:
        """Return where a point was, on average, in the usable frames most alike each asked one."""
        apart, known = self._apart(point, asked)[:, usable], self._others[usable]
        count = min(GAPS.nearest, len(known))
        nearest = np.argpartition(apart, count - 1, axis=1)[:, :count]
        least = TINY * self._size**2
        weight = 1.0 / np.maximum(np.take_along_axis(apart, nearest, axis=1).astype(float), least)
        weight += SMALLEST
        weight /= weight.sum(axis=1, keepdims=True)
        return np.asarray(np.einsum("fk,fkd->fd", weight, self._places[known[nearest], point]))

    def _apart(self, point: int, asked: NDArray[np.intp]) -> Array:
        """Return mean squared distances (n, m) of frames to the others.

        By what both show of the other points.
        """
        rows, known = self._asked[asked], self._known[asked]
        rows[:, point] = known[:, point] = 0.0
        shared = known.reshape(len(asked), -1) @ self._theirs_known
        apart = np.maximum(rows.reshape(len(asked), -1) @ self._theirs, 0.0)
        return np.where(shared > 0.0, apart / np.maximum(shared, 1.0), np.inf)
