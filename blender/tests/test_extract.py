"""The button: from an action to loops."""

import math
import re
import time
from pathlib import Path

import bpy
import numpy as np
import pytest

import roundelay
from conftest import CAPTURES, drifting, import_capture
from inside import curves_of, extract, keys_of, pose_at
from rigs import choose
from roundelay.topology.kernel import compiled, engine


def span(action):
    return int(action.frame_start), int(action.frame_end)


def test_the_loop_is_a_cyclic_action_of_one_period(jumps):
    source = jumps.animation_data.action
    action = extract()
    assert action.name == f"Periodic {source.name}"
    assert action.use_cyclic and action.use_frame_range
    start, end = span(action)
    cycle = roundelay.find_cycles(roundelay.read(CAPTURES / "01_01.bvh"))[0]
    assert end - start == pytest.approx(round(cycle.period * 120), abs=2)
    report = bpy.context.scene.roundelay.loops[0]
    assert report.verdict.startswith(("good", "look", "do not use"))
    assert report.period == pytest.approx(cycle.period, rel=0.01)
    assert report.repetitions == pytest.approx(cycle.evidence.repetitions, abs=0.2)
    assert report.confidence == pytest.approx(cycle.evidence.confidence, abs=0.02)


def test_keys_are_at_every_frame_and_close(jumps):
    start, end = span(extract())
    curves = curves_of(jumps)
    assert len(curves) == 3 + 3 * len(jumps.pose.bones)
    for (path, _), curve in curves.items():
        keys = keys_of(curve)
        assert np.array_equal(keys[:, 0], np.arange(start, end + 1))
        (modifier,) = curve.modifiers
        assert modifier.type == "CYCLES"
        if path.endswith("location"):
            assert modifier.mode_after == modifier.mode_before == "REPEAT_OFFSET"
        else:
            turns = (keys[-1, 1] - keys[0, 1]) / (2 * math.pi)
            assert turns == pytest.approx(round(turns), abs=1e-5)


def test_the_seam_does_not_show(jumps):
    start, end = span(extract())
    before, first, after = (pose_at(jumps, end + step) for step in (-1, 0, 1))
    travel = first[0, :3, 3] - pose_at(jumps, start)[0, :3, 3]
    again = pose_at(jumps, start) + 0.0
    again[:, :3, 3] += travel
    assert np.allclose(first, again, atol=1e-3)
    assert np.linalg.norm(travel[:2]) > 1.0
    moved = pose_at(jumps, start + 1)
    moved[:, :3, 3] += travel
    assert np.allclose(after, moved, atol=1e-3)
    steps = [
        np.abs(np.diff([pose_at(jumps, f)[:, :3, 3] for f in (a, a + 1)], axis=0)).max()
        for a in range(start, end, 7)
    ]
    assert np.abs(first - before)[:, :3, 3].max() < 1.5 * max(steps)


def test_the_loop_looks_like_the_capture(jumps):
    source = jumps.animation_data.action
    start, end = span(extract())
    loop = np.array([limbs(jumps, f) for f in range(start, end, 5)])
    bpy.ops.roundelay.toggle()
    assert jumps.animation_data.action == source
    seen = np.array([limbs(jumps, f) for f in range(200, 800, 5)])
    apart = np.linalg.norm(loop[:, None] - seen[None], axis=-1).max(axis=-1).min(axis=1)
    size = np.ptp(seen[0], axis=0).max()
    assert apart.max() < 0.2 * size
    bpy.ops.roundelay.toggle()
    assert jumps.animation_data.action != source


def limbs(armature, frame):
    """Return joints relative to the root, in its own axes."""
    matrices = pose_at(armature, frame)
    inverse = np.linalg.inv(matrices[0])
    return (inverse @ matrices)[:, :3, 3]


@pytest.mark.parametrize("mode", ["QUATERNION", "ZYX"])
def test_any_rotation_mode_gives_the_same_loop(mode):
    native = import_capture("01_03")
    start, end = span(extract())
    poses = [limbs(native, f) for f in range(start, end, 10)]
    bpy.data.objects.remove(native)
    other = import_capture("01_03", mode)
    assert other.pose.bones[0].rotation_mode == mode
    assert span(extract()) == (start, end)
    for frame, pose in zip(range(start, end, 10), poses, strict=True):
        assert np.allclose(limbs(other, frame), pose, atol=0.02)


