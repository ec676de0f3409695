"""From candidate parts to evidence: topology judges each, and those of one motion together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from roundelay.cloud import TopologyOptions
from roundelay.detection import Part, candidate_parts, recurring_groups
from roundelay.errors import NoPeriod, TooShort
from roundelay.periodicity import Evidence, disagreement, measure, without_pauses
from roundelay.progress import Progress, report
from roundelay.timing import Run

__all__ = ["judged", "no_period", "periodic_parts"]

Array = NDArray[np.float64]

# Mean distance of poses a turn apart over that of any two, from which a motion is none that
# repeats: those that do lie below .72, in all captures looked at.
_APART = 0.85


def periodic_parts(
    points: Array,
    fps: float,
    span: Run,
    step: int,
    options: TopologyOptions,
    progress: Progress | None = None,
) -> tuple[list[Evidence], list[NoPeriod]]:
    """Find the stretches in which poses come back after a period.

    Parameters
    ----------
    points : (F, d) ndarray
        One pose a frame.
    fps : float
        Frames a second.
    span : (start, stop)
        The frames to look at.
    step : int
        Look at every step-th frame only.
    options : TopologyOptions
    progress : callable, optional

    Returns
    -------
    found : list of Evidence
        One a motion.
    refused : list of NoPeriod
        Why candidates are none.
    """
    first, last = span
    report(progress, 0.0, "looking for recurring poses")
    parts = candidate_parts(points[first:last:step], fps / step)
    groups = recurring_groups(points, [part.spread(step, first, last) for part in parts])
    found: list[Evidence] = []
    refused: list[NoPeriod] = []
    for number, group in enumerate(groups):
        report(progress, 0.1 + 0.4 * number / len(groups), "computing barcodes")
        accepted, reasons = _together_or_apart(points, group, step, options, last - first)
        found += accepted
        refused += reasons
    return found, refused


def _together_or_apart(
    points: Array, group: list[Part], step: int, options: TopologyOptions, searched: int
) -> tuple[list[Evidence], list[NoPeriod]]:
    """Ask topology about parts that look alike: all together, else each by itself."""
    runs, period = _union(group), float(np.median([part.period for part in group]))
    try:
        return [judged(points, runs, period, step, options, searched)], []
    except NoPeriod as refusal:
        if len(group) == 1:
            return [], [refusal]
    accepted, refused = [], []
    for part in group:
        evidence, reasons = _together_or_apart(points, [part], step, options, searched)
        accepted += evidence
        refused += reasons
    return accepted, refused


def judged(
    points: Array,
    runs: Sequence[Run],
    period: float,
    step: int,
    options: TopologyOptions,
    searched: int,
) -> Evidence:
    """Measure the runs of one motion, cut its pauses out, and check the result.

    Parameters
    ----------
    points, runs, period, step, options
        As for `roundelay.periodicity.measure`.
    searched : int
        Frames of the capture that were looked at.

    Raises
    ------
    NoPeriod
        If it is no periodic motion, with the reason and what was measured.
    """
    by_hand = options.class_index is not None
    try:
        evidence = measure(points, runs, period, step, options)
        cut = without_pauses(evidence)
        if cut and tuple(cut) != evidence.runs:
            again = measure(points, cut, evidence.period, step, options)
            evidence = again if again.objection(searched, chosen=by_hand) is None else evidence
    except (NoPeriod, TooShort) as error:
        measured = error.evidence if isinstance(error, NoPeriod) else None
        raise NoPeriod(f"frames {_listed(runs)}: {error}", measured) from error
    objection = evidence.objection(searched, chosen=by_hand)
    if objection is None and not by_hand and disagreement(points, evidence) >= _APART:
        objection = "its poses are hardly nearer to those a turn later than any two are"
    if objection is not None:
        raise NoPeriod(f"frames {_listed(evidence.runs)}: {objection}", evidence)
    return evidence


def _listed(runs: Sequence[Run]) -> str:
    return ", ".join(f"{start}-{stop}" for start, stop in runs)


def _union(parts: list[Part]) -> list[Run]:
    """Join ranges that overlap."""
    joined: list[Run] = []
    for part in parts:
        if joined and part.start <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(part.stop, joined[-1][1]))
        else:
            joined.append((part.start, part.stop))
    return joined


def no_period(refused: Sequence[NoPeriod]) -> NoPeriod:
    """Return one refusal that tells the first reasons, with the first's evidence."""
    if not refused:
        return NoPeriod("no periodic motion found: no pose comes back after a while")
    shown = "; ".join(str(reason) for reason in refused[:3])
    more = f"; and {len(refused) - 3} more" if len(refused) > 3 else ""
    return NoPeriod(f"no periodic motion found: {shown}{more}", refused[0].evidence)
