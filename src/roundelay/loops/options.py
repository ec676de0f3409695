"""What a user may choose of how a loop is sampled, repaired and written."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

from roundelay.base.options import Checked, option
from roundelay.cycles.events import checked_start
from roundelay.formats import checked_format, wraps_at_last_key
from roundelay.loops.presets import Target, Unit, UpAxis, preset_of
from roundelay.loops.profiles import profiles
from roundelay.motion.motion import FASTEST

__all__ = ["LoopOptions"]


@dataclass(frozen=True)
class LoopOptions(Checked):
    """Choices of how a loop is sampled, repaired and written.

    What is None is chosen by the target when the options are made; what is given overrules it.

    Parameters
    ----------
    target : {"unity", "unreal", "godot", "blender", "maya", "web"}, optional
        The program that plays the loop; see `roundelay.loops.presets`.
    fps : float, optional
        Frames a second; the target's by default, or else the capture's.
    periods : int
        How many periods, one after the other.
    start : float or str
        Where the loop begins: "left" or "right" for the contact of that foot, a phase of the cycle,
        or "frame:N" for what a frame of the capture shows; phase 0 is the left foot's contact, or
        the largest event where no foot steps (`roundelay.cycles.events`).
    in_place : bool, optional
        Leave out the root's travel and turning.
    repeat_first : bool, optional
        Append the frame that repeats the first; see `first_repeated`.
    mirror : bool
        Exchange left and right.
    resize : float
        Factor of every length.
    foot_lock : bool
        Hold standing feet still; see `roundelay.cycles.edit.footlock`.
    repair : bool
        Part limbs that pass through each other more than they do in the capture.
    file_format : str, optional
        "bvh", "amc", "glb", "gltf", "fbx", or a suffix that a plug-in's writer knows; "bvh" by
        default.
    unit : {"file", "m", "cm"}, optional
        The unit of lengths, where that of the capture is known by the body's size.
    up : {"file", "y", "z"}, optional
        The axis that points up.
    face_forward : bool, optional
        Face the front: +Z where Y points up, -Y where Z does.
    root_bone : bool, optional
        Let a bone on the ground carry travel and turning.
    profile : str
        What the record tells of playing the loop, by the name of an export profile.

    Raises
    ------
    ValueError
        If a value is out of range, or the target does not read the format.

    Examples
    --------
    >>> walk = rl.read("walk.bvh")
    >>> loop = rl.make_loops(walk, render=rl.LoopOptions(fps=60.0, in_place=True))[0]
    >>> len(loop.motion), loop.motion.fps
    (66, 60.0)
    """

    title: ClassVar[str] = "What is written"

    target: Target | None = option(
        None,
        "Write as this program plays it: format, rate, unit, axes, root; other options overrule.",
        flag="for",
    )
    fps: float | None = option(
        None,
        "Frame rate of what is written; the capture's by default.",
        unit="frames a second",
        above=0,
        most=FASTEST,
    )
    periods: int = option(1, "Write so many periods, one after the other.", least=1, most=1000)
    start: float | str = option(
        0.0,
        "Where the loop begins: the left or right foot's contact, a phase of the cycle, or what a "
        "frame of the capture shows; 0 is the left contact, or the largest event.",
        least=0,
        below=1,
        form="left|right|PHASE|frame:N",
    )
    in_place: bool | None = option(None, "Leave the root's travel and turning out.")
    repeat_first: bool | None = option(
        None, "Let the last frame repeat the first; in a glTF or FBX file it always does."
    )
    mirror: bool = option(False, "Exchange left and right.")
    resize: float = option(1.0, "Multiply every length by this.", above=0)
    foot_lock: bool = option(True, "Keep standing feet where they stand.", label="Hold Feet")
    repair: bool = option(
        True,
        "Part limbs that pass through each other more than they do in the capture.",
        label="Part Limbs",
    )
    file_format: str | None = option(
        None, "Format of the file: {formats}. BVH by default.", flag="format"
    )
    unit: Unit | None = option(
        None, "Unit of lengths, where the body's size tells the capture's; that one by default."
    )
    up: UpAxis | None = option(None, "Axis that points up; the capture's by default.")
    face_forward: bool | None = option(
        None, "Face the front: +Z where Y points up, -Y where Z does."
    )
    root_bone: bool | None = option(
        None, "Let a bone on the ground carry the root's travel and turning."
    )
    profile: str = option("generic", "What the record tells of playing the loop: {profiles}.")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.file_format is not None:
            checked_format(self.file_format)
        for name, value in preset_of(self.target, self.file_format).items():
            if getattr(self, name) is None:
                object.__setattr__(self, name, value)
        checked_start(self.start)
        profiles[self.profile]  # refuses a name that is not known

    @property
    def _format(self) -> str:
        return self.file_format or "bvh"

    def in_format(self, file_format: str) -> LoopOptions:
        """Return the options of another format, and of the unit that its readers take.

        A unit that is not the target's own stays.

        Raises
        ------
        ValueError
            If the target does not read it.
        """
        usual = preset_of(self.target, self.file_format)["unit"]
        unit = None if self.unit == usual else self.unit
        return replace(self, file_format=file_format, unit=unit)

    @property
    def first_repeated(self) -> bool:
        """Whether the last frame written repeats the first: if asked, or as players need it."""
        return bool(self.repeat_first) or wraps_at_last_key(self._format)

    @property
    def sampling(self) -> dict[str, Any]:
        """What `roundelay.Cycle.sample` takes of it, by name."""
        return {
            "fps": self.fps,
            "periods": self.periods,
            "in_place": self.in_place,
            "repeat_first": self.first_repeated,
            "foot_lock": self.foot_lock,
        }
