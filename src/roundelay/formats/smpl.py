"""Read NPZ files of SMPL bodies, as AMASS and its like have them: rotations of named joints.

What a body of SMPL looks like is under a licence of its own. The skeleton here has proportions of
our own, of a person of 1.7 m; shapes (``betas``) are left out. Nothing in a file is run: objects
are refused. Joints: Loper et al. 2015 (SMPL), Romero et al. 2017 (SMPL+H), Pavlakos et al. 2019
(SMPL-X); AMASS: Mahmood et al. 2019.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError
from roundelay.base.files import name_of
from roundelay.formats.arrays import arrays_of, names_in
from roundelay.formats.point_files import rate_assumed
from roundelay.formats.sane import LARGEST, fault_of_size, require_memory
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion

__all__ = ["SmplReader"]

Array = NDArray[np.float64]

_BODY = {
    "pelvis": ("", (0.0, 0.0, 0.0)),
    "left_hip": ("pelvis", (0.09, -0.08, 0.0)),
    "right_hip": ("pelvis", (-0.09, -0.08, 0.0)),
    "spine1": ("pelvis", (0.0, 0.11, -0.02)),
    "left_knee": ("left_hip", (0.02, -0.41, 0.0)),
    "right_knee": ("right_hip", (-0.02, -0.41, 0.0)),
    "spine2": ("spine1", (0.0, 0.13, 0.0)),
    "left_ankle": ("left_knee", (0.0, -0.42, -0.03)),
    "right_ankle": ("right_knee", (0.0, -0.42, -0.03)),
    "spine3": ("spine2", (0.0, 0.06, 0.0)),
    "left_foot": ("left_ankle", (0.02, -0.06, 0.12)),
    "right_foot": ("right_ankle", (-0.02, -0.06, 0.12)),
    "neck": ("spine3", (0.0, 0.21, -0.03)),
    "left_collar": ("spine3", (0.07, 0.12, -0.02)),
    "right_collar": ("spine3", (-0.07, 0.12, -0.02)),
    "head": ("neck", (0.0, 0.09, 0.04)),
    "left_shoulder": ("left_collar", (0.11, 0.04, -0.01)),
    "right_shoulder": ("right_collar", (-0.11, 0.04, -0.01)),
    "left_elbow": ("left_shoulder", (0.26, 0.0, -0.02)),
    "right_elbow": ("right_shoulder", (-0.26, 0.0, -0.02)),
    "left_wrist": ("left_elbow", (0.25, 0.0, 0.0)),
    "right_wrist": ("right_elbow", (-0.25, 0.0, 0.0)),
}
_HANDS = {
    "left_hand": ("left_wrist", (0.08, 0.0, 0.0)),
    "right_hand": ("right_wrist", (-0.08, 0.0, 0.0)),
}
_FACE = {
    "jaw": ("head", (0.0, 0.0, 0.02)),
    "left_eye": ("head", (0.03, 0.06, 0.06)),
    "right_eye": ("head", (-0.03, 0.06, 0.06)),
}
# Along the hand and across it, in metres, where each finger begins.
_FINGERS = {
    "index": (0.09, 0.02),
    "middle": (0.1, 0.0),
    "pinky": (0.07, -0.04),
    "ring": (0.08, -0.02),
    "thumb": (0.02, 0.03),
}
_PHALANX = 0.03
_ENDS = {"head": (0.0, 0.18, 0.0), "left_foot": (0.0, 0.0, 0.07), "right_foot": (0.0, 0.0, 0.07)}
_Bones = dict[str, tuple[str, tuple[float, float, float]]]


def _fingers() -> _Bones:
    bones: _Bones = {}
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for finger, (along, across) in _FINGERS.items():
            above = f"{side}_wrist"
            for number in (1, 2, 3):
                first = (sign * along, 0.0, across)
                place = first if number == 1 else (sign * _PHALANX, 0.0, 0.0)
                bones[f"{side}_{finger}{number}"] = (above, place)
                above = f"{side}_{finger}{number}"
    return bones


# The joints of each model in its order, by the numbers of a frame.
_MODELS: dict[int, _Bones] = {
    66: _BODY,
    72: _BODY | _HANDS,
    156: _BODY | _fingers(),
    165: _BODY | _FACE | _fingers(),
}
_POSES = ("poses", "pose_body")
# Arrays that together are the poses, in the order of SMPL-X.
_PARTS = ("root_orient", "pose_body", "pose_jaw", "pose_eye", "pose_hand")
_RATES = ("mocap_framerate", "mocap_frame_rate", "fps", "frame_rate")
_KINDS = dict.fromkeys((*_PARTS, "poses", "trans", *_RATES), "fiu")


class SmplReader:
    """The reader of NPZ files of SMPL bodies."""

    name = "smpl"
    suffixes = (".npz",)
    # Other NPZ hold points.
    shares_suffix = True

    def read(self, path: Path) -> Motion:
        """Read an NPZ of poses of SMPL, SMPL+H or SMPL-X.

        Parameters
        ----------
        path : Path

        Returns
        -------
        Motion
            Lengths in metres; the root moves as ``trans`` says.

        Raises
        ------
        FormatError
            If the file is not sound, or has not the numbers of a model.
        OSError
            If it cannot be read.
        """
        arrays = arrays_of(path, _KINDS)
        poses = _poses(path, arrays)
        bones = _MODELS.get(poses.shape[1])
        if bones is None:
            known = ", ".join(map(str, _MODELS))
            told = f"expected {known} numbers in a pose, found {poses.shape[1]}"
            raise FormatError(told, path=path)
        fault = fault_of_size(len(poses), len(bones))
        if fault is not None:
            raise FormatError(fault, path=path)
        require_memory(len(poses), len(bones))
        turns = rot.from_rotation_vector(poses.reshape(len(poses), -1, 3))
        path_of_root = _checked(path, arrays, "trans", len(poses))
        step = 1.0 / _rate(path, arrays)
        return Motion(_skeleton(bones), turns, path_of_root, step, None, name_of(path))

    def claims(self, path: Path) -> bool:
        """Tell whether an NPZ holds poses of SMPL.

        Raises
        ------
        OSError
            If it cannot be read.
        """
        return any(name in _POSES for name in names_in(path))


def _poses(path: Path, arrays: dict[str, NDArray[Any]]) -> Array:
    if "poses" in arrays:
        return _checked(path, arrays, "poses", None)
    there = [name for name in _PARTS if name in arrays]
    if there[:2] != list(_PARTS[:2]):
        raise FormatError("expected an array 'poses', found none", path=path)
    parts = [_checked(path, arrays, name, None) for name in there]
    if len({len(part) for part in parts}) > 1:
        lengths = sorted({len(part) for part in parts})
        raise FormatError(f"expected poses of one number of frames, found {lengths}", path=path)
    return np.concatenate(parts, axis=1)


def _checked(path: Path, arrays: dict[str, NDArray[Any]], name: str, frames: int | None) -> Array:
    """Return an array of rows; those of the root where a number of frames is asked for."""
    found = arrays.get(name)
    if found is None and frames is not None:
        return np.zeros((frames, 3))
    shape = "(F, n)" if frames is None else f"({frames}, 3)"
    if found is None or found.ndim != 2 or not len(found):
        told = "none" if found is None else f"{found.shape}"
        raise FormatError(f"expected {name!r} of shape {shape}, found {told}", path=path)
    if frames is not None and found.shape != (frames, 3):
        raise FormatError(f"expected {name!r} of shape {shape}, found {found.shape}", path=path)
    with np.errstate(all="ignore"):
        rows = found.astype(float)
    if not np.all(np.abs(rows) <= LARGEST):
        told = f"expected finite numbers of at most {LARGEST:g} in {name!r}, found others"
        raise FormatError(told, path=path)
    return rows


def _rate(path: Path, arrays: dict[str, NDArray[Any]]) -> float:
    """Return the frames a second; the usual, with a note, where none are told."""
    for name in _RATES:
        found = arrays.get(name)
        if found is not None and found.size == 1:
            rate = float(found.reshape(-1)[0])
            if not 0.0 < rate < LARGEST:
                raise FormatError(f"expected a positive {name!r}, found {rate:g}", path=path)
            return rate
    return rate_assumed(path)


def _skeleton(bones: _Bones) -> Skeleton:
    """Return the skeleton of a model, parents first as in its order."""
    names = tuple(bones)
    parents = tuple(names.index(parent) if parent else -1 for parent, _ in bones.values())
    offsets = np.array([offset for _, offset in bones.values()])
    ends = tuple((names.index(name), np.array(end)) for name, end in _ENDS.items())
    return Skeleton(names, parents, offsets, ends)
