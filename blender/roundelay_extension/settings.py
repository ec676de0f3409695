# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel holds, in the scene; every default is the automatic choice."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from roundelay import LoopOptions, Options, TopologyOptions
from roundelay.segmentation import BehaviourOptions

from .declared import declared, description, shared

_AXIS_MODELS = [
    ("TRAVEL", "Travel", "The root moves on, with the sway of every period"),
    ("SWAY", "In Place", "The root sways, but comes back"),
    ("NONE", "None", "The root does not move"),
]
_MODELS = [*_AXIS_MODELS, ("AXES", "By Axis", "Chosen for the armature's axes one by one")]
_METHOD = declared(Options, "method")
_METHODS = [
    ("AUTO", "Automatic", "The mean, or the take where a limb would lose a fifth of its movement"),
    ("HARMONIC", "Mean", "Smooth regression of rotations, faded over where parts end"),
    ("TAKE", "Take", "The most typical repetition as it was played"),
    ("PAPER", "Weighted", "Regression of angles with velocities and accelerations (Raunio 2014)"),
    ("CENTROID", "Averages", "Means of the nearest poses (Vejdemo-Johansson et al. 2015)"),
]


def _is_loop(settings: bpy.types.PropertyGroup, action: bpy.types.Action) -> bool:
    return action.use_cyclic


class LoopReport(bpy.types.PropertyGroup):
    """One loop that was made."""

    action: PointerProperty(type=bpy.types.Action)
    armature: PointerProperty(type=bpy.types.Object)
    controls: BoolProperty()
    by_hand: BoolProperty()
    away: FloatProperty()
    join: FloatProperty()
    verdict: StringProperty()
    period: FloatProperty()
    repetitions: FloatProperty()
    confidence: FloatProperty()
    seam: FloatProperty()
    step: FloatProperty()
    turning: FloatProperty()
    frames: StringProperty()


class ClassItem(bpy.types.PropertyGroup):
    """One class of the poses of an armature."""

    armature: StringProperty()
    motion: IntProperty()
    index: IntProperty()
    birth: FloatProperty()
    death: FloatProperty()
    share: FloatProperty(min=0.0, max=1.0)
    text: StringProperty()
    chosen: BoolProperty(name="Use", description="Make a loop of this class")


class Settings(bpy.types.PropertyGroup):
    """Options and results of the panel."""

    use_frames: BoolProperty(name="Frame Range", description="Use some of the action's frames only")
    first_frame: IntProperty(name="First", description="The first frame to use", default=1)
    frame_count: IntProperty(
        name="Count", description="Use at most this many frames", default=500, min=8
    )
    subsample: IntProperty(
        name="Frame Step",
        description="Use every so many-th frame; 1 for all",
        default=1,
        min=1,
        max=100,
    )
    most: shared(Options, "most")
    persistent: IntProperty(
        name="Most Persistent",
        description="Make a motion each of so many of the longest bars of all frames; 0 for what "
        "repeats by the timeline",
        min=0,
        max=100,
    )
    per_behaviour: BoolProperty(
        name="Per Behaviour", description="Cut the action into behaviours first, and search in each"
    )
    foot_lock: shared(LoopOptions, "foot_lock")
    repair: shared(LoopOptions, "repair")
    travel: EnumProperty(
        name="Root", description="How the root moves over the periods of a loop", items=_MODELS
    )
    travel_x: EnumProperty(name="X", description="Root along the armature's X", items=_AXIS_MODELS)
    travel_y: EnumProperty(name="Y", description="Root along the armature's Y", items=_AXIS_MODELS)
    travel_z: EnumProperty(name="Z", description="Root along the armature's Z", items=_AXIS_MODELS)
    start_phase: FloatProperty(
        name="Start Phase", description="Where in the period the loop starts", min=0.0, max=1.0
    )
    mirror: shared(LoopOptions, "mirror")
    key_step: IntProperty(
        name="Key Every",
        description="Frames from key to key; 1 for a key at every frame, more for fewer keys",
        default=1,
        min=1,
        max=20,
    )
    use_strip: BoolProperty(name="NLA Strip", description="Put the loop on an NLA track, too")
    repeat: FloatProperty(name="Repeat", description="Repetitions in the strip", default=4, min=1)
    max_scale: shared(TopologyOptions, "max_scale", precision=4)
    scale: shared(TopologyOptions, "scale", precision=4)
    use_delay: BoolProperty(
        name="Set Delay", description="Set how velocity is weighed against position"
    )
    delay: shared(TopologyOptions, "delay", zero=True, precision=3)
    prime: shared(TopologyOptions, "prime")
    harmonics: shared(Options, "harmonics")
    travel_harmonics: IntProperty(
        name="Of the Root",
        description="Harmonics of the root's travel; 0 for as many as the joints have",
        min=0,
        max=500,
    )
    method: EnumProperty(name=_METHOD.label, description=description(_METHOD), items=_METHODS)
    velocity: shared(Options, "velocity")
    acceleration: shared(Options, "acceleration")
    use_plots: BoolProperty(name="PCA Plots", description="Write plots of poses and loops")
    plot_folder: StringProperty(name="Folder", subtype="DIR_PATH", default="//")
    sensitivity: shared(BehaviourOptions, "sensitivity", soft_max=20.0)
    cuts_to: EnumProperty(
        name="Cuts To",
        items=[
            ("MARKERS", "Markers", "Markers on the timeline"),
            ("STRIPS", "NLA Strips", "One strip a behaviour"),
        ],
    )
    blend_first: PointerProperty(name="First", type=bpy.types.Action, poll=_is_loop)
    blend_second: PointerProperty(name="Second", type=bpy.types.Action, poll=_is_loop)
    classes: CollectionProperty(type=ClassItem)
    loops: CollectionProperty(type=LoopReport)
    message: StringProperty()
    notes: StringProperty()
    progress: FloatProperty(min=0.0, max=1.0)


CLASSES = (LoopReport, ClassItem, Settings)


def register() -> None:
    """Attach the settings to scenes."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    scenes: Any = bpy.types.Scene
    scenes.roundelay = PointerProperty(type=Settings)  # type: ignore[func-returns-value]


def unregister() -> None:
    """Take the settings off."""
    delattr(bpy.types.Scene, "roundelay")
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
