"""What a person may choose of a part: other periods, other classes."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from roundelay.base.errors import NoPeriod
from roundelay.cycles.cycle import Cycle
from roundelay.studio.work import Part
from roundelay.timeline.behaviours import Behaviour, Timeline
from roundelay.timeline.evidence import follow

__all__ = ["class_choices", "period_choices"]

# Classes that are followed.
_CLASSES = 5


def period_choices(told: Timeline, part: Part, cycle: Cycle) -> list[dict[str, Any]]:
    """List the periods that a part may have, each once.

    Parameters
    ----------
    told : Timeline
        The take's.
    part : Part
    cycle : Cycle
        As it is made now.

    Returns
    -------
    list of dict
        ``seconds``, and in ``words`` where it is from: half and twice what it is, and what was
        found in these frames, sure or not.
    """
    found = [(cycle.period / 2, "half"), (cycle.period, "as it is"), (cycle.period * 2, "twice")]
    for each in (*told.cyclic, *told.uncertain):
        if any(each.spans.within(range(*span)) for span in part.spans):
            found.append((each.period, _sure(each)))
            if each.phrase is not None:
                found.append((each.phrase.period, "phrase of several"))
    listed: dict[str, str] = {}
    for seconds, words in found:
        listed.setdefault(f"{seconds:.2f}", words)
    return [{"seconds": float(key), "words": words} for key, words in sorted(listed.items())]


def _sure(each: Behaviour) -> str:
    return "found" if each.probability is None else f"found, {each.probability:.0%} sure"


def class_choices(cycle: Cycle) -> list[dict[str, Any]]:
    """List the classes of a part's barcode.

    Parameters
    ----------
    cycle : Cycle
        Of the part.

    Returns
    -------
    list of dict
        ``index``, 0 being the longest bar; ``birth`` and ``death`` of the bar, in body sizes;
        ``turns`` forward in all, None where it does not go around; whether it is ``chosen``.
    """
    evidence = cycle.evidence
    if evidence is None or evidence.cloud is None:
        return []
    barcode, listed = evidence.barcode, []
    for index in range(min(_CLASSES, len(barcode))):
        turns = None
        with suppress(NoPeriod):
            turns = follow(evidence.cloud, index, n_frames=len(evidence.turns)).net
        listed.append({
            "index": index,
            "birth": float(barcode.births[index]),
            "death": float(min(barcode.deaths[index], barcode.max_scale)),
            "turns": turns,
            "chosen": index == evidence.coordinate.class_index,
        })  # fmt: skip
    return listed
