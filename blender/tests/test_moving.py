"""What moves besides bones that turn: the armature, its parents; places and scales of bones."""

import sys

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from conftest import MODULE, import_capture
from inside import curves_of, extract, keys_of, pose_at
from rigs import FRAMES, PERIOD, choose, pendulum


def in_world(armature, frame):
    """Return the bones' matrices (J, 4, 4) in the world."""
    poses = pose_at(armature, frame)
    return np.array(armature.matrix_world) @ poses


def span(action):
    return int(action.frame_start), int(action.frame_end)


def walk_by_object(armature):
    """Take the way over the ground from the root bone's curves and key it on the object."""
    root, curves = armature.pose.bones[0], curves_of(armature)
    path = root.path_from_id("location")
    local = np.stack([keys_of(curves[path, axis])[:, 1] for axis in range(3)], axis=1)
    frames = keys_of(curves[path, 0])[:, 0]
    rest = np.array(root.bone.matrix_local)[:3, :3]
    way = local @ rest.T * (1.0, 1.0, 0.0)
    for axis, column in enumerate((local - way @ rest).T):
        keys = np.column_stack([frames, column])
        curves[path, axis].keyframe_points.foreach_set("co", keys.ravel())
        curves[path, axis].update()
    for frame, place in zip(frames, way, strict=True):
        armature.location = place
        armature.keyframe_insert("location", frame=frame)


def test_motion_of_the_object_is_motion_of_the_root():
    """However the way over the ground is shared out, the loop is the same in the world."""
    plain = import_capture("01_03")
    start, end = span(extract())
    expected = [in_world(plain, frame) for frame in (start, start + 30, end, 2 * end - start)]
    bpy.data.objects.remove(plain)
    moved = import_capture("01_03")
    walk_by_object(moved)
    source = moved.animation_data.action
    bpy.context.scene.frame_set(150)
    there = np.array(moved.matrix_world)
    action = extract()
    assert span(action) == (start, end)
    assert all(path.startswith("pose.bones") for path, _ in curves_of(moved))
    for frame, poses in zip((start, start + 30, end, 2 * end - start), expected, strict=True):
        assert np.allclose(in_world(moved, frame), poses, atol=0.02)
    bpy.ops.roundelay.toggle()
    assert moved.animation_data.action == source
    bpy.context.scene.frame_set(150)
    assert np.allclose(moved.matrix_world, there, atol=1e-5)


def on_a_circle(armature):
    """Let the object go once around in the capture, a parent's odd scale above it."""
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale, parent.rotation_euler = (0.5, 0.5, 0.5), (0.2, 0.0, 1.0)
    armature.parent, armature.scale = parent, (3.0, 3.0, 3.0)
    armature.rotation_mode = "QUATERNION"
    for frame in FRAMES:
        angle = 2 * np.pi * (frame - 1) / len(FRAMES)
        armature.location = 10 * np.cos(angle), 10 * np.sin(angle), 1.0
        armature.rotation_quaternion = Matrix.Rotation(angle, 3, "Z").to_quaternion()
        for path in ("location", "rotation_quaternion"):
            armature.keyframe_insert(path, frame=frame)
    return parent


def still_body(armature):
    """Keep the body bone where it is: the object alone carries it."""
    path = armature.pose.bones["body"].path_from_id("location")
    for (name, _), curve in curves_of(armature).items():
        if name == path:
            for point in curve.keyframe_points:
                point.co.y = 0.0
            curve.update()


@pytest.mark.parametrize("taken", ["root", "limb.R"])
def test_the_object_moves_what_is_selected(taken):
    """Its motion is in the loop if the bone that takes it is selected, too."""
    armature = pendulum()
    on_a_circle(armature)
    still_body(armature)
    bpy.ops.object.mode_set(mode="POSE")
    choose(armature, {"limb.L", "limb.R", taken})
    extract()
    keyed = {path.split('"')[1] for path, _ in curves_of(armature)}
    assert keyed == {"limb.L", "limb.R", taken}
    walked = {path for path, _ in curves_of(armature) if path.endswith("location")}
    assert walked == ({'pose.bones["root"].location'} if taken == "root" else set())


