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
    """What an option of `roundelay.LoopOptions` is where the user does not say.

    `formats` are those that the program reads, the usual one first; none given means any.
    """

    formats: tuple[str, ...] = ()
    fps: float | None = None
    in_place: bool = False
    repeat_first: bool = False
    up: UpAxis = "file"
    face_forward: bool = False
    root_bone: bool = False


_GLTF = ("glb", "gltf")
_PRESETS: dict[Target | None, _Preset] = {
    None: _Preset(),
    "unity": _Preset(("fbx",), 30, up="y", face_forward=True, root_bone=True),
    "unreal": _Preset(("fbx",), 30, up="y", face_forward=True, root_bone=True),
    "godot": _Preset(_GLTF, 30, up="y", face_forward=True, root_bone=True),
    # A scene's range shows each of its frames once: BVH repeats none, and 24 is the scene's rate.
    "blender": _Preset(("bvh", *_GLTF, "fbx"), 24, up="y", face_forward=True),
    "maya": _Preset(("fbx",), 24, up="y", face_forward=True),
    "web": _Preset(_GLTF, 30, in_place=True, up="y", face_forward=True),
}


def preset_of(target: Target | None, file_format: str | None) -> dict[str, Any]:
    """Return the options of a preset by name; those of no program for None.

    Parameters
    ----------
    target : str, optional
    file_format : str, optional
        The format that was asked for; the program's usual one by default.

    Raises
    ------
    ValueError
        If the program does not read the format.
    """
    options = dict(vars(_PRESETS[target]))
    formats = options.pop("formats") or (file_format or "bvh",)
    file_format = file_format or formats[0]
    if file_format not in formats:
        known = ", ".join(formats)
        raise ValueError(f"expected a format that {target} reads ({known}), found {file_format!r}")
    # Readers of FBX take lengths for centimetres, others for metres.
    unit = "file" if target is None else "cm" if file_format == "fbx" else "m"
    return options | {"file_format": file_format, "unit": unit}
