"""Write Acclaim motion files (AMC), each with its skeleton (ASF) beside it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roundelay.formats import text
from roundelay.formats.acclaim import AcclaimLayout, Bone
from roundelay.formats.acclaim_bones import Rig, rig
from roundelay.formats.amc import FRAME_TIME
from roundelay.formats.euler import DEGREE, Winding, decompose
from roundelay.geometry import rotations as rot
from roundelay.motion.motion import Motion

__all__ = ["AmcWriter"]

Array = NDArray[np.float64]


class AmcWriter:
    """The writer of AMC files, each with its ASF."""

    name = "amc"
    suffixes = (".amc",)

    def write(self, motion: Motion, path: Path) -> None:
        """Write an AMC file, and the ASF of the same name beside it.

        Bones, axes and channels are those of the ASF the skeleton came from, with more channels
        where those cannot express the motion; otherwise every joint becomes a bone with axes
        "0 0 0 XYZ" and channels "rx ry rz". The root is called "root", as the format demands. A
        rate other than 120 frames a second is written as ``:SAMPLES-PER-SECOND``.

        Raises
        ------
        OSError
            If a file cannot be written.
        """
        bones = rig(motion)
        text.save(path.with_suffix(".asf"), _skeleton(bones))
        text.save(path, _frames(motion, bones.layout))


def _skeleton(bones: Rig) -> Iterator[str]:
    layout = bones.layout
    yield "".join(f"{line}\n" for line in layout.heading)
    yield ":units\n" + "".join(f"  {name} {value}\n" for name, value in layout.units)
    root = layout.bones[0]
    yield f":root\n  order {' '.join(root.dof).upper()}\n  axis {root.axis_order}\n"
    yield f"  position {_numbers(layout.position)}\n  orientation {_numbers(root.axis)}\n"
    yield ":bonedata\n"
    for number, bone in enumerate(layout.bones[1:], 1):
        yield from _bone(number, bone)
    yield ":hierarchy\n  begin\n"
    yield from _tree(bones)
    yield "  end\n"


def _bone(number: int, bone: Bone) -> Iterator[str]:
    yield f"  begin\n    id {number}\n    name {bone.name}\n"
    yield f"    direction {_numbers(bone.direction)}\n    length {_numbers([bone.length])}\n"
    yield f"    axis {_numbers(bone.axis)} {bone.axis_order}\n"
    if bone.dof:
        yield f"    dof {' '.join(bone.dof)}\n"
    if len(bone.limits) == len(bone.dof) > 0:
        limits = (f"({low} {high})" for low, high in bone.limits)
        yield "    limits " + "\n           ".join(limits) + "\n"
    yield "  end\n"


def _tree(bones: Rig) -> Iterator[str]:
    names = [bone.name for bone in bones.layout.bones]
    children: list[list[str]] = [[] for _ in names]
    for name, parent in zip(names[1:], bones.parents[1:], strict=True):
        children[parent].append(name)
    for name, own in zip(names, children, strict=True):
        if own:
            yield f"    {name} {' '.join(own)}\n"


def _frames(motion: Motion, layout: AcclaimLayout) -> Iterator[str]:
    yield ":FULLY-SPECIFIED\n"
    if abs(motion.frame_time - FRAME_TIME) > 1e-9:
        yield f":SAMPLES-PER-SECOND {motion.fps!r}\n"
    yield ":DEGREES\n" if layout.degree == DEGREE else ":RADIANS\n"
    moving = _frame_order(layout, motion.skeleton.n_joints)
    row = "%s\n"
    for joint in moving:
        row += f"{layout.bones[joint].name}{' %s' * len(layout.bones[joint].dof)}\n"
    number = np.arange(1.0, len(motion) + 1.0)[:, None]
    yield from text.rows(np.hstack([number, *_columns(motion, layout, moving)]), row)


def _frame_order(layout: AcclaimLayout, joints: int) -> list[int]:
    """Return the joints whose bones have channels, in the order in which frames list them."""
    place = {name: number for number, name in enumerate(layout.frame_order)}
    moving = [joint for joint in range(joints) if layout.bones[joint].dof]
    return sorted(moving, key=lambda joint: place.get(layout.bones[joint].name, len(place)))


def _columns(motion: Motion, layout: AcclaimLayout, joints: list[int]) -> Iterator[Array]:
    """Yield the channels (F, n) of some joints' bones, in the layout's unit of angle."""
    axes = layout.local_axes()
    unknown: tuple[Winding, ...] = ("continuous",)
    windings = layout.windings or unknown * len(axes)
    for joint in joints:
        bone = layout.bones[joint]
        own = np.empty((len(motion), len(bone.dof)))
        own[:, bone.columns("t")] = _moves(motion, layout, joint, axes[joint])
        if bone.turns:
            turns = motion.rotations[:, [joint]]
            local = rot.multiply(rot.multiply(rot.conjugate(axes[joint]), turns), axes[joint])
            angles = decompose(local, bone.turns, windings[joint])[:, 0, ::-1]
            own[:, bone.columns("r")] = angles * (DEGREE / layout.degree)
        yield own


def _moves(motion: Motion, layout: AcclaimLayout, joint: int, axes: Array) -> Array:
    """Return the values (F, n) of a bone's translation channels."""
    bone = layout.bones[joint]
    places = [bone.dof[column][1] for column in bone.columns("t")]
    if joint == 0:
        moves = motion.root_path - np.array(layout.position)
    elif motion.translations is None:
        return np.zeros((len(motion), len(places)))
    else:
        away = motion.translations[:, joint] - motion.skeleton.offsets[joint]
        moves = rot.rotate(rot.conjugate(axes), away)
    return moves[:, ["xyz".index(axis) for axis in places]]


def _numbers(values: Array | tuple[float, ...] | list[float]) -> str:
    return " ".join(f"{value:.10g}" for value in values)
