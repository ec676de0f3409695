"""Segmentation by the distance of the coming frames from the past ones: [B] 3.2.

A Gaussian of probabilistic PCA is fitted to the first K frames of a segment; the Mahalanobis
distance H of the T frames after them falls while the model learns a behaviour, rises when
another one enters the window, and falls again when the model takes it in. Valley and peak make
a cut.

H is the root of eq. 10 (the diagonal of figure 6 is 7, the root of 56 rounded down), or eq. 10 as
it is printed. Where [B] is silent: a valley must come after a descent; a peak is over when H has
come down from it by a tenth of its rise over the valley.

[B] makes passes to and fro until one brings no new cut. Here each later pass runs inside of the
segments so far. The default makes two passes over the whole capture instead, one to and one fro; a
cut of the second is new if it is farther than T from every one of the first.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from itertools import pairwise
from math import sqrt
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.errors import RoundelayWarning, TooShort
from roundelay.base.numeric import SMALLEST
from roundelay.base.options import Checked, option
from roundelay.base.threads import one_thread
from roundelay.segmentation.pca import intrinsic_dimension
from roundelay.segmentation.thresholds import PPCA

__all__ = ["OnlinePPCA", "PPCAModel", "PPCAOptions", "ppca_cuts"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PPCAOptions(Checked):
    """Parameters of the probabilistic PCA method.

    Parameters
    ----------
    rule : {"ratio", "difference"}
        Whether the peak must be `threshold` times the valley, or that much above it. The ratio
        does not depend on the number of joints; the difference is [B]'s.
    threshold : float
        3 for the ratio, 15 for the difference (R).
    energy : float
        Share of the variance inside the hyperplane (tau).
    window : float
        Seconds looked ahead, and seconds of the first model (T = 150 frames).
    step : float
        Seconds by which the model grows (Delta = 10 frames).
    middle : bool
        Put a cut that both passes find halfway between; [B] keeps the forward one.
    squared : bool
        H is eq. 10 as it is printed, a mean of squares, instead of its root.
    converge : bool
        Make passes to and fro until none brings a new cut ([B]), instead of two. No cut is then
        found twice, so that `middle` says nothing.
    """

    title: ClassVar[str] = "Cuts by the coming frames (ppca)"

    rule: Literal["ratio", "difference"] = option(
        "ratio",
        "Hold the peak over the valley against the threshold, or the peak less the valley.",
        flag="ppca-rule",
    )
    threshold: float = option(
        3.0, "How far a peak must be above its valley.", above=0, flag="ppca-threshold"
    )
    energy: float = option(
        0.95,
        "Share of the variance that the hyperplane keeps.",
        above=0,
        below=1,
        flag="ppca-energy",
    )
    window: float = option(
        1.25,
        "Time looked ahead, and that of the first model.",
        unit="seconds",
        above=0,
        flag="ppca-window",
    )
    step: float = option(
        10 / 120, "Time by which the model grows.", unit="seconds", above=0, flag="ppca-step"
    )
    middle: bool = option(
        True,
        "Put a cut that both passes find halfway; [B] keeps the forward one.",
        flag="ppca-middle",
    )
    squared: bool = option(
        False,
        "Take the mean squared distance, as [B] eq. 10 is printed, instead of its root.",
        flag="ppca-squared",
    )
    converge: bool = option(
        False,
        "Make passes to and fro until none brings a new cut, as [B], instead of two.",
        flag="ppca-converge",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.step > self.window:
            raise ValueError(f"expected step <= window, found {self}")

    @classmethod
    def paper(cls) -> PPCAOptions:
        """Return the parameters of [B] 3.2."""
        return cls(rule="difference", threshold=PPCA.rise, middle=False, converge=True)

    def frames(self, fps: float) -> tuple[int, int]:
        """Return T and Delta in frames; T is a multiple of Delta."""
        step = max(1, round(self.step * fps))
        return max(2, round(self.window * fps / step)) * step, step

    def rise(self, valley: float, peak: float) -> float:
        """How far a peak is above a valley, over the threshold: 1 makes a cut."""
        if self.rule == "difference":
            return (peak - valley) / self.threshold
        return peak / (valley * self.threshold) if valley > 0.0 else 0.0

    def check_threshold(self, dimension: int) -> None:
        """Warn where a difference does not fit the dimension of the poses.

        Inside of a behaviour H is about the root of the dimension, or as printed the dimension.
        [B]'s R is twice that: 15 for 56 coordinates. It fits from once to four times that.
        """
        usual = dimension if self.squared else sqrt(dimension)
        if self.rule == "difference" and not usual <= self.threshold <= 4 * usual:
            warnings.warn(
                f"a peak {self.threshold:g} above its valley hardly fits {dimension} coordinates, "
                f"whose distance is about {usual:.3g} inside of a behaviour: try a threshold of "
                f"{2 * usual:.3g}, or the rule 'ratio'",
                RoundelayWarning,
                stacklevel=2,
            )


@dataclass(frozen=True, eq=False)
class PPCAModel:
    """A Gaussian of probabilistic PCA ([B] eq. 7-9).

    Parameters
    ----------
    mean : (d,) ndarray
    variances : (d,) ndarray
        Of the principal axes; those outside the hyperplane are all equal.
    axes : (d, d) ndarray
        In columns.
    rank : int
        Dimension of the hyperplane.
    """

    mean: Array
    variances: Array
    axes: Array
    rank: int

    @classmethod
    def of(cls, count: int, total: Array, products: Array, energy: float) -> PPCAModel:
        """Fit to sums over frames: their number, sum (d,) and sum of products (d, d)."""
        mean = total / count
        squares, axes = np.linalg.eigh(products - count * np.outer(mean, mean))
        squares, axes = np.maximum(squares[::-1], 0.0), axes[:, ::-1]
        rank = intrinsic_dimension(squares, energy)
        # Eq. 7 averages over all discarded values, structural zeros too: keep it above rounding.
        floor = PPCA.floor * squares.sum() + PPCA.rounding * np.trace(products) + SMALLEST
        discarded = squares[rank:].mean() if rank < len(squares) else 0.0
        spread = np.append(squares[:rank], np.full(len(squares) - rank, discarded))
        return cls(mean, np.maximum(spread, floor) / max(count - 1, 1), axes, rank)

    def distance(self, count: int, total: Array, products: Array) -> float:
        """Root of the mean squared Mahalanobis distance ([B] eq. 10) of frames given by sums."""
        scatter = products - np.outer(total, self.mean) - np.outer(self.mean, total)
        scatter = scatter / count + np.outer(self.mean, self.mean)
        along = np.einsum("ij,ij->j", self.axes, scatter @ self.axes)
        return float(np.sqrt(max(0.0, np.sum(along / self.variances))))


class OnlinePPCA:
    """The forward pass, while the motion arrives.

    Parameters
    ----------
    fps : float
        Frames a second.
    options : PPCAOptions, optional

    Attributes
    ----------
    cuts : list of int
        Frames at which cuts were made.
    strengths : list of float
        For each cut, the rise from valley to peak over the threshold.
    curve : list of (int, float)
        Frame at the end of the model and H: figure 2.
    window : int
        Frames looked ahead, T.
    """

    def __init__(self, fps: float, options: PPCAOptions | None = None) -> None:
        self.options = options or PPCAOptions()
        self.window, self._step = self.options.frames(fps)
        self._blocks: list[tuple[Array, Array]] = []
        self._waiting: list[Array] = []
        self._start = 0
        self.cuts: list[int] = []
        self.strengths: list[float] = []
        self.curve: list[tuple[int, float]] = []
        self._restart()

    @one_thread
    def push(self, frames: ArrayLike) -> list[int]:
        """Take one frame (d,) or several (n, d); return the cuts they led to."""
        known = len(self.cuts)
        for frame in np.atleast_2d(np.asarray(frames, float)):
            self._waiting.append(frame)
            if len(self._waiting) == self._step:
                self._close_block()
        return self.cuts[known:]

    def _restart(self) -> None:
        self._model_blocks, self._gone = 0, 0
        self._total, self._products = np.zeros(1), np.zeros((1, 1))
        self._latest, self._descended = -np.inf, False
        self._valley, self._peak, self._peak_blocks = np.inf, -np.inf, 0

    def _close_block(self) -> None:
        block = np.array(self._waiting)
        self._waiting.clear()
        self._blocks.append((block.sum(axis=0), block.T @ block))
        ahead = self.window // self._step
        # The first model takes T frames, and T more must be there to look at.
        while self._gone + len(self._blocks) >= max(self._model_blocks + 1, ahead) + ahead:
            self._grow(max(self._model_blocks + 1, ahead), ahead)

    def _grow(self, blocks: int, ahead: int) -> None:
        first, last = self._model_blocks - self._gone, blocks - self._gone
        for total, products in self._blocks[first:last]:
            self._total, self._products = self._total + total, self._products + products
        self._model_blocks = blocks
        count = blocks * self._step
        model = PPCAModel.of(count, self._total, self._products, self.options.energy)
        window = self._blocks[last : last + ahead]
        total = np.sum([part[0] for part in window], axis=0)
        products = np.sum([part[1] for part in window], axis=0)
        distance = model.distance(self.window, total, products)
        if self.options.squared:
            distance = distance**2
        self.curve.append((self._start + count, distance))
        self._watch(distance)

    def _watch(self, distance: float) -> None:
        """Follow H down into its valley and up to its peak; cut once the peak is over."""
        self._descended |= distance < self._latest
        self._latest = distance
        if distance > self._peak:
            self._peak, self._peak_blocks = distance, self._model_blocks
        rise = self.options.rise(self._valley, self._peak) if self._descended else 0.0
        if rise >= 1.0 and self._peak - distance > PPCA.descent * (self._peak - self._valley):
            self._cut(rise)
            return
        if not self._descended or (rise < 1.0 and distance < self._valley):
            self._valley, self._peak = distance, distance
            self._peak_blocks = self._model_blocks
        # What is no peak yet becomes none without a new one, or a new valley.
        self._forget(self._peak_blocks if rise >= 1.0 else self._model_blocks)

    def _forget(self, blocks: int) -> None:
        """Let go of blocks that are in the model, and at which no cut can be made any more."""
        del self._blocks[: blocks - self._gone]
        self._gone = blocks

    def _cut(self, rise: float) -> None:
        self._start += self._peak_blocks * self._step
        self.cuts.append(self._start)
        self.strengths.append(rise)
        self._forget(self._peak_blocks)
        self._restart()


def ppca_cuts(
    values: Array, fps: float, options: PPCAOptions
) -> tuple[list[int], list[float], list[tuple[int, float]]]:
    """Cut with a forward and a backward pass, or with passes to and fro until none is new.

    Parameters
    ----------
    values : (n, d) ndarray
        One point a frame.
    fps : float
        Frames a second.
    options : PPCAOptions

    Returns
    -------
    cuts : list of int
        First frame of every segment but the first.
    strengths : list of float
        For each cut, the rise from valley to peak over the threshold.
    curve : list of (int, float)
        Frame and H of the forward pass.

    Raises
    ------
    TooShort
        If there are fewer frames than two windows.
    """
    window = options.frames(fps)[0]
    if len(values) < 2 * window:
        raise TooShort(f"expected at least two windows, {2 * window} frames, found {len(values)}")
    options.check_threshold(values.shape[1])
    if options.converge:
        return _to_and_fro(values, fps, options)
    forward, backward = OnlinePPCA(fps, options), OnlinePPCA(fps, options)
    forward.push(values)
    backward.push(values[::-1])
    mirrored = [len(values) - cut for cut in backward.cuts]
    return *_united(forward, mirrored, backward.strengths), forward.curve


def _to_and_fro(
    values: Array, fps: float, options: PPCAOptions
) -> tuple[list[int], list[float], list[tuple[int, float]]]:
    """Look into the segments so far, forward and backward in turn, until neither finds a cut.

    A cut is at least a window from the borders of the segment that it parts.
    """
    forward = OnlinePPCA(fps, options)
    forward.push(values)
    found = dict(zip(forward.cuts, forward.strengths, strict=True))
    idle, direction = 0, -1
    while idle < 2:
        new: dict[int, float] = {}
        bounds = [0, *sorted(found), len(values)]
        for start, stop in pairwise(bounds):
            online = OnlinePPCA(fps, options)
            online.push(values[start:stop][::direction])
            places = [start + cut if direction > 0 else stop - cut for cut in online.cuts]
            new |= dict(zip(places, online.strengths, strict=True))
        found |= new
        idle, direction = 0 if new else idle + 1, -direction
    return sorted(found), [found[cut] for cut in sorted(found)], forward.curve


def _united(
    forward: OnlinePPCA, mirrored: list[int], strengths: list[float]
) -> tuple[list[int], list[float]]:
    """Add those cuts of the backward pass that are new, and settle those that are not."""
    window = forward.window
    found: dict[int, float] = {}
    for cut, strength in zip(forward.cuts, forward.strengths, strict=True):
        near = [other for other in mirrored if abs(other - cut) <= window]
        place = (cut + min(near, key=lambda other: abs(other - cut))) // 2 if near else cut
        found[place if forward.options.middle else cut] = strength
    found |= {
        cut: strength
        for cut, strength in zip(mirrored, strengths, strict=True)
        if all(abs(cut - other) > window for other in forward.cuts)
    }
    return sorted(found), [found[cut] for cut in sorted(found)]
