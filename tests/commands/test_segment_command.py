"""``roundelay segment``, as people and programs use it, and periods of segments."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from tests.segmentation.conftest import make_capture
from typer.testing import CliRunner

import roundelay as rl
from roundelay import pipeline
from roundelay.cli import app

runner = CliRunner()


@pytest.fixture(scope="module")
def capture(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("captures") / "day.bvh"
    rl.write(make_capture("aba", seed=3).motion, path)
    return path


def run(*arguments):
    return runner.invoke(app, ["segment", *map(str, arguments)])


def test_segment_writes_record_table_picture_and_clips(capture, tmp_path):
    result = run(capture, "-o", tmp_path, "--split")
    assert result.exit_code == 0, result.output
    assert "3 segments, 2 behaviours" in result.stdout
    assert len(result.stdout.splitlines()) == 5
    clips = [f"day_segment0{number}.bvh" for number in (1, 2, 3)]
    others = ["day_segments.csv", "day_segments.json", "day_segments.png"]
    assert sorted(path.name for path in tmp_path.iterdir()) == clips + others
    record = json.loads((tmp_path / "day_segments.json").read_text())
    assert record["files"] == clips
    frames = [len(rl.read(tmp_path / clip)) for clip in clips]
    assert sum(frames) == record["n_frames"]
    assert [s["end_frame"] - s["start_frame"] for s in record["segments"]] == frames


def test_json_is_all_that_is_printed(capture, tmp_path):
    result = run(capture, "-o", tmp_path, "--json", "--no-picture", "--segments", 2)
    assert len(json.loads(result.stdout)["segments"]) == 2
    assert not list(tmp_path.glob("*.png"))


@pytest.mark.parametrize("method", ["pca", "ppca", "gmm", "pca-paper", "ppca-paper"])
def test_other_methods(capture, tmp_path, method):
    result = run(capture, "-o", tmp_path, "--cut-by", method)
    assert result.exit_code == 0, result.output


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--cut-by", "magic"], "expected a segmentation method among"),
        (["--cut-by", "pca", "--sensitivity", "2"], "expected options of the method 'behaviours'"),
        (["--cut-by", "ppca-paper", "--ppca-rule", "difference"], "options of the method 'ppca'"),
        (["--gmm-clusters", "3"], "expected options of the method 'gmm' with that method"),
        (["--cut-by", "pca", "--pca-lag", "9"], "expected lag < window <= start"),
        (["--joints", "tail"], "no joint 'tail'"),
        (["--segments", "99"], "expected at most"),
        (["--segments", "3", "--sensitivity", "2"], "expected --sensitivity or --segments"),
    ],
)
def test_bad_input_is_one_line_and_2(capture, tmp_path, arguments, message):
    result = run(capture, "-o", tmp_path, *arguments)
    assert result.exit_code == 2
    assert result.stderr.startswith("roundelay: ")
    assert message in result.stderr
    assert result.stderr.count("\n") == 1


def test_periods_of_segments():
    made = make_capture("ab", seed=1, seconds=8.0)
    found = rl.segment(made.motion)
    assert len(found) == 2
    for segment in found.segments:
        assert segment.periodic
        assert 0.7 < segment.period < 1.5


def test_cancelled_search_for_periods():
    made = make_capture("ab", seed=1)
    with pytest.raises(rl.Cancelled):
        rl.segment(made.motion, progress=lambda fraction, stage: False)


def test_a_timeline_that_is_known_is_not_made_again(monkeypatch):
    made = make_capture("ab", seed=1).motion
    told, found = rl.understand(made), rl.segment(made)

    def again(*given):
        raise AssertionError("made again")

    monkeypatch.setattr(pipeline, "timeline_of", again)
    monkeypatch.setattr("roundelay.timeline.finding.timeline_of", again)
    assert rl.segment(made, timeline=told).segments == found.segments
    assert len(rl.make_loops(made, timeline=told)) == len(rl.find_cycles(made, timeline=told)) > 0
    for use in (rl.segment, rl.find_cycles, rl.make_loops):
        with pytest.raises(ValueError, match="expected the timeline of a take of 500 frames"):
            use(made[:500], timeline=told)


def test_t_pose_in_front_changes_nothing():
    made = make_capture("aba", seed=3).motion
    still = rl.concatenate([make_capture("c", seed=9).motion[:1], made])
    cuts, shifted = rl.segment(made).cuts, rl.segment(still).cuts
    assert [abs(a + 1 - b) <= 8 for a, b in zip(cuts, shifted, strict=True)] == [True] * 2


def test_loop_in_every_segment(capture, tmp_path):
    arguments = [
        "loop",
        str(capture),
        "-o",
        str(tmp_path),
        "--per-behaviour",
        "--no-picture",
        "--json",
    ]
    result = runner.invoke(app, arguments)
    assert result.exit_code == 0, result.output
    cycles = json.loads(result.stdout)["cycles"]
    cuts = rl.segment(rl.read(capture)).cuts
    starts = [cycle["parts"][0][0] for cycle in cycles]
    assert sum(start < cuts[0] for start in starts) >= 1
    assert sum(cuts[0] <= start < cuts[1] for start in starts) >= 1
    assert all((tmp_path / cycle["files"][0]).exists() for cycle in cycles)


def test_frames_and_behaviours_do_not_go_together(capture, tmp_path):
    arguments = ["loop", str(capture), "-o", str(tmp_path), "--per-behaviour", "--frames", "0:500"]
    result = runner.invoke(app, arguments)
    assert result.exit_code == 2
    assert "found both" in result.stderr


def test_segments_without_a_period(tmp_path):
    motion = rl.concatenate([make_capture("a").motion[:1]] * 400)
    with pytest.raises(rl.NoPeriod):
        pipeline.cycles_in_segments(rl.segment(motion), motion)
