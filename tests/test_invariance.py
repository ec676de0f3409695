"""What a motion is does not depend on where, in which unit or in which order it is written."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.cycles.edit.align import mirrored
from roundelay.cycles.events import begun
from roundelay.geometry import rotations as rot
from roundelay.loops.quality import quality

PHASE = np.linspace(0.0, 1.5, 40)
# Body sizes: how much a value is smoothed is chosen for each of the world's axes by itself.
NEAR = 5e-4


@pytest.fixture(scope="module")
def walk() -> rl.Motion:
    return synth.gait("walk", repetitions=2.6, turning=0.4, noise=0.003, unevenness=0.2).motion


@pytest.fixture(scope="module")
def cycle(walk: rl.Motion) -> rl.Cycle:
    return rl.find_cycles(walk)[0]


def turned(motion: rl.Motion, turn: np.ndarray, up: int = 1) -> rl.Motion:
    """The motion in a world that is turned."""
    rotations = motion.rotations.copy()
    rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
    path = rot.rotate(turn, motion.root_path)
    return replace(motion, rotations=rotations, root_path=path, up=up)


def places(cycle: rl.Cycle) -> np.ndarray:
    """Positions (n, J, 3) of the joints over one and a half periods, from where it begins."""
    found = cycle.at(PHASE, frame_time=0.01).positions()
    return found - found[0, 0]


@pytest.mark.parametrize("method", ["harmonic", "paper", "centroid"])
def test_heading_does_not_matter(walk, method):
    turn = rot.from_rotation_vector([0.0, 2.1, 0.0])
    options = rl.Options(method=method)
    here, there = (rl.find_cycles(one, options)[0] for one in (walk, turned(walk, turn)))
    assert there.evidence.runs == here.evidence.runs
    assert there.period == pytest.approx(here.period, rel=1e-9)
    assert np.allclose(
        places(there), rot.rotate(turn, places(here)), atol=NEAR * walk.skeleton.size
    )


@pytest.mark.parametrize("up", [0, 2])
@pytest.mark.parametrize("method", ["harmonic", "paper", "centroid"])
def test_any_axis_may_point_up(walk, method, up):
    # X, Y, Z become one another in turn.
    shift = {2: 1, 0: -1}[up]
    turn = rot.from_rotation_vector(np.full(3, shift * 2 * np.pi / 3 / np.sqrt(3)))
    assert np.allclose(rot.rotate(turn, np.eye(3)[1]), np.eye(3)[up])
    options, other = rl.Options(method=method), turned(walk, turn, up)
    here, there = (rl.find_cycles(one, options)[0] for one in (walk, other))
    assert there.period == pytest.approx(here.period, rel=1e-9)
    assert there.turning == pytest.approx(here.turning, abs=1e-6)
    assert np.allclose(
        places(there), rot.rotate(turn, places(here)), atol=NEAR * walk.skeleton.size
    )
    loops = [one.sample(60, periods=2, heading=None).positions() for one in (here, there)]
    assert np.allclose(loops[1], rot.rotate(turn, loops[0]), atol=1e-3 * walk.skeleton.size)
    figures = [quality(c, m) for c, m in ((here, walk), (there, other))]
    assert figures[1].loop_skate == pytest.approx(figures[0].loop_skate, rel=0.02, abs=1e-4)
    assert figures[1].template_error == pytest.approx(figures[0].template_error, rel=1e-3)


@pytest.mark.parametrize("factor", [0.01, 2.54, 1000.0])
def test_the_unit_does_not_matter(walk, cycle, factor):
    there = rl.find_cycles(walk.scaled(factor))[0]
    assert there.evidence.runs == cycle.evidence.runs
    assert there.period == pytest.approx(cycle.period, rel=1e-6)
    assert np.allclose(places(there), factor * places(cycle), atol=1e-4 * factor)
    assert quality(there, walk.scaled(factor)).seam_velocity == pytest.approx(
        quality(cycle, walk).seam_velocity, rel=1e-3
    )


def test_backwards_in_time_it_is_the_same_period(walk, cycle):
    back = replace(walk, rotations=walk.rotations[::-1], root_path=walk.root_path[::-1])
    there = rl.find_cycles(back)[0]
    assert there.period == pytest.approx(cycle.period, rel=0.005)
    assert there.evidence.repetitions == pytest.approx(cycle.evidence.repetitions, abs=0.05)
    assert there.turning == pytest.approx(-cycle.turning, abs=0.02)
    speed = [np.linalg.norm(one.travel) for one in (there, cycle)]
    assert speed[0] == pytest.approx(speed[1], rel=0.01)


def test_the_order_of_joints_does_not_matter(walk, cycle):
    # Children of a joint in the reverse order, each joint followed by what hangs on it.
    order: list[int] = []
    todo = [0]
    while todo:
        order.append(todo.pop())
        todo += [j for j, p in enumerate(walk.skeleton.parents) if p == order[-1]]
    place = {joint: number for number, joint in enumerate(order)}
    skeleton = rl.Skeleton(
        tuple(walk.skeleton.names[joint] for joint in order),
        tuple(place.get(walk.skeleton.parents[joint], -1) for joint in order),
        walk.skeleton.offsets[order],
        tuple((place[joint], offset) for joint, offset in walk.skeleton.end_sites),
    )
    assert order != sorted(order)
    there = rl.find_cycles(replace(walk, skeleton=skeleton, rotations=walk.rotations[:, order]))[0]
    assert there.period == pytest.approx(cycle.period, rel=1e-6)
    assert np.allclose(places(there), places(cycle)[:, order], atol=1e-4 * walk.skeleton.size)


def test_the_cycle_of_the_mirrored_motion_is_the_mirrored_cycle(walk, cycle):
    there = rl.find_cycles(walk.mirror())[0]
    assert there.period == pytest.approx(cycle.period, rel=1e-6)
    assert np.allclose(
        places(there), places(begun(mirrored(cycle))), atol=1e-3 * walk.skeleton.size
    )


@pytest.mark.parametrize("method", ["harmonic", "paper", "centroid"])
def test_bones_that_could_change_length_but_do_not(walk, method):
    still = np.broadcast_to(walk.skeleton.offsets, (*walk.rotations.shape[:2], 3))
    options = rl.Options(method=method)
    here, there = (
        rl.find_cycles(one, options)[0] for one in (walk, replace(walk, translations=still))
    )
    assert there.period == pytest.approx(here.period, rel=1e-9)
    assert np.allclose(places(there), places(here), atol=1e-6 * walk.skeleton.size)


@pytest.mark.parametrize("fps", [24.0, 30.0, 60.0, 240.0])
def test_the_frame_rate_matters_little(walk, cycle, fps):
    there = rl.find_cycles(walk.resample(fps))[0]
    assert there.period == pytest.approx(cycle.period, rel=0.01)
    assert there.evidence.repetitions == pytest.approx(cycle.evidence.repetitions, abs=0.1)
    assert rl.cycle_distance(there, cycle) < 0.01
