"""One entry for all methods: a motion in, a `Segmentation` out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from roundelay.base.checks import expected
from roundelay.base.errors import TooShort
from roundelay.base.spans import Spans
from roundelay.base.threads import one_thread
from roundelay.motion.motion import Motion
from roundelay.motion.poses import leading_rest_pose
from roundelay.segmentation.behaviours import BehaviourOptions
from roundelay.segmentation.features import joint_quaternions
from roundelay.segmentation.gmm import GMMOptions
from roundelay.segmentation.method import Channels, Cuts, SegmentationMethod
from roundelay.segmentation.methods import segmentation_methods
from roundelay.segmentation.pca import PCAOptions
from roundelay.segmentation.ppca import PPCAOptions
from roundelay.segmentation.result import Segment, Segmentation
from roundelay.segmentation.thresholds import MODEL
from roundelay.segmentation.tree import CutTree

__all__ = ["checked_method", "method_names", "segment", "segment_channels", "segmented"]

# Names for options of a method: all choices of [B] itself.
_PAPER: dict[str, Any] = {
    "pca-paper": PCAOptions.paper(),
    "ppca-paper": PPCAOptions.paper(),
    "gmm-paper": GMMOptions.paper(),
}


@one_thread
def segment(
    motion: Motion,
    *,
    method: str | Any = "behaviours",
    sensitivity: float = 1.0,
    n_segments: int | None = None,
    joints: Iterable[str] | None = None,
    rng: int | np.random.Generator | None = None,
    repeating: Iterable[Spans] = (),
) -> Segmentation:
    """Cut a capture into behaviours, and name those that come back alike.

    `roundelay.segment` does the same, and knows what repeats in the capture.

    Parameters
    ----------
    motion : Motion
    method : str or options
        ``behaviours`` (the default, needs nothing); ``gaussian``, what it proposes by itself;
        ``pca``, ``ppca`` or ``gmm`` of [B]; ``pca-paper``, ``ppca-paper`` and ``gmm-paper`` with
        all of the paper's own choices; one that a plug-in brings; or a method's options, such as
        ``PPCAOptions(threshold=2.5)``.
    sensitivity : float
        2 finds finer behaviours, .5 coarser ones (``behaviours`` only).
    n_segments : int, optional
        Make exactly this many segments (``behaviours`` only).
    joints : iterable of str, optional
        Joints to look at; by default those that correspond to [B]'s fourteen.
    rng : int or numpy.random.Generator, optional
        For ``gmm``; seeded with 0 by default.
    repeating : iterable of Spans
        Frames in which something is known to repeat; see `Channels`.

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
    values = joint_quaternions(expected(Motion, motion), joints)
    if leading_rest_pose(values):
        values[0] = values[1]
    chosen, options = _chosen(method, sensitivity, n_segments)
    # A quaternion moves half as far as its rotation turns.
    channels = Channels(values, motion.fps, 2.0, MODEL.resolution, np.random.default_rng(rng or 0))
    channels = replace(channels, repeating=tuple(repeating))
    return replace(segmented(channels, chosen, options), source=motion.name)


@one_thread
def segment_channels(
    values: ArrayLike,
    fps: float,
    *,
    method: str | Any = "behaviours",
    sensitivity: float = 1.0,
    n_segments: int | None = None,
    rng: int | np.random.Generator | None = None,
) -> Segmentation:
    """Cut bare channels (n, d) of any unit into behaviours; see `segment`.

    Raises
    ------
    TooShort, ValueError
        As `segment` does; ValueError also for values that are not finite or no channels.
    """
    points = np.asarray(values, float)
    if points.ndim != 2 or points.shape[1] == 0 or not np.all(np.isfinite(points)):
        raise ValueError(f"expected finite values (n, d), found shape {points.shape}")
    if not (np.isfinite(fps) and fps > 0.0):
        raise ValueError(f"expected a positive frame rate, found {fps}")
    chosen, options = _chosen(method, sensitivity, n_segments)
    channels = Channels(points, fps, rng=np.random.default_rng(rng or 0))
    return segmented(channels, chosen, options)


def method_names() -> tuple[str, ...]:
    """Return the names that `segment` takes."""
    return (*segmentation_methods.names(), *_PAPER)


def checked_method(name: str) -> str:
    """Return a name that `segment` takes.

    Raises
    ------
    ValueError
        If there is no method of that name; the message lists those that are known.
    """
    # Plug-ins are not looked for where one of ours has the name.
    if name not in _PAPER and all(name != method.name for method in segmentation_methods):
        names = method_names()
        raise ValueError(f"expected a segmentation method among {names}, found {name!r}")
    return name


def _chosen(
    method: Any, sensitivity: float, n_segments: int | None
) -> tuple[SegmentationMethod, Any]:
    """Return the method of a name or of options, and its options."""
    if method == "behaviours":
        options = BehaviourOptions(sensitivity=sensitivity, n_segments=n_segments)
        return segmentation_methods["behaviours"], options
    if sensitivity != 1.0 or n_segments is not None:
        raise ValueError("expected sensitivity and n_segments with the method 'behaviours' only")
    if isinstance(method, str) and checked_method(method) not in _PAPER:
        named = segmentation_methods[method]
        return named, named.options
    options = _PAPER[method] if isinstance(method, str) else method
    return _method_of(options), options


def _method_of(options: object) -> SegmentationMethod:
    """Return the first method that has options of this type."""
    for method in segmentation_methods:
        if type(method.options) is type(options):
            return method
    raise ValueError(f"expected a method's name or options, found {options!r}")


def segmented(channels: Channels, method: SegmentationMethod, options: Any) -> Segmentation:
    """Cut channels by a method.

    Raises
    ------
    TooShort
        If there is no frame, or fewer than the method looks at.
    """
    if len(channels.values) == 0:
        raise TooShort("expected at least one frame, found none")
    found = method.find(channels, options)
    labels, held = found.labels, found.held
    if labels is None or held is None:
        told = _described(channels, found)
        labels, held = labels or told[0], held or told[1]
    segments = _segments(found, labels, held, len(channels.values))
    return Segmentation(segments, method.name, options, 1.0 / channels.fps, found.curve)


def _described(channels: Channels, found: Cuts) -> tuple[list[int], list[bool]]:
    """Tell of segments what the default method does: labels, and which are held."""
    tree = CutTree.of(channels, shortest=0.0)
    places = [min(cut // tree.model.step, len(tree.model) - 1) for cut in found.frames]
    return tree.described(places)


def _segments(
    found: Cuts, labels: Sequence[int], held: Sequence[bool], frames: int
) -> tuple[Segment, ...]:
    bounds = [0, *found.frames, frames]
    clear = [np.inf, *found.strengths, np.inf]
    scores = [float(s) if np.isfinite(s) else None for s in np.minimum(clear[:-1], clear[1:])]
    return tuple(
        Segment(start, stop, label, score, held=still)
        for start, stop, label, score, still in zip(
            bounds[:-1], bounds[1:], labels, scores, held, strict=True
        )
    )
