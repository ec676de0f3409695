"""Which parts of a capture are periodic: candidates from recurrence, for topology to judge.

A periodic part returns to each of its poses after about one period. For every frame the lags
at which the pose comes back (valleys of the distance to later frames) are linked over time
into *returns*: a run of frames, each with the lag after which it recurs. A return that covers
more of the motion than chance would is a candidate part. This needs no model of the motion,
follows a changing tempo, and costs time linear in the capture's length. The final word is
the verdict's.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.numeric import TINY
from roundelay.base.spans import Spans
from roundelay.motion.poses import lag_distances, with_velocity
from roundelay.timeline.proposals.proposal import Proposal
from roundelay.timeline.search import Search
from roundelay.timeline.thresholds import RECURRENCE

__all__ = ["Part", "Recurrence", "candidate_parts", "recurring_groups"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Part:
    """A stretch of a capture in which poses come back after a period.

    Parameters
    ----------
    start, stop : int
        Half-open range of frames.
    period : float
        Typical lag of a return, in frames.
    repeats : float
        How often the period fits into the part, measured along the path of poses.
    distance : float
        Mean squared distance of returning poses over the largest on the way, in [0, 1).
    """

    start: int
    stop: int
    period: float
    repeats: float
    distance: float

    @property
    def score(self) -> float:
        """How much of the motion recurs, and how well: for choosing among rivals."""
        return (self.repeats - 1.0) * (1.0 - self.distance / RECURRENCE.returned)

    def spread(self, step: int, first: int, last: int) -> Part:
        """Express a part of every step-th frame from `first` on in all frames up to `last`."""
        return replace(
            self,
            start=first + self.start * step,
            stop=min(first + self.stop * step, last),
            period=self.period * step,
        )

    def overlap(self, other: Part) -> int:
        """Return the number of frames two parts share."""
        return max(0, min(self.stop, other.stop) - max(self.start, other.start))


class Recurrence:
    """Propose stretches in which poses recur, those of one motion together.

    Parameters
    ----------
    name : str
    limbs : str
        Look at these limbs alone: a few bones that do not repeat can hide those that do, as in
        boxing ([C] ch. 7). What they show must stand out more.
    """

    def __init__(self, name: str, limbs: str = "") -> None:
        self.name, self._limbs = name, limbs

    def propose(self, search: Search) -> Iterator[Proposal]:
        """Propose each motion, best first; if refused as a whole, by its parts."""
        own = search.of(self._limbs)
        if own is None:
            return
        first, last = own.span
        found = candidate_parts(own.points[first : last : own.step], own.fps / own.step)
        parts = [part.spread(own.step, first, last) for part in found]
        for group in recurring_groups(own.points, parts):
            alone = tuple(self._proposal([part]) for part in group)
            yield replace(self._proposal(group), apart=alone if len(group) > 1 else ())

    def _proposal(self, group: list[Part]) -> Proposal:
        runs = Spans.union((part.start, part.stop) for part in group)
        period = float(np.median([part.period for part in group]))
        least = RECURRENCE.prominent_limbs if self._limbs else 0.0
        return Proposal(runs, period, self._limbs, least)


def candidate_parts(points: ArrayLike, fps: float) -> list[Part]:
    """Find stretches in which poses recur, without overlap, best first.

    Parameters
    ----------
    points : (n, d) array_like
        One point a frame, as from `roundelay.point_cloud`.
    fps : float
        Frames a second.

    Returns
    -------
    list of Part
    """
    x = np.asarray(points, float)
    reach = min(len(x) - 2, round(RECURRENCE.longest * fps))
    if reach < 3:
        return []
    apart = lag_distances(x, reach)
    ratio = _return_ratio(_averaged(apart, round(RECURRENCE.window * fps)))
    arc = np.concatenate([[0.0], np.cumsum(np.sqrt(apart[:-1, 1]))])
    linked = _link(_valleys(ratio, max(2, int(RECURRENCE.shortest * fps))))
    tracks = [steady for track in linked for steady in _steady_stretches(track)]
    parts = [_part(track, ratio, arc) for track in tracks]
    return _choose([part for part in parts if _credible(part)])


def _averaged(apart: Array, half: int) -> Array:
    """Average lag distances over frames within `half` of each: the delay embedding's.

    Windows are cut at the ends of the capture rather than frames lost there.
    """
    known = np.isfinite(apart)
    total = _padded_sums(np.where(known, apart, 0.0))
    count = _padded_sums(known.astype(float))
    frames = np.arange(len(apart))
    first, last = np.maximum(frames - half, 0), np.minimum(frames + half + 1, len(apart))
    with np.errstate(invalid="ignore"):
        mean = (total[last] - total[first]) / (count[last] - count[first])
    return np.where(known, mean, np.nan)


def _padded_sums(values: Array) -> Array:
    return np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values, axis=0)])


def _return_ratio(apart: Array) -> Array:
    """Divide each distance by the largest on the way to it; infinity where unknown."""
    known = np.isfinite(apart)
    largest = np.maximum.accumulate(np.where(known, apart, 0.0), axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = apart / largest
    return np.where(known & (largest > 0.0), ratio, np.inf)


def _valleys(ratio: Array, shortest: int) -> list[NDArray[np.intp]]:
    """List for every frame the lags at which its pose has come back."""
    low = np.zeros(ratio.shape, bool)
    middle = ratio[:, 1:-1]
    low[:, 1:-1] = (
        (middle <= ratio[:, :-2]) & (middle <= ratio[:, 2:]) & (middle < RECURRENCE.returned)
    )
    low[:, :shortest] = False
    rows, lags = np.nonzero(low)
    return np.split(lags, np.searchsorted(rows, np.arange(1, len(ratio))))


def _link(valleys: list[NDArray[np.intp]]) -> list[NDArray[np.intp]]:
    """Chain valleys of neighbouring frames whose lags are near into tracks (frame, lag)."""
    finished: list[list[tuple[int, int]]] = []
    live: list[list[tuple[int, int]]] = []
    for frame, lags in enumerate(valleys):
        free, kept = set(lags.tolist()), []
        for track in live:
            last_frame, last_lag = track[-1]
            reach = RECURRENCE.jump * (frame - last_frame)
            near = [t for t in free if abs(t - last_lag) <= reach]
            if near:
                lag = min(near, key=lambda t: abs(t - last_lag))
                free.discard(lag)
                track.append((frame, lag))
                kept.append(track)
            else:
                (kept if frame - last_frame <= RECURRENCE.gap else finished).append(track)
        live = kept + [[(frame, lag)] for lag in sorted(free)]
    return [np.array(track) for track in finished + live if len(track) >= RECURRENCE.fewest]


def _steady_stretches(track: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Split a track where its lag leaves what is typical of it: there it changed its motion."""
    lags = track[:, 1]
    typical = np.median(lags)
    within = (lags > typical / RECURRENCE.drift) & (lags < typical * RECURRENCE.drift)
    if within.all():
        return [track]
    pieces = np.split(track, np.flatnonzero(np.diff(within)) + 1)
    long = [piece for piece in pieces if len(piece) >= RECURRENCE.fewest]
    return [steady for piece in long for steady in _steady_stretches(piece)]


