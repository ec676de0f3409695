"""The main job end to end, on real and on synthetic captures."""

from __future__ import annotations

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth


def test_ten_jumps_are_found_in_two_tempos(jump_cycles):
    assert all(1.4 < cycle.period < 2.1 for cycle in jump_cycles)
    shown = [cycle.evidence.runs for cycle in jump_cycles]
    assert 8.5 < sum(cycle.evidence.repetitions for cycle in jump_cycles) < 10.5
    assert min(runs[0][0] for runs in shown) >= 1, "the T-pose is no part of it"
    # Between the fourth jump and the fifth, and the seventh and the eighth, he turns around; the
    # first is slower than the next three.
    assert sum(len(runs) for runs in shown) == 4


def test_what_is_refused_tells_its_best_candidate(jumps):
    options = rl.Options(frames=(1, 900), joints=("LeftUpLeg", "LeftLeg", "LeftFoot"))
    with pytest.raises(rl.NoPeriod, match="no periodic motion found: frames") as refusal:
        rl.find_cycles(jumps, options)
    assert refusal.value.evidence is not None
    assert "poses a period apart are hardly alike" in str(refusal.value)


def test_the_walk_in_the_playground_is_found(captures):
    (cycle,) = rl.find_cycles(rl.read(captures / "01_03.bvh"))
    assert cycle.evidence.runs[0][0] == 1
    assert cycle.evidence.runs[0][1] < 350
    assert 1.2 < cycle.period < 1.45


@pytest.mark.parametrize("kind", ["walk", "run", "jacks", "punch", "spin"])
@pytest.mark.parametrize("repetitions", [1.3, 2.5])
def test_period_and_phase_are_those_made(kind, repetitions):
    made = synth.gait(kind, repetitions=repetitions, unevenness=0.4)
    (cycle,) = rl.find_cycles(made.motion)
    assert cycle.period == pytest.approx(made.period, rel=0.01)
    assert cycle.evidence.repetitions == pytest.approx(repetitions, abs=0.15)


def test_wandering_has_no_cycle():
    for seed in range(4):
        with pytest.raises(rl.NoPeriod):
            rl.find_cycles(synth.wander(8.0, seed=seed).motion)


def test_standing_still_has_no_cycle():
    still = rl.concatenate([synth.wander(3, seed=1).motion[5:6]] * 200)
    with pytest.raises(rl.NoPeriod, match="nothing moves"):
        rl.find_cycles(still)


def test_several_motions_are_told_apart_and_recognised_again():
    walk = synth.gait("walk", repetitions=3, seed=1)
    jacks = synth.gait("jacks", repetitions=3.5, seed=1)
    made = synth.sequence(walk, jacks, synth.gait("walk", repetitions=3, seed=1))
    cycles = rl.find_cycles(made.motion)
    periods = sorted(cycle.period for cycle in cycles)
    assert periods == pytest.approx([1.1, 1.2], rel=0.03)
    walking = min(cycles, key=lambda cycle: cycle.period)
    assert len(walking.evidence.runs) == 2


def test_results_do_not_depend_on_rate_place_and_unit(jumps):
    there = rl.find_cycles(jumps[1:].resample(60.0).scaled(2.54))
    here = rl.find_cycles(jumps)
    assert len(there) == len(here)
    for one, other in zip(there, here, strict=True):
        assert one.period == pytest.approx(other.period, rel=0.02)
        assert len(one.evidence.runs) == len(other.evidence.runs)


def test_frames_and_joints_may_be_chosen(jumps):
    options = rl.Options(frames=(2100, 2700), joints=("LeftArm", "LeftForeArm", "LeftHand"))
    cycle = rl.find_cycles(jumps, options)[0]
    assert all(2100 <= start < stop <= 2700 for start, stop in cycle.evidence.runs)
    assert set(cycle.evidence.behaviour.joints) <= set(options.joints)


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"frames": (10, 5)}, ValueError),
        ({"frames": (0, 10**6)}, ValueError),
        ({"joints": ("Tail",)}, rl.SkeletonMismatch),
        ({"features": "shape"}, ValueError),
        ({"harmonics": 0}, ValueError),
        ({"most": -1}, ValueError),
        ({"method": "magic"}, ValueError),
        ({"proposers": ("magic",)}, ValueError),
        ({"topology": rl.TopologyOptions(prime=48)}, ValueError),
    ],
)
def test_wrong_options_are_refused(jumps, options, error):
    with pytest.raises(error, match=r"expected|no joint"):
        rl.find_cycles(jumps, rl.Options(**options))


def test_a_handful_of_frames_is_too_short(jumps):
    with pytest.raises(rl.TooShort, match="at least 8 frames"):
        rl.find_cycles(jumps[:5])


def test_progress_is_reported_and_cancels(jumps):
    seen = []
    rl.find_cycles(jumps[:900], progress=lambda fraction, stage: seen.append((fraction, stage)))
    fractions = [fraction for fraction, _ in seen]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    with pytest.raises(rl.Cancelled):
        rl.find_cycles(jumps[:900], progress=lambda *_: False)


def test_the_loop_has_no_seam(jump_cycles):
    loop = jump_cycles[0].sample(fps=60)
    again = jump_cycles[0].sample(fps=60, periods=2)
    steps = np.abs(np.diff(again.rotations, axis=0)).max(axis=(1, 2))
    assert len(again) == 2 * len(loop)
    assert steps[len(loop) - 1] <= steps.max()
    assert np.allclose(again.rotations[: len(loop)], loop.rotations)


def test_a_file_whose_hips_move_below_an_unmoving_root(jumps):
    """The same motion, put on the joint below a root that stands still."""
    made = synth.gait("walk", repetitions=3).motion
    old = made.skeleton
    skeleton = rl.Skeleton(
        ("World", *old.names),
        (-1, *(p + 1 for p in old.parents)),
        np.vstack([[0, 0, 0], old.offsets]),
    )
    still = np.zeros((len(made), 1, 4))
    still[..., 0] = 1.0
    moved = np.broadcast_to(skeleton.offsets, (len(made), skeleton.n_joints, 3)).copy()
    moved[:, 1] = made.root_path
    motion = rl.Motion(
        skeleton,
        np.hstack([still, made.rotations]),
        np.zeros((len(made), 3)),
        made.frame_time,
        moved,
    )
    (cycle,) = rl.find_cycles(motion)
    (plain,) = rl.find_cycles(made)
    assert cycle.period == pytest.approx(plain.period, rel=1e-3)
    assert np.allclose(cycle.travel, plain.travel, atol=0.02)
