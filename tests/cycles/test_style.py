"""The difference of two cycles laid on a third."""

from dataclasses import replace

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.cycles.edit.align import align, hung_as, mapped
from roundelay.geometry import rotations as rot

LEAN = np.array([0.3, 0.0, 0.0])


def leaning(cycle: rl.Cycle, joint: str = "Spine") -> rl.Cycle:
    """A cycle whose trunk leans, slower and lower by known amounts."""
    number = cycle.skeleton.index(joint)
    turn = rot.from_rotation_vector(LEAN)

    def leaned(values):
        rows = values.reshape(len(values), -1, 4).copy()
        rows[:, number] = rot.multiply(turn, rows[:, number])
        return rows.reshape(values.shape)

    return replace(
        cycle,
        pose=mapped(cycle.pose, leaned),
        period=1.2 * cycle.period,
        velocity=mapped(cycle.velocity, lambda v: 0.8 * v),
        height=replace(cycle.height, constant=cycle.height.constant - 0.05),
        name="old",
    )


@pytest.fixture(scope="module")
def walk():
    return rl.find_cycles(synth.gait("walk", rng=1).motion)[0]


@pytest.fixture(scope="module")
def run():
    return rl.find_cycles(synth.gait("run", rng=2, start=0.3).motion)[0]


@pytest.mark.parametrize("amount", [0.0, 0.5, 1.0, -1.0])
def test_a_known_difference_is_laid_on_another_cycle(walk, run, amount):
    made = rl.style(leaning(walk), walk).on(run, amount)
    grid = np.arange(40) / 40
    spine = run.skeleton.index("Spine")
    turns = rot.to_rotation_vector(
        rot.multiply(made.rotations(grid), rot.conjugate(run.rotations(grid)))
    )
    assert np.allclose(turns[:, spine], amount * LEAN, atol=0.02)
    assert np.allclose(np.delete(turns, spine, axis=1), 0.0, atol=0.02)
    assert made.period == pytest.approx(run.period * 1.2**amount, rel=1e-6)
    # Of a way in a period 0.8 is left.
    assert np.linalg.norm(made.travel) == pytest.approx(
        np.linalg.norm(run.travel) * 0.8**amount, rel=1e-6
    )
    assert np.allclose(made.height(grid), run.height(grid) - 0.05 * amount, atol=0.002)


def test_a_cycle_less_its_own_neutral_is_the_styled_one(walk):
    styled = leaning(walk)
    made = rl.style(styled, walk).on(walk)
    assert align(styled, made).distance < 0.005


def test_what_is_made_can_be_sampled_blended_and_written(walk, run, tmp_path):
    made = rl.style(leaning(walk), walk).on(run, 0.7)
    rl.write(made.sample(30), tmp_path / "old_run.bvh")
    assert len(rl.read(tmp_path / "old_run.bvh")) == round(30 * made.period)
    rl.blend([made, walk], [0.5, 0.5])


def test_other_skeletons_and_amounts_are_refused(walk):
    dog = rl.find_cycles(synth.gait("trot").motion)[0]
    with pytest.raises(rl.SkeletonMismatch, match="joints only in the first"):
        rl.style(walk, dog)
    with pytest.raises(rl.SkeletonMismatch, match="joints only in the first"):
        rl.style(walk, walk).on(dog)
    with pytest.raises(
        ValueError, match="expected amount as a number, at least 0 and at most 3, found 4"
    ):
        rl.style(walk, walk).on(walk, 4.0)
    with pytest.raises(TypeError, match="expected a Cycle"):
        rl.style(walk, None)


def below_a_root(motion: rl.Motion, offset: np.ndarray) -> rl.Motion:
    """The motion with an unmoving root at the origin, the hips at an offset from it."""
    own = motion.skeleton
    skeleton = rl.Skeleton(
        ("World", *own.names),
        (-1, *(parent + 1 for parent in own.parents)),
        np.concatenate(
            [np.zeros((1, 3)), own.offsets + (np.arange(len(own.names)) == 0)[:, None] * offset]
        ),
        tuple((joint + 1, place) for joint, place in own.end_sites),
    )
    frames = len(motion)
    still = np.tile([1.0, 0.0, 0.0, 0.0], (frames, 1, 1))
    moved = np.broadcast_to(skeleton.offsets, (frames, *skeleton.offsets.shape)).copy()
    moved[:, 1] = motion.root_path
    return rl.Motion(
        skeleton,
        np.concatenate([still, motion.rotations], axis=1),
        np.zeros((frames, 3)),
        motion.frame_time,
        moved,
        name=motion.name,
    )


def test_where_a_file_hangs_its_hips_says_nothing_of_the_body():
    motion = synth.gait("walk", rng=1, turning=0.2).motion
    near = rl.find_cycles(below_a_root(motion, np.array([0.0, 0.9, 0.0])))[0]
    far = rl.find_cycles(below_a_root(motion, np.array([0.3, 0.9, -4.0])))[0]
    found = align(near, far)
    assert found.distance < 0.01
    phase = np.linspace(0.0, 2.0, 30)
    here, there = (
        one.at(phase, frame_time=0.1).positions() for one in (far, hung_as(far, near.skeleton))
    )
    # Only where the path begins is another place.
    assert np.allclose(here - here[0, 1], there - there[0, 1], atol=1e-6)


def test_the_command_lays_a_style_on_a_loop(tmp_path):
    from typer.testing import CliRunner

    from roundelay.cli import app

    for name, seed in (("run", 3), ("walk", 1)):
        rl.write(synth.gait(name, rng=seed).motion, tmp_path / f"{name}.bvh")
    run, walk, out = tmp_path / "run.bvh", tmp_path / "walk.bvh", tmp_path / "out.bvh"
    words = ["blend", run, "--style", walk, walk, "--amount", ".5", "-o", out]
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exit_code == 0, result.output
    assert len(rl.read(out)) > 10
    result = CliRunner().invoke(app, ["blend", str(run), "--amount", ".5", "-o", str(out)])
    assert result.exit_code == 2
