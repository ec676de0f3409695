"""Behaviours, import, cancelling, rigs made by hand, registration."""

import sys
import time
import types

import bpy
import numpy as np
import pytest

import roundelay
from conftest import CAPTURES, MODULE
from inside import curves_of, extract, keys_of, pose_at
from rigs import choose, pendulum
from roundelay.base.options import leaves
from roundelay.cycles.edit.separate import Mended
from roundelay.loops import recipe
from roundelay.segmentation import BehaviourOptions


def test_behaviours_as_markers(jumps):
    assert bpy.ops.roundelay.segment() == {"FINISHED"}
    scene = bpy.context.scene
    markers = sorted(scene.timeline_markers, key=lambda marker: marker.frame)
    assert len(markers) > 1 and markers[0].frame == 1 and markers[0].name[0] == "A"
    scene.frame_set(markers[1].frame + 1)
    bpy.ops.roundelay.frames_from_markers()
    assert scene.roundelay.first_frame == markers[1].frame


def test_behaviours_as_strips(jumps):
    bpy.context.scene.roundelay.cuts_to = "STRIPS"
    assert bpy.ops.roundelay.segment() == {"FINISHED"}
    (track,) = jumps.animation_data.nla_tracks
    strips = list(track.strips)
    assert len(strips) > 1
    assert [s.frame_start for s in strips[1:]] == [s.frame_end for s in strips[:-1]]


def test_range_from_no_markers(jumps):
    with pytest.raises(RuntimeError, match="no marker"):
        bpy.ops.roundelay.frames_from_markers()


def test_import_of_acclaim(tmp_path):
    motion = roundelay.read(CAPTURES / "01_03.bvh")
    roundelay.write(motion, tmp_path / "walk.amc")
    assert bpy.ops.roundelay.import_acclaim(filepath=str(tmp_path / "walk.amc")) == {"FINISHED"}
    armature = bpy.context.view_layer.objects.active
    assert armature.type == "ARMATURE"
    assert bpy.context.scene.render.fps == 120
    root = pose_at(armature, 100)[0, :3, 3]
    x, y, z = roundelay.read(tmp_path / "walk.amc").root_path[99]
    assert np.allclose(root, (x, -z, y), atol=0.05)
    assert extract().name == "Periodic walk"


def test_import_of_a_broken_file(tmp_path):
    (tmp_path / "walk.amc").write_text("nonsense")
    with pytest.raises(RuntimeError, match="Error"):
        bpy.ops.roundelay.import_acclaim(filepath=str(tmp_path / "walk.amc"))
    assert not any(block.name.startswith("walk") for block in bpy.data.armatures)


def test_cancel(jumps):
    """Esc closes the generator: the thread ends and nothing was made."""
    jobs = sys.modules[f"{MODULE}.jobs"]
    reports = []

    def call(progress):
        while True:
            reports.append(roundelay.base.progress.report(progress, 0.5, "working"))

    steps = jobs.threaded(call)
    assert next(steps) == (0.5, "working")
    steps.close()
    seen = len(reports)
    assert seen > 0 and len(reports) == seen
    assert not any(a.name.startswith("Periodic") for a in bpy.data.actions)


class Clicked:
    """An operator as a window drives it: there is none in the background."""

    def __init__(self, name):
        cls = getattr(sys.modules[f"{MODULE}.extract"], name)
        long_operator = sys.modules[f"{MODULE}.jobs"].LongOperator
        self.operator = type("Clicked", (long_operator,), {"steps": cls.steps, "report": print})()
        self.timers = []
        manager = types.SimpleNamespace(event_timer_remove=self.timers.remove)
        self.context = types.SimpleNamespace(
            mode="OBJECT",
            scene=bpy.context.scene,
            screen=None,
            selected_objects=bpy.context.selected_objects,
            active_object=bpy.context.view_layer.objects.active,
            window_manager=manager,
        )
        self.timers.append("timer")
        self.operator._timer = "timer"
        self.operator._steps = self.operator.steps(self.context)

    def event(self, name):
        return self.operator.modal(self.context, types.SimpleNamespace(type=name))


def test_a_fault_of_the_program_leaves_no_button_greyed(jumps):
    def broken():
        yield 0.1, "working"
        raise KeyError("a fault")

    clicked, jobs = Clicked("ROUNDELAY_OT_extract"), sys.modules[f"{MODULE}.jobs"]
    jobs.LongOperator.busy, clicked.operator._steps = True, broken()
    with pytest.raises(KeyError):
        clicked.event("TIMER")
    assert not jobs.LongOperator.busy
    assert clicked.timers == []


def test_slices_do_not_freeze(jumps):
    clicked, longest = Clicked("ROUNDELAY_OT_extract"), 0.0
    assert clicked.event("MOUSEMOVE") == {"PASS_THROUGH"}
    for _ in range(1000):
        began = time.thread_time()
        state = clicked.event("TIMER")
        if state != {"RUNNING_MODAL"}:
            break
        longest = max(longest, time.thread_time() - began)
    assert state == {"FINISHED"}
    assert not clicked.timers
    assert jumps.animation_data.action.name.startswith("Periodic")
    assert longest < 0.5


