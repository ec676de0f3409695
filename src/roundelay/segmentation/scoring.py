"""How good a segmentation is: cuts against a person's windows, labels against a person's labels.

[B] 4 gives a window for each true cut and counts precision and recall. Here a window takes one
found cut at most (a second one in it is false), and windows can be widened by a tolerance.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.segmentation.partitions import (
    adjusted_rand,
    best_assignment,
    contingency,
    mutual_information,
)
from roundelay.segmentation.result import Segmentation
from roundelay.segmentation.thresholds import SCORING

__all__ = ["TOLERANCES", "Agreement", "Score", "Truth", "pooled", "score"]

TOLERANCES = SCORING.tolerances
"""Seconds by which windows are widened on both sides; 0 is strict."""


@dataclass(frozen=True)
class Truth:
    """Hold a person's segmentation.

    Parameters
    ----------
    segments : tuple of (int, int, str)
        First frame, frame after the last, and behaviour of each segment, without gaps.
    windows : tuple of (int, int)
        Earliest and latest acceptable frame of each cut, in either order.
    frame_time : float
        Seconds from one frame to the next.

    Raises
    ------
    ValueError
        If segments leave gaps or there is not one window a cut.
    """

    segments: tuple[tuple[int, int, str], ...]
    windows: tuple[tuple[int, int], ...]
    frame_time: float

    def __post_init__(self) -> None:
        if not self.segments or self.segments[0][0] != 0:
            raise ValueError("expected segments that begin at frame 0")
        bounds = [(one[1], other[0]) for one, other in pairwise(self.segments)]
        if any(stop != start for stop, start in bounds):
            raise ValueError("expected segments without gaps or overlap")
        if len(self.windows) != len(self.segments) - 1:
            raise ValueError(
                f"expected {len(self.segments) - 1} windows, found {len(self.windows)}"
            )

    @classmethod
    def around(
        cls, segments: Iterable[tuple[int, int, str]], *, frame_time: float, half: float = 50 / 120
    ) -> Truth:
        """Make windows of `half` seconds to each side of the cuts: by default [B]'s usual ones."""
        kept = tuple((int(start), int(stop), str(label)) for start, stop, label in segments)
        reach = round(half / frame_time)
        windows = tuple((start - reach, start + reach) for start, _, _ in kept[1:])
        return cls(kept, windows, frame_time)

    @property
    def labels(self) -> NDArray[np.str_]:
        """The behaviour (F,) of every frame."""
        return np.repeat([s[2] for s in self.segments], [s[1] - s[0] for s in self.segments])


@dataclass(frozen=True)
class Agreement:
    """Count found cuts that fall in windows.

    Parameters
    ----------
    tolerance : float
        Seconds by which the windows were widened.
    hits, found, true : int
        Matched pairs, cuts found, cuts there are.
    """

    tolerance: float
    hits: int
    found: int
    true: int

    @property
    def precision(self) -> float:
        """Share of found cuts that are right; 1 if none was found."""
        return self.hits / self.found if self.found else 1.0

    @property
    def recall(self) -> float:
        """Share of true cuts that were found; 1 if there are none."""
        return self.hits / self.true if self.true else 1.0

    @property
    def f(self) -> float:
        """Harmonic mean of precision and recall; 1 if there was nothing to find nor found."""
        total = self.found + self.true
        return 2.0 * self.hits / total if total else 1.0


