"""The mean over repetitions, unless it loses what they have in common: then one of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from roundelay.cycles.cycle import Cycle
from roundelay.cycles.models.regression import Harmonic
from roundelay.cycles.models.take import Take, take_cycle
from roundelay.cycles.swings import Swing, swings
from roundelay.cycles.thresholds import TAKE
from roundelay.motion.motion import Motion
from roundelay.timeline.evidence import Evidence
from roundelay.timeline.options import Options

__all__ = ["Automatic"]


class Automatic:
    """The default: the model "harmonic", or "take" where a limb would lose its accents.

    The cycle says in `Cycle.method` which it was.
    """

    name = "auto"

    def fit(
        self, motion: Motion, phase: NDArray[np.float64], evidence: Evidence, options: Options
    ) -> Cycle:
        """Fit the cycle; see `roundelay.cycles.models.CycleModel`."""
        mean = Harmonic().fit(motion, phase, evidence, options)
        shown = swings(mean.sample(foot_lock=False), motion, evidence)
        if all(_kept(swing, evidence) for swing in shown):
            return replace(mean, method=Harmonic.name)
        return replace(take_cycle(mean, motion), method=Take.name)


def _kept(swing: Swing, evidence: Evidence) -> bool:
    """Tell whether a limb keeps its movement, or repeats nothing that could be kept."""
    repeats = swing.limb in (evidence.partial or (swing.limb,))
    return swing.kept >= TAKE.kept or not repeats
