"""Faults put into clean loops are named, clean ones have none, and what can be mended is clean."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.loops.lint import lint, phase_of_set, taken_apart
from roundelay.loops.mend import continued, mended
from roundelay.loops.unrolled import seen, steps_of


@pytest.fixture(scope="module", params=["walk", "run"])
def cycle(request):
    motion = synth.gait(request.param, turning=0.3).motion
    return rl.find_cycles(motion.scaled(1.9 / motion.skeleton.size))[0]


@pytest.fixture(scope="module")
def loop(cycle):
    # Not at the contact, where accelerations hide a small pop.
    return cycle.sample(60.0, start=0.25)


def names(motion, wraps=False, phase=None):
    return [fault.name for fault in lint(motion, wraps, phase)]


@pytest.mark.parametrize("fps", [24.0, 30.0, 120.0])
@pytest.mark.parametrize("start", [0.0, 0.3, 0.7])
@pytest.mark.parametrize("in_place", [False, True])
def test_clean_loops_have_no_fault(cycle, fps, start, in_place):
    asked = {"start": start, "in_place": in_place}
    assert names(cycle.sample(fps, **asked)) == []
    assert names(cycle.sample(fps, repeat_first=True, **asked), wraps=True) == []


def test_two_periods_are_clean(cycle):
    assert names(cycle.sample(60.0, periods=2)) == []


def test_a_fault_tells_what_was_measured(cycle):
    (fault,) = lint(cycle.sample(60.0, repeat_first=True), wraps=False)
    assert fault.name == "frame too many"
    assert fault.value == pytest.approx(1.0, abs=0.05)
    assert (fault.limit < 1.0, fault.unit) == (True, "frames")
    assert "the last frame repeats the first" in fault.says


@pytest.mark.parametrize("count", [1, 2, 3])
def test_frames_too_many(loop, count):
    assert "frame too many" in names(continued(loop, count))
    assert "frame too many" in names(continued(loop, count + 1), wraps=True)
    assert len(mended(continued(loop, count), wraps=False)) == len(loop)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_frames_missing(loop, count):
    assert "frame missing" in names(loop[:-count])
    assert "frame missing" in names(continued(loop, 1)[:-count], wraps=True)
    again = mended(loop[:-count], wraps=False)
    assert len(again) == len(loop)
    assert "frame missing" not in names(again)


def test_a_loop_for_players_gets_the_first_frame_behind_the_last(cycle):
    short, whole = cycle.sample(60.0), cycle.sample(60.0, repeat_first=True)
    assert names(short, wraps=True) == ["frame missing"]
    again = mended(short, wraps=True)
    assert names(again, wraps=True) == []
    away = np.abs(again.positions() - whole.positions()).max()
    assert away < 0.01 * whole.skeleton.size


def popped(loop, degrees):
    axes = np.random.default_rng(3).normal(size=(loop.skeleton.n_joints, 3))
    axes[0] = 0.0
    share = np.linspace(0.0, 1.0, len(loop))[:, None, None]
    turns = rot.from_rotation_vector(np.radians(degrees) * share * axes)
    return replace(loop, rotations=rot.multiply(loop.rotations, turns))


@pytest.mark.parametrize("periods", [2, 3])
@pytest.mark.parametrize("wraps", [False, True])
def test_a_pop_at_every_join_of_a_file_is_found_and_spread(loop, periods, wraps):
    """The joins between periods are not what the last one is measured by."""
    once = popped(loop, 6.0)
    bad = once
    for _ in range(1, periods):
        bad = continued(bad, len(once))
    bad = continued(bad, 1) if wraps else bad
    (alone,) = [fault for fault in lint(once, wraps=False) if fault.name == "pop"]
    (fault,) = [fault for fault in lint(bad, wraps) if fault.name == "pop"]
    assert fault.value == pytest.approx(alone.value, rel=1e-6)
    again = mended(bad, wraps)
    assert (names(again, wraps), len(again)) == ([], len(bad))


@pytest.mark.parametrize("degrees", [6.0, 12.0])
def test_a_pop_is_found_and_spread(loop, degrees):
    bad = popped(loop, degrees)
    assert "pop" in names(bad)
    assert "pop" in names(popped(continued(loop, 1), degrees), wraps=True)
    again = mended(bad, wraps=False)
    assert names(again) == []
    turned = rot.angle_between(again.rotations, bad.rotations)
    assert np.degrees(turned.max()) < 4 * degrees


def test_a_last_key_that_is_not_the_first_pops(loop):
    form = continued(loop, 1)
    rotations = form.rotations.copy()
    rotations[-1, 3] = rot.multiply(rotations[-1, 3], rot.from_rotation_vector([0.5, 0.0, 0.0]))
    assert "pop" in names(replace(form, rotations=rotations), wraps=True)


def faster(loop, speed):
    seconds = np.arange(len(loop))[:, None] * loop.frame_time
    ahead = loop.root_path[-1] - loop.root_path[0]
    ahead *= 1.0 - loop.up_vector
    way = speed * loop.skeleton.size * seconds * ahead / np.linalg.norm(ahead)
    return replace(loop, root_path=loop.root_path + way)


@pytest.fixture(scope="module")
def jump(jump_cycles):
    """A jump forward, of a person whose feet stand before and after."""
    loop = jump_cycles[0].sample(30.0)
    return loop.scaled(1.9 / loop.skeleton.size)


@pytest.mark.parametrize("speed", [0.15, 0.3, 0.6])
def test_feet_that_slide(jump, speed):
    assert names(jump) == []
    assert names(faster(jump, speed)) == ["foot slide"]


def climbing(loop, climb):
    share = np.arange(len(loop))[:, None] / len(loop)
    path = loop.root_path + climb * loop.skeleton.size * share * loop.up_vector
    return replace(loop, root_path=path)


@pytest.mark.parametrize("climb", [-0.1, 0.08])
def test_drift_is_found_and_taken_out(jump, climb):
    (fault,) = lint(climbing(jump, climb), wraps=False)
    assert fault.name == "drift"
    assert fault.value == pytest.approx(abs(climb), rel=0.2)
    again = mended(climbing(jump, climb), wraps=False)
    assert names(again) == []
    assert np.allclose(again.root_path, jump.root_path, atol=0.02 * jump.skeleton.size)


def test_on_stairs_a_climb_is_none(jump):
    """The body climbs while no foot stands."""
    stands = steps_of(seen(jump), len(jump)).standing.any(axis=1)
    share = np.cumsum(~stands) / np.count_nonzero(~stands)
    climb = 0.05 * jump.skeleton.size * share[:, None] * jump.up_vector
    stairs = replace(jump, root_path=jump.root_path + climb)
    assert "drift" not in names(stairs)


@pytest.mark.parametrize("factor", [4.0, 5.0])
def test_a_stride_that_takes_too_long(loop, factor):
    assert "rate" in names(replace(loop, frame_time=factor * loop.frame_time))
    assert "rate" in names(replace(loop, frame_time=loop.frame_time / factor))


@pytest.mark.parametrize("factor", [0.01, 0.1, 10.0, 100.0])
def test_units_of_a_format_in_metres(loop, factor):
    assert names(continued(loop, 1).scaled(factor), wraps=True) == ["unit"]


@pytest.mark.parametrize(("factor", "faults"), [(100.0, []), (1e4, ["unit"]), (0.01, ["unit"])])
def test_a_bvh_may_be_in_centimetres(loop, factor, faults):
    assert names(loop.scaled(factor)) == faults


def on_a_bone(loop, bob):
    """The loop below a root bone that moves along on the ground."""
    skeleton, up = loop.skeleton, loop.up_vector
    lowest = float((loop.positions() @ up).min())
    waves = 0.5 * bob * skeleton.size * np.sin(4 * np.pi * np.arange(len(loop)) / len(loop))
    path = loop.root_path * (1.0 - up) + (lowest + waves)[:, None] * up
    places = np.tile(np.vstack([np.zeros((1, 3)), skeleton.offsets]), (len(loop), 1, 1))
    places[:, 1] = loop.root_path - path
    made = Skeleton(
        ("root", *skeleton.names),
        (-1, *(parent + 1 for parent in skeleton.parents)),
        places.mean(axis=0),
        tuple((joint + 1, offset) for joint, offset in skeleton.end_sites),
    )
    turns = np.concatenate([rot.identity(len(loop), 1), loop.rotations], axis=1)
    return replace(loop, skeleton=made, rotations=turns, root_path=path, translations=places)


def test_a_root_bone_that_bobs(loop):
    assert names(on_a_bone(loop, 0.0)) == []
    assert names(on_a_bone(loop, 0.02)) == ["root bob"]


def test_a_gait_out_of_phase_with_its_set(cycle):
    loops = [cycle.sample(60.0, start=start) for start in (0.0, 0.02, 0.98, 0.4)]
    phases = [taken_apart(one, wraps=False).phase for one in loops]
    shared = phase_of_set(phases)
    assert [names(one, phase=shared) for one in loops] == [[], [], [], ["phase"]]


def test_a_set_without_a_phase_of_its_own():
    assert phase_of_set([0.1, 0.1]) is None
    assert phase_of_set([0.0, 0.25, 0.5, 0.75]) is None
    assert phase_of_set([0.98, 0.02, 0.5]) in (0.98, 0.02)


def test_a_loop_is_told_from_a_capture(cycle, loop):
    capture = synth.gait("walk", repetitions=5.7, fps=60).motion
    long = synth.gait("walk", repetitions=20, fps=60).motion
    for whole in (loop, popped(loop, 3.0), loop[:-3], continued(loop, 2), cycle.sample(periods=2)):
        assert taken_apart(whole, wraps=False).recognised
    for part in (capture, synth.wander(6.0, fps=60).motion, long[: 15 * 60]):
        assert not taken_apart(part, wraps=False).recognised


def test_what_is_no_gait_has_no_phase():
    cycle = rl.find_cycles(synth.gait("jacks").motion)[0]
    assert taken_apart(cycle.sample(), wraps=False).phase is None


def test_a_clean_loop_is_given_back_as_it_is(loop):
    assert mended(loop, wraps=False) is loop


def test_what_is_too_short_is_refused(loop):
    with pytest.raises(rl.TooShort, match="at least 8 frames, found 7"):
        lint(loop[:7], wraps=False)


def test_a_still_pose_has_no_fault(loop):
    still = loop.at(np.zeros(30))
    assert names(still) == []
