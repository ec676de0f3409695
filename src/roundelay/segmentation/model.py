"""The likelihood of stretches of a capture, each a Gaussian cloud of poses ([B] 3.2).

What a user would otherwise have to set is measured here: the rate of the frames that carry
information, the axes and the number of effective dimensions, the time after which poses are
as good as independent.
"""

from __future__ import annotations

from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.errors import TooShort
from roundelay.base.numeric import SMALLEST
from roundelay.segmentation.moments import Moments, normalized, principal_axes
from roundelay.segmentation.thresholds import GAUSSIAN, MODEL

__all__ = ["GaussianModel", "smoothed"]

Array = NDArray[np.float64]


class GaussianModel:
    """The likelihood of stretches of a capture, on thinned frames.

    Parameters
    ----------
    values : (n, d) ndarray
        One point a frame.
    fps : float
        Frames a second.
    resolution : float, optional
        As in `GaussianOptions`; relative to the values by default.

    Raises
    ------
    TooShort
        If there is no frame.
    """

    def __init__(self, values: Array, fps: float, resolution: float | None = None) -> None:
        if len(values) == 0:
            raise TooShort("expected at least one frame, found none")
        self.step = max(1, round(fps / MODEL.rate))
        self.fps = fps / self.step
        thinned = _without_glitches(_thinned(values, self.step))
        variances, axes = principal_axes(thinned)
        total = float(np.sqrt(variances.sum()))
        self.resolution = MODEL.relative * total if resolution is None else resolution
        kept = variances > (MODEL.negligible * self.resolution) ** 2
        moving = (thinned - thinned.mean(axis=0)) @ axes[:, kept]
        self.points = smoothed(moving, MODEL.smoothing * self.fps, ends="edge")
        self.dimension = float(np.sum(variances / (variances + self.resolution**2 + SMALLEST)))
        self.still = not kept.any()

    def __len__(self) -> int:
        return len(self.points)

    @cached_property
    def correlation_time(self) -> float:
        """Frames after which a pose is as good as independent; see `_correlation_time`."""
        return _correlation_time(self.points, max(1, round(MODEL.window * self.fps)))

    @cached_property
    def penalty(self) -> float:
        """Twice the log-likelihood that one cut must gain."""
        return MODEL.evidence * self.correlation_time * self.dimension

    def cost(self, count: Array, covariance: Array) -> Array:
        """Minus twice the log-likelihood, but for constants, of clouds of poses."""
        noise = self.resolution**2 * np.eye(covariance.shape[-1])
        return count * np.linalg.slogdet(covariance + noise)[1]

    def cost_between(self, start: ArrayLike, stop: ArrayLike) -> Array:
        """`cost` of the frames between boundaries."""
        first, last = np.broadcast_arrays(start, stop)
        before, until = self._sums_before(first), self._sums_before(last)
        count = (last - first).astype(float)
        total, products = (b - a for a, b in zip(before, until, strict=True))
        _, _, covariance = normalized(count, total, products)
        return self.cost(count, covariance)

    def _sums_before(self, places: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return sums (..., d) and sums of products (..., d, d) of the frames before places."""
        block, moments = self._block, self._moments
        whole, rest = np.divmod(places, block)
        total, products = moments.sums[whole], moments.products[whole]
        if rest.any():
            within = np.arange(block - 1)
            frames = np.minimum(whole[..., None] * block + within, len(self) - 1)
            points = self.points[frames] * (within < rest[..., None])[..., None]
            total = total + points.sum(axis=-2)
            products = products + np.swapaxes(points, -1, -2) @ points
        return total, products

    @cached_property
    def _block(self) -> int:
        """Frames a sum is kept of: cuts are first sought at its multiples."""
        return max(1, min(round(GAUSSIAN.grid * self.fps), len(self)))

    @cached_property
    def _moments(self) -> Moments:
        return Moments.of(self.points, self._block)

    def evidence(self, start: ArrayLike, cut: ArrayLike, stop: ArrayLike) -> Array:
        """How much a cut between two boundaries gains, over what is asked: 1 is just enough."""
        parts = self.cost_between(start, cut) + self.cost_between(cut, stop)
        return (self.cost_between(start, stop) - parts) / self.penalty


def _thinned(values: Array, step: int) -> Array:
    """Average each `step` frames; what is left over joins the last."""
    blocks = max(1, len(values) // step)
    starts = np.arange(blocks) * step
    counts = np.diff(np.append(starts, len(values)))
    return np.add.reduceat(values, starts, axis=0) / counts[:, None]


def _without_glitches(values: Array) -> Array:
    """Replace each value (n, d) by the median of it and its two neighbours in time."""
    if len(values) < 3:
        return values
    before, here, after = values[:-2], values[1:-1], values[2:]
    low, high = np.minimum(before, after), np.maximum(before, after)
    return np.concatenate([values[:1], np.clip(here, low, high), values[-1:]])


def smoothed(values: Array, deviation: float, *, ends: Literal["edge", "reflect"]) -> Array:
    """Smooth values (n, d) over time with a Gaussian.

    Parameters
    ----------
    values : (n, d) ndarray
    deviation : float
        Standard deviation, in frames.
    ends : str
        What is beyond the ends: the last value, or what lies before it, mirrored.
    """
    reach = int(np.ceil(MODEL.kernel * deviation))
    reach = min(reach, len(values) - 1) if ends == "reflect" else reach
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / deviation) ** 2)
    padded = np.pad(values, ((reach, reach), (0, 0)), mode=ends)
    smooth = np.zeros_like(values)
    for shift, weight in enumerate(weights / weights.sum()):
        smooth += weight * padded[shift : shift + len(values)]
    return smooth


def _correlation_time(points: Array, window: int) -> float:
    """Integrated autocorrelation time, in frames, within windows: 1 + 2 sum rho up to rho = 0."""
    size = min(window, len(points))
    parts = points[: len(points) // size * size].reshape(-1, size, points.shape[1])
    spectrum = np.abs(np.fft.rfft(parts - parts.mean(axis=1, keepdims=True), 2 * size, axis=1)) ** 2
    correlation = np.fft.irfft(spectrum.sum(axis=(0, 2)))[:size]
    if correlation[0] <= 0.0:
        return 1.0
    negative = np.flatnonzero(correlation < 0.0)
    until = negative[0] if len(negative) else size
    return float(1.0 + 2.0 * correlation[1:until].sum() / correlation[0])
