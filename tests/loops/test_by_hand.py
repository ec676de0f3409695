"""Loops of frames that a person chose."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.cli import app
from roundelay.geometry import rotations as rot
from roundelay.loops.by_hand import CloseOptions, close_by_hand
from roundelay.motion.features import point_cloud


@pytest.fixture(scope="module")
def idle():
    """What never repeats."""
    return synth.wander(6.0, fps=60.0, seed=4).motion


def around(made):
    """Two periods, one behind the other."""
    again = made.again.rotations[0, 0]
    gained = rot.multiply(again, rot.conjugate(made.loop.rotations[0, 0]))
    turned = made.loop.rotations.copy()
    turned[:, 0] = rot.multiply(gained, turned[:, 0])
    way = rot.rotate(gained, made.loop.root_path - made.loop.root_path[0])
    return (
        np.concatenate([made.loop.rotations, turned]),
        np.concatenate([made.loop.root_path, way + made.again.root_path[0]]),
    )


@pytest.mark.parametrize("ping_pong", [False, True])
@pytest.mark.parametrize("turning", [None, 0.6])
def test_the_join_is_no_harder_than_the_rest(idle, ping_pong, turning):
    motion = idle if turning is None else synth.gait("walk", turning=turning, fps=60).motion
    made = close_by_hand(motion, (40, 150), CloseOptions(ping_pong=ping_pong))
    rotations, path = around(made)
    count = len(made.loop)
    steps = rot.to_rotation_vector(rot.multiply(rot.conjugate(rotations[:-1]), rotations[1:]))
    changes = np.linalg.norm(np.diff(steps, axis=0), axis=-1).max(axis=1)
    beside = np.r_[changes[: count - 3], changes[count + 2 :]].max()
    assert changes[count - 3 : count + 2].max() <= 1.5 * beside
    kinks = np.linalg.norm(np.diff(path, n=2, axis=0), axis=1)
    assert (
        kinks[count - 2 : count + 1].max() <= 1.5 * np.delete(kinks, slice(count - 3, None)).max()
    )


def test_near_ends_are_taken_where_they_fit_best():
    motion = synth.gait("walk", repetitions=4, fps=60).motion
    period = 1.1 * 60
    made = close_by_hand(motion, (30, 30 + round(1.1 * period)))
    start, stop = made.frames
    assert stop - start == pytest.approx(period, abs=1)
    assert made.apart < 0.01
    reach = 0.15 * round(1.1 * period) + 1
    assert abs(start - 30) <= reach
    assert abs(stop - 30 - round(1.1 * period)) <= reach
    travel = made.again.root_path[0] - made.loop.root_path[0]
    assert np.linalg.norm(travel) == pytest.approx(
        np.linalg.norm(rl.find_cycles(motion)[0].travel), rel=0.05
    )


@pytest.mark.parametrize("seed", range(4))
def test_the_ends_are_found_in_noise(seed):
    motion = synth.gait("walk", repetitions=4, noise=0.01, seed=seed).motion
    made = close_by_hand(motion, (60, 205))
    assert made.frames[1] - made.frames[0] == pytest.approx(132, abs=1)
    # What noise of half a degree seems to turn at the ends is not carried on.
    assert made.largest < np.radians(4.0)


def test_the_turning_points_are_found_in_noise():
    clean = synth.wander(6.0, seed=4).motion
    turns = np.random.default_rng(4).normal(0.0, 0.003, (*clean.rotations.shape[:-1], 3))
    rotations = rot.multiply(clean.rotations, rot.from_rotation_vector(turns))
    there = CloseOptions(ping_pong=True)
    wanted = close_by_hand(clean, (120, 360), there).frames
    found = close_by_hand(replace(clean, rotations=rotations), (120, 360), there).frames
    assert found == pytest.approx(wanted, abs=5)


def test_frames_beyond_the_fade_are_as_they_were(idle):
    made = close_by_hand(idle, (60, 200), CloseOptions(fade=0.2))
    start, stop = made.frames
    assert np.array_equal(made.loop.rotations[12:], idle.rotations[start + 12 : stop])
    assert rot.angle_between(made.loop.rotations[0, 1:], idle.rotations[stop, 1:]).max() < 1e-6


def test_there_and_back_is_a_mirror_of_itself_and_rests_at_its_ends(idle):
    made = close_by_hand(idle, (60, 200), CloseOptions(ping_pong=True))
    points = point_cloud(made.loop)
    assert np.allclose(points[1:], points[1:][::-1], atol=1e-9)
    pace = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert pace[[0, -1, len(pace) // 2]].max() < 0.3 * pace.max()
    assert np.allclose(made.again.root_path, made.loop.root_path[0])


@pytest.mark.parametrize(
    ("frames", "words"),
    [("100:104", "shorter than a step"), ("100:99999", "expected frames"), (None, "--frames")],
)
def test_what_cannot_be_closed_is_refused_in_one_line(tmp_path, idle, frames, words):
    capture = tmp_path / "idle.bvh"
    rl.write(idle, capture)
    given = ["close", str(capture), "-o", str(tmp_path)]
    found = CliRunner().invoke(app, given + ([] if frames is None else ["--frames", frames]))
    assert found.exit_code == 2
    assert words in found.output
    assert found.output.strip().count("\n") == 0


def test_the_command_says_that_it_was_closed_by_hand(tmp_path, idle):
    capture = tmp_path / "idle.bvh"
    rl.write(idle, capture)
    given = ["close", str(capture), "-o", str(tmp_path), "--frames", "60:200"]
    found = CliRunner().invoke(app, given)
    assert found.exit_code == 0
    assert "closed by hand" in found.output
    record = json.loads((tmp_path / "idle_closed.json").read_text())
    assert record["kind"] == "closed by hand"
    assert record["asked"] == [60, 200]
    assert len(rl.read(tmp_path / "idle_closed.bvh")) == record["loop_frames"]
    again = [*given, "--ping-pong", "--format", "glb", "--json"]
    told = json.loads(CliRunner().invoke(app, again).output)
    start, stop = told["frames"]
    assert told["loop_frames"] == 2 * (stop - start) + 1


def closed(tmp_path, motion, *words):
    """What the command writes of a capture, as it is read, and its record."""
    capture = tmp_path / "idle.bvh"
    rl.write(motion, capture)
    given = ["close", str(capture), "--frames", "60:200", "--json", *map(str, words)]
    shown = CliRunner().invoke(app, given)
    assert shown.exit_code == 0, shown.output
    return json.loads(shown.stdout)


def test_it_is_written_for_a_program_as_other_loops_are(tmp_path, idle):
    told = closed(tmp_path, idle, "--for", "godot", "-o", f"{tmp_path}/")
    assert told["files"] == ["idle_closed.glb"]
    (length,) = np.frombuffer((tmp_path / "idle_closed.glb").read_bytes()[12:16], "<u4")
    document = json.loads((tmp_path / "idle_closed.glb").read_bytes()[20 : 20 + length])
    assert document["animations"][0]["name"].endswith("-loop")
    made = rl.read(tmp_path / "idle_closed.glb")
    assert made.fps == pytest.approx(30)
    assert made.skeleton.names[0] == "root"
    assert told["loop_frames"] == len(made) == round(told["period_seconds"] * 30) + 1


def test_the_curve_goes_through_its_frames(idle):
    made = close_by_hand(idle, (60, 200))
    shown = made.cycle().sample(foot_lock=False)
    assert np.abs(point_cloud(shown) - point_cloud(made.loop)).max() < 1e-3
    ways = shown.root_path - shown.root_path[0], made.loop.root_path - made.loop.root_path[0]
    assert np.abs(ways[0] - ways[1]).max() < 1e-3


def test_a_file_is_named_as_in_other_commands(tmp_path, idle):
    closed(tmp_path, idle, "-o", tmp_path / "new" / "x.glb")
    assert sorted(path.name for path in (tmp_path / "new").iterdir()) == ["x.glb", "x.json"]
    over = ["close", str(tmp_path / "idle.bvh"), "--frames", "60:200"]
    shown = CliRunner().invoke(app, [*over, "-o", str(tmp_path / "idle.bvh")])
    assert (shown.exit_code, "than the capture itself" in shown.stderr) == (2, True)
