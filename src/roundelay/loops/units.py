"""The unit of a file's lengths, guessed from the body: so that figures can be told in metres."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from roundelay.geometry.skeleton import Skeleton
from roundelay.loops.thresholds import UNITS
from roundelay.motion.floating import PointsLayout
from roundelay.motion.points import METRES

__all__ = ["Lengths"]


@dataclass(frozen=True)
class Lengths:
    """Tell lengths of a file to people.

    Attributes
    ----------
    size : float
        The longest way along bones from the hips on, in the file's unit.
    metres : float or None
        Metres that the file's unit has; None where the body is no person's in any unit.
    """

    size: float
    metres: float | None

    @classmethod
    def of(cls, skeleton: Skeleton, resized: float = 1.0) -> Lengths:
        """Return the unit that points tell, or guess that in which a skeleton is a person's.

        What lies above the hips, such as a bone on the ground, is no part of the body.

        Parameters
        ----------
        skeleton : Skeleton
        resized : float
            By what it was multiplied on purpose: it need be a person's before, not now.
        """
        offsets = skeleton.offsets.copy()
        offsets[list(skeleton.trunk)] = 0.0
        size = replace(skeleton, offsets=offsets).size
        known = np.array(UNITS.metres)
        metres = size / resized * known
        if skeleton.free and isinstance(skeleton.layout, PointsLayout):
            # Laboratories tell their unit; pixels have no length.
            return cls(size, METRES.get(skeleton.layout.units.lower()))
        fits = np.flatnonzero((metres >= UNITS.shortest) & (metres <= UNITS.longest))
        return cls(size, float(known[fits[0]]) if len(fits) else None)

    def told(self, length: float) -> str:
        """Return a length in the file's unit as a text: "4 cm", or ".02 body sizes"."""
        if self.metres is None:
            return f"{length / self.size:.2g} body sizes"
        centimetres = 100 * length * self.metres
        return f"{centimetres:.{0 if centimetres >= 1.0 else 1}f} cm"

    def told_speed(self, speed: float) -> str:
        """Return a speed in the file's unit a second as a text, that one and metres if known."""
        own = f"{speed:.3g} units/s"
        if self.metres is None:
            return f"{speed / self.size:.2g} body sizes/s ({own})"
        return f"{speed * self.metres:.2f} m/s ({own})"
