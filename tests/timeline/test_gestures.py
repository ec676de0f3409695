"""Gestures that recur with something else between."""

from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.cli import app
from roundelay.timeline.proposals.excitation import Region
from roundelay.timeline.proposals.gestures import gesture_runs

FPS = 30


@pytest.fixture(scope="module")
def made() -> synth.Synthetic:
    """A jumping jack now and again, each time with other things between, for over ten seconds."""
    jack = synth.gait("jacks", repetitions=1.1, fps=FPS)
    between = [synth.wander(seconds, fps=FPS, seed=n) for n, seconds in enumerate((2, 11, 14))]
    return synth.sequence(between[0], jack, between[1], jack, between[2], jack)


def test_a_gesture_is_found_wherever_it_recurs(made):
    cycle = rl.find_cycles(made.motion)[0]
    assert cycle.period == pytest.approx(1.2, rel=0.15)
    edges = [0, *made.cuts, len(made.motion)]
    shown = list(zip(edges[1::2], edges[2::2], strict=False))
    assert cycle.evidence is not None
    assert len(cycle.evidence.runs) == 3
    for run, (start, stop) in zip(cycle.evidence.runs, shown, strict=True):
        assert abs(run[0] - start) < 0.2 * FPS
        # Of the 1.1 repetitions made, one whole turn is shown.
        assert abs(run[1] - stop) < 0.2 * FPS


def test_a_gesture_must_recur_three_times(made):
    with pytest.raises(rl.NoPeriod, match="no periodic motion found"):
        rl.find_cycles(made.motion[: made.cuts[3]])


def test_what_repeats_and_what_recurs_are_found_in_one_take(made):
    walk = synth.gait("walk", repetitions=6, fps=FPS).motion
    cycles = rl.find_cycles(rl.concatenate([made.motion, walk]))
    assert {len(cycle.evidence.runs) for cycle in cycles} == {1, 3}


def test_only_the_chosen_frames_are_searched(made):
    four = rl.concatenate([made.motion, made.motion[: made.cuts[1]]])
    span = (made.cuts[1], len(four))
    found = rl.find_cycles(four, rl.Options(frames=span))[0]
    assert found.evidence.runs[0][0] >= span[0]
    assert len(found.evidence.runs) == 3


def test_the_commands_show_and_loop_gestures(made, tmp_path):
    path = tmp_path / "jacks.bvh"
    rl.write(made.motion, path)
    shown = CliRunner().invoke(app, ["excitations", str(path), "-o", str(tmp_path), "--json"])
    classes = json.loads(shown.stdout)["classes"]
    whole = [[r["frames"] for r in one["regions"] if r["net_turns"] > 0.75] for one in classes]
    assert any(len(regions) == 3 for regions in whole)
    assert (tmp_path / "jacks_excitations.png").exists()
    assert json.loads((tmp_path / "jacks_excitations.json").read_text())["classes"] == classes
    looped = CliRunner().invoke(app, ["loop", str(path), "-o", str(tmp_path)])
    assert looped.exit_code == 0, looped.output
    assert len(json.loads((tmp_path / "jacks_loop.json").read_text())["cycles"][0]["parts"]) == 3


def test_frames_of_the_command_are_those_of_the_capture(made, tmp_path):
    path = tmp_path / "jacks.bvh"
    rl.write(made.motion, path)
    arguments = ["excitations", str(path), "-o", str(tmp_path), "--no-picture", "--frames"]
    shown = CliRunner().invoke(app, [*arguments, f"{made.cuts[1]}:", "--json"])
    regions = json.loads(shown.stdout)["classes"][0]["regions"]
    assert all(made.cuts[1] <= frame <= len(made.motion) for r in regions for frame in r["frames"])
    wrong = CliRunner().invoke(app, [*arguments, "5:90000"])
    assert wrong.exit_code == 2
    assert "expected frames within 0 and" in wrong.output


def test_wandering_holds_no_gesture():
    with pytest.raises(rl.NoPeriod):
        rl.find_cycles(synth.wander(20, seed=3).motion, rl.Options(proposers=("excitation",)))


def test_regions_without_a_gap_are_one():
    class Excited:
        regions = (
            Region(0, 100, 1.0, 1.0),
            Region(110, 210, 0.9, 1.0),
            Region(250, 300, 0.4, 0.4),
            Region(400, 500, 1.0, 1.2),
        )

    runs = gesture_runs(Excited(), (0, 505))
    assert runs == ((0, 220), (390, 505))
    assert gesture_runs(Excited(), (20, 525)) == ((20, 240), (410, 525))


def test_a_class_that_cannot_be_lifted_is_no_gesture(made, monkeypatch):
    def unliftable(*_, **__):
        raise rl.LiftError("class 0 lifts to no integer cocycle")

    monkeypatch.setattr("roundelay.timeline.proposals.gestures.excitations", unliftable)
    with pytest.raises(rl.NoPeriod):
        rl.find_cycles(made.motion)
