"""The entry: all methods on captures with known cuts, and bad input."""

import itertools
import json
from dataclasses import replace

import numpy as np
import pytest
from tests.segmentation.conftest import make_capture

import roundelay as rl
from roundelay import synth
from roundelay.base.errors import SkeletonMismatch, TooShort
from roundelay.base.spans import Spans
from roundelay.geometry import rotations as rot
from roundelay.motion.motion import concatenate
from roundelay.segmentation import (
    STANDARD_JOINTS,
    BehaviourOptions,
    GaussianOptions,
    PPCAOptions,
    score,
    segment,
    segment_channels,
)


@pytest.mark.parametrize("seed", range(4))
def test_default_finds_cuts_and_recurring_behaviours(seed):
    made = make_capture("abcabd", seed=seed)
    found = segment(made.motion)
    assert score(found, made.truth).strict.f == 1.0
    assert [s.label for s in found.segments] == [0, 1, 2, 0, 1, 3]
    assert score(found, made.truth).label_accuracy > 0.98
    assert all(0.5 <= s.score <= 1.0 for s in found.segments)


@pytest.mark.parametrize("method", ["pca", "ppca", "gmm", "pca-paper", "ppca-paper", "gmm-paper"])
def test_methods_of_the_paper_give_a_whole_segmentation(capture, method):
    found = segment(capture.motion, method=method)
    assert found.segments[0].start == 0
    assert found.n_frames == len(capture.motion)
    assert all(a.stop == b.start for a, b in zip(found.segments, found.segments[1:], strict=False))
    assert score(found, capture.truth).at(0.5).recall >= 0.6
    assert len(found.curve.frames) == len(found.curve.values) > 0


def test_ppca_finds_all_cuts(capture):
    assert score(segment(capture.motion, method="ppca"), capture.truth).at(0.5).f >= 0.9


def test_noise_changes_nothing(capture):
    noisy = make_capture(noise=0.03)
    assert score(segment(noisy.motion), noisy.truth).strict.f == 1.0


@pytest.mark.parametrize("fps", [24.0, 30.0, 60.0, 100.0, 240.0])
def test_frame_rate_does_not_matter(capture, fps):
    reference = np.array(segment(capture.motion).cuts) / 120.0
    other = np.array(segment(capture.motion.resample(fps)).cuts) / fps
    np.testing.assert_allclose(other, reference, atol=0.35)


def test_time_reversed_gives_the_same_cuts(capture):
    values = capture.motion.rotations[:, 1:].reshape(len(capture.motion), -1)
    forward = np.array(segment_channels(values, 120.0).cuts)
    backward = len(values) - np.array(segment_channels(values[::-1], 120.0).cuts)[::-1]
    np.testing.assert_allclose(forward, backward, atol=30)


def test_units_of_channels_do_not_matter(capture):
    values = capture.motion.rotations[:, 1:].reshape(len(capture.motion), -1)
    assert segment_channels(values, 120.0).cuts == segment_channels(values * 57.3, 120.0).cuts


@pytest.mark.parametrize("count", [1, 2, 5, 6, 9])
def test_asked_number_of_segments_is_met(capture, count):
    assert len(segment(capture.motion, n_segments=count)) == count


def test_more_sensitive_is_not_coarser(capture):
    counts = [len(segment(capture.motion, sensitivity=s)) for s in (1e-6, 1.0, 50.0, 5000.0)]
    assert counts == sorted(counts)
    assert counts[0] < counts[1] < counts[3]


def test_finer_answers_hold_all_cuts_of_coarser_ones(capture):
    """Sensitivities and numbers are sections of one tree; what is sure does not change."""
    known = {}
    answers = [segment(capture.motion, sensitivity=2.0**k) for k in range(-8, 9, 2)]
    answers += [segment(capture.motion, n_segments=count) for count in (1, 3, 7, 12)]
    for answer in answers:
        for cut in answer.cuts:
            sure = answer.curve.values[cut]
            assert known.setdefault(cut, sure) == pytest.approx(sure, abs=1e-12)
    for one, other in itertools.combinations(sorted(answers, key=len), 2):
        assert set(one.cuts) <= set(other.cuts)
    assert len(max(answers, key=len)) > 10


def test_too_many_segments(capture):
    with pytest.raises(ValueError, match=r"at most .* segments of at least 1 s"):
        segment(capture.motion, n_segments=500)


