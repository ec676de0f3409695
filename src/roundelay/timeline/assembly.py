"""From candidates to the timeline of a take.

::

    Motion -> Body          limbs as signals                     limbs.py
           -> candidates    stretches that may repeat            proposals/predictability.py
           -> Predicted     every repetition by the others       prediction.py
           -> account       the best for every frame and limb    account.py, tempo.py
           -> Behaviour     with one probability                 calibration.py
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import TooShort
from roundelay.base.progress import Progress, report
from roundelay.base.spans import Span, Spans
from roundelay.motion.features import point_cloud
from roundelay.motion.motion import Motion
from roundelay.timeline.account import account
from roundelay.timeline.behaviours import Behaviour, Timeline
from roundelay.timeline.calibration import judged_by
from roundelay.timeline.closing import closing_span
from roundelay.timeline.limbs import Body, body_of
from roundelay.timeline.prediction import Predicted, predict_all
from roundelay.timeline.proposals.predictability import candidates
from roundelay.timeline.tempo import local_periods, steady_pieces
from roundelay.timeline.thresholds import JUDGEMENT, PREDICTABILITY, SEARCH

__all__ = ["candidates_of", "timeline_of"]


def timeline_of(motion: Motion, progress: Progress | None = None) -> Timeline:
    """Tell what repeats in a take; see `roundelay.understand`.

    Raises
    ------
    TooShort
        If there are fewer than 8 frames.
    """
    if len(motion) < SEARCH.fewest:
        raise TooShort(f"a period needs at least {SEARCH.fewest} frames, found {len(motion)}")
    body, pieces = candidates_of(motion, progress)
    found = sorted(
        (_cyclic(motion, body, piece) for piece in pieces),
        key=lambda each: each.certainty,
        reverse=True,
    )
    closing = _closing(motion, body)
    likely = [each for each in found if _likely(each, closing, motion.fps)]
    uncertain = [each for each in found if each not in likely]
    told = likely or _closed(motion, body, closing)
    report(progress, 1.0, "done")
    return Timeline(
        len(motion),
        motion.fps,
        tuple(limb.name for limb in body.limbs),
        (*told, *_neutral(motion, body)),
        tuple(uncertain),
        motion.name,
    )


def candidates_of(motion: Motion, progress: Progress | None = None) -> tuple[Body, list[Predicted]]:
    """Return a take's body and all that may repeat, not judged yet.

    Parameters
    ----------
    motion : Motion
    progress : callable, optional
    """
    report(progress, 0.0, "looking at limbs")
    body = body_of(motion)
    report(progress, 1 / 8, "looking for what comes back")
    proposed = candidates(body)
    report(progress, 0.5, "predicting repetitions")
    predicted = predict_all(body, proposed)
    report(progress, 7 / 8, "choosing the best account")
    chosen = account(body, predicted)
    return body, [piece for one in chosen for piece in steady_pieces(body, one)]


def _cyclic(motion: Motion, body: Body, one: Predicted) -> Behaviour:
    probability, tests = judged_by(body, one)
    spans = Spans.union(sorted((body.frames(a), body.frames(b)) for a, b in one.runs))
    when, lasted = local_periods(one)
    tempo = np.column_stack([(body.first + when * body.step) / motion.fps, lasted / body.rate])
    moves = one.amplitudes >= PREDICTABILITY.least
    return Behaviour(
        "cyclic",
        spans,
        _names(body, one.claimed),
        tuple(motion.skeleton.names[joint] for joint in body.joints(one.claimed)),
        bool(one.claimed[moves].all()),
        one.period / body.rate,
        one.repetitions,
        probability,
        tempo,
        tests,
    )


def _names(body: Body, claimed: NDArray[np.bool_]) -> tuple[str, ...]:
    return tuple(limb.name for limb, own in zip(body.limbs, claimed, strict=True) if own)


def _likely(one: Behaviour, closing: Span | None, fps: float) -> bool:
    """Tell whether a behaviour is told; a take that closes is a witness for twice the period."""
    if one.probability is None or one.probability < JUDGEMENT.likely:
        return False
    if closing is None:
        return True
    twice = 2.0 * one.period * fps / (closing[1] - closing[0])
    return abs(twice - 1.0) > JUDGEMENT.half or one.tests[0].value >= JUDGEMENT.exact


def _closing(motion: Motion, body: Body) -> Span | None:
    """Return the frames of the take that are one closed pass, if its ends meet."""
    last = body.first + len(body) * body.step
    return closing_span(point_cloud(motion.with_root_motion())[:last], motion.fps, body.first)


def _closed(motion: Motion, body: Body, span: Span | None) -> list[Behaviour]:
    """Return all frames as one closed pass, if they are."""
    if span is None:
        return []
    everything = np.ones(len(body.limbs), bool)
    return [_whole("closed", motion, body, Spans([span]), everything)]


def _neutral(motion: Motion, body: Body) -> list[Behaviour]:
    """Return the frames that an exporter put before or behind the movement."""
    last = min(len(motion), body.first + len(body) * body.step)
    # The clock of the search may end some frames before the take does.
    ends = [(0, body.first), (last, len(motion))]
    spans = Spans((a, b) for a, b in ends if b - a >= body.step or (a == 0 and b > 0))
    everything = np.ones(len(body.limbs), bool)
    return [_whole("neutral", motion, body, spans, everything)] if spans else []


def _whole(
    kind: str, motion: Motion, body: Body, spans: Spans, claimed: NDArray[np.bool_]
) -> Behaviour:
    closed = kind == "closed"
    return Behaviour(
        kind,  # type: ignore[arg-type]
        spans,
        _names(body, claimed),
        tuple(motion.skeleton.names[joint] for joint in body.joints(claimed)),
        True,
        spans.total / motion.fps if closed else float("nan"),
        1.0 if closed else 0.0,
        None,
        np.zeros((0, 2)),
        (),
    )
