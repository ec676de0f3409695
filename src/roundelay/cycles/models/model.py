"""What a cycle model is."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from roundelay.cycles.cycle import Cycle
from roundelay.motion.motion import Motion
from roundelay.timeline.evidence import Evidence
from roundelay.timeline.options import Options

__all__ = ["CycleModel"]


class CycleModel(Protocol):
    """Make a cycle of the frames that show a motion."""

    @property
    def name(self) -> str:
        """How `Options.method` names it."""
        ...

    def fit(
        self, motion: Motion, phase: NDArray[np.float64], evidence: Evidence, options: Options
    ) -> Cycle:
        """Fit the cycle.

        Parameters
        ----------
        motion : Motion
            The capture, its travel in the root.
        phase : (F,) ndarray
            In turns, proportional to time; NaN outside the frames that count. It becomes
            `Cycle.phase`, unless the model puts there what it fitted by instead.
        evidence : Evidence
            What was found; `Evidence.runs` are the frames that count. It goes into the cycle.
        options : Options
            Harmonics, and what a model of ours needs besides.

        Raises
        ------
        TooShort
            If the frames hold no whole period.
        """
        ...
