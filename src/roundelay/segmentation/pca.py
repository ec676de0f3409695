"""Segmentation by intrinsic dimension: [B] 3.1, online."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.numeric import TINY
from roundelay.base.options import Checked, option
from roundelay.base.threads import one_thread
from roundelay.segmentation.thresholds import PCA

__all__ = ["OnlinePCA", "PCAOptions", "intrinsic_dimension"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PCAOptions(Checked):
    """Parameters of the PCA method; the defaults are those of [B] 3.1 at 120 frames a second.

    [B] tells of growth that "rises sharply", and of a test "more than 3 standard deviations from
    the average": the default asks for the first, `paper` for the second.

    Parameters
    ----------
    energy : float
        Share of the variance the hyperplane keeps (tau, eq. 6).
    window : float
        Seconds from which the dimension is taken (k = 240 frames).
    lag : float
        Seconds over which the error's growth is measured (l = 60 frames).
    deviations : float
        Standard deviations above the average growth that make a cut (k_sigma).
    start : float
        Seconds after a cut before the next can be (i_0 = 300 frames).
    two_sided : bool
        Growth as far below the average makes a cut, too.
    """

    title: ClassVar[str] = "Cuts by intrinsic dimension (pca)"

    energy: float = option(
        0.9,
        "Share of the variance that the hyperplane keeps.",
        above=0,
        below=1,
        flag="pca-energy",
    )
    window: float = option(
        2.0, "Time the dimension is taken from.", unit="seconds", above=0, flag="pca-window"
    )
    lag: float = option(
        0.5,
        "Time over which the growth of the error is measured.",
        unit="seconds",
        above=0,
        flag="pca-lag",
    )
    deviations: float = option(
        3.0,
        "Standard deviations above the mean growth that make a cut.",
        above=0,
        flag="pca-deviations",
    )
    start: float = option(
        2.5,
        "Time after a cut before there can be another.",
        unit="seconds",
        above=0,
        flag="pca-start",
    )
    two_sided: bool = option(
        False, "Growth as far below the mean makes a cut, too.", flag="pca-two-sided"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.lag < self.window <= self.start:
            raise ValueError(f"expected lag < window <= start, found {self}")

    @classmethod
    def paper(cls) -> PCAOptions:
        """Return the parameters of [B] 3.1, its test word for word."""
        return cls(two_sided=True)


def intrinsic_dimension(variances: Array, energy: float) -> int:
    """Return the smallest r whose first r variances hold more than `energy` ([B] eq. 6).

    Parameters
    ----------
    variances : (d,) ndarray
        Squared singular values, largest first.
    energy : float
    """
    total = np.cumsum(variances)
    if len(total) == 0 or total[-1] <= 0.0:
        return 1
    return min(int(np.searchsorted(total / total[-1], energy, side="right")) + 1, len(variances))


class OnlinePCA:
    """Cut a motion while it arrives, where the projection error begins to grow fast.

    Parameters
    ----------
    fps : float
        Frames a second.
    options : PCAOptions, optional

    Attributes
    ----------
    cuts : list of int
        Frames at which cuts were made.
    growth : list of (int, float, float)
        Frame, derivative d_i of the error, and the threshold it is held against, for every
        frame from i_0 on: figure 1.
    strengths : list of float
        For each cut, d_i's distance from the average over what was asked.
    """

    def __init__(self, fps: float, options: PCAOptions | None = None) -> None:
        self.options = options or PCAOptions()
        seconds = (self.options.window, self.options.lag, self.options.start)
        self._window, self._lag, self._start = (max(1, round(s * fps)) for s in seconds)
        self._frame = 0
        self._basis: Array | None = None
        self.cuts: list[int] = []
        self.growth: list[tuple[int, float, float]] = []
        self.strengths: list[float] = []
        self._restart()

    @one_thread
    def push(self, frames: ArrayLike) -> list[int]:
        """Take one frame (d,) or several (n, d); return the cuts they led to."""
        known = len(self.cuts)
        for frame in np.atleast_2d(np.asarray(frames, float)):
            self._take(frame)
        return self.cuts[known:]

    def _restart(self) -> None:
        """Forget the segment before."""
        dimensions = 0 if self._basis is None else len(self._basis)
        self._sum, self._scatter = np.zeros(dimensions), np.zeros((dimensions, dimensions))
        self._seen, self._rank = 0, 0
        self._spectra: deque[Array] = deque(maxlen=self._lag + 1)
        self._measured, self._average, self._squares = 0, 0.0, 0.0

    def _take(self, frame: Array) -> None:
        point = self._coordinates(frame)
        self._include(point)
        if self._seen >= self._window and self._is_cut():
            self.cuts.append(self._frame)
            self._restart()
            self._include(point)
        self._frame += 1

    def _include(self, point: Array) -> None:
        self._sum += point
        self._scatter += np.outer(point, point)
        self._seen += 1
        if self._seen >= self._window - self._lag:
            mean = self._sum / self._seen
            scatter = self._scatter - self._seen * np.outer(mean, mean)
            self._spectra.append(np.asarray(np.linalg.eigvalsh(scatter), float))
        if self._seen == self._window:
            self._rank = intrinsic_dimension(self._spectra[-1][::-1], self.options.energy)

    def _is_cut(self) -> bool:
        """Hold the derivative d_i against all earlier ones of this segment, from d_k on."""
        now, before = self._spectra[-1], self._spectra[0]
        # Eq. 5: the squared singular values but the r largest.
        derivative = float(now[: -self._rank].sum() - before[: -self._rank].sum())
        excess = derivative - self._average
        needed = self.options.deviations * np.sqrt(self._squares / max(self._measured, 1))
        self._measured += 1
        self._average += excess / self._measured
        self._squares += excess * (derivative - self._average)
        if self._seen <= self._start:
            return False
        self.growth.append((self._frame, derivative, derivative - excess + needed))
        least = max(float(needed), TINY * self._scale)
        away = abs(excess) if self.options.two_sided else excess
        if away > least:
            self.strengths.append(away / least)
        return away > least

    def _coordinates(self, frame: Array) -> Array:
        """Express a frame in an orthonormal basis of the span so far, which grows if it must.

        Coordinates that never vary independently (8 of the 56 of [B]'s body) then cost nothing.
        """
        if self._basis is None:
            self._origin, self._basis = frame.copy(), np.zeros((0, len(frame)))
        offset = frame - self._origin
        point = self._basis @ offset
        rest = offset - point @ self._basis
        length = float(np.sqrt(rest @ rest))
        if length <= PCA.span * self._scale or len(self._basis) == len(frame):
            return point
        rest -= (self._basis @ rest) @ self._basis
        self._basis = np.vstack([self._basis, rest / np.linalg.norm(rest)])
        self._sum = np.append(self._sum, 0.0)
        self._scatter = np.pad(self._scatter, (0, 1))
        return self._basis @ offset

    @property
    def _scale(self) -> float:
        return 1.0 + float(self._origin @ self._origin)
