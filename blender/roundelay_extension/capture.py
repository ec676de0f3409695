# SPDX-License-Identifier: GPL-3.0-or-later
"""What is searched: the armatures asked for, and what each does in the frames asked for."""

from __future__ import annotations

import re
from collections.abc import Collection, Generator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay import Motion, SkeletonMismatch

from .body import Body, body_of
from .bones import moves
from .compat import Armature, Context
from .jobs import Steps, aside
from .keyed import Keyed, Property, Samples, keyed_of
from .loops import Chosen
from .plain import is_plain
from .playing import play
from .reading import Reading, read
from .rig import Rig, rig_of
from .takes import Take, require_writable, take_of
from .writing import is_loop, show_capture

Array = NDArray[np.float64]

_RANGE = re.compile(r"\b(\d+)-(\d+)\b")
# The fewest frames that could repeat anything.
_FEWEST = 8
# Constraints from which on not every frame is played, and frames a second that are enough then.
_HEAVY, _ENOUGH = 100, 12.0


@dataclass
class Capture:
    """What an armature plays as read for the search: every step-th frame from the first on.

    Attributes
    ----------
    armature : bpy.types.Object
    take : Take
    keyed : Keyed
        What the loop is written on.
    first, step : int
    motion : Motion
        What is searched: the bones' own, or that of the body of a rig.
    place : (4, 4) ndarray or None
        Where the armature stood, if its motion is in the root's.
    rig : Rig or None
        If every bone that moves is keyed itself.
    body : Body or None
        Of a rig that moves by its controls.
    standing : Motion or None
        The body's motion in the armature, likewise.
    parents : dict
        Of controls, their matrices (V, 4, 4), likewise.
    samples : dict or None
        Values of what is keyed (V, n) where strips play.
    chosen : sequence of (int, int)
        Classes chosen by hand.
    in_part : bool
        Whether some bones alone are looked at.
    """

    armature: Armature
    take: Take
    keyed: Keyed
    first: int
    step: int
    motion: Motion
    place: Array | None = None
    rig: Rig | None = None
    body: Body | None = None
    standing: Motion | None = None
    parents: dict[str, Array] = field(default_factory=dict)
    samples: Samples | None = None
    chosen: Chosen = ()
    in_part: bool = False

    @property
    def frames(self) -> Array:
        """The frames of the scene that were looked at."""
        return np.asarray(self.first + self.step * np.arange(len(self.motion)), float)

    def in_scene(self, text: str) -> str:
        """Give a text's ranges of frames, 57-893, as frames of the scene."""
        return _RANGE.sub(
            lambda ends: "-".join(str(self.first + int(end) * self.step) for end in ends.groups()),
            text,
        )


def armatures_of(context: Context) -> list[Armature]:
    """Return the armatures to work on: in Pose Mode those in it, else the selected ones."""
    if context.mode == "POSE":
        return [o for o in context.objects_in_mode if o.type == "ARMATURE"]
    selected = [o for o in context.selected_objects if o.type == "ARMATURE"]
    active = context.active_object
    return selected or ([active] if active is not None and active.type == "ARMATURE" else [])


def has_armature(operator: Any, context: Context) -> bool:
    """Tell whether an operator has an armature and no other work in progress."""
    if not armatures_of(context):
        operator.poll_message_set("Select an armature")
        return False
    return not operator.busy


def shows_loop(operator: Any, context: Context) -> bool:
    """Tell whether the first armature shows a loop."""
    armatures = armatures_of(context)
    data = armatures[0].animation_data if armatures else None
    if data is None or not is_loop(data.action):
        operator.poll_message_set("Show a loop first")
        return False
    return True


def read_capture(context: Context, armature: Armature, settings: Any) -> Steps[Capture]:
    """Read what an armature does in the chosen frames; a loop gives way to its capture."""
    require_writable(armature)
    data = armature.animation_data
    if data is not None and is_loop(data.action):
        show_capture(armature, data.action)
    take = take_of(armature)
    chosen = None
    if context.mode == "POSE":
        chosen = {bone.name for bone in context.selected_pose_bones if bone.id_data == armature}
    keyed = keyed_of(armature, take)
    _require_keys(armature, take, keyed)
    frames = _frames(take, settings)
    reading = _read(context, armature, take, keyed, frames, chosen, settings)
    while True:
        try:
            yield next(reading), f"reading {armature.name}"
        except StopIteration as end:
            found: Capture = end.value
            found.chosen, found.in_part = _chosen(settings, armature), chosen is not None
            return found