@pytest.mark.parametrize(
    "method",
    ["behaviours", "gaussian", "pca", "ppca", "gmm", "pca-paper", "ppca-paper", "gmm-paper"],
)
def test_constant_capture_is_one_behaviour(capture, method):
    still = concatenate([capture.motion[:1]] * 700)
    found = segment(still, method=method)
    assert len(found) == 1
    assert found.segments[0].score is None


def test_a_constant_capture_cannot_be_cut(capture):
    with pytest.raises(ValueError, match="at most 1 segment"):
        segment(concatenate([capture.motion[:1]] * 700), n_segments=2)


@pytest.mark.parametrize("frames", [1, 2, 30, 200])
def test_short_capture_is_one_behaviour(capture, frames):
    assert len(segment(capture.motion[:frames])) == 1


@pytest.mark.parametrize("method", ["pca", "ppca", "gmm", "ppca-paper"])
def test_short_capture_for_the_papers_methods(capture, method):
    with pytest.raises(TooShort, match="found 100"):
        segment(capture.motion[:100], method=method)


def test_empty_capture(capture):
    with pytest.raises(TooShort):
        segment(capture.motion[:0])


def test_missing_standard_joint_is_named():
    made = make_capture("ab", names=[n for n in STANDARD_JOINTS if n != "ltibia"])
    with pytest.raises(SkeletonMismatch, match="ltibia"):
        segment(made.motion)
    assert len(segment(made.motion, joints=["lfemur", "rfemur", "lhumerus", "head"])) == 2


def test_unknown_joint_is_named(capture):
    with pytest.raises(SkeletonMismatch, match="tail"):
        segment(capture.motion, joints=["tail"])


@pytest.mark.parametrize(
    "arguments",
    [
        {"method": "magic"},
        {"method": "ppca", "sensitivity": 2.0},
        {"method": "gmm", "n_segments": 3},
        {"method": GaussianOptions(), "sensitivity": 2.0},
        {"sensitivity": 2.0, "n_segments": 3},
        {"sensitivity": 0.0},
        {"sensitivity": float("nan")},
        {"n_segments": 0},
        {"joints": []},
    ],
)
def test_misuse(capture, arguments):
    with pytest.raises(ValueError, match="expected"):
        segment(capture.motion, **arguments)


@pytest.mark.parametrize("values", [np.zeros(5), np.zeros((9, 0)), np.full((300, 2), np.nan)])
def test_bad_channels(values):
    with pytest.raises(ValueError, match="finite values"):
        segment_channels(values, 120.0)


def test_bad_rate():
    with pytest.raises(ValueError, match="frame rate"):
        segment_channels(np.zeros((9, 2)), 0.0)


def test_options_choose_the_method(capture):
    found = segment(capture.motion, method=PPCAOptions(threshold=2.0))
    assert (found.method, found.options.threshold) == ("ppca", 2.0)


def test_same_seed_same_mixture(capture):
    results = [
        segment(capture.motion, method="gmm", rng=np.random.default_rng(3)).cuts for _ in range(2)
    ]
    assert results[0] == results[1]


def test_results_as_files(capture):
    found = segment(capture.motion)
    document = json.loads(found.to_json())
    assert document["method"] == "behaviours"
    assert document["options"]["sensitivity"] == 1.0
    assert len(document["segments"]) == len(found)
    assert len(document["curve"]["values"]) == len(found.curve.frames)
    rows = found.to_csv().splitlines()
    assert rows[0].startswith("start,end,seconds,label,name,kind,score")
    assert len(rows) == len(found) + 1


def test_clips_make_up_the_capture(capture):
    found = segment(capture.motion)
    clips = found.clips(capture.motion)
    np.testing.assert_array_equal(concatenate(clips).rotations, capture.motion.rotations)
    np.testing.assert_array_equal(
        found.labels, np.repeat([s.label for s in found.segments], [len(clip) for clip in clips])
    )
    with pytest.raises(ValueError, match="frames"):
        found.clips(capture.motion[:50])


def test_curve_is_the_probability_of_each_cut(capture):
    found = segment(capture.motion)
    assert np.flatnonzero(found.curve.values).tolist() == list(found.cuts)
    sure = found.curve.values[list(found.cuts)]
    assert sure.min() >= 0.5
    scores = [each.score for each in found.segments]
    assert scores == pytest.approx(np.minimum([1.0, *sure], [*sure, 1.0]))