def _part(track: NDArray[np.intp], ratio: Array, arc: Array) -> Part:
    frames, lags = track[:, 0], track[:, 1]
    loop = float(np.median(arc[frames + lags] - arc[frames]))
    return Part(
        start=int(frames[0]),
        stop=int(frames[-1] + lags[-1]) + 1,
        period=float(np.median(lags)),
        repeats=1.0 + float(arc[frames[-1]] - arc[frames[0]]) / max(loop, TINY),
        distance=float(ratio[frames, lags].mean()),
    )


def _credible(part: Part) -> bool:
    """Ask for closer returns where fewer were seen."""
    repeated = part.repeats - 1.0
    near = min(RECURRENCE.returned, RECURRENCE.close + RECURRENCE.closeness * repeated)
    return repeated >= RECURRENCE.least_repeat and part.distance <= near


def _choose(parts: list[Part]) -> list[Part]:
    """Keep the best of rivals that share more than half of the shorter one's frames."""
    chosen: list[Part] = []
    for part in sorted(parts, key=lambda p: p.score, reverse=True):
        short = [min(part.stop - part.start, c.stop - c.start) for c in chosen]
        if all(2 * part.overlap(c) <= s for c, s in zip(chosen, short, strict=True)):
            chosen.append(part)
    return chosen


def recurring_groups(points: ArrayLike, parts: list[Part]) -> list[list[Part]]:
    """Group parts that show the same motion, each group in order of time.

    Parameters
    ----------
    points : (n, d) array_like
        One point a frame.
    parts : list of Part
        Best first, as from `candidate_parts`.

    Returns
    -------
    list of list of Part
        In the order of their best parts.
    """
    x = np.asarray(points, float)
    groups: list[list[Part]] = []
    for part in parts:
        home = next((g for g in groups if _alike(x, g, part)), None)
        if home is None:
            groups.append([part])
        else:
            home.append(part)
    return [sorted(group, key=lambda p: p.start) for group in groups]


def _alike(points: Array, group: list[Part], part: Part) -> bool:
    """Compare a part with those of a group, without the frames that they share."""
    start, stop = part.start, part.stop
    for other in group:
        pieces = (start, min(stop, other.start)), (max(start, other.stop), stop)
        start, stop = max(pieces, key=lambda piece: piece[1] - piece[0])
    if stop - start < RECURRENCE.overlap * part.period:
        return True
    return any(_near(points, other, part, (start, stop)) for other in group)


def _near(points: Array, first: Part, second: Part, own: tuple[int, int]) -> bool:
    """Tell whether typical poses of each are near to poses of the other."""
    period = 0.5 * (first.period + second.period)
    if abs(first.period - second.period) > RECURRENCE.alike_period * period:
        return False
    clouds = [with_velocity(points, [run], period) for run in ((first.start, first.stop), own)]
    a, b = (cloud[:: max(1, len(cloud) // RECURRENCE.compared)] for cloud in clouds)
    apart = _squared(a, b)
    pairs = ((a, apart.min(axis=1)), (b, apart.min(axis=0)))
    return all(np.median(nearest) < RECURRENCE.alike * _width(cloud) for cloud, nearest in pairs)


def _width(cloud: Array) -> float:
    """Return the largest squared distance within a cloud; a little more than 0."""
    return max(float(_squared(cloud, cloud).max()), TINY)


def _squared(a: Array, b: Array) -> Array:
    inner = a @ b.T
    squares = np.einsum("ij,ij->i", a, a)[:, None] + np.einsum("ij,ij->i", b, b)
    return np.maximum(squares - 2.0 * inner, 0.0)
