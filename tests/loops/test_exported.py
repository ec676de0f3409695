"""Loops as engines want them: unit, axes, facing, root bone."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

import roundelay as rl
from roundelay import synth
from roundelay.geometry import rotations as rot
from roundelay.loops.exported import exported, placement
from roundelay.loops.presets import Target
from roundelay.loops.recipe import placed

TARGETS = get_args(Target)


@pytest.fixture(scope="module")
def walk() -> rl.Cycle:
    return rl.find_cycles(synth.gait("walk", repetitions=3, turning=0.4).motion)[0]


@pytest.fixture(scope="module")
def z_up(walk) -> rl.Cycle:
    made = synth.gait("walk", repetitions=3).motion
    turn = rot.from_rotation_vector([np.pi / 2, 0.0, 0.0])
    turns = made.rotations.copy()
    turns[:, 0] = rot.multiply(turn, turns[:, 0])
    path = rot.rotate(turn, made.root_path)
    return rl.find_cycles(rl.Motion(made.skeleton, turns, path, made.frame_time, up=2))[0]


def front(motion: rl.Motion) -> np.ndarray:
    points = motion.positions()
    left, right = motion.skeleton.indices(["LeftUpLeg", "RightUpLeg"])
    return np.cross((points[:, left] - points[:, right]).mean(axis=0), motion.up_vector)


def test_without_a_target_nothing_changes(walk):
    options = rl.LoopOptions()
    assert (options.file_format, options.unit, options.in_place) == ("bvh", "file", False)
    ours, plain = exported(walk, options), walk.sample()
    assert ours.skeleton is plain.skeleton
    assert np.array_equal(ours.rotations, plain.rotations)


@pytest.mark.parametrize("target", TARGETS)
def test_what_is_given_overrules_the_preset(target):
    given = {"fps": 48.0, "in_place": False, "repeat_first": True}
    given |= {"unit": "file", "up": "z", "face_forward": False, "root_bone": False}
    options = rl.LoopOptions(target=target, **given)
    assert {name: getattr(options, name) for name in given} == given


def test_formats_are_those_that_programs_read():
    formats = {target: rl.LoopOptions(target=target).file_format for target in TARGETS}
    assert formats["godot"] == formats["web"] == "glb"
    assert formats["unity"] == formats["unreal"] == formats["maya"] == "fbx"
    assert rl.LoopOptions(target="web").first_repeated
    assert not rl.LoopOptions(target="blender").first_repeated
    with pytest.raises(ValueError, match=r"that unity reads \(fbx\), found 'glb'"):
        rl.LoopOptions(target="unity", file_format="glb")


def test_the_unit_is_that_which_readers_of_the_format_take():
    assert rl.LoopOptions(target="blender").unit == "m"
    assert rl.LoopOptions(target="blender", file_format="fbx").unit == "cm"
    assert rl.LoopOptions(file_format="fbx").unit == "file"
    assert rl.LoopOptions(target="blender").in_format("fbx").unit == "cm"
    assert rl.LoopOptions(target="blender", unit="file").in_format("fbx").unit == "file"


def test_lengths_are_in_the_unit(walk, jump_cycles):
    for cycle in (walk, jump_cycles[0]):
        metres, centimetres = (
            exported(cycle, rl.LoopOptions(unit=unit)).skeleton.size for unit in ("m", "cm")
        )
        assert 0.5 < metres < 2.5
        assert centimetres == pytest.approx(100 * metres)


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_a_resized_body_is_so_much_larger_in_any_unit(walk, factor):
    sizes = []
    for resize in (1.0, factor):
        options = rl.LoopOptions(target="web", resize=resize)
        cycle = placed(walk, options)
        assert placement(cycle, options).metres == 1.0
        sizes.append(exported(cycle, options).skeleton.size)
    assert sizes[1] == pytest.approx(factor * sizes[0])


def test_an_unknown_unit_stays(walk):
    giant = replace(walk, skeleton=walk.skeleton.scaled(1e6))
    options = rl.LoopOptions(target="unity")
    assert placement(giant, options).metres is None
    assert exported(giant, options).skeleton.size == pytest.approx(giant.skeleton.size)


@pytest.mark.parametrize("target", TARGETS)
def test_bodies_face_the_front(walk, z_up, jump_cycles, target):
    for cycle in (walk, z_up, jump_cycles[0]):
        options = rl.LoopOptions(target=target, in_place=True)
        seen = front(exported(cycle, options))
        seen /= np.linalg.norm(seen)
        assert np.allclose(seen, [0.0, 0.0, 1.0], atol=0.05)


def test_z_up_is_kept_or_turned_skeleton_and_all(z_up):
    kept = exported(z_up, rl.LoopOptions(face_forward=True, in_place=True))
    turned = exported(z_up, rl.LoopOptions(face_forward=True, up="y", in_place=True))
    assert (kept.up, turned.up) == (2, 1)
    there = kept.positions()[..., [0, 2, 1]] * [1.0, 1.0, -1.0]
    assert np.allclose(turned.positions(), there, atol=1e-9)
    assert np.allclose(front(kept)[[0, 2]], 0.0, atol=0.05)


def test_a_bone_on_the_ground_glides_and_the_body_stays_where_it_is(walk, jump_cycles):
    for cycle in (walk, jump_cycles[0]):
        options = rl.LoopOptions(root_bone=True, repeat_first=True, fps=30.0)
        loop, plain = exported(cycle, options), cycle.sample(30.0, repeat_first=True)
        names = [name for name in plain.skeleton.names if name in loop.skeleton.names]
        ours = loop.positions()[:, loop.skeleton.indices(names)]
        assert np.allclose(ours, plain.positions()[:, plain.skeleton.indices(names)], atol=1e-9)
        assert np.allclose(loop.root_path[:, loop.up], 0.0, atol=1e-9)
        assert np.ptp(np.linalg.norm(np.diff(loop.root_path, axis=0), axis=1)) < 1e-6 * cycle.speed
        way = loop.root_path[-1] - loop.root_path[0]
        assert np.linalg.norm(way) == pytest.approx(np.linalg.norm(cycle.travel[[0, 2]]), rel=0.05)


def test_the_root_bone_takes_a_name_that_is_free(walk):
    assert exported(walk, rl.LoopOptions(root_bone=True)).skeleton.names[0] not in (
        walk.skeleton.names
    )


def test_godot_repeats_what_its_name_says(walk):
    assert exported(walk, rl.LoopOptions(target="godot")).name.endswith("-loop")


def test_names_that_an_engine_takes_for_one_are_refused(walk):
    names = list(walk.skeleton.names)
    names[-1] = names[-2].upper()
    alike = replace(walk, skeleton=replace(walk.skeleton, names=tuple(names)))
    with pytest.raises(ValueError, match=r"^expected joints that unreal can tell apart, found"):
        exported(alike, rl.LoopOptions(target="unreal"))
