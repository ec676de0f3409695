"""Spans: stretches of frames, as half-open ranges. The one type for them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import accumulate, pairwise
from operator import index
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Span", "Spans", "closed_spans"]

Span = tuple[int, int]
Mask = NDArray[np.bool_]
Indices = NDArray[np.intp]


class Spans(tuple[Span, ...]):
    """Hold half-open ranges (start, stop) of frames, in order of time and without overlap.

    Equal to, hashed and shown as a plain tuple of pairs.

    Parameters
    ----------
    spans : iterable of (int, int)
        ``0 <= start <= stop``, each beginning where or after the one before ends.

    Raises
    ------
    ValueError
        If a pair is not of this form, or begins before the one before it ends.
    """

    __slots__ = ()

    def __new__(cls, spans: Iterable[Iterable[int]] = ()) -> Spans:
        """Check the pairs."""
        if isinstance(spans, cls):
            return spans
        pairs = tuple(_pair(span) for span in spans)
        for (_, before), (start, stop) in pairwise(pairs):
            if start < before:
                raise ValueError(f"expected frames from {before} on, found {start} to {stop}")
        return super().__new__(cls, pairs)

    @classmethod
    def of_mask(cls, mask: Mask) -> Spans:
        """Return the ranges in which a mask (F,) is true."""
        edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(int)))
        return cls(edges.reshape(-1, 2).tolist())

    @classmethod
    def union(cls, spans: Iterable[Span]) -> Spans:
        """Join ranges in order of their starts that meet or overlap."""
        joined: list[Span] = []
        for start, stop in spans:
            if joined and start <= joined[-1][1]:
                joined[-1] = (joined[-1][0], max(stop, joined[-1][1]))
            else:
                joined.append((start, stop))
        return cls(joined)

    @classmethod
    def end_to_end(cls, lengths: Iterable[int]) -> Spans:
        """Return ranges of given lengths, one after the other from 0."""
        return cls(pairwise(accumulate(lengths, initial=0)))

    @property
    def frames(self) -> Indices:
        """The frames (n,) in all ranges, in order."""
        ranges = [np.arange(start, stop) for start, stop in self]
        return np.concatenate([np.zeros(0, np.intp), *ranges])

    @property
    def lengths(self) -> list[int]:
        """How many frames each range has."""
        return [stop - start for start, stop in self]

    @property
    def total(self) -> int:
        """How many frames all ranges have."""
        return sum(self.lengths)

    def within(self, frames: range) -> int:
        """Count the frames of all ranges that lie in a range."""
        return sum(
            max(0, min(stop, frames.stop) - max(start, frames.start)) for start, stop in self
        )

    def moved(self, by: int) -> Spans:
        """Return the ranges so many frames later, or earlier."""
        return Spans((start + by, stop + by) for start, stop in self)

    def without(self, others: Spans, shortest: int = 1) -> Spans:
        """Return what others leave of the ranges, pieces of so many frames or more."""
        kept = np.zeros(self[-1][1] if self else 0, bool)
        kept[self.frames] = True
        for part in others.slices():
            kept[part] = False
        pieces = Spans.of_mask(kept)
        return Spans(piece for piece in pieces if piece[1] - piece[0] >= shortest)

    @property
    def joined(self) -> Spans:
        """The ranges of `frames` that hold each range: the same lengths, end to end."""
        return Spans.end_to_end(self.lengths)

    def slices(self) -> Iterator[slice]:
        """Iterate over the ranges as slices."""
        return (slice(start, stop) for start, stop in self)

    def __str__(self) -> str:
        return ", ".join(f"{start}-{stop}" for start, stop in self)


def _pair(span: Any) -> Span:
    try:
        start, stop = (index(end) for end in span)
    except (TypeError, ValueError):
        raise ValueError(f"expected a range of frames (start, stop), found {span!r}") from None
    if not 0 <= start <= stop:
        raise ValueError(f"expected a range of frames from 0 on, found {start} to {stop}")
    return start, stop


def closed_spans(mask: Mask) -> list[Span]:
    """List the ranges in which a mask (F,) of one period is true, each once.

    A range that goes on across the seam is listed where it begins, and its stop lies beyond F.
    """
    if mask.all():
        return [(0, len(mask))]
    # What is true at the first frame began before it, unless the last is not.
    first = 1 if mask[-1] else 0
    return [(a, b) for a, b in Spans.of_mask(np.tile(mask, 2)) if first <= a < len(mask)]