def _read(
    context: Context,
    armature: Armature,
    take: Take,
    keyed: Keyed,
    frames: range,
    chosen: Collection[str] | None,
    settings: Any,
) -> Generator[float, None, Capture]:
    rig, name = _rig(armature, keyed, chosen, context.scene, frames), take.action.name
    if rig is not None:
        reading: Reading = yield from read(rig, context.scene, frames, name)
        thin = reading.subsampled(settings.subsample)
        taken = (b.name for b, kept in zip(rig.bones, rig.keyed, strict=True) if kept)
        own = keyed if chosen is None else keyed.of(taken)
        return Capture(
            armature, take, own, frames.start, settings.subsample, thin.motion, thin.place, rig
        )
    own = keyed if chosen is None else keyed.of(chosen)
    if not own.curves:
        raise SkeletonMismatch(f"{armature.name}: none of the selected bones is animated")
    body = body_of(armature, own, chosen)
    step = settings.subsample * (1 if take.strips else _stride(armature, context.scene))
    seen = range(frames.start, frames.stop, step)
    properties = list(own.curves) if take.strips else []
    return (yield from _played(context.scene, take, own, body, seen, properties))


def _rig(
    armature: Armature, keyed: Keyed, chosen: Collection[str] | None, scene: Any, frames: range
) -> Rig | None:
    """Return the bones of an armature if each that moves is keyed itself, else none."""
    try:
        rig = rig_of(armature, chosen)
    except SkeletonMismatch:
        if chosen is not None or not any(not one.bone for one in keyed.curves):
            raise
        return None
    return rig if is_plain(rig, keyed, chosen, scene, frames) else None


def _stride(armature: Armature, scene: Any) -> int:
    """Return every how many-th frame is played: all, but of rigs that are slow."""
    heavy = sum(len(bone.constraints) for bone in armature.pose.bones) > _HEAVY
    rate = scene.render.fps / scene.render.fps_base
    return max(1, int(rate / _ENOUGH)) if heavy else 1


def _played(
    scene: Any, take: Take, keyed: Keyed, body: Body, seen: range, properties: list[Property]
) -> Generator[float, None, Capture]:
    armature = body.armature
    above = {one.holder.parent for one in keyed.curves if one.bone} - {None}
    names = [*body.names, *sorted(bone.name for bone in above)]
    played = yield from play(armature, scene, seen, names, properties)
    count, whole = len(body.names), body
    body = whole.reduced(played.matrices[:, :count])
    shown = played.matrices[:, [whole.names.index(name) for name in body.names]]
    frame_time = seen.step * scene.render.fps_base / scene.render.fps
    name = take.action.name
    standing = yield from aside(lambda: body.motion(shown, frame_time, name))
    motion = standing
    if moves(armature):
        placed = np.linalg.inv(played.places[0]) @ played.places
        motion = yield from aside(lambda: body.motion(placed[:, None] @ shown, frame_time, name))
    parents = dict(zip(names[count:], played.matrices[:, count:].swapaxes(0, 1), strict=True))
    return Capture(
        armature,
        take,
        keyed,
        seen.start,
        seen.step,
        motion,
        body=body,
        standing=standing,
        parents=parents,
        samples=played.samples if properties else None,
    )


def _require_keys(armature: Armature, take: Take, keyed: Keyed) -> None:
    """Check that an action moves the armature that has it."""
    name = take.action.name
    if not keyed.curves:
        if keyed.orphans:
            path = keyed.orphans[0].split('"')
            what = path[1] if len(path) > 2 else keyed.orphans[0]
            raise SkeletonMismatch(
                f"{name} is an action of another rig: {armature.name} has no {what}; choose the "
                "action that was made for it"
            )
        raise SkeletonMismatch(f"{name} has no keys for {armature.name}: key or import some motion")
    if keyed.keys == 1:
        raise SkeletonMismatch(f"{name} has one key: a motion has two or more")


def _frames(take: Take, settings: Any) -> range:
    """Return the take's frames as far as they are asked for."""
    whole = take.frames
    start, last = whole.start, whole.stop - 1
    if settings.use_frames:
        start = max(start, settings.first_frame)
        last = min(last, start + settings.frame_count - 1)
    if last < start + _FEWEST - 1:
        raise SkeletonMismatch(
            f"{take.action.name} has {max(0, last - start + 1)} frames in the chosen range: a loop "
            f"needs {_FEWEST} or more"
        )
    return range(start, last + 1)


def _chosen(settings: Any, armature: Armature) -> Chosen:
    return [
        (c.motion, c.index) for c in settings.classes if c.chosen and c.armature == armature.name
    ]
