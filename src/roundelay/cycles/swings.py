"""How far the limbs of a cycle move, beside the repetitions it was made from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import SMALLEST
from roundelay.cycles.thresholds import SWINGS
from roundelay.motion.features import point_cloud
from roundelay.motion.motion import Motion
from roundelay.timeline.evidence import Evidence
from roundelay.timeline.limbs import Limb, body_of

__all__ = ["Swing", "swings"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Swing:
    """How far a limb moves.

    Attributes
    ----------
    limb : str
        Its name.
    usual : float
        In the usual repetition: how far its joints are from their mean places, RMS over frames
        and joints, in body sizes; the median over repetitions.
    kept : float
        What the loop keeps of it, as a share.
    """

    limb: str
    usual: float
    kept: float


def swings(loop: Motion, motion: Motion, evidence: Evidence) -> tuple[Swing, ...]:
    """Tell of each limb that moves how much of its movement a loop keeps.

    Parameters
    ----------
    loop : Motion
        One period, the body's motion in its root.
    motion : Motion
        The capture, likewise.
    evidence : Evidence
        What the loop was made of.

    Returns
    -------
    tuple of Swing
        In the order of the body's limbs. A limb that moves at most .02 body sizes in the usual
        repetition is left out.
    """
    repetitions, shown = _repetitions(evidence, motion), point_cloud(loop)
    return tuple(_told(shown, repetitions, body_of(motion).limbs))


def _told(shown: Array, repetitions: Sequence[Array], limbs: Sequence[Limb]) -> Iterator[Swing]:
    for limb in limbs:
        usual = float(np.median([_amplitude(one, limb) for one in repetitions]))
        if usual > SWINGS.moves:
            yield Swing(limb.name, usual, _amplitude(shown, limb) / max(usual, SMALLEST))


def _repetitions(evidence: Evidence, motion: Motion) -> list[Array]:
    """Return the poses (n, 3 (J - 1)) of every whole repetition; of parts where none is whole."""
    points, frames = point_cloud(motion), evidence.period
    return [
        points[round(start + k * frames) : round(start + (k + 1) * frames)]
        for start, stop in evidence.runs
        for k in range(max(1, int((stop - start) / frames)))
    ]


def _amplitude(points: Array, limb: Limb) -> float:
    """Return how far a limb's joints are from their mean places, RMS over frames and joints."""
    # The root is no point of a pose.
    own = points.reshape(len(points), -1, 3)[:, np.array(limb.joints) - 1]
    return float(np.sqrt(own.var(axis=0).sum(axis=-1).mean()))
