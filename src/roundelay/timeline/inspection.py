"""Look behind the automatic choice: every class of a motion's barcode with its figures."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.checks import chosen
from roundelay.base.errors import NoPeriod
from roundelay.base.threads import one_thread
from roundelay.motion.motion import Motion
from roundelay.timeline.evidence import Evidence, follow
from roundelay.timeline.finding import find_evidence
from roundelay.timeline.options import Options
from roundelay.topology.significance import p_values

__all__ = ["ClassFigures", "Inspection", "inspect"]


@dataclass(frozen=True, eq=False)
class ClassFigures:
    """One class of a barcode.

    Attributes
    ----------
    index : int
        Which bar, 0 being the longest: what ``roundelay loop --class`` takes.
    birth, death : float
        Of the bar, in body sizes.
    p_value : float
        Chance of such a bar in noise (Bobrowski and Skraba 2023), times the number of bars.
    evidence : Evidence or None
        Its circular coordinate over time, scale, period and turns.
    fault : str
        Why there is none, or empty.
    """

    index: int
    birth: float
    death: float
    p_value: float
    evidence: Evidence | None
    fault: str


@dataclass(frozen=True, eq=False)
class Inspection:
    """A motion of the capture and the classes of its poses.

    Attributes
    ----------
    evidence : Evidence
        What the main job uses, or would if it did not object.
    objection : str
        Why the main job refuses it, or empty.
    classes : list of ClassFigures
        The longest bars, longest first.
    """

    evidence: Evidence
    objection: str
    classes: list[ClassFigures]


@one_thread
def inspect(motion: Motion, options: Options | None = None, *, most: int = 5) -> list[Inspection]:
    """List the classes of every periodic motion, or of the best candidate if there is none.

    Parameters
    ----------
    motion : Motion
    options : Options, optional
        As for `find_cycles`.
    most : int
        Classes to follow for each motion.

    Raises
    ------
    NoPeriod
        If no pose comes back at all.
    """
    try:
        _, found = find_evidence(motion, chosen(Options, options))
    except NoPeriod as refusal:
        if not isinstance(refusal.evidence, Evidence):
            raise
        return [_inspected(refusal.evidence, str(refusal), most, motion)]
    return [_inspected(evidence, "", most, motion) for evidence in found]


def _inspected(evidence: Evidence, objection: str, most: int, motion: Motion) -> Inspection:
    barcode = evidence.barcode
    chances = p_values(barcode)
    classes = []
    for index in range(min(most, len(barcode))):
        followed, fault = _followed(evidence, index, len(motion))
        classes.append(
            ClassFigures(
                index=index,
                birth=float(barcode.births[index]),
                death=float(barcode.deaths[index]),
                p_value=float(chances[index]),
                evidence=followed,
                fault=fault,
            )
        )
    return Inspection(evidence, objection, classes)


def _followed(evidence: Evidence, index: int, frames: int) -> tuple[Evidence | None, str]:
    if index == evidence.coordinate.class_index:
        return evidence, ""
    if evidence.cloud is None:
        return None, "the points are not at hand"
    try:
        return follow(evidence.cloud, index, n_frames=frames), ""
    except NoPeriod as error:
        return None, str(error)