@dataclass(frozen=True)
class Score:
    """All measures of one segmentation against one person's.

    Parameters
    ----------
    cuts : tuple of Agreement
        One for each tolerance, strict first.
    covering : float
        Mean over true segments, by length, of the best intersection over union with a found
        segment (Arbelaez et al. 2011), in [0, 1].
    label_accuracy : float
        Share of frames that bear the right label, labels matched one to one as well as can be.
    nmi : float
        Mutual information of the labels over the mean of their entropies, in [0, 1].
    ari : float
        Adjusted Rand index of the labels (Hubert and Arabie 1985), at most 1, 0 by chance.
    """

    cuts: tuple[Agreement, ...]
    covering: float
    label_accuracy: float
    nmi: float
    ari: float

    @property
    def strict(self) -> Agreement:
        """The agreement within the person's own windows."""
        return self.at(0.0)

    def at(self, tolerance: float) -> Agreement:
        """Return the agreement at one of the tolerances.

        Raises
        ------
        ValueError
            If there is none.
        """
        for agreement in self.cuts:
            if agreement.tolerance == tolerance:
                return agreement
        raise ValueError(f"no agreement at {tolerance:g} s")

    def to_dict(self) -> dict[str, Any]:
        """Return all numbers, for JSON."""
        rows = [{**asdict(a), "p": a.precision, "r": a.recall, "f": a.f} for a in self.cuts]
        return {**asdict(self), "cuts": rows}


def score(
    found: Segmentation | Sequence[int],
    truth: Truth,
    *,
    labels: Sequence[int] | None = None,
    tolerances: Iterable[float] = TOLERANCES,
) -> Score:
    """Compare a segmentation with a person's.

    Parameters
    ----------
    found : Segmentation or sequence of int
        The segmentation, or the first frames of all segments but the first.
    truth : Truth
    labels : sequence of int, optional
        Labels of the segments between cuts; the segmentation's own, or all different.
    tolerances : iterable of float
        Seconds by which to widen the windows.

    Returns
    -------
    Score

    Raises
    ------
    ValueError
        If the cuts are not within the capture or the labels are not one more than the cuts.
    """
    cuts = found.cuts if isinstance(found, Segmentation) else tuple(found)
    if labels is None and isinstance(found, Segmentation):
        labels = [segment.label for segment in found.segments]
    frames = len(truth.labels)
    if any(not 0 < cut < frames for cut in cuts) or list(cuts) != sorted(set(cuts)):
        raise ValueError(f"expected rising cuts between frames 0 and {frames}, found {cuts}")
    names = np.arange(len(cuts) + 1) if labels is None else np.asarray(labels)
    if len(names) != len(cuts) + 1:
        raise ValueError(f"expected {len(cuts) + 1} labels, found {len(names)}")
    lengths = np.diff([0, *cuts, frames])
    counts = contingency(np.repeat(names, lengths), truth.labels)
    return Score(
        cuts=tuple(_agreement(cuts, truth, tolerance) for tolerance in tolerances),
        covering=_covering(np.repeat(np.arange(len(lengths)), lengths), truth),
        label_accuracy=best_assignment(counts) / frames,
        nmi=mutual_information(counts),
        ari=adjusted_rand(counts),
    )


def pooled(agreements: Iterable[Agreement]) -> Agreement:
    """Add up agreements of several captures at one tolerance.

    Raises
    ------
    ValueError
        If there are none or their tolerances differ.
    """
    parts = list(agreements)
    if len({part.tolerance for part in parts}) != 1:
        raise ValueError("expected agreements at one tolerance")
    return Agreement(
        parts[0].tolerance,
        hits=sum(part.hits for part in parts),
        found=sum(part.found for part in parts),
        true=sum(part.true for part in parts),
    )


def _agreement(cuts: Sequence[int], truth: Truth, tolerance: float) -> Agreement:
    """Match one to one, as many as can be: by windows' ends, each takes its earliest cut."""
    wider = tolerance / truth.frame_time
    free, hits = sorted(cuts), 0
    for early, late in sorted((sorted(w) for w in truth.windows), key=lambda w: w[1]):
        inside = [cut for cut in free if early - wider <= cut <= late + wider]
        if inside:
            free.remove(inside[0])
            hits += 1
    return Agreement(tolerance, hits, len(cuts), len(truth.windows))


def _covering(found: NDArray[np.intp], truth: Truth) -> float:
    true = np.repeat(np.arange(len(truth.segments)), [b - a for a, b, _ in truth.segments])
    shared = contingency(found, true)
    union = shared.sum(axis=1)[:, None] + shared.sum(axis=0) - shared
    return float(np.max(shared / union, axis=0) @ shared.sum(axis=0) / shared.sum())
