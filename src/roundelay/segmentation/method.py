"""What a segmentation method is: what it is given, and what it gives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from roundelay.base.spans import Spans
from roundelay.segmentation.model import GaussianModel
from roundelay.segmentation.result import Curve

__all__ = ["Channels", "Cuts", "SegmentationMethod"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Channels:
    """What is cut: one point a frame.

    Parameters
    ----------
    values : (F, d) ndarray
        Of a motion, the quaternions of the joints that are looked at.
    fps : float
        Frames a second.
    turn : float
        How far a rotation turns, in radians, where the values move by one: 2 for quaternions,
        which move half as far. 1 for channels of any unit.
    resolution : float, optional
        Difference, after `turn`, that makes no behaviour; relative to the values by default.
    rng : numpy.random.Generator
        For methods that draw numbers.
    repeating : tuple of Spans
        Frames in which something repeats that is known to be one behaviour, such as those of
        `roundelay.Timeline.cyclic`.
    """

    values: Array
    fps: float
    turn: float = 1.0
    resolution: float | None = None
    rng: np.random.Generator = field(default_factory=lambda: np.random.default_rng(0))
    repeating: tuple[Spans, ...] = ()

    def model(self, resolution: float | None = None) -> GaussianModel:
        """Return the likelihood of stretches of the channels, at a resolution of one's own.

        Raises
        ------
        TooShort
            If there is no frame.
        """
        return GaussianModel(self.turn * self.values, self.fps, resolution or self.resolution)


@dataclass(frozen=True, eq=False)
class Cuts:
    """What a method finds.

    Parameters
    ----------
    frames : sequence of int
        First frame of every segment but the first, growing, within 1 and F - 1.
    strengths : sequence of float
        How clear each cut is, in the method's own measure over what it asks of a cut.
    curve : Curve
        What the method watched.
    labels : sequence of int, optional
        One a segment, numbered by first appearance from 0; by default, segments that one
        Gaussian describes as well as two share a label.
    """

    frames: Sequence[int]
    strengths: Sequence[float]
    curve: Curve
    labels: Sequence[int] | None = None


class SegmentationMethod(Protocol):
    """Find where one behaviour ends and another begins."""

    @property
    def name(self) -> str:
        """How `roundelay.segment` and ``roundelay segment --cut-by`` name it."""
        ...

    @property
    def options(self) -> Any:
        """Its options by default, a frozen dataclass; `segment` takes others of this type."""
        ...

    def find(self, channels: Channels, options: Any) -> Cuts:
        """Find the cuts.

        Parameters
        ----------
        channels : Channels
        options : object
            Of the type of `options`.

        Raises
        ------
        TooShort
            If there are fewer frames than the method looks at.
        """
        ...
