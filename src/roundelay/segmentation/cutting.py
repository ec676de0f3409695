"""One entry for all methods: a motion in, a `Segmentation` out."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.errors import TooShort
from roundelay.motion.motion import Motion
from roundelay.motion.poses import leading_rest_pose
from roundelay.segmentation.features import joint_quaternions
from roundelay.segmentation.gaussian import (
    GaussianOptions,
    cut_evidence,
    evidence_curve,
    gaussian_cuts,
)
from roundelay.segmentation.gmm import GMMOptions, gmm_labels
from roundelay.segmentation.model import GaussianModel
from roundelay.segmentation.pca import OnlinePCA, PCAOptions
from roundelay.segmentation.ppca import PPCAOptions, ppca_cuts
from roundelay.segmentation.result import Curve, Segment, Segmentation

__all__ = ["Method", "segment", "segment_channels"]

Array = NDArray[np.float64]
Method = Literal["gaussian", "pca", "ppca", "gmm", "ppca-paper", "gmm-paper"]
Options = GaussianOptions | PCAOptions | PPCAOptions | GMMOptions

# Differences between poses below this many radians do not make behaviours.
_RESOLUTION = 0.15
_DEFAULTS: dict[str, Options] = {
    "gaussian": GaussianOptions(),
    "pca": PCAOptions(),
    "ppca": PPCAOptions(),
    "gmm": GMMOptions(),
    "ppca-paper": PPCAOptions.paper(),
    "gmm-paper": GMMOptions.paper(),
}


def segment(
    motion: Motion,
    *,
    method: Method | Options = "gaussian",
    sensitivity: float = 1.0,
    n_segments: int | None = None,
    joints: Iterable[str] | None = None,
    rng: np.random.Generator | None = None,
) -> Segmentation:
    """Cut a capture into behaviours, and name those that come back alike.

    Parameters
    ----------
    motion : Motion
    method : str or options
        ``gaussian`` (the default, needs nothing), ``pca``, ``ppca`` or ``gmm`` of [B];
        ``ppca-paper`` and ``gmm-paper`` with all of the paper's own choices (those of ``pca``
        are the paper's); or a method's options, such as ``PPCAOptions(threshold=2.5)``.
    sensitivity : float
        2 finds finer behaviours, .5 coarser ones (``gaussian`` only).
    n_segments : int, optional
        Make exactly this many segments (``gaussian`` only).
    joints : iterable of str, optional
        Joints to look at; by default those that correspond to [B]'s fourteen.
    rng : numpy.random.Generator, optional
        For ``gmm``; seeded with 0 by default.

    Returns
    -------
    Segmentation

    Raises
    ------
    SkeletonMismatch
        If a joint is missing; the message names it.
    TooShort
        If a method of [B] gets fewer frames than it looks at. The default method takes a
        capture under two seconds for one behaviour.
    ValueError
        If an option is out of range, or ``n_segments`` cannot be met.
    """
    values = joint_quaternions(motion, joints)
    if leading_rest_pose(values):
        values[0] = values[1]
    options = _options(method, sensitivity, n_segments)
    # A quaternion moves half as far as its rotation turns.
    model = GaussianModel(2.0 * values, motion.fps, _resolution(options) or _RESOLUTION)
    return replace(_segment(values, motion.fps, options, model, rng), source=motion.name)


def segment_channels(
    values: ArrayLike,
    fps: float,
    *,
    method: Method | Options = "gaussian",
    sensitivity: float = 1.0,
    n_segments: int | None = None,
    rng: np.random.Generator | None = None,
) -> Segmentation:
    """Cut bare channels (n, d) of any unit into behaviours; see `segment`.

    Raises
    ------
    TooShort, ValueError
        As `segment` does; ValueError also for values that are not finite or no channels.
    """
    channels = np.asarray(values, float)
    if channels.ndim != 2 or channels.shape[1] == 0 or not np.all(np.isfinite(channels)):
        raise ValueError(f"expected finite values (n, d), found shape {channels.shape}")
    if not (np.isfinite(fps) and fps > 0.0):
        raise ValueError(f"expected a positive frame rate, found {fps}")
    options = _options(method, sensitivity, n_segments)
    return _segment(channels, fps, options, GaussianModel(channels, fps, _resolution(options)), rng)


def _resolution(options: Options) -> float | None:
    return options.resolution if isinstance(options, GaussianOptions) else None


def _options(method: Method | Options, sensitivity: float, n_segments: int | None) -> Options:
    if method == "gaussian":
        return GaussianOptions(sensitivity=sensitivity, n_segments=n_segments)
    if sensitivity != 1.0 or n_segments is not None:
        raise ValueError("expected sensitivity and n_segments with the method 'gaussian' only")
    if not isinstance(method, str):
        return method
    if method not in _DEFAULTS:
        raise ValueError(f"expected a method among {get_args(Method)}, found {method!r}")
    return _DEFAULTS[method]


@dataclass(frozen=True, eq=False)
class _Found:
    """Cuts in frames, how clear each is, and the method's curve; labels if it gives them."""

    cuts: list[int]
    strengths: list[float]
    curve: Curve
    labels: list[int] | None = None


