"""The matrix of rigs: what is keyed is what gets looped, and it plays as the capture does."""

import sys
import time

import bpy
import numpy as np
import pytest

import judging
import roundelay
import walkers
from conftest import MODULE, import_capture
from inside import extract

DEFORMING = ["DEF-spine"] + [
    f"DEF-{n}.{s}" for n in ("thigh", "shin", "foot", "upper_arm", "forearm", "hand") for s in "LR"
]
MADE = {
    "Mixamo-like": lambda _: walkers.baked(prefix="mixamorig:"),
    "IK outside the root": lambda _: walkers.ik_walker(),
    "spline IK": lambda _: walkers.spline_walker(),
    "copy rotation": lambda _: walkers.copying(),
    "drivers": lambda _: walkers.driven(),
    "turned": lambda _: walkers.baked(laid=100.0),
    "IK turned": lambda _: walkers.ik_walker(laid=100.0),
    "negative": lambda _: walkers.mirrored(),
    "60 fingers": lambda _: walkers.with_fingers(),
    "NLA": lambda _: walkers.pushed_down(),
    "FBX": walkers.round_trip,
    "every 3rd frame": lambda _: walkers.baked(step=3, last=196),
    "every 4th frame": lambda _: walkers.ik_walker(step=4, last=261),
    "Rigify FK": lambda _: walkers.rigify("FK"),
    "Rigify IK": lambda _: walkers.rigify("IK"),
}
PREFIXES = ("", "mixamorig:", "DEF-")


def shown(armature):
    """Name the bones that show the body, the hips first."""
    if "DEF-spine" in armature.pose.bones:
        return DEFORMING
    prefix = next(p for p in PREFIXES if p + "hips" in armature.pose.bones)
    others = [b.name for b in armature.pose.bones if b.name.startswith(("tail", "finger"))]
    return [prefix + name for name in walkers.SHOWN] + others


def last_of(armature):
    """Return the last frame of a capture made here."""
    action = armature.animation_data.action
    return walkers.LAST if action is None else round(action.frame_range[1])


def judged(armature, names, period=walkers.PERIOD):
    """Press the button; return figures beside those of the capture."""
    step = 0.5 if len(armature.pose.bones) > 200 else 0.25
    frames = np.arange(1.0, last_of(armature) + step, step)
    capture = judging.heads(armature, frames, names)
    before = judging.keyed(armature)
    began = time.perf_counter()
    action = extract()
    seconds = time.perf_counter() - began
    found = judging.compare(armature, capture, frames, action, names, period)
    found |= {"keyed": judging.keyed(armature) == before, "seconds": seconds}
    feet = [names.index(n) for n in names if "foot" in n]
    whole = capture[:: round(1 / step)] * found["unit"]
    for name, places in (("slide", found["loop"]), ("slid", whole)):
        found[name] = max(judging.slide(places, foot, 0.001) for foot in feet)
    return found


# Bones keyed at every 3rd frame: the repetitions differ by how the keys fall, the loop is 1.2 cm
# from their mean, and the feet slide by 5 mm a frame.
SHORT = pytest.mark.xfail(reason="1.2 cm from the mean repetition", strict=False)


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=SHORT) if n == "every 3rd frame" else n for n in MADE]
)
def test_the_loop_plays_as_the_capture_does(name, tmp_path, record_rig):
    armature = MADE[name](tmp_path)
    found = judged(armature, shown(armature))
    record_rig(name, found)
    assert found["keyed"]
    assert found["away"] <= judging.CENTIMETRE
    assert found["join"] <= 1.1
    assert found["slide"] <= max(1.2 * found["slid"], 0.001)
    (report,) = bpy.context.scene.roundelay.loops
    assert report.away < 0.01
    assert bpy.context.scene.roundelay.message == "Made 1 loop"


def test_two_armatures_at_once():
    first, second = walkers.ik_walker(name="First"), walkers.baked()
    before = [judging.keyed(one) for one in (first, second)]
    walkers.select(first, second)
    assert bpy.ops.roundelay.extract() == {"FINISHED"}
    assert [judging.keyed(one) for one in (first, second)] == before
    assert bpy.context.scene.roundelay.message == "Made 2 loops"


def test_an_import_keeps_what_is_keyed(record_rig):
    armature = import_capture("01_01")
    before = judging.keyed(armature)
    began = time.perf_counter()
    extract()
    assert judging.keyed(armature) == before
    report = bpy.context.scene.roundelay.loops[0]
    record_rig("BVH import", {"away": report.away, "seconds": time.perf_counter() - began})
    assert report.away < 1e-3 and report.join <= 1.1


def test_a_long_take_in_slices(record_rig):
    """20,000 frames: as many loops as the take shows once, and nothing freezes."""
    armature = walkers.baked(last=325)
    repeated(armature, 325, 20_000)
    began = time.perf_counter()
    extract()
    seconds = time.perf_counter() - began
    record_rig("20,000 frames", {"seconds": seconds})
    assert len(bpy.context.scene.roundelay.loops) == 1


