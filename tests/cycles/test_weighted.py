"""[C]'s regression as a method of the main job, on motion whose truth is known and on captures."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import roundelay as rl
from roundelay import synth
from roundelay.cli import app
from roundelay.cycles.models.weighted import paper_cycle
from roundelay.geometry import rotations as rot
from roundelay.loops.quality import quality

PAPER = rl.Options(method="paper")


@pytest.fixture(scope="module")
def made() -> synth.Synthetic:
    return synth.gait("walk", repetitions=4, noise=0.01)


def apart(cycle: rl.Cycle, motion: rl.Motion) -> float:
    """Return the largest mean angle of joints from the loop's poses to the nearest of a motion."""
    poses = cycle.rotations(np.arange(100) / 100)[:, 1:]
    angles = rot.angle_between(poses[:, None], motion.rotations[None, :, 1:]).mean(axis=2)
    return float(angles.min(axis=1).max())


def test_the_loop_is_the_motion(made):
    clean = synth.gait("walk", repetitions=1).motion
    (cycle,) = rl.find_cycles(made.motion, PAPER)
    (default,) = rl.find_cycles(made.motion)
    assert apart(cycle, clean) < 0.03
    assert cycle.period == default.period
    assert cycle.travel == pytest.approx(default.travel, abs=0.01 * np.ptp(default.travel))


def test_constraints_keep_the_speed(captures):
    """What [C] has them for: without, the loop follows each frame and is rougher."""
    walk = rl.read(captures / "01_03.bvh")
    default = rl.find_cycles(walk)[0]
    speed, rough = {}, {}
    for used in ((True, True), (True, False), (False, True), (False, False)):
        cycle = paper_cycle(default, walk, velocity=used[0], acceleration=used[1])
        speed[used] = quality(cycle, walk).velocity_error
        # The third derivative of the curves themselves, before feet or limbs are put right.
        rough[used] = float(np.sqrt(np.mean(cycle.pose(np.arange(200) / 200, derivative=3) ** 2)))
    assert speed[True, True] < speed[True, False] < speed[False, True] < speed[False, False]
    assert rough[False, False] > 1.5 * max(rough[True, False], rough[False, True])


@pytest.mark.parametrize("method", ["harmonic", "centroid"])
def test_other_methods_have_no_constraints(made, method):
    for switched in ({"velocity": False}, {"acceleration": False}):
        with pytest.raises(ValueError, match="left out of the method 'paper' only"):
            rl.find_cycles(made.motion, rl.Options(method=method, **switched))


def test_differences_stay_within_runs(jumps, jump_cycles):
    """Three runs of jumps in different directions make one closed loop that travels as far."""
    cycle = rl.find_cycles(jumps, PAPER)[0]
    assert len(cycle.evidence.runs) == 3
    figures, default = quality(cycle, jumps), quality(jump_cycles[0], jumps)
    assert figures.template_error < 1.3 * default.template_error
    assert figures.seam_rotation <= figures.step_rotation
    # Differences weigh each frame alike, the default each repetition: the first jump is shorter.
    travel = [np.linalg.norm(one.travel) for one in (cycle, jump_cycles[0])]
    assert travel[0] == pytest.approx(travel[1], rel=0.1)


def test_a_walk_on_a_circle_stays_one():
    motion = synth.gait("walk", repetitions=2.6, turning=0.8).motion
    cycle, default = (rl.find_cycles(motion, options)[0] for options in (PAPER, None))
    assert cycle.turning == default.turning
    assert np.linalg.norm(cycle.travel - default.travel) < 0.03 * np.linalg.norm(default.travel)


@pytest.mark.parametrize("turns", [1, 2])
def test_a_joint_that_turns_all_the_way_comes_back(turns):
    made = synth.gait("walk", repetitions=3.2)
    hand = made.motion.skeleton.index("LeftHand")
    spun = made.motion.rotations.copy()
    around = 2 * np.pi * turns * made.phase[:, None] * np.array([1.0, 0.0, 0.0])
    spun[:, hand] = rot.multiply(spun[:, hand], rot.from_rotation_vector(around))
    motion = replace(made.motion, rotations=spun)
    cycle = rl.find_cycles(motion, PAPER)[0]
    assert (cycle.odd_pose is not None) == (turns == 1)
    assert apart(cycle, motion) < 0.03
    loop = cycle.sample().rotations[:, hand]
    steps = rot.angle_between(loop, np.roll(loop, -1, axis=0))
    assert steps.sum() == pytest.approx(2 * np.pi * turns, rel=0.1)
    assert steps.max() < 1.5 * steps.mean()


@pytest.mark.parametrize("fps", [24.0, 30.0])
def test_one_closed_period_comes_back(captures, fps):
    """Where frames are few, [C]'s weights would be ratios of rounding errors."""
    motion = rl.find_cycles(rl.read(captures / "01_03.bvh"))[0].sample(fps=fps)
    cycle = rl.find_cycles(motion, replace(PAPER, frames=(0, len(motion))))[0]
    assert cycle.evidence.closed
    assert quality(cycle, motion).template_error < 0.05