def _segment(
    values: Array,
    fps: float,
    options: Options,
    model: GaussianModel,
    rng: np.random.Generator | None,
) -> Segmentation:
    name, found = _find(values, fps, options, model, rng)
    labels = found.labels
    if labels is None:
        labels = model.labels([min(cut // model.step, len(model) - 1) for cut in found.cuts])
    segments = _segments(found, labels, len(values))
    return Segmentation(segments, name, options, 1.0 / fps, found.curve)


def _find(
    values: Array,
    fps: float,
    options: Options,
    model: GaussianModel,
    rng: np.random.Generator | None,
) -> tuple[str, _Found]:
    if isinstance(options, GaussianOptions):
        return "gaussian", _find_gaussian(model, options)
    if isinstance(options, PCAOptions):
        return "pca", _find_pca(values, fps, options)
    if isinstance(options, PPCAOptions):
        return "ppca", _find_ppca(values, fps, options)
    return "gmm", _find_gmm(values, fps, options, rng or np.random.default_rng(0))


def _find_gaussian(model: GaussianModel, options: GaussianOptions) -> _Found:
    cuts = gaussian_cuts(model, options)
    labels = model.labels(cuts)
    if options.n_segments is None:
        # Neighbours that turned out to be one behaviour, together with others of its kind.
        kept = [i for i in range(len(cuts)) if labels[i] != labels[i + 1]]
        cuts, labels = [cuts[i] for i in kept], [labels[i] for i in [*kept, len(labels) - 1]]
    strengths = cut_evidence(model, cuts) * options.sensitivity
    places, values = evidence_curve(model, cuts)
    meaning = "evidence for a cut (1 is enough)"
    curve = Curve(places * float(model.step), values * options.sensitivity, meaning)
    return _Found([cut * model.step for cut in cuts], strengths.tolist(), curve, labels)


def _find_pca(values: Array, fps: float, options: PCAOptions) -> _Found:
    if len(values) <= round(options.start * fps):
        raise TooShort(
            f"expected more than {round(options.start * fps)} frames, found {len(values)}"
        )
    online = OnlinePCA(fps, options)
    online.push(values)
    rows = np.array(online.growth, float).reshape(-1, 3)
    curve = Curve(rows[:, 0], rows[:, 1], "growth of the projection error, d_i")
    return _Found(online.cuts, online.strengths, curve)


def _find_ppca(values: Array, fps: float, options: PPCAOptions) -> _Found:
    cuts, strengths, watched = ppca_cuts(values, fps, options)
    rows = np.array(watched, float).reshape(-1, 2)
    curve = Curve(rows[:, 0], rows[:, 1], "Mahalanobis distance of the coming frames, H")
    return _Found(cuts, strengths, curve)


def _find_gmm(values: Array, fps: float, options: GMMOptions, rng: np.random.Generator) -> _Found:
    clusters, certainty = gmm_labels(values, fps, options, rng)
    cuts = (np.flatnonzero(np.diff(clusters)) + 1).tolist()
    bounds = [0, *cuts, len(values)]
    number: dict[int, int] = {}
    labels = [number.setdefault(int(clusters[start]), len(number)) for start in bounds[:-1]]
    sure = np.add.reduceat(certainty, bounds[:-1]) / np.diff(bounds)
    strengths = np.minimum(sure[1:], sure[:-1]).tolist()
    frames = np.arange(len(values), dtype=float)
    return _Found(cuts, strengths, Curve(frames, certainty, "certainty of the cluster"), labels)


def _segments(found: _Found, labels: list[int], frames: int) -> tuple[Segment, ...]:
    bounds = [0, *found.cuts, frames]
    clear = [np.inf, *found.strengths, np.inf]
    return tuple(
        Segment(start, stop, label, float(score) if np.isfinite(score) else None)
        for start, stop, label, score in zip(
            bounds[:-1], bounds[1:], labels, np.minimum(clear[:-1], clear[1:]), strict=True
        )
    )