def test_escape_makes_nothing(jumps):
    clicked = Clicked("ROUNDELAY_OT_extract")
    assert clicked.event("TIMER") == {"RUNNING_MODAL"}
    assert clicked.event("ESC") == {"CANCELLED"}
    assert bpy.context.scene.roundelay.message == "Cancelled"
    assert not clicked.timers
    assert not any(a.name.startswith("Periodic") for a in bpy.data.actions)


def test_an_armature_made_by_hand():
    armature = pendulum()
    capture = {f: pose_at(armature, f) for f in range(1, 161)}
    action = extract()
    start, end = int(action.frame_start), int(action.frame_end)
    assert end - start == pytest.approx(40, abs=1)
    names = {path.split('"')[1] for path, _ in curves_of(armature)}
    assert names == {"body", "limb.L", "limb.R"}
    begun = pose_at(armature, start)
    moved = pose_at(armature, end)[2, :3, 3] - begun[2, :3, 3]
    assert np.linalg.norm(moved) == pytest.approx(0.05 * 40, rel=0.02)
    apart = [np.abs(relative(begun) - relative(pose)).max() for pose in capture.values()]
    assert min(apart) < 0.05


def relative(matrices):
    return np.linalg.inv(matrices[2]) @ matrices[3:]


def test_one_limb_alone():
    armature = pendulum()
    bpy.ops.object.mode_set(mode="POSE")
    choose(armature, ["limb.R"])
    action = extract()
    assert {path for path, _ in curves_of(armature)} == {'pose.bones["limb.R"].rotation_axis_angle'}
    assert action.frame_end - action.frame_start == pytest.approx(40, abs=1)
    keys = keys_of(curves_of(armature)['pose.bones["limb.R"].rotation_axis_angle', 0])
    assert keys[0, 1] == keys[-1, 1]


def test_off_and_on_again(extension):
    extension.unregister()
    assert not hasattr(bpy.types.Scene, "roundelay")
    extension.register()
    assert hasattr(bpy.types.Scene, "roundelay")


def test_a_loop_for_each_behaviour(jumps):
    bpy.context.scene.roundelay.per_behaviour = True
    extract()
    assert len(bpy.context.scene.roundelay.loops) >= 1


@pytest.mark.parametrize("wanted", [True, False])
def test_limbs_are_parted_if_wanted(jumps, monkeypatch, wanted):
    """The library is asked, with the frames that show the cycle, and what it did is told."""
    asked = []

    def repaired(cycle, sources):
        asked.append([len(source) for source in sources])
        return cycle, (Mended(("LeftHand", "Hips"), ((0.0, 0.1),), 0.1),)

    monkeypatch.setattr(recipe, "repaired", repaired)
    settings = bpy.context.scene.roundelay
    settings.repair = wanted
    extract()
    cycles = roundelay.find_cycles(roundelay.read(CAPTURES / "01_01.bvh"))
    shown = [[stop - start for start, stop in cycle.evidence.runs] for cycle in cycles]
    assert asked == (shown if wanted else [])
    told = "LeftHand and Hips moved apart by up to 6\u00b0\n"
    assert settings.notes == (told * len(cycles) if wanted else "")


def test_blend_lies_between(jumps):
    settings = bpy.context.scene.roundelay
    settings.use_frames, settings.first_frame, settings.frame_count = True, 57, 836
    first = extract()
    bpy.ops.roundelay.toggle()
    settings.first_frame = 1989
    second = extract()
    settings.blend_first, settings.blend_second = first, second
    lengths = {}
    for weight in (0.0, 0.5, 1.0):
        assert bpy.ops.roundelay.blend(weight=weight) == {"FINISHED"}
        blended = jumps.animation_data.action
        assert blended.name.startswith("Blend") and blended.use_cyclic
        lengths[weight] = blended.frame_end - blended.frame_start
    assert lengths[0.0] == pytest.approx(first.frame_end - first.frame_start, abs=1)
    assert lengths[1.0] == pytest.approx(second.frame_end - second.frame_start, abs=1)
    assert min(lengths[0.0], lengths[1.0]) <= lengths[0.5] <= max(lengths[0.0], lengths[1.0])


def test_what_is_shared_is_as_the_library_declares_it():
    held, seen = bpy.context.scene.roundelay.bl_rna.properties, []
    for options in (roundelay.Options, roundelay.LoopOptions, BehaviourOptions):
        for one in leaves(options):
            # The list of classes to choose from is called as the number of them.
            if one.name in held and held[one.name].type != "COLLECTION":
                seen.append(one.name)
                found = held[one.name]
                assert found.name == one.label
                assert found.description.startswith(one.known.text.rstrip("."))
                assert one.known.unit in found.description
                if one.default is not None and found.type != "ENUM":
                    assert found.default == one.default
                if one.known.most is not None:
                    assert found.hard_max == one.known.most
    assert {"most", "prime", "scale", "delay", "repair", "method", "sensitivity"} <= set(seen)


def test_a_delay_is_in_seconds_whatever_frames_are_used(extension):
    settings = bpy.context.scene.roundelay
    options_of = sys.modules[f"{MODULE}.loops"].options_of
    assert options_of(settings).topology.delay is None
    settings.use_delay, settings.delay, settings.subsample = True, 0.25, 4
    assert options_of(settings).topology.delay == 0.25
    settings.delay = 0.0
    assert options_of(settings).topology.delay == 0.0