@pytest.mark.parametrize("root", ["body", "root"])
def test_a_circle_becomes_a_straight_line(root):
    armature = pendulum()
    on_a_circle(armature)
    if root == "root":
        still_body(armature)
    action = extract()
    start, end = span(action)
    assert end - start == pytest.approx(PERIOD, abs=1)
    names = {path.split('"')[1] for path, _ in curves_of(armature)}
    assert root in names and not any(path.startswith("loc") for path, _ in curves_of(armature))
    assert bpy.context.scene.roundelay.loops[0].turning == pytest.approx(
        np.degrees(2 * np.pi * PERIOD / len(FRAMES)), rel=0.03
    )
    where = armature.matrix_world.copy()
    frames = range(start, start + 3 * (end - start) + 1)
    poses = np.array([in_world(armature, frame) for frame in frames])
    assert np.allclose(armature.matrix_world, where)
    body = poses[:, 2]
    heading = (
        body[:: end - start, :3, 0] / np.linalg.norm(body[:: end - start, :3, 0], axis=1)[:, None]
    )
    assert np.allclose(heading, heading[0], atol=1e-3)
    periods = np.diff(body[:: end - start, :3, 3], axis=0)
    assert np.allclose(periods, periods[0], rtol=1e-2, atol=1e-3)
    # Three times as large in a world half as large.
    arc = 1.5 * 10 / 3 * 2 * np.pi * PERIOD / len(FRAMES)
    if root == "root":
        assert np.linalg.norm(periods[0]) == pytest.approx(arc, rel=0.05)
    steps = np.linalg.norm(np.diff(poses[:, :, :3, 3], axis=0), axis=-1).max(axis=1)
    assert steps.max() < 1.5 * np.median(steps)


def test_whole_turns_stay():
    """What spins once a period goes on spinning, evenly over the seam."""
    armature = pendulum()
    still_body(armature)
    for frame in (FRAMES[0], FRAMES[-1]):
        armature.rotation_euler.z = 2 * np.pi * (frame - 1) / PERIOD
        armature.keyframe_insert("rotation_euler", frame=frame)
    for curve in curves_of(armature).values():
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    start, end = span(extract())
    assert end - start == pytest.approx(PERIOD, abs=1)
    axes = np.array(
        [in_world(armature, frame)[2, :2, 0] for frame in range(start, 2 * end - start)]
    )
    steps = np.diff(np.unwrap(np.arctan2(axes[:, 1], axes[:, 0])))
    assert steps[: end - start].sum() == pytest.approx(2 * np.pi, abs=1e-3)
    assert np.allclose(steps[end - start :], steps[: start - end], atol=1e-4)
    assert np.ptp(steps) < 0.1 * steps.mean()
    assert bpy.context.scene.roundelay.loops[0].turning == pytest.approx(0.0, abs=1.0)


def test_a_shown_loop_stands_where_the_capture_began():
    armature = pendulum()
    on_a_circle(armature)
    bpy.context.scene.frame_set(1)
    begun = np.array(armature.matrix_world)
    bpy.context.scene.frame_set(130)
    extract()
    bpy.context.view_layer.update()
    assert np.allclose(armature.matrix_world, begun, atol=1e-5)


def motion_of(armature):
    """Read an armature's motion as the extension does."""
    rig = sys.modules[f"{MODULE}.rig"].rig_of(armature)
    reading = sys.modules[f"{MODULE}.reading"].read(rig, bpy.context.scene, FRAMES)
    while True:
        try:
            next(reading)
        except StopIteration as end:
            return end.value.motion


