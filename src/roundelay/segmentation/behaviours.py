"""The default method: a cut stands where what explains the frames changes.

Its cuts are sections of one tree, see `roundelay.segmentation.tree`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from roundelay.segmentation.gaussian import GaussianOptions
from roundelay.segmentation.method import Channels, Cuts
from roundelay.segmentation.result import Curve
from roundelay.segmentation.tree import CutTree

__all__ = ["BehaviourOptions", "Behaviours"]


@dataclass(frozen=True)
class BehaviourOptions(GaussianOptions):
    """Choices of the default method; none needs to be made.

    Parameters
    ----------
    sensitivity : float
        Multiplies the odds of every cut: 2 keeps cuts whose odds are 1 to 2, 0.5 only those of
        2 to 1. A larger one keeps every cut of a smaller one.
    n_segments : int, optional
        Keep the most probable cuts, so many that there are this many segments.
    resolution : float, optional
        Standard deviation that is too small to matter: in radians for motions, by default .15;
        for bare channels in their unit, by default .15 of the total standard deviation.
    shortest : float
        Seconds a behaviour lasts at least.

    Raises
    ------
    ValueError
        If an option is out of range, or both a sensitivity and a number are given.
    """

    title: ClassVar[str] = "Cuts by what explains the frames (behaviours)"


class Behaviours:
    """The default: cuts by change of posture, kept where neighbours do not predict each other."""

    name = "behaviours"
    options = BehaviourOptions()

    def find(self, channels: Channels, options: BehaviourOptions) -> Cuts:
        """Find the cuts; see `roundelay.segmentation.SegmentationMethod`."""
        tree = CutTree.of(channels, shortest=options.shortest, resolution=options.resolution)
        kept, step = _section(tree, options), tree.model.step
        cuts = list(kept)
        labels, held = tree.described(cuts)
        odds = np.exp(np.array(list(kept.values())))
        sure = (odds / (1.0 + odds)).tolist()
        frames = np.arange(len(channels.values), dtype=float)
        probability = np.zeros(len(frames))
        probability[[cut * step for cut in cuts]] = sure
        curve = Curve(frames, probability, "probability of a cut")
        return Cuts([cut * step for cut in cuts], sure, curve, labels, held)


def _section(tree: CutTree, options: BehaviourOptions) -> dict[int, float]:
    """Return the cuts that are asked for, with their heights."""
    count = options.n_segments
    if count is None:
        return tree.above(-float(np.log(options.sensitivity)))
    kept = tree.highest(count - 1)
    if len(kept) + 1 < count:
        seconds = len(tree.model) / tree.model.fps
        raise ValueError(
            f"expected at most {len(kept) + 1} segments of at least {options.shortest:g} s in "
            f"{seconds:.1f} s, found n_segments={count}"
        )
    return kept
