"""Presets: how a loop is written for the program that plays it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

__all__ = ["Target", "Unit", "UpAxis", "preset_of"]

Target = Literal["unity", "unreal", "godot", "blender", "maya", "web"]
Unit = Literal["file", "m", "cm"]
UpAxis = Literal["file", "y", "z"]


@dataclass(frozen=True)
class _Preset:
    """What an option of `roundelay.LoopOptions` is where the user does not say."""

    file_format: str = "bvh"
    fps: float | None = None
    in_place: bool = False
    repeat_first: bool = False
    unit: Unit = "file"
    up: UpAxis = "file"
    face_forward: bool = False
    root_bone: bool = False


# Readers of FBX take lengths for centimetres, those of glTF for metres.
_PRESETS: dict[Target | None, _Preset] = {
    None: _Preset(),
    "unity": _Preset("fbx", 30, unit="cm", up="y", face_forward=True, root_bone=True),
    "unreal": _Preset("fbx", 30, unit="cm", up="y", face_forward=True, root_bone=True),
    "godot": _Preset("glb", 30, unit="m", up="y", face_forward=True, root_bone=True),
    # A scene's range shows each of its frames once: BVH repeats none, and 24 is the scene's rate.
    "blender": _Preset("bvh", 24, unit="m", up="y", face_forward=True),
    "maya": _Preset("fbx", 24, unit="cm", up="y", face_forward=True),
    "web": _Preset("glb", 30, in_place=True, unit="m", up="y", face_forward=True),
}


def preset_of(target: Target | None) -> dict[str, Any]:
    """Return the options of a preset by name; those of no program for None."""
    return vars(_PRESETS[target])