def repeated(armature, period, frames):
    """Key a cyclic action on and on, place by place."""
    from inside import curves_of, keys_of

    for (path, _), curve in curves_of(armature).items():
        values = keys_of(curve)[:period, 1]
        gain = (values[-1] - values[0]) * period / (period - 1) if path.endswith("location") else 0
        gain = gain if abs(gain) > 1.0 else 0.0
        count = frames // period + 1
        rows = (values + gain * np.arange(count)[:, None]).ravel()[:frames]
        curve.keyframe_points.clear()
        curve.keyframe_points.add(frames)
        co = np.column_stack([np.arange(1, frames + 1), rows])
        curve.keyframe_points.foreach_set("co", co.ravel())
        curve.update()


def refused(match):
    with pytest.raises(RuntimeError, match=match):
        bpy.ops.roundelay.extract()
    message = bpy.context.scene.roundelay.message
    assert message and "\n" not in message


def test_an_action_of_another_rig_is_named():
    action = walkers.baked(prefix="mixamorig:").animation_data.action
    other = walkers.armature("Other")
    other.animation_data_create().action = action
    if hasattr(action, "slots"):
        other.animation_data.action_slot = action.slots[0]
    refused("is an action of another rig: Other has no mixamorig:hips")


def test_one_key_is_no_motion():
    thing = walkers.armature("Still")
    thing.pose.bones["hips"].keyframe_insert("location", frame=1)
    refused("has one key")


def test_a_few_frames_are_no_loop():
    walkers.baked(last=5)
    refused("a loop needs 8 or more")


def test_muted_strips_are_told():
    thing = walkers.pushed_down()
    for track in thing.animation_data.nla_tracks:
        track.mute = True
    refused("its NLA tracks are muted")


def test_the_strips_play_again():
    thing = walkers.pushed_down()
    extract()
    assert not thing.animation_data.use_nla
    assert bpy.ops.roundelay.toggle() == {"FINISHED"}
    assert thing.animation_data.action is None and thing.animation_data.use_nla
    assert bpy.ops.roundelay.toggle() == {"FINISHED"}
    assert thing.animation_data.action.name.startswith("Periodic")


def test_a_file_without_a_place_has_no_plots():
    walkers.baked()
    bpy.context.scene.roundelay.use_plots = True
    refused("the file is not saved")


def test_a_broken_loop_is_not_kept(monkeypatch):
    """What does not play as was meant is named, and nothing of it is left."""
    thing = walkers.ik_walker()
    source = thing.animation_data.action
    controls = sys.modules[f"{MODULE}.controls"]
    plain = controls.Controls.tracks

    def broken(self, **how):
        for track in plain(self, **how):
            if "thigh" in track.target.bone or track.target.bone == "ctl.L":
                track.rows[:] += 0.2
            yield track

    monkeypatch.setattr(controls.Controls, "tracks", broken)
    refused("not kept: played back, .* elsewhere than in the capture")
    assert thing.animation_data.action == source
    assert not any(one.name.startswith("Periodic") for one in bpy.data.actions)


def test_the_join_moves_with_the_loop():
    thing = walkers.ik_walker()
    action = extract()
    start, end = int(action.frame_start), int(action.frame_end)
    before = judging.heads(thing, range(start, end + 1), walkers.SHOWN)
    assert bpy.ops.roundelay.join(frames=5) == {"FINISHED"}
    after = judging.heads(thing, range(start, end + 1), walkers.SHOWN)
    assert np.allclose(after[:-5], before[5:], atol=1e-4)
    moved = after[-1] - after[0]
    assert np.allclose(moved, before[-1] - before[0], atol=1e-4)


def test_a_click_in_the_diagram_chooses_a_class():
    walkers.ik_walker()
    bpy.ops.roundelay.inspect()
    classes = bpy.context.scene.roundelay.classes
    diagram = sys.modules[f"{MODULE}.diagram"]
    for number, (x, y) in enumerate(diagram.points_of(classes)):
        found = diagram.nearest(classes, x + 2, y - 2)
        assert found == number or np.allclose(diagram.points_of(classes)[found], (x, y), atol=5)
    assert diagram.nearest(classes, 5000, 5000) is None
    classes[0].chosen = True
    extract()
    assert bpy.context.scene.roundelay.loops[0].by_hand


@pytest.mark.parametrize("suffix", ["glb", "fbx"])
def test_the_loop_is_exported_with_its_seam(tmp_path, suffix):
    walkers.baked()
    action = extract()
    path = tmp_path / f"loop.{suffix}"
    assert bpy.ops.roundelay.export(filepath=str(path)) == {"FINISHED"}
    motion = roundelay.read(path)
    assert len(motion) == action.frame_end - action.frame_start + 1
    ends = motion.positions()[[0, -1]]
    own = ends - ends[:, :1]
    assert np.abs(own[0] - own[1]).max() < 1e-3 * motion.skeleton.size
