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

_AXIS_MODELS = [
    ("TRAVEL", "Travel", "The root moves on, with the sway of every period"),
    ("SWAY", "In Place", "The root sways, but comes back"),
    ("NONE", "None", "The root does not move"),
]
_MODELS = [*_AXIS_MODELS, ("AXES", "By Axis", "Chosen for the armature's axes one by one")]
_METHODS = [
    ("HARMONIC", "Automatic", "Smooth regression of rotations, faded over where parts end"),
    ("PAPER", "Weighted", "Regression of angles with velocities and accelerations (Raunio 2014)"),
    ("CENTROID", "Averages", "Means of the nearest poses (Vejdemo-Johansson et al. 2015)"),
]


def _is_loop(settings: bpy.types.PropertyGroup, action: bpy.types.Action) -> bool:
    return action.use_cyclic


class LoopReport(bpy.types.PropertyGroup):
    """One loop that was made."""

    action: PointerProperty(type=bpy.types.Action)
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
    most: IntProperty(
        name="Max Loops",
        description="Number of loops, one action each, the surest first; 0 for all",
        default=0,
        min=0,
    )
    per_behaviour: BoolProperty(
        name="Per Behaviour", description="Cut the action into behaviours first, and search in each"
    )
    foot_lock: BoolProperty(
        name="Hold Feet", description="Keep standing feet where they stand", default=True
    )
    part_limbs: BoolProperty(
        name="Part Limbs",
        description="Move limbs apart that pass through each other more than in the capture",
        default=True,
    )
    travel: EnumProperty(
        name="Root", description="How the root moves over the periods of a loop", items=_MODELS
    )
    travel_x: EnumProperty(name="X", description="Root along the armature's X", items=_AXIS_MODELS)
    travel_y: EnumProperty(name="Y", description="Root along the armature's Y", items=_AXIS_MODELS)
    travel_z: EnumProperty(name="Z", description="Root along the armature's Z", items=_AXIS_MODELS)
    start_phase: FloatProperty(
        name="Start Phase", description="Where in the period the loop starts", min=0.0, max=1.0
    )
    mirror: BoolProperty(name="Mirror", description="Exchange left and right")
    key_step: IntProperty(
        name="Key Every",
        description="Frames from key to key; 1 for a key at every frame, more for fewer keys",
        default=1,
        min=1,
        max=20,
    )
    use_strip: BoolProperty(name="NLA Strip", description="Put the loop on an NLA track, too")
    repeat: FloatProperty(name="Repeat", description="Repetitions in the strip", default=4, min=1)
    max_scale: FloatProperty(
        name="Maximal Scale",
        description="Largest scale of the complex, in body sizes: classes born above are left out, "
        "bars end there; 0 for all",
        min=0.0,
        precision=4,
    )
    scale: FloatProperty(
        name="Scale",
        description="Scale of the circular coordinate, in body sizes, within the bar of its "
        "class; 0 for automatic",
        min=0.0,
        precision=4,
    )
    use_delay: BoolProperty(
        name="Set Delay", description="Set how velocity is weighed against position"
    )
    delay: FloatProperty(
        name="Delay", description="In frames; 0 for poses without velocities", min=0.0
    )
    prime: IntProperty(
        name="Prime", description="Cohomology has coefficients modulo this prime", default=47, min=2
    )
    harmonics: IntProperty(
        name="Harmonics",
        description="Harmonics of the joints' rotations; 0 for automatic",
        min=0,
        max=500,
    )
    travel_harmonics: IntProperty(
        name="Of the Root",
        description="Harmonics of the root's travel; 0 for as many as the joints have",
        min=0,
        max=500,
    )
    method: EnumProperty(name="Method", description="How poses become a loop", items=_METHODS)
    velocity: BoolProperty(
        name="Velocity",
        description="Let the loop follow the velocities of the capture, too",
        default=True,
    )
    acceleration: BoolProperty(
        name="Acceleration",
        description="Let the loop follow the accelerations of the capture, too",
        default=True,
    )
    use_plots: BoolProperty(name="PCA Plots", description="Write plots of poses and loops")
    plot_folder: StringProperty(name="Folder", subtype="DIR_PATH", default="//")
    sensitivity: FloatProperty(
        name="Sensitivity",
        description="2 finds finer behaviours, 0.5 coarser ones",
        default=1.0,
        min=0.05,
        max=20.0,
    )
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
