"""Where a cycle begins, and what happens in it."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.cli import app
from roundelay.cycles.edit.align import mirrored, shifted
from roundelay.cycles.events import begun, events_of, started
from roundelay.geometry import rotations as rot
from roundelay.loops.options import LoopOptions
from roundelay.loops.profiles import profiles
from roundelay.loops.recipe import made_loop, placed
from roundelay.motion.features import point_cloud


def ahead(motion, joint, way):
    """How far a joint is ahead of the hips, in frames (F,)."""
    places = motion.positions()
    names = motion.skeleton.names
    return (places[:, names.index(joint)] - places[:, names.index("Hips")]) @ way


def near(phase, other):
    return abs((phase - other + 0.5) % 1.0 - 0.5)


@pytest.fixture(scope="module")
def walk():
    return rl.find_cycles(synth.gait("walk", repetitions=3.4, seed=1).motion)[0]


@pytest.mark.parametrize("kind", ["walk", "run"])
@pytest.mark.parametrize("turning", [0.0, 0.4])
@pytest.mark.parametrize("method", ["harmonic", "centroid", "paper"])
def test_a_gait_begins_at_the_left_contact(kind, turning, method):
    made = synth.gait(kind, repetitions=3.4, turning=turning, seed=1)
    cycle = rl.find_cycles(made.motion, rl.Options(method=method))[0]
    loop = cycle.sample(200, in_place=True, foot_lock=False)
    way = cycle.velocity.constant / np.linalg.norm(cycle.velocity.constant)
    first = int(np.argmax(ahead(loop, "LeftFoot", way))) / len(loop)
    assert near(first, 0.0) < 0.01
    names = [event.name for event in events_of(cycle)]
    assert sorted(names) == ["left contact", "left off", "right contact", "right off"]
    assert near({e.name: e.phase for e in events_of(cycle)}["right contact"], 0.5) < 0.03


def test_loops_of_one_gait_are_in_step(walk):
    """Wherever their captures were cut."""
    motion = synth.gait("walk", repetitions=4.4, seed=1).motion
    late = rl.find_cycles(motion[57:])[0]
    grid = np.arange(64) / 64
    apart = rot.angle_between(late.rotations(grid)[:, 1:], walk.rotations(grid)[:, 1:])
    assert apart.max() < 0.05


def test_who_stays_in_place_makes_contact_along_the_facing():
    made = synth.gait("walk", repetitions=4).motion
    still = replace(made, root_path=made.root_path * made.up_vector)
    turn = rot.from_rotation_vector([0.0, 2.0, 0.0])
    rotations = still.rotations.copy()
    rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
    (cycle,) = rl.find_cycles(replace(still, rotations=rotations))
    way = rot.rotate(turn, np.array([0.0, 0.0, 1.0]))
    values = ahead(cycle.sample(200, foot_lock=False), "LeftFoot", way)
    assert near(int(np.argmax(values)) / len(values), 0.0) < 0.01


@pytest.mark.parametrize("apart", [0.0, 0.3])
def test_hips_at_one_place_or_above_each_other_have_no_way_ahead(walk, apart):
    """Of a body that stays in place: it has no facing then, and no contacts along it."""
    skeleton = walk.skeleton
    offsets = skeleton.offsets.copy()
    hips = skeleton.indices(["LeftUpLeg", "RightUpLeg"])
    offsets[hips] = [[0.0, 0.0, 0.0], [0.0, apart, 0.0]]
    upright = walk.pose.constant.copy()
    upright[:4] = (1.0, 0.0, 0.0, 0.0)
    waves = [part.copy() for part in (walk.pose.cosine, walk.pose.sine)]
    for part in waves:
        part[:, :4] = 0.0
    still = replace(
        walk,
        skeleton=replace(skeleton, offsets=offsets),
        pose=replace(walk.pose, constant=upright, cosine=waves[0], sine=waves[1]),
        velocity=replace(walk.velocity, constant=np.zeros(3)),
        turning=0.0,
    )
    assert events_of(still) == ()
    grid = np.arange(8) / 8
    assert np.isfinite(begun(still).rotations(grid)).all()
    with pytest.raises(ValueError, match="a left and a right foot, side by side"):
        started(still, "left")


def test_what_has_no_steps_begins_at_its_largest_event():
    one, other = (
        rl.find_cycles(footless(synth.gait("jacks", repetitions=4.2).motion)[cut:])[0]
        for cut in (0, 40)
    )
    grid = np.arange(64) / 64
    apart = rot.angle_between(one.rotations(grid)[:, 1:], other.rotations(grid)[:, 1:])
    assert apart.max() < 0.1
    assert events_of(one) == ()


def test_beginning_again_changes_nothing(walk):
    assert np.allclose(begun(shifted(walk, 0.3)).pose.sine, walk.pose.sine, atol=1e-4)
    contacts = {event.name: event.phase for event in events_of(mirrored(walk))}
    assert near(contacts["right contact"], 0.0) < 0.01


@pytest.mark.parametrize("start", ["right", 0.25, "frame:200"])
def test_a_loop_begins_where_it_is_told_to(walk, start):
    phase = {"right": {e.name: e.phase for e in events_of(walk)}["right contact"], 0.25: 0.25}
    expected = phase.get(start, walk.phase[200])
    loop = started(walk, start).sample(foot_lock=False)
    there = walk.rotations([expected])[0, 1:]
    assert rot.angle_between(loop.rotations[0, 1:], there).max() < 1e-6
    assert started(walk, "left").pose.sine == pytest.approx(walk.pose.sine, abs=1e-4)


def frames_off(motion, render, cycle, frame):
    """How many frames the nearest pose of a loop is behind its first."""
    render = replace(render, start=f"frame:{frame}", foot_lock=False, repair=False)
    shown = point_cloud(made_loop(cycle, motion, render).motion.with_root_motion())
    pose = point_cloud(placed(motion, render).with_root_motion())[frame]
    count = len(shown)
    nearest = int(np.argmin(np.linalg.norm(shown - pose, axis=1)))
    return abs((nearest + count // 2) % count - count // 2)


@pytest.mark.parametrize("render", [LoopOptions(), LoopOptions(mirror=True, resize=2.0)])
def test_the_first_frame_shows_the_pose_of_the_frame(jumps, jump_cycles, render):
    """Also where a repetition strays from the mean of all."""
    motion = synth.gait("punch", repetitions=4, unevenness=0.3, noise=0.003, seed=2).motion
    for cycle in rl.find_cycles(motion, rl.Options(method="take")):
        assert max(frames_off(motion, render, cycle, n) for n in range(5, 300, 23)) <= 1
    for frame in (260, 320, 1300, 1450, 2250, 2500):
        assert frames_off(jumps, render, jump_cycles[0], frame) <= 1


@pytest.mark.parametrize("start", ["middle", "frame:", "frame:-3", "frame:x", 1.0, -0.1])
def test_another_start_is_refused(start):
    with pytest.raises(ValueError, match="start"):
        LoopOptions(start=start)


def test_a_start_that_is_not_there_is_refused(walk):
    with pytest.raises(ValueError, match="found 99999"):
        started(walk, "frame:99999")
    with pytest.raises(ValueError, match="a cycle of one capture"):
        started(replace(walk, phase=None), "frame:3")


def test_markers_name_the_events(walk):
    told = profiles["generic"].record(walk, LoopOptions(fps=30))
    events = {one["name"]: one for one in told["markers"]}
    assert events["left contact"]["phase"] == 0.0
    right = events["right contact"]
    assert right["frame"] == pytest.approx(right["phase"] * told["frames_per_period"])


def footless(motion):
    """The same without legs."""
    names = [name for name in motion.skeleton.names if "Leg" not in name and "Foot" not in name]
    return motion.select(names)


def test_without_feet_the_command_says_so_in_one_line(tmp_path):
    capture = tmp_path / "arms.bvh"
    rl.write(footless(synth.gait("jacks", repetitions=4).motion), capture)
    given = ["loop", str(capture), "-o", str(tmp_path), "--no-picture"]
    found = CliRunner().invoke(app, [*given, "--start", "left"])
    assert found.exit_code == 2
    assert found.output.strip().count("\n") == 0
    assert "expected a left and a right foot" in found.output
    assert CliRunner().invoke(app, given).exit_code == 0


def test_the_command_begins_at_a_phase(tmp_path):
    capture = tmp_path / "walk.bvh"
    rl.write(synth.gait("walk", repetitions=4).motion, capture)
    given = ["loop", str(capture), "-o", str(tmp_path), "--no-picture", "--start"]
    firsts = []
    for start in ("left", "right", "0.5"):
        assert CliRunner().invoke(app, [*given, start]).exit_code == 0
        firsts.append(rl.read(tmp_path / "walk_loop.bvh").rotations[0, 1:])
        record = json.loads((tmp_path / "walk_loop.json").read_text())
        assert str(record["sampling"]["start"]) == start
    assert rot.angle_between(firsts[0], firsts[1]).max() > 0.3
    assert rot.angle_between(firsts[1], firsts[2]).max() < 0.1