def test_played_and_read_motion_of_the_object_agree():
    armature = pendulum()
    on_a_circle(armature)
    armature.delta_location = 1.0, 2.0, 3.0
    breathing(armature)
    read = motion_of(armature)
    armature.pose.bones["limb.R"].constraints.new("LIMIT_SCALE")
    played = motion_of(armature)
    assert np.ptp(read.root_path[:, 0]) > 5.0
    assert np.allclose(played.root_path, read.root_path, atol=1e-4)
    assert np.allclose(played.rotations, read.rotations, atol=1e-4)
    assert np.allclose(played.translations, read.translations, atol=1e-4)


def test_a_parent_goes_on_moving():
    armature = pendulum()
    action = extract()
    start, end = span(action)
    expected = [pose_at(armature, frame) for frame in (start, end)]
    bpy.ops.roundelay.toggle()
    parent = bpy.data.objects.new("Ship", None)
    bpy.context.scene.collection.objects.link(parent)
    for frame in (1, 201):
        parent.location.x = frame
        parent.keyframe_insert("location", frame=frame)
    armature.parent = parent
    extract()
    assert (
        bpy.context.scene.roundelay.notes
        == "Ship moves Pendulum: not in the loop, goes on as it is\n"
    )
    for frame, poses in zip((start, end), expected, strict=True):
        assert np.allclose(pose_at(armature, frame), poses, atol=1e-4)
        assert armature.matrix_world.translation.x == pytest.approx(
            parent.matrix_world.translation.x
        )


def breathing(armature):
    """Let a limb slide along X and a quarter of a period later grow along Y."""
    bone = armature.pose.bones["limb.L"]
    for frame in FRAMES:
        swing = 2 * np.pi * (frame - 1) / PERIOD
        bone.location.x, bone.scale.y = 0.3 * np.sin(swing), 1.0 + 0.2 * np.cos(swing)
        bone.keyframe_insert("location", frame=frame)
        bone.keyframe_insert("scale", frame=frame)
    return bone


def curve_of(armature, bone, name, index):
    return keys_of(curves_of(armature)[f'pose.bones["{bone}"].{name}', index])[:, 1]


@pytest.mark.parametrize("played", [False, True])
def test_places_and_scales_of_bones_are_in_the_loop(played):
    armature = pendulum()
    breathing(armature)
    if played:
        armature.pose.bones["limb.R"].constraints.new("LIMIT_SCALE")
    extract()
    slide = curve_of(armature, "limb.L", "location", 0)
    grown = curve_of(armature, "limb.L", "scale", 1)
    assert slide[0] == pytest.approx(slide[-1], abs=1e-5)
    assert grown[0] == pytest.approx(grown[-1], abs=1e-5)
    phase = np.unwrap(np.arctan2(slide / 0.3, (grown - 1.0) / 0.2))
    assert np.allclose(np.hypot(slide / 0.3, (grown - 1.0) / 0.2), 1.0, atol=0.02)
    assert phase[-1] - phase[0] == pytest.approx(2 * np.pi, abs=1e-3)
    assert np.allclose(curve_of(armature, "limb.L", "scale", 0), 1.0, atol=1e-4)


def test_mirrored_scale_changes_sides():
    armature = pendulum()
    breathing(armature)
    bpy.context.scene.roundelay.mirror = True
    extract()
    grown = curve_of(armature, "limb.R", "scale", 1)
    assert np.ptp(grown) == pytest.approx(0.4, rel=0.02) and grown.min() > 0.7


def test_both_sides_selected_can_be_mirrored():
    armature = pendulum()
    bpy.ops.object.mode_set(mode="POSE")
    choose(armature, ["limb.L", "limb.R"])
    extract()
    plain = pose_at(armature, 11)[3:]
    bpy.ops.roundelay.toggle()
    bpy.context.scene.roundelay.mirror = True
    extract()
    mirrored = pose_at(armature, 11)[3:]
    across = np.diag([-1.0, 1.0, 1.0])
    # From where each limb hangs to its tail, which is all a mirror image can be asked for.
    tails = [
        np.array(
            [
                bone.bone.length * pose[:3, 1]
                for bone, pose in zip(armature.pose.bones[3:], poses, strict=True)
            ]
        )
        for poses in (plain, mirrored)
    ]
    assert np.allclose(tails[1], tails[0][::-1] @ across, atol=1e-3)
    assert not np.allclose(tails[1], tails[0], atol=0.05)


