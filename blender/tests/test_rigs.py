"""The matrix of rigs: what is keyed is what gets looped, and it plays as the capture does."""

import time

import bpy
import numpy as np
import pytest

import judging
import walkers
from conftest import import_capture
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
    "every 3rd frame": lambda _: walkers.baked(step=3),
    "every 4th frame": lambda _: walkers.ik_walker(step=4),
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


def judged(armature, names, period=walkers.PERIOD):
    """Press the button; return figures beside those of the capture."""
    step = 0.5 if len(armature.pose.bones) > 200 else 0.25
    frames = np.arange(1.0, walkers.LAST + step, step)
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


@pytest.mark.parametrize("name", MADE)
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
