"""Segmentation by clusters of poses: a Gaussian mixture over the whole capture, [B] 3.3.

Where [B] is silent: covariances get 1e-6 of the mean variance on their diagonal; of several
starts the likeliest mixture is kept; short segments go shortest first, halved between their
neighbours, those at the ends to their one neighbour.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import TooShort
from roundelay.base.numeric import ROUNDING, SMALLEST
from roundelay.base.options import Checked, option
from roundelay.segmentation.moments import principal_axes
from roundelay.segmentation.pca import intrinsic_dimension
from roundelay.segmentation.thresholds import GMM

__all__ = ["GMMOptions", "Mixture", "fit_mixture", "gmm_labels", "merge_short"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class GMMOptions(Checked):
    """Parameters of the mixture method; the defaults are those of [B] 3.3 but for the starts.

    Parameters
    ----------
    clusters : int
        Number of behaviours (k).
    most : int, optional
        Try each number of behaviours up to this, and keep that of the least Bayesian information
        criterion, instead of `clusters`. [B] did not find it useful.
    energy : float
        Share of the variance kept by the projection before.
    shortest : float
        Seconds below which a segment is given to its neighbours (120 frames).
    starts : int
        Number of starts.
    guess : {"parts", "frames"}
        What a start begins with: one random frame in each of k parts of the capture, which [B]
        found slightly better, or k random frames.
    iterations : int
        EM steps at most; they end once the log-likelihood per frame gains less than 1e-6.
    """

    title: ClassVar[str] = "Cuts by clusters of poses (gmm)"

    clusters: int = option(4, "Number of behaviours.", least=1, flag="gmm-clusters")
    most: int | None = option(
        None,
        "Try each number of behaviours up to this, and keep the best by BIC.",
        least=1,
        most=64,
        flag="gmm-most",
    )
    energy: float = option(
        0.9, "Share of the variance that is kept.", above=0, below=1, flag="gmm-energy"
    )
    shortest: float = option(
        1.0,
        "A shorter segment goes to its neighbours.",
        unit="seconds",
        least=0,
        flag="gmm-shortest",
    )
    starts: int = option(
        5, "Starts, of which the likeliest mixture is kept.", least=1, flag="gmm-starts"
    )
    guess: Literal["parts", "frames"] = option(
        "parts",
        "Start from a random frame of each of as many parts, or from random frames of all.",
        flag="gmm-guess",
    )
    iterations: int = option(200, "Steps of a start.", least=1, flag="gmm-iterations")

    @classmethod
    def paper(cls) -> GMMOptions:
        """Return the parameters of [B] 3.3: one start, from random frames."""
        return cls(starts=1, guess="frames")


@dataclass(frozen=True, eq=False)
class Mixture:
    """A Gaussian mixture.

    Parameters
    ----------
    weights : (k,) ndarray
    means : (k, d) ndarray
    covariances : (k, d, d) ndarray
    likelihood : float
        Mean log-likelihood of the frames it was fitted to.
    """

    weights: Array
    means: Array
    covariances: Array
    likelihood: float = -np.inf

    def log_densities(self, values: Array) -> Array:
        """Return log(weight times density) (n, k) of values (n, d)."""
        columns = []
        for weight, mean, covariance in zip(
            self.weights, self.means, self.covariances, strict=True
        ):
            root = np.linalg.cholesky(covariance)
            white = np.linalg.solve(root, (values - mean).T)
            scale = np.log(2.0 * np.pi) * len(mean) + 2.0 * np.log(np.diagonal(root)).sum()
            columns.append(np.log(weight + SMALLEST) - 0.5 * (scale + np.sum(white**2, axis=0)))
        return np.stack(columns, axis=1)

    def criterion(self, frames: int) -> float:
        """Return the Bayesian information criterion of a fit to so many frames; least is best."""
        clusters, d = self.means.shape
        free = clusters - 1 + clusters * d + clusters * d * (d + 1) // 2
        return free * float(np.log(frames)) - 2.0 * frames * self.likelihood


def fit_mixture(values: Array, options: GMMOptions, rng: np.random.Generator) -> Mixture:
    """Fit a mixture to frames (n, d) by expectation maximisation, from several starts."""
    if options.most is None:
        return _fitted(values, options.clusters, options, rng)
    counts = range(1, min(options.most, len(values)) + 1)
    mixtures = (_fitted(values, count, options, rng) for count in counts)
    return min(mixtures, key=lambda mixture: mixture.criterion(len(values)))


def _fitted(values: Array, count: int, options: GMMOptions, rng: np.random.Generator) -> Mixture:
    trials = (_fit_once(values, count, options, rng) for _ in range(options.starts))
    return max(trials, key=lambda mixture: mixture.likelihood)


def gmm_labels(
    values: Array, fps: float, options: GMMOptions, rng: np.random.Generator
) -> tuple[NDArray[np.intp], Array]:
    """Label every frame by its likeliest cluster, short segments merged.

    Parameters
    ----------
    values : (n, d) ndarray
        One point a frame.
    fps : float
        Frames a second.
    options : GMMOptions
    rng : numpy.random.Generator
        Chooses the frames EM starts from.

    Returns
    -------
    labels : (n,) ndarray of int
    certainty : (n,) ndarray
        Posterior probability of the frame's own label, before merging.

    Raises
    ------
    TooShort
        If there are fewer frames than clusters, or than two of the shortest segment.
    """
    least = max(options.clusters, round(2 * options.shortest * fps))
    if len(values) < least:
        raise TooShort(f"expected at least {least} frames, found {len(values)}")
    variances, axes = principal_axes(values)
    if variances[0] <= GMM.still:
        return np.zeros(len(values), dtype=np.intp), np.ones(len(values))
    kept = axes[:, : intrinsic_dimension(variances, options.energy)]
    points = (values - values.mean(axis=0)) @ kept
    shares, _ = _responsibilities(fit_mixture(points, options, rng).log_densities(points))
    labels = np.argmax(shares, axis=1)
    return merge_short(labels, round(options.shortest * fps)), shares.max(axis=1)


def merge_short(labels: NDArray[np.intp], least: int) -> NDArray[np.intp]:
    """Give runs shorter than `least` frames to their neighbours, half each, shortest first."""
    merged = labels.copy()
    while True:
        bounds = np.flatnonzero(np.diff(merged)) + 1
        starts, stops = np.append(0, bounds), np.append(bounds, len(merged))
        shortest = int(np.argmin(stops - starts))
        start, stop = starts[shortest], stops[shortest]
        if len(bounds) == 0 or stop - start >= least:
            return merged
        before = merged[start - 1] if start > 0 else merged[stop]
        after = merged[stop] if stop < len(merged) else before
        middle = (start + stop) // 2
        merged[start:middle], merged[middle:stop] = before, after


def _fit_once(values: Array, count: int, options: GMMOptions, rng: np.random.Generator) -> Mixture:
    mixture = _first_guess(values, count, options.guess, rng)
    for _ in range(options.iterations):
        shares, likelihood = _responsibilities(mixture.log_densities(values))
        gained = likelihood - mixture.likelihood
        mixture = _maximised(values, shares, likelihood)
        if gained < GMM.gain:
            break
    return mixture


def _first_guess(values: Array, clusters: int, guess: str, rng: np.random.Generator) -> Mixture:
    """Take random frames as means, of all or one of each of k consecutive parts ([B] 3.3)."""
    if guess == "frames":
        chosen = rng.choice(len(values), clusters, replace=False).tolist()
    else:
        parts = np.array_split(np.arange(len(values)), clusters)
        chosen = [int(rng.choice(part)) for part in parts]
    means = values[chosen]
    covariance = np.atleast_2d(np.cov(values.T, bias=True))
    covariance = covariance + _floor(covariance)
    weights = np.full(clusters, 1.0 / clusters)
    return Mixture(weights, means, np.repeat(covariance[None], clusters, axis=0))


def _responsibilities(densities: Array) -> tuple[Array, float]:
    """Return posterior shares (n, k) and the mean log-likelihood."""
    top = densities.max(axis=1, keepdims=True)
    shares = np.exp(densities - top)
    total = shares.sum(axis=1, keepdims=True)
    return shares / total, float(np.mean(top + np.log(total)))


def _maximised(values: Array, shares: Array, likelihood: float) -> Mixture:
    mass = shares.sum(axis=0) + ROUNDING
    means = (shares.T @ values) / mass[:, None]
    covariances = []
    for share, weight, mean in zip(shares.T, mass, means, strict=True):
        centred = values - mean
        covariances.append((centred * (share / weight)[:, None]).T @ centred)
    spread = np.array(covariances) + _floor(np.cov(values.T, bias=True))
    return Mixture(mass / mass.sum(), means, spread, likelihood)


def _floor(covariance: Array) -> Array:
    square = np.atleast_2d(covariance)
    return (GMM.floor * np.trace(square) / len(square) + SMALLEST) * np.eye(len(square))