def test_the_proposals_curve_stands_above_one_at_cuts_only(capture):
    found = segment(capture.motion, method="gaussian")
    at_cut = np.isin(found.curve.frames, found.cuts)
    far = np.min(np.abs(found.curve.frames[:, None] - np.array(found.cuts)), axis=1) > 240
    assert found.curve.values[at_cut].min() >= 1.0
    assert found.curve.values[far].max() < 1.0


def test_what_repeats_is_not_cut_and_bears_one_label(capture):
    """Six segments of four behaviours, of which some are said to be one."""
    cuts = segment(capture.motion).cuts
    first, last = Spans([(0, cuts[1])]), Spans([(0, cuts[0]), (cuts[3], cuts[4])])
    whole = segment(capture.motion, repeating=[first])
    assert whole.cuts == cuts[1:]
    again = segment(capture.motion, repeating=[last])
    assert again.cuts == cuts
    assert again.segments[0].label == again.segments[4].label


@pytest.mark.parametrize("deviation", [0.06, 0.12])
def test_slow_drift_of_posture_is_no_cut(deviation):
    """A walk of a minute, and behaviours that come back, of a body that sinks and leans."""
    walk = synth.gait("walk", repetitions=50, period=1.1, fps=30.0, seed=1).motion
    assert len(rl.segment(drifting(walk, deviation, 0))) == 1
    kinds = {"walk": 1.1, "run": 0.75, "jacks": 1.2}
    parts = [
        synth.gait(kind, repetitions=9.0 / kinds[kind], period=kinds[kind], fps=30.0, seed=1)
        for kind in ("walk", "run", "jacks", "walk", "run")
    ]
    made = synth.sequence(*parts, blend=0.4)
    found = rl.segment(drifting(made.motion, deviation, 1))
    assert [each.label for each in found.segments] == [0, 1, 2, 0, 1]
    np.testing.assert_allclose(found.cuts, made.cuts, atol=15)
    assert [each.periodic for each in found.segments] == [True] * 5


def drifting(motion, deviation, seed, memory=4.0):
    """Let all joints but the root turn slowly about."""
    rng = np.random.default_rng(seed)
    count = len(motion) + round(12 * memory * motion.fps)
    gain = 1.0 / (1.0 + (2.0 * np.pi * memory * np.fft.rfftfreq(count, motion.frame_time)) ** 2)
    noise = np.fft.rfft(rng.normal(size=(count, motion.skeleton.n_joints, 3)), axis=0)
    wander = np.fft.irfft(noise * gain[:, None, None], count, axis=0)[-len(motion) :]
    wander *= deviation / wander.std(axis=0)
    wander[:, 0] = 0.0
    turned = rot.multiply(motion.rotations, rot.from_rotation_vector(wander))
    return replace(motion, rotations=turned)


def test_held_poses_are_told_apart_by_posture(capture):
    """Nothing moves in them that could be predicted."""
    poses = [capture.motion[place : place + 1] for place in (0, 2000, 0)]
    held = concatenate([pose for pose in poses for _ in range(960)])
    found = segment(held)
    np.testing.assert_allclose(found.cuts, (960, 1920), atol=30)
    assert [each.label for each in found.segments] == [0, 1, 0]
    assert [each.kind for each in found.segments] == ["held"] * 3


@pytest.mark.parametrize("frames", [1, 2, 17, 119, 241, 500])
@pytest.mark.parametrize("fps", [1e-3, 1.0, 24.0, 120.0])
@pytest.mark.parametrize("kind", ["noise", "walk", "constant", "step", "huge"])
def test_any_numbers_give_segments_or_a_clear_error(frames, fps, kind):
    rng = np.random.default_rng(frames)
    noise = rng.normal(size=(frames, 5))
    values = {
        "noise": noise,
        "walk": np.cumsum(noise, axis=0),
        "constant": np.full((frames, 5), 3.0),
        "step": np.repeat(np.arange(frames)[:, None] < frames // 2, 5, axis=1).astype(float),
        "huge": 1e8 * noise,
    }[kind]
    for method in (
        "behaviours",
        "gaussian",
        "pca",
        "ppca",
        "gmm",
        BehaviourOptions(sensitivity=50.0),
        GaussianOptions(sensitivity=50.0),
    ):
        try:
            found = segment_channels(values, fps, method=method)
        except TooShort:
            continue
        bounds = [0, *found.cuts, frames]
        assert bounds == sorted(set(bounds))
        assert np.isfinite(found.curve.values).all()