def test_scaled_and_turned_armatures(jumps):
    start, end = span(extract())
    travel = np.diff([pose_at(jumps, f)[0, :3, 3] for f in (start, end)], axis=0)[0]
    bpy.ops.roundelay.toggle()
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale, parent.rotation_euler = (0.01, 0.01, 0.01), (0.0, 0.0, 1.0)
    jumps.parent, jumps.scale = parent, (3.0, 3.0, 3.0)
    bpy.context.view_layer.update()
    assert span(extract()) == (start, end)
    again = np.diff([pose_at(jumps, f)[0, :3, 3] for f in (start, end)], axis=0)[0]
    assert np.allclose(again, travel, rtol=1e-3, atol=1e-3)


def test_in_place_and_single_axes(jumps):
    settings = bpy.context.scene.roundelay
    settings.travel = "SWAY"
    start, end = span(extract())
    assert np.allclose(pose_at(jumps, start)[0], pose_at(jumps, end)[0], atol=1e-3)
    assert not np.allclose(pose_at(jumps, start)[0], pose_at(jumps, start + 50)[0], atol=0.1)
    settings.travel = "NONE"
    start, _ = span(extract())
    still = pose_at(jumps, start)[0, :3, 3]
    assert np.allclose(pose_at(jumps, start + 50)[0, :3, 3], still, atol=1e-3)
    settings.travel, settings.travel_x, settings.travel_z = "AXES", "NONE", "SWAY"
    start, end = span(extract())
    (x, y, z), (x_after, y_after, z_after) = (pose_at(jumps, f)[0, :3, 3] for f in (start, end))
    assert x_after == pytest.approx(x, abs=1e-3) and z_after == pytest.approx(z, abs=1e-3)
    assert abs(y_after - y) > 1.0


def test_mirror_phase_fewer_keys_and_strip(jumps):
    settings = bpy.context.scene.roundelay
    settings.mirror, settings.start_phase, settings.key_step = True, 0.25, 4
    settings.use_strip, settings.repeat = True, 3.0
    action = extract()
    start, end = span(action)
    keys = keys_of(next(iter(curves_of(jumps).values())))
    assert len(keys) == math.ceil((end - start) / 4) + 1 and keys[-1, 0] == end
    strip = jumps.animation_data.nla_tracks[0].strips[0]
    assert strip.action == action and strip.repeat == 3.0
    assert strip.frame_end - strip.frame_start == pytest.approx(3 * (end - start))


def test_fewer_keys_keep_the_motion(jumps):
    start, end = span(extract())
    full = [limbs(jumps, f) for f in range(start, end, 3)]
    bpy.ops.roundelay.toggle()
    bpy.context.scene.roundelay.key_step = 4
    extract()
    fewer = [limbs(jumps, f) for f in range(start, end, 3)]
    size = np.ptp(full[0], axis=0).max()
    assert np.abs(np.array(full) - fewer).max() < 0.02 * size


def test_selected_bones_only_in_pose_mode(jumps):
    arm = [
        b.name for b in jumps.pose.bones if b.name.startswith(("Left", "lShldr", "lHand", "lFore"))
    ]
    arm = [n for n in arm if "Leg" not in n and "Foot" not in n and "Toe" not in n] or arm
    bpy.ops.object.mode_set(mode="POSE")
    choose(jumps, arm)
    extract()
    paths = {path for path, _ in curves_of(jumps)}
    assert paths and all(any(f'"{name}"' in path for name in arm) for path in paths)
    assert not any(path.endswith("location") for path in paths)


def test_pose_mode_without_animated_bones(jumps):
    bpy.ops.object.mode_set(mode="POSE")
    choose(jumps, [])
    with pytest.raises(RuntimeError, match="none of the selected bones is animated"):
        bpy.ops.roundelay.extract()


def test_mirror_wants_both_sides(jumps):
    bpy.ops.object.mode_set(mode="POSE")
    choose(jumps, ["LeftArm", "LeftForeArm"])
    bpy.context.scene.roundelay.mirror = True
    with pytest.raises(RuntimeError, match=r"mirroring needs both sides: .* 'RightArm'"):
        bpy.ops.roundelay.extract()


