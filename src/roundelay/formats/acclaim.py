"""What an Acclaim skeleton file (ASF) says of its bones.

A bone becomes the joint at its start, of the same name; the bone's end is where its children
start. A bone with local axes C turns by C M C^-1, M its degrees of freedom applied in the
file's order about fixed axes ("rx ry rz": M = Rz Ry Rx); C is composed likewise from the
``axis`` angles. Lengths stay as written; the file's ``length`` unit is kept in the layout.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.formats.euler import Winding
from roundelay.geometry import rotations as rot

__all__ = ["ROOT_DOF", "AcclaimLayout", "Bone", "Vector"]

Array = NDArray[np.float64]
Vector = tuple[float, float, float]

ROOT_DOF = ("tx", "ty", "tz", "rx", "ry", "rz")
_ZERO: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Bone:
    """Hold a bone of an ASF as written there.

    Parameters
    ----------
    name : str
    direction : (float, float, float)
        From the bone's start to its end, in global axes.
    length : float
        In the file's numbers.
    axis : (float, float, float)
        Angles of the bone's local axes, in the file's unit.
    axis_order : str
        The order in which they apply about fixed axes, as in "XYZ".
    dof : tuple of str
        Channels in the AMC's order: rx ry rz turn the bone, tx ty tz (also lx ly lz) move its
        start along its local axes, l lengthens it.
    limits : tuple of (str, str)
        Smallest and largest value of each channel, as written.
    """

    name: str
    direction: Vector = (0.0, 0.0, 1.0)
    length: float = 0.0
    axis: Vector = _ZERO
    axis_order: str = "XYZ"
    dof: tuple[str, ...] = ()
    limits: tuple[tuple[str, str], ...] = ()

    @property
    def turns(self) -> str:
        """Axes of the rotation channels, intrinsic (last applied first), as in "ZYX"."""
        return "".join(dof[1].upper() for dof in self.dof if dof[0] == "r")[::-1]

    @property
    def end(self) -> Array:
        """The bone's end (3,) relative to its start, at rest."""
        return np.array(self.direction) * self.length

    def columns(self, kind: str) -> list[int]:
        """Return where among the bone's channels those of a kind are: "r", "t" or "l"."""
        kinds = ["t" if len(dof) == 2 and dof[0] in "tl" else dof[0] for dof in self.dof]
        return [column for column, own in enumerate(kinds) if own == kind]


@dataclass(frozen=True)
class AcclaimLayout:
    """Hold how an ASF writes its skeleton.

    Parameters
    ----------
    bones : tuple of Bone
        One a joint, in the joints' order; the first is the root, whose ``axis`` is its
        orientation and whose ``dof`` is the order of its channels.
    position : (float, float, float)
        The root's place at rest, added to its path.
    units : tuple of (str, str)
        The file's units: mass, length and angle ("deg" or "rad").
    heading : tuple of str
        Lines of the file's version, name and documentation.
    frame_order : tuple of str
        Bones in the order of the AMC's frames, as far as they are known.
    windings : tuple of {"principal", "positive", "continuous"}
        Which of the equivalent angles each bone's channels give, if known; see
        `euler.Winding`.
    """

    bones: tuple[Bone, ...]
    position: Vector = _ZERO
    units: tuple[tuple[str, str], ...] = (("mass", "1.0"), ("length", "1.0"), ("angle", "deg"))
    heading: tuple[str, ...] = (":version 1.10", ":name roundelay")
    frame_order: tuple[str, ...] = ()
    windings: tuple[Winding, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the bones."""
        return tuple(bone.name for bone in self.bones)

    @property
    def degree(self) -> float:
        """Radians in the file's unit of angle."""
        angle = dict(self.units).get("angle", "deg").lower()
        return float(np.pi / 180.0) if angle.startswith("deg") else 1.0

    def local_axes(self) -> Array:
        """Return the rotations (J, 4) from the bones' local axes to the skeleton's."""
        turns = [
            rot.from_euler(np.array(bone.axis[::-1]) * self.degree, bone.axis_order[::-1])
            for bone in self.bones
        ]
        return np.array(turns)
