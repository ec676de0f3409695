"""What a segmentation method must do."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, is_dataclass

import numpy as np

from roundelay import synth
from roundelay.base.errors import TooShort
from roundelay.segmentation import (
    Channels,
    Curve,
    Cuts,
    Segmentation,
    SegmentationMethod,
    joint_quaternions,
    segmented,
)
from roundelay.segmentation.thresholds import MODEL
from roundelay.testing.expecting import SECONDS, Subject

__all__ = ["check_segmentation_method"]

_RATE = 20.0
_JOINTS = ("LeftUpLeg", "RightUpLeg", "LeftArm", "RightArm")
# Frames of captures too short for most methods.
_SHORT = (1, 2, 3, 10)


def check_segmentation_method(method: SegmentationMethod) -> None:
    """Check that a method cuts whatever it is given into segments without gaps.

    It is given a walk followed by jumping jacks, a motion without behaviours, channels of
    another unit, what does not move, and captures of a few frames.

    - It has a name; its options are a dataclass that JSON can hold.
    - Cuts are whole numbers that grow, within the capture; each has a strength, none is NaN.
    - Labels, if it gives them, are one a segment, numbered by first appearance.
    - Its curve has as many values as frames, which do not decrease, and says what it means.
    - The same channels and seed give the same cuts, and the channels are left as they are.
    - What is too short for it is `TooShort`, and nothing else.
    - Segments cover every frame, and can be written as JSON and as a table.

    Parameters
    ----------
    method : SegmentationMethod

    Raises
    ------
    AssertionError
        If it does not.
    """
    subject = Subject("segmentation method", method)
    subject.expect_parts("find")
    options = getattr(method, "options", None)
    fits = is_dataclass(options) and not isinstance(options, type)
    subject.expect(fits, "options as an instance of a dataclass", repr(options))
    json.dumps(asdict(options))  # type: ignore[arg-type]
    for values, turn in _given():
        found = _found(subject, values, turn)
        _check_cuts(subject, found, len(values))
        _check_segments(subject, found, _segmented(subject, values, turn), len(values))
    _check_short(subject)


def _given() -> Iterator[tuple[np.ndarray, float]]:
    """Yield values (F, d), and how far a rotation turns where they move by one."""
    walk = synth.gait("walk", repetitions=8.0, fps=_RATE)
    jacks = synth.gait("jacks", repetitions=7.0, fps=_RATE)
    yield joint_quaternions(synth.sequence(walk, jacks).motion, _JOINTS), 2.0
    yield joint_quaternions(synth.wander(12.0, fps=_RATE).motion, _JOINTS), 2.0
    rng = np.random.default_rng(0)
    yield 100.0 * np.cumsum(rng.normal(size=(round(12 * _RATE), 3)), axis=0), 1.0
    yield np.ones((round(12 * _RATE), 4)), 1.0


def _channels(values: np.ndarray, turn: float) -> Channels:
    resolution = MODEL.resolution if turn == 2.0 else None
    return Channels(values, _RATE, turn, resolution, np.random.default_rng(0))


def _found(subject: Subject, values: np.ndarray, turn: float) -> Cuts:
    method, channels = subject.item, _channels(values.copy(), turn)
    found = subject.within(SECONDS, lambda: method.find(channels, method.options), "cutting")
    subject.expect(isinstance(found, Cuts), "Cuts", repr(found))
    same = np.array_equal(values, channels.values)
    subject.expect(same, "channels left as they are", "changed ones")
    return found


def _segmented(subject: Subject, values: np.ndarray, turn: float) -> Segmentation:
    return segmented(_channels(values, turn), subject.item, subject.item.options)


def _check_cuts(subject: Subject, found: Cuts, frames: int) -> None:
    expect, cuts = subject.expect, list(found.frames)
    whole = all(isinstance(cut, int | np.integer) for cut in cuts)
    expect(whole, "cuts as whole numbers", cuts)
    bounds = [0, *cuts, frames]
    expect(bool(np.all(np.diff(bounds) > 0)), f"cuts that grow, within 1 and {frames - 1}", cuts)
    count = len(found.strengths)
    expect(count == len(cuts), f"{len(cuts)} strengths", count)
    expect(not np.any(np.isnan(found.strengths)), "strengths that are numbers", found.strengths)
    if found.labels is not None:
        _check_labels(subject, list(found.labels), len(cuts) + 1)
    _check_curve(subject, found.curve)


def _check_labels(subject: Subject, labels: list[int], segments: int) -> None:
    subject.expect(len(labels) == segments, f"{segments} labels", len(labels))
    order = list(dict.fromkeys(labels))
    counted = order == list(range(len(order)))
    subject.expect(counted, "labels numbered by first appearance", labels)


def _check_curve(subject: Subject, curve: Curve) -> None:
    frames, values = np.asarray(curve.frames), np.asarray(curve.values)
    one = frames.ndim == 1 and frames.shape == values.shape
    found = f"shapes {frames.shape} and {values.shape}"
    subject.expect(one, "a curve of frames (m,) and values (m,)", found)
    grows = not np.any(np.diff(frames) < 0)
    subject.expect(grows, "a curve whose frames do not decrease", frames)
    meant = isinstance(curve.meaning, str) and bool(curve.meaning)
    subject.expect(meant, "a meaning of the curve", repr(curve.meaning))


def _check_segments(subject: Subject, cuts: Cuts, found: Segmentation, frames: int) -> None:
    again = list(found.cuts)
    subject.expect(again == list(cuts.frames), f"the same cuts again, {list(cuts.frames)}", again)
    labels = len(found.labels)
    subject.expect(labels == frames, f"labels of {frames} frames", labels)
    told = json.loads(found.to_json())
    subject.expect(told["method"] == subject.item.name, "its name in JSON", told["method"])
    rows = len(found.to_csv().splitlines())
    subject.expect(rows == len(found) + 1, f"a table of {len(found)} rows", rows - 1)


def _check_short(subject: Subject) -> None:
    whole = joint_quaternions(synth.gait("walk", fps=_RATE).motion, _JOINTS)
    for frames in _SHORT:
        try:
            _check_cuts(subject, _found(subject, whole[:frames], 2.0), frames)
        except AssertionError:
            raise
        except TooShort:
            pass
        except Exception as error:
            subject.expect(False, f"cuts or TooShort for {frames} frames", repr(error))