def test_several_armatures_and_one_that_fails():
    first, second, third = import_capture(), import_capture("01_03"), drifting()
    for armature in (first, second, third):
        armature.select_set(True)
    assert bpy.ops.roundelay.extract() == {"FINISHED"}
    names = [a.animation_data.action.name for a in (first, second, third)]
    assert [name.startswith("Periodic") for name in names] == [True, True, False]
    assert "no periodic motion" in bpy.context.scene.roundelay.message


def test_refusal_is_one_line():
    armature = drifting()
    with pytest.raises(RuntimeError, match="no periodic motion found"):
        bpy.ops.roundelay.extract()
    settings = bpy.context.scene.roundelay
    assert settings.message.startswith("no periodic motion found") and "\n" not in settings.message
    assert not armature.animation_data.action.name.startswith("Periodic")


def test_no_class_is_born_below_a_small_maximal_scale(jumps):
    bpy.context.scene.roundelay.max_scale = 0.05
    with pytest.raises(RuntimeError, match="the poses form 0 loops"):
        bpy.ops.roundelay.extract()
    bpy.context.scene.roundelay.max_scale = 1.0
    assert extract().use_cyclic


def test_an_armature_without_action(jumps):
    jumps.animation_data.action = None
    with pytest.raises(RuntimeError, match="has no action"):
        bpy.ops.roundelay.extract()


def test_frames_and_subsampling(jumps):
    settings = bpy.context.scene.roundelay
    settings.use_frames, settings.first_frame, settings.frame_count = True, 1150, 730
    all_frames = extract()
    assert all_frames.frame_start == 1150
    bpy.ops.roundelay.toggle()
    settings.subsample = 3
    lengths = [b - a for a, b in (span(all_frames), span(extract()))]
    assert lengths[1] == pytest.approx(lengths[0], abs=2)


def test_constraints_are_played(jumps):
    """A constraint that changes nothing leads to the same loop by the other road."""
    start, end = span(extract())
    poses = [limbs(jumps, f) for f in range(start, end, 20)]
    bpy.ops.roundelay.toggle()
    bone = jumps.pose.bones[-1]
    bone.constraints.new("LIMIT_SCALE")
    bpy.context.scene.frame_set(7)
    assert span(extract()) == (start, end)
    assert bpy.context.scene.frame_current == 7
    for frame, pose in zip(range(start, end, 20), poses, strict=True):
        assert np.allclose(limbs(jumps, frame), pose, atol=0.02)


def test_plots(jumps, tmp_path):
    settings = bpy.context.scene.roundelay
    settings.use_plots, settings.plot_folder = True, str(tmp_path)
    action = extract()
    assert (tmp_path / f"{action.name}.svg").read_text().count("<polyline") >= 2


def test_names_of_plots_are_names_of_files_everywhere(jumps, tmp_path):
    settings, name = bpy.context.scene.roundelay, 'Armature|walk: "1/2"?'
    settings.use_plots, settings.plot_folder = True, str(tmp_path)
    jumps.animation_data.action.name = name
    bpy.ops.roundelay.extract()
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == [f"Periodic Armature_walk_ _1_2__{number}.svg" for number in (" 2", "")]


def test_classes_by_hand(jumps):
    settings = bpy.context.scene.roundelay
    assert bpy.ops.roundelay.inspect() == {"FINISHED"}
    assert len(settings.classes) >= 1
    shares = [item.share for item in settings.classes]
    assert max(shares) == 1.0 and all(0.0 < share <= 1.0 for share in shares)
    automatic = span(extract())
    bpy.ops.roundelay.toggle()
    settings.classes[0].chosen = True
    action = extract()
    assert action.name.startswith("Periodic")
    assert span(action) == automatic


def test_500_frames():
    """Tells how long the button takes; not judged, since machines differ."""
    armature = import_capture("01_01")
    settings = bpy.context.scene.roundelay
    settings.use_frames, settings.first_frame, settings.frame_count = True, 60, 500
    began = time.perf_counter()
    action = extract()
    seconds = time.perf_counter() - began
    print(f"\n500 frames, {len(armature.pose.bones)} bones: {seconds:.2f} s")
    assert action.frame_start == 60 and action.frame_end < 560