def test_a_control_beside_the_root_goes_on_as_it_does():
    armature = pendulum()
    control = armature.pose.bones["control"]
    for frame in (1, 201):
        control.location.x = frame
        control.keyframe_insert("location", frame=frame)
    for curve in curves_of(armature).values():
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    before = set(curves_of(armature))
    start, end = span(extract())
    assert set(curves_of(armature)) == before
    way = curve_of(armature, "control", "location", 0)
    assert way[-1] - way[0] == pytest.approx(end - start, rel=5e-3)


def gliding():
    """Return a pendulum whose root goes over the ground, while its body bobs above."""
    armature = pendulum()
    bpy.ops.object.mode_set(mode="EDIT")
    bones = armature.data.edit_bones
    bones.remove(bones["control"])
    for side in "LR":
        limb, hand = bones[f"limb.{side}"], bones.new(f"hand.{side}")
        hand.head, hand.parent = limb.tail, limb
        hand.tail = limb.tail + limb.tail - limb.head
    bpy.ops.object.mode_set(mode="POSE")
    root, body = (armature.pose.bones[name] for name in ("root", "body"))
    for frame in FRAMES:
        root.location = 0.0, 0.05 * frame, 0.0
        body.location = 0.0, 0.2 * np.sin(2 * np.pi * (frame - 1) / PERIOD), 0.0
        root.keyframe_insert("location", frame=frame)
        body.keyframe_insert("location", frame=frame)
    bpy.ops.object.mode_set(mode="OBJECT")
    return armature


@pytest.mark.parametrize("travel", ["TRAVEL", "SWAY"])
def test_a_bone_for_root_motion_glides_and_the_body_bobs(travel):
    armature = gliding()
    before = in_world(armature, 41)
    bpy.context.scene.roundelay.travel = travel
    action = extract()
    start, end = span(action)
    glides = np.stack([curve_of(armature, "root", "location", axis) for axis in range(3)], axis=1)
    bobs = curve_of(armature, "body", "location", 1)
    way = 0.05 * (end - start) if travel == "TRAVEL" else 0.0
    assert np.allclose(glides[-1] - glides[0], (0.0, way, 0.0), atol=0.01)
    assert np.allclose(np.diff(glides, axis=0), np.diff(glides, axis=0)[0], atol=1e-4)
    assert np.ptp(bobs) == pytest.approx(0.4, abs=0.01)
    places = in_world(armature, end)[:, :3, 3]
    assert places[0, 2] == pytest.approx(before[0, 2, 3], abs=1e-4)
    assert np.allclose(places[0, :2], places[1, :2], atol=0.05)


def test_without_path_neither_bone_moves():
    armature = gliding()
    bpy.context.scene.roundelay.travel = "NONE"
    start, end = span(extract())
    places = [in_world(armature, frame)[:2, :3, 3] for frame in range(start, end + 1, 5)]
    assert np.ptp(places, axis=0).max() < 1e-4


def test_blended_loops_keep_the_bone_for_root_motion():
    armature, settings = gliding(), bpy.context.scene.roundelay
    settings.blend_first = settings.blend_second = extract()
    assert bpy.ops.roundelay.blend(weight=0.5) == {"FINISHED"}
    assert np.ptp(curve_of(armature, "root", "location", 1)) == pytest.approx(2.0, abs=0.05)
    assert np.ptp(curve_of(armature, "root", "location", 2)) < 1e-3
    assert np.ptp(curve_of(armature, "body", "location", 1)) == pytest.approx(0.4, abs=0.01)
