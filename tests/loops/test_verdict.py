"""The verdict on a loop, as an animator reads it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.geometry import rotations as rot
from roundelay.loops.units import Lengths
from roundelay.loops.verdict import Verdict, verdict_of


def judged(
    motion: rl.Motion, change: Callable[[rl.Motion], rl.Motion] = lambda loop: loop, **how: object
) -> Verdict:
    cycle = rl.find_cycles(motion)[0]
    loop = change(cycle.sample(**how))
    figures = rl.quality(cycle, motion)
    return verdict_of(cycle, motion, loop, figures, in_place=bool(how.get("in_place")))


@pytest.fixture(scope="module")
def walk() -> rl.Motion:
    return synth.gait("walk", repetitions=5, fps=60).motion


@pytest.mark.parametrize(
    "how",
    [
        {},
        {"in_place": True},
        {"periods": 3},
        {"repeat_first": True},
        {"periods": 2, "repeat_first": True, "in_place": True},
        {"fps": 24},
    ],
)
def test_a_clean_loop_is_good_however_it_is_written(walk, how):
    assert judged(walk, **how) == Verdict("good")
    assert str(judged(walk, **how)) == "good"


@pytest.mark.parametrize("in_place", [False, True])
def test_a_loop_that_turns_is_good(in_place):
    turning = synth.gait("walk", repetitions=5, fps=60, turning=0.5).motion
    assert judged(turning, in_place=in_place).word == "good"


@pytest.mark.parametrize("periods", [1, 2])
def test_a_break_at_the_join_is_told(walk, periods):
    def broken(loop: rl.Motion) -> rl.Motion:
        path = loop.root_path.copy()
        path[:, 1] += np.linspace(0.0, 0.2, len(path))
        return replace(loop, root_path=path)

    verdict = judged(walk, broken, periods=periods)
    assert verdict.word == "do not use"
    assert "jerks where it is joined" in verdict.reasons[0]


@pytest.mark.parametrize("periods", [2, 3])
def test_a_break_at_every_join_is_told(walk, periods):
    """What one period is judged by does not hide behind the others."""

    def broken(loop: rl.Motion) -> rl.Motion:
        path = loop.root_path.copy()
        path[:, 1] += 0.2 * (np.arange(len(path)) % 66) / 66
        return replace(loop, root_path=path)

    assert judged(walk, broken, periods=periods) == judged(walk, broken)
    assert judged(walk, broken).word == "do not use"


@pytest.mark.parametrize(("metres", "word"), [(0.0, "good"), (0.1, "look"), (0.3, "do not use")])
def test_feet_that_slide_are_told_in_centimetres(jumps, jump_cycles, metres, word):
    """Feet that stand in the capture, in a loop that sways from side to side."""
    loop = jump_cycles[0].sample()
    phase = 2 * np.pi * np.arange(len(loop))[:, None] / len(loop)
    sway = metres / Lengths.of(jumps.skeleton).metres * np.sin(phase) * [1.0, 0.0, 0.0]
    swaying = replace(loop, root_path=loop.root_path + sway)
    verdict = verdict_of(jump_cycles[0], jumps, swaying, rl.quality(jump_cycles[0], jumps))
    assert verdict.word == word
    told = [reason.split(" slides ") for reason in verdict.reasons]
    assert [name for name, _ in told] == ["left foot", "right foot"] * (metres > 0.0)
    for _, figures in told:
        far, before = figures.removesuffix(" in the capture)").split(" cm (")
        more = float(far) - float(before.removesuffix(" cm"))
        assert 30 * metres < more < 400 * metres


@pytest.mark.parametrize(("kept", "word"), [(0.9, "good"), (0.55, "look"), (0.2, "do not use")])
def test_a_limb_that_moves_less_than_in_the_capture_is_told(walk, kept, word):
    def damped(loop: rl.Motion) -> rl.Motion:
        rotations = loop.rotations.copy()
        for joint in loop.skeleton.indices(["LeftShoulder", "LeftArm", "LeftForeArm"]):
            middle = rot.mean(rotations[:, joint])[None]
            share = np.full(len(loop), kept)
            rotations[:, joint] = rot.slerp(
                np.repeat(middle, len(loop), 0), rotations[:, joint], share
            )
        return replace(loop, rotations=rotations)

    verdict = judged(walk, damped)
    assert verdict.word == word
    assert [reason.split(" keeps ")[0] for reason in verdict.reasons] == ["left arm"] * (kept < 0.7)


def test_a_climb_is_told():
    made = synth.gait("walk", repetitions=5, fps=60)
    climb = 0.3 * made.phase[:, None] * [0.0, 1.0, 0.0]
    up = replace(made.motion, root_path=made.motion.root_path + climb)
    assert "climbs 30 cm a period" in judged(up).reasons
    assert "climbs 30 cm a period" in judged(up, in_place=True).reasons
    down = replace(made.motion, root_path=made.motion.root_path - climb)
    assert "sinks 30 cm a period" in judged(down).reasons


def test_few_repetitions_are_told():
    verdict = judged(synth.gait("walk", repetitions=1.97, fps=60).motion)
    assert verdict == Verdict("look", ("made of 1.9 repetitions only",))
    assert str(verdict) == "look: made of 1.9 repetitions only"


def test_what_stays_on_the_ground_is_judged_as_what_carries_itself(walk):
    """A bone for root motion, even far away, is no part of the body."""
    skeleton = rl.Skeleton(
        ("World", *walk.skeleton.names),
        (-1, *(parent + 1 for parent in walk.skeleton.parents)),
        np.vstack([[0.0, 0.0, 0.0], walk.skeleton.offsets]),
    )
    moved = np.tile(skeleton.offsets, (len(walk), 1, 1))
    moved[:, 1] = walk.root_path
    still = np.concatenate([rot.identity(len(walk), 1), walk.rotations], axis=1)
    hung = rl.Motion(skeleton, still, np.zeros((len(walk), 3)), walk.frame_time, moved)
    assert judged(hung).word == "good"


@pytest.mark.parametrize(
    ("factor", "metres"),
    [(1.0, 1.0), (10.0, 0.1), (100.0, 0.01), (1000.0, 0.001), (1 / 0.0254, 0.0254), (4.0, None)],
)
def test_the_unit_is_guessed_from_the_body(walk, factor, metres):
    lengths = Lengths.of(walk.scaled(factor).skeleton)
    assert lengths.metres == metres
    if metres is None:
        assert lengths.told(0.5 * lengths.size) == "0.5 body sizes"
        assert lengths.told_speed(2.0 * lengths.size).startswith("2 body sizes/s (")
    else:
        assert lengths.told(0.04 / metres) == "4 cm"
        assert lengths.told(0.004 / metres) == "0.4 cm"
        assert lengths.told_speed(1.25 / metres).startswith("1.25 m/s (")


@pytest.mark.parametrize("factor", [0.5, 2.0, 30.0])
def test_the_unit_is_that_of_the_body_before_it_was_resized(walk, factor):
    lengths = Lengths.of(walk.scaled(100.0 * factor).skeleton, factor)
    assert lengths.metres == 0.01
    assert lengths.told(5.0) == "5 cm"


def test_the_unit_of_the_bundled_captures_is_known(jumps):
    assert Lengths.of(jumps.skeleton).metres == pytest.approx(0.0564, abs=1e-4)


def test_an_unknown_origin_is_refused(walk):
    cycle = rl.find_cycles(walk)[0]
    figures, unknown = rl.quality(cycle, walk), replace(cycle, evidence=None)
    with pytest.raises(ValueError, match="expected a cycle found in a capture"):
        verdict_of(unknown, walk, cycle.sample(), figures)
