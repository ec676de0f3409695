"""Selection: from proposals and verdicts to what a take shows.

Proposers are asked one after the other, each only if those before it led to nothing.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from roundelay.base.errors import NoPeriod
from roundelay.base.progress import Progress, report
from roundelay.timeline.evidence import Evidence
from roundelay.timeline.options import Options
from roundelay.timeline.proposals import Proposal, Proposer, proposers
from roundelay.timeline.search import Search
from roundelay.timeline.verdict import judged, judged_closed, no_period

__all__ = ["find_evidence"]

_GESTURES = "gestures"
# What these proposers find is refused with reasons that hold for the whole body.
_TELLING = ("recurrence", "closed")


def find_evidence(search: Search, progress: Progress | None = None) -> list[Evidence]:
    """Find the periodic motions of a take.

    Parameters
    ----------
    search : Search
    progress : callable, optional
        Called with the fraction done, up to .5, and the stage's name; returning False cancels.

    Returns
    -------
    list of Evidence
        The one most often and most surely repeated first; gestures the most significant first.

    Raises
    ------
    NoPeriod
        If there is none, with the reasons.
    ValueError
        If the options name an unknown proposer.
    """
    refused: list[NoPeriod] = []
    for number, proposer in enumerate(_asked(search.options)):
        told = progress if number == 0 else _held(progress)
        report(told, 0.0, f"looking for {proposer.name}")
        found, reasons = _accepted(proposer, search, told)
        if found:
            if proposer.name != _GESTURES:
                found.sort(key=_weight, reverse=True)
            return found[: search.options.most]
        if proposer.name in _TELLING or search.options.proposers is not None:
            refused += reasons
    if search.options.gestures and search.options.proposers is None:
        raise NoPeriod("; ".join(["no gesture recurs", *map(str, reasons[:3])]))
    raise no_period(refused)


def _held(progress: Progress | None) -> Progress | None:
    """Report progress of what is looked for when all was looked at once: half is done."""
    return progress and (lambda _, stage: progress(0.5, stage))


def _asked(options: Options) -> Iterable[Proposer]:
    """Return the proposers that the options ask for; plug-ins are looked for last."""
    if options.proposers is not None:
        return [proposers[name] for name in options.proposers]
    if options.gestures:
        return [proposers[_GESTURES]]
    never = options.gestures is not None or options.topology.class_index is not None
    return (each for each in proposers if not (never and each.name == _GESTURES))


def _accepted(
    proposer: Proposer, search: Search, progress: Progress | None
) -> tuple[list[Evidence], list[NoPeriod]]:
    """Ask the verdict about all that is proposed; return what it accepts, and why not the rest."""
    taken = np.zeros(len(search.points), bool)
    found: list[Evidence] = []
    refused: list[NoPeriod] = []
    try:
        proposals = list(proposer.propose(search))
    except NoPeriod as refusal:
        return [], [refusal]
    for number, proposal in enumerate(proposals):
        report(progress, (1 + 4 * number / len(proposals)) / 10, "computing barcodes")
        if proposal.fresh and np.mean(taken[proposal.runs.frames]) > 1.0 - proposal.fresh:
            continue
        accepted, reasons = _together_or_apart(search, proposal)
        found += accepted
        refused += reasons
        taken[proposal.runs.frames] |= bool(accepted)
    return found, refused


def _together_or_apart(search: Search, proposal: Proposal) -> tuple[list[Evidence], list[NoPeriod]]:
    """Ask about all frames of a proposal together, else about its parts."""
    try:
        return [_judged(search, proposal)], []
    except NoPeriod as refusal:
        if not proposal.apart:
            return [], [refusal]
    accepted, refused = [], []
    for part in proposal.apart:
        evidence, reasons = _together_or_apart(search, part)
        accepted += evidence
        refused += reasons
    return accepted, refused


def _judged(search: Search, proposal: Proposal) -> Evidence:
    own = search.of(proposal.limbs)
    if own is None:
        raise NoPeriod(f"there are no {proposal.limbs} to look at alone")
    if proposal.rate is not None:
        own = replace(own, step=max(1, round(own.fps / proposal.rate)))
    if proposal.closed:
        return judged_closed(own, proposal.runs[0])
    evidence = judged(own, proposal.runs, proposal.period)
    if evidence.prominence < proposal.least_prominence:
        raise NoPeriod(f"no loop of the {proposal.limbs} stands out", evidence)
    return replace(evidence, limbs=proposal.limbs)


def _weight(evidence: Evidence) -> float:
    return evidence.repetitions * evidence.confidence