def test_a_joint_that_flips_is_averaged(made):
    """Half a turn to and fro, as thumbs of captures do, leaves no sign to follow."""
    motion, hand = made.motion, made.motion.skeleton.index("RightHand")
    broken = motion.rotations.copy()
    flip = rot.from_rotation_vector(np.array([np.pi, 0.0, 0.0]))
    for start in (60, 190, 210, 330):
        broken[start : start + 12, hand] = rot.multiply(broken[start : start + 12, hand], flip)
    cycle = rl.find_cycles(replace(motion, rotations=broken), PAPER)[0]
    loop = cycle.sample().rotations[:, hand]
    assert np.median(rot.angle_between(loop, rot.mean(motion.rotations[:, hand]))) < 0.2


def test_what_it_cannot_do_is_said(made):
    cycle = rl.find_cycles(made.motion)[0]
    with pytest.raises(ValueError, match="with its evidence"):
        paper_cycle(replace(cycle, evidence=None), made.motion)


def test_the_command_offers_it(made, tmp_path: Path):
    capture = tmp_path / "walk.bvh"
    rl.write(made.motion, capture)
    arguments = ["loop", str(capture), "-o", str(tmp_path), "--no-picture", "--no-velocity"]
    result = CliRunner().invoke(app, [*arguments, "--method", "paper"])
    assert result.exit_code == 0, result.output
    options = json.loads((tmp_path / "walk_loop.json").read_text())["options"]
    used = {name: options[name] for name in ("method", "velocity", "acceleration")}
    assert used == {"method": "paper", "velocity": False, "acceleration": True}
    refused = CliRunner().invoke(app, arguments)
    assert refused.exit_code == 2
    assert "left out of the method 'paper' only" in refused.stderr


def test_a_joint_without_angles_is_named(made):
    """Two turns there and two back in a period: neither about a mean nor a steady turn."""
    hand = made.motion.skeleton.index("LeftHand")
    there_and_back = 1.0 - np.abs(1.0 - 2.0 * (made.phase[:, None] % 1.0))
    spun = made.motion.rotations.copy()
    spun[:, hand] = rot.continuous(
        rot.from_rotation_vector(there_and_back * np.array([4 * np.pi, 0.0, 0.0]))
    )
    with pytest.raises(ValueError, match="have none: LeftHand"):
        rl.find_cycles(replace(made.motion, rotations=spun), PAPER)


def test_the_path_is_modelled_axis_by_axis(made):
    """[C] 3.9: a line, harmonics alone, or nothing; the walk goes along one level axis."""
    (default,) = rl.find_cycles(made.motion, PAPER)
    ahead = int(np.argmax(np.abs(default.travel)))
    side = next(axis for axis in range(3) if axis not in (ahead, default.up))

    def of(*kinds: str) -> rl.Cycle:
        root = ",".join(f"{'xyz'[axis]}={kind}" for axis, kind in kinds)
        return rl.find_cycles(made.motion, replace(PAPER, root=tuple(root.split(","))))[0]

    still = of((ahead, "none"), (side, "none"), (default.up, "none"))
    path = still.root_path(np.linspace(0.0, 2.0, 50))
    assert np.ptp(path, axis=0).max() < 1e-9
    swaying = of((ahead, "periodic"), (side, "line"), (default.up, "periodic"))
    path = swaying.root_path(np.linspace(0.0, 1.0, 50))
    assert abs(path[-1, ahead] - path[0, ahead]) < 1e-6
    assert np.ptp(path[:, ahead]) > 0.0
    same = of((ahead, "line"), (side, "line"))
    assert same.travel == pytest.approx(default.travel)
    rising = of((default.up, "line"))
    assert rising.height.sine.max() == rising.height.cosine.max() == 0.0
    phases = np.linspace(0.0, 1.0, 50)
    bobs = np.ptp(default.root_path(phases)[:, default.up])
    assert np.ptp(rising.root_path(phases)[:, default.up]) == pytest.approx(bobs, rel=0.3)


@pytest.mark.parametrize(
    "words", [("x=up",), ("w=line",), ("x=line", "x=none"), ("line",), ()], ids=str
)
def test_a_model_of_the_path_that_is_none_is_refused(words):
    with pytest.raises(ValueError, match="expected root as"):
        rl.Options(method="paper", root=words)
    with pytest.raises(ValueError, match="expected root with the method 'paper' only"):
        rl.Options(root=("x=line",))


def test_the_command_line_takes_models_of_the_path(captures, tmp_path):
    capture = str(captures / "01_03.bvh")
    words = ["loop", capture, "-o", str(tmp_path), "--no-picture", "--most", "1"]
    result = CliRunner().invoke(
        app, [*words, "--method", "paper", "--root", "x=none,y=periodic,z=none"]
    )
    assert result.exit_code in (0, 3), result.stderr
    wrong = CliRunner().invoke(app, [*words, "--method", "paper", "--root", "x=sideways"])
    assert wrong.exit_code == 2
    assert "x, y or z = one of ('line', 'periodic', 'none')" in wrong.stderr