def test_undo(jumps):
    bpy.ops.ed.undo_push(message="before")
    extract()
    bpy.ops.ed.undo_push(message="loop")
    bpy.ops.ed.undo()
    armature = bpy.context.view_layer.objects.active
    assert not armature.animation_data.action.name.startswith("Periodic")


def test_pressed_again_it_works_on_the_capture(jumps):
    source = jumps.animation_data.action
    first = extract()
    bpy.context.scene.roundelay.travel = "SWAY"
    second = extract()
    assert second != first and second["roundelay_source"] == source
    assert span(second) == span(first)
    bpy.ops.roundelay.toggle()
    assert jumps.animation_data.action == source
    bpy.ops.roundelay.toggle()
    assert jumps.animation_data.action == second


def test_a_walk_that_turns_goes_straight_on():
    walk = import_capture("01_03")
    start, end = span(extract())
    (cycle,) = roundelay.find_cycles(roundelay.read(CAPTURES / "01_03.bvh"))
    report = bpy.context.scene.roundelay.loops[0]
    assert report.turning == pytest.approx(math.degrees(cycle.turning), abs=0.5)
    assert abs(report.turning) > 30.0
    roots = np.array([pose_at(walk, f)[0] for f in range(start, 2 * end - start + 2)])
    period = end - start
    assert np.allclose(roots[:-period, :3, :3], roots[period:, :3, :3], atol=1e-3)
    steps = np.diff(roots[:, :3, 3], axis=0)
    change = np.linalg.norm(np.diff(steps, axis=0), axis=1)
    assert change[period - 2 : period + 2].max() <= change[: period - 2].max()


def test_reports_count_frames_of_the_scene(jumps):
    settings = bpy.context.scene.roundelay
    extract()
    found = settings.loops[0].frames
    cycle = roundelay.find_cycles(roundelay.read(CAPTURES / "01_01.bvh"))[0]
    runs = [f"{start + 1}-{stop + 1}" for start, stop in cycle.evidence.runs]
    assert found == "Frames " + ", ".join(runs)
    settings.use_frames, settings.first_frame, settings.frame_count = True, 1001, 60
    with pytest.raises(RuntimeError) as refusal:
        extract()
    numbers = [int(n) for n in re.findall(r"(\d+)-\d+", str(refusal.value))]
    assert all(1001 <= number <= 1061 for number in numbers)


def loop_by(method, **constraints):
    """Return the rotation curves' values of the active armature's loop by a method."""
    settings = bpy.context.scene.roundelay
    settings.method = method
    for name in ("velocity", "acceleration"):
        setattr(settings, name, constraints.get(name, True))
    action = extract()
    armature = bpy.context.view_layer.objects.active
    values = [keys_of(curve)[:, 1] for curve in curves_of(armature).values()]
    return span(action), np.array(values)


def test_methods_and_constraints(jumps):
    """Each choice arrives: the same period, other curves; unheeded where it has no meaning."""
    frames, smooth = loop_by("HARMONIC")
    loops = {
        "weighted": loop_by("PAPER"),
        "without velocity": loop_by("PAPER", velocity=False),
        "without acceleration": loop_by("PAPER", acceleration=False),
        "positions only": loop_by("PAPER", velocity=False, acceleration=False),
        "averages": loop_by("CENTROID"),
    }
    assert all(found == frames for found, _ in loops.values())
    curves = [smooth, *(values for _, values in loops.values())]
    for number, values in enumerate(curves):
        assert all(np.abs(values - other).max() > 1e-3 for other in curves[:number])
    assert np.array_equal(loop_by("HARMONIC", velocity=False)[1], smooth)


@pytest.mark.parametrize("method", ["PAPER", "CENTROID"])
def test_classes_by_hand_heed_the_method(jumps, method):
    automatic = loop_by(method)[1]
    settings = bpy.context.scene.roundelay
    assert bpy.ops.roundelay.inspect() == {"FINISHED"}
    settings.classes[0].chosen = True
    assert np.allclose(loop_by(method)[1], automatic, atol=1e-5)


def test_the_zip_brings_the_kernel_of_this_system():
    assert type(engine()).__name__ == "Compiled"
    assert Path(bpy.utils.user_resource("EXTENSIONS")) in compiled._binary().parents
