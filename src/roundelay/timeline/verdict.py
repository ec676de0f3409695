"""The verdict: whether what was measured of a proposal shows a periodic motion, and if not why."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from roundelay.base.errors import NoPeriod, TooShort
from roundelay.base.spans import Span, Spans
from roundelay.timeline.evidence import (
    Evidence,
    disagreement,
    measure,
    measure_closed,
    without_pauses,
)
from roundelay.timeline.search import Search
from roundelay.timeline.thresholds import VERDICT

__all__ = ["judged", "judged_closed", "no_period", "objection"]


def judged(search: Search, runs: Spans, period: float) -> Evidence:
    """Measure the frames of one motion, cut its pauses out, and check the result.

    Parameters
    ----------
    search : Search
    runs : Spans
        The frames proposed.
    period : float
        Rough period in frames.

    Raises
    ------
    NoPeriod
        If it is no periodic motion, with the reason and what was measured.
    """
    by_hand = search.options.topology.class_index is not None
    try:
        evidence = measure(search, runs, period)
        cut = without_pauses(evidence)
        if cut and cut != evidence.runs:
            again = measure(search, cut, evidence.period)
            sound = objection(again, search.n_frames, chosen=by_hand) is None
            evidence = again if sound else evidence
    except (NoPeriod, TooShort) as error:
        measured = error.evidence if isinstance(error, NoPeriod) else None
        raise NoPeriod(f"frames {runs}: {error}", measured) from error
    why = objection(evidence, search.n_frames, chosen=by_hand)
    if why is None and not by_hand and disagreement(search.points, evidence) >= VERDICT.apart:
        why = "its poses are hardly nearer to those a turn later than any two are"
    if why is not None:
        raise NoPeriod(f"frames {evidence.runs}: {why}", evidence)
    return evidence


def objection(evidence: Evidence, searched: int, *, chosen: bool = False) -> str | None:
    """Say why this is not a periodic motion, or None.

    Parameters
    ----------
    evidence : Evidence
    searched : int
        Frames of the capture that were searched: in a long one, something comes back once by
        chance.
    chosen : bool
        The class was chosen by hand: its bar need not stand out.
    """
    net, prominence = evidence.net, evidence.prominence
    if net < VERDICT.least_turns:
        return f"it makes {net:.2f} turns of its loop, not more than one"
    if evidence.steadiness < VERDICT.steady:
        return f"of {evidence.total:.2f} turns only {net:.2f} remain forwards"
    share = evidence.runs.total / searched
    unique = net >= VERDICT.unique_turns and prominence >= VERDICT.unique
    if net < VERDICT.enough_turns and share < VERDICT.share and not unique:
        return f"it makes {net:.2f} turns of its loop in {share:.0%} of the frames"
    if chosen:
        return None
    # One turn and a bit could be chance: the less is seen twice, the more its loop must stand
    # out. Many turns are no chance even if another bar is nearly as long: it is enough that
    # prominence^-turns is at most a quarter.
    enough = min(VERDICT.prominent, VERDICT.chance ** (1.0 / net))
    needed = max(1.0 + VERDICT.beyond / (net - 1.0), enough)
    if prominence < needed:
        return f"its longest bar is {prominence:.2f} times the next, not {needed:.2f}"
    return None


def judged_closed(search: Search, run: Span) -> Evidence:
    """Take frames for one closed period if their ends meet.

    They meet if the last pose comes as near to the first as neighbouring poses are; where the
    user chose the frames, they may lie a few steps apart.

    Raises
    ------
    NoPeriod
        If the ends do not meet, with how far they are apart, or the poses form no loop.
    """
    chosen, poses = search.options.frames is not None, search.points[slice(*run)]
    steps = np.linalg.norm(np.diff(poses, axis=0), axis=1)
    gap = float(np.linalg.norm(poses[-1] - poses[0]))
    usual = max(
        VERDICT.median_steps * float(np.median(steps)),
        float(np.percentile(steps, VERDICT.usual)),
    )
    if gap > usual * (VERDICT.chosen_steps if chosen else 1.0):
        apart = f"{gap / usual:.1f} steps" if usual > 0.0 else "far"
        raise NoPeriod(f"its last pose is {apart} from its first: no closed period")
    width = float(np.linalg.norm(poses - poses[0], axis=1).max())
    if width < VERDICT.wider * gap:
        wide = f"{width / gap:.1f} times as wide as the gap between its ends"
        raise NoPeriod(f"its loop is {wide}, not {VERDICT.wider:g}")
    evidence = measure_closed(search, run)
    if evidence.prominence < VERDICT.prominent and not chosen:
        raise NoPeriod(
            f"its ends meet, but its longest bar is {evidence.prominence:.2f} times the next, "
            f"not {VERDICT.prominent:g}",
            evidence,
        )
    return evidence


def no_period(refused: Sequence[NoPeriod]) -> NoPeriod:
    """Return one refusal that tells the first reasons, with the first's evidence."""
    if not refused:
        return NoPeriod("no periodic motion found: no pose comes back after a while")
    shown = "; ".join(str(reason) for reason in refused[:3])
    more = f"; and {len(refused) - 3} more" if len(refused) > 3 else ""
    return NoPeriod(f"no periodic motion found: {shown}{more}", refused[0].evidence)
