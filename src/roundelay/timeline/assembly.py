"""From candidates to the timeline of a take.

::

    Motion -> Body          limbs as signals                     limbs.py
           -> candidates    stretches that may repeat            proposals/
           -> Predicted     every repetition by the others       prediction.py
           -> account       the best for every frame and limb    account.py, tempo.py, merging.py
           -> Behaviour     with one probability                 calibration.py
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.checks import chosen, expected
from roundelay.base.errors import TooShort
from roundelay.base.progress import Progress, report
from roundelay.base.spans import Span, Spans
from roundelay.motion.motion import Motion
from roundelay.motion.poses import Poses
from roundelay.timeline.account import account
from roundelay.timeline.behaviours import Behaviour, Timeline
from roundelay.timeline.calibration import judged_by
from roundelay.timeline.chance import excess
from roundelay.timeline.closing import closing_length
from roundelay.timeline.limbs import Body, body_of, within_ends
from roundelay.timeline.merging import merged
from roundelay.timeline.nesting import phrase_of
from roundelay.timeline.options import Options
from roundelay.timeline.prediction import Predicted, predict_all
from roundelay.timeline.proposals import proposed
from roundelay.timeline.search import points_of_take
from roundelay.timeline.tempo import local_periods, refined, steady_pieces, without_pauses
from roundelay.timeline.thresholds import (
    ACCOUNT,
    CHANCE,
    CLOSING,
    JUDGEMENT,
    PREDICTABILITY,
    SEARCH,
)

__all__ = ["candidates_of", "cyclic", "timeline_of"]


def timeline_of(
    take: Motion | Poses, options: Options | None = None, progress: Progress | None = None
) -> Timeline:
    """Tell what repeats in a take; see `roundelay.understand`."""
    options = chosen(Options, options)
    body, pieces = candidates_of(take, options, progress)
    found = [replace(cyclic(body, piece), phrase=_phrase(body, piece)) for piece in pieces]
    found.sort(key=lambda each: each.certainty, reverse=True)
    closing = _closing(take, body, options)
    likely = [each for each in found if _likely(each, closing, take.fps)]
    uncertain = [each for each in found if each not in likely]
    told = likely or ([] if closing is None else [_whole("closed", body, Spans([closing]))])
    report(progress, 1.0, "done")
    return Timeline(
        body.n_frames,
        take.fps,
        tuple(limb.name for limb in body.limbs),
        (*told, *_aside(body, options.span(body.n_frames))),
        tuple(uncertain),
        getattr(take, "name", ""),
    )


def candidates_of(
    take: Motion | Poses, options: Options | None = None, progress: Progress | None = None
) -> tuple[Body, list[Predicted]]:
    """Return a take's body and all that may repeat, not judged yet.

    Parameters
    ----------
    take : Motion or Poses
    options : Options, optional
    progress : callable, optional

    Raises
    ------
    TooShort
        If there are fewer than 8 frames.
    SkeletonMismatch
        If a joint of the options does not exist.
    ValueError
        If the frames of the options are not all there.
    """
    options = chosen(Options, options)
    report(progress, 0.0, "looking at limbs")
    body = body_of(take, _span(take, options), options.joints)
    report(progress, 1 / 8, "looking for what comes back")
    found = proposed(body, options.proposers)
    report(progress, 0.5, "predicting repetitions")
    predicted = predict_all(body, found)
    report(progress, 7 / 8, "choosing the best account")
    going = [without_pauses(one) for one in account(body, predicted)]
    return body, merged(body, list(_sound_pieces(body, going)))


def _sound_pieces(body: Body, going: Sequence[Predicted]) -> Iterator[Predicted]:
    """Yield the steady pieces of what is no chance, as a whole or by themselves."""
    for one, pieces in zip(going, steady_pieces(body, going), strict=True):
        whole = refined(body, one)
        sound = excess(body, whole) > CHANCE.least
        for piece in pieces or [whole]:
            if sound or excess(body, piece) > CHANCE.least:
                yield piece


def _span(take: Motion | Poses, options: Options) -> Span:
    """Return the frames to look at."""
    if not isinstance(take, Motion | Poses):
        raise TypeError(f"expected a Motion or Poses, found {type(take).__name__}")
    count = len(take) if isinstance(take, Motion) else len(take.values)
    start, stop = expected(Options, options).span(count) or (0, count)
    if stop - start < SEARCH.fewest:
        raise TooShort(f"a period needs at least {SEARCH.fewest} frames, found {stop - start}")
    return start, stop


def cyclic(body: Body, one: Predicted) -> Behaviour:
    """Make the behaviour of what was predicted, with the probability that it repeats."""
    probability, tests = judged_by(body, one)
    spans = _spans(body, one)
    when, lasted = local_periods(one)
    fps, (first, _) = body.rate * body.step, body.span
    moves = one.amplitudes >= PREDICTABILITY.least
    return Behaviour(
        "cyclic",
        spans,
        _names(body, one.claimed),
        tuple(body.names[joint] for joint in body.joints(one.claimed)),
        bool(one.claimed[moves].all()),
        one.period / body.rate,
        one.repetitions,
        probability,
        np.column_stack([(first + when * body.step) / fps, lasted / body.rate]),
        tests,
        paused=_paused(body, one, spans),
        passages=first + one.times * body.step,
    )


def _phrase(body: Body, piece: Predicted) -> Behaviour | None:
    """Return the phrase that a behaviour is a beat of, if it is rather one."""
    longer = phrase_of(body, piece)
    if longer is None:
        return None
    phrase = cyclic(body, longer)
    return phrase if (phrase.probability or 0.0) >= JUDGEMENT.likely else None


def _spans(body: Body, one: Predicted) -> Spans:
    """Return the frames of the runs in which the body is seen.

    What is nearly the end of those looked at is their end.
    """
    spans = [[body.frames(a), body.frames(b)] for a, b in sorted(one.runs)]
    near = ACCOUNT.end * one.period * body.step
    if spans[0][0] - body.span[0] < near:
        spans[0][0] = body.span[0]
    if body.span[1] - spans[-1][1] < near:
        spans[-1][1] = body.span[1]
    found = Spans.union((start, stop) for start, stop in spans)
    return found.without(body.unseen, shortest=SEARCH.fewest) if body.unseen else found


def _paused(body: Body, one: Predicted, spans: Spans) -> Spans:
    """Return the frames between some spans in which the phase rests."""
    resting = np.zeros(body.n_frames, bool)
    for before, after in one.pauses:
        resting[body.frames(before) : body.frames(after)] = True
    resting[: spans[0][0]] = resting[spans[-1][1] :] = False
    resting[spans.frames] = False
    return Spans.of_mask(resting)


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


def _closing(take: Motion | Poses, body: Body, options: Options) -> Span | None:
    """Return the frames that are one closed pass, if the ends of those looked at meet."""
    first, last = body.span
    if last - first > CLOSING.longest * take.fps:
        return None
    points = points_of_take(take, options)[1][first:last]
    length = closing_length(points, chosen=options.frames is not None)
    return None if length is None else (first, first + length)


def _aside(body: Body, asked: Span | None) -> list[Behaviour]:
    """Return the frames that an exporter put before or behind the movement, and the unseen ones."""
    seen = within_ends(asked or (0, body.n_frames), body.unseen)
    aside = {"neutral": _around(body.span, seen), "unseen": body.unseen}
    return [_whole(kind, body, spans) for kind, spans in aside.items() if spans]


def _around(inner: Span, outer: Span) -> Spans:
    """Return what a span leaves of another at either end."""
    ends = ((outer[0], inner[0]), (inner[1], outer[1]))
    return Spans((start, stop) for start, stop in ends if stop > start)


def _whole(kind: str, body: Body, spans: Spans) -> Behaviour:
    everything = np.ones(len(body.limbs), bool)
    closed = kind == "closed"
    return Behaviour(
        kind,  # type: ignore[arg-type]
        spans,
        _names(body, everything),
        tuple(body.names[joint] for joint in body.joints(everything)),
        True,
        spans.total / (body.rate * body.step) if closed else float("nan"),
        1.0 if closed else 0.0,
        None,
        np.zeros((0, 2)),
        (),
    )
