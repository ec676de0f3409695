# SPDX-License-Identifier: GPL-3.0-or-later
"""A loop written on what is keyed: every control's mean over the repetitions, at equal phase.

What goes along with the body is averaged as seen from it, and goes its mean way; all else is
averaged as it is.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from roundelay.geometry import rotations as rot

from .averaging import Values, Windows
from .body import Body
from .ground import Ground
from .keyed import Keyed, Property, Samples
from .tracks import Track, angles_of, rows_of

Array = NDArray[np.float64]

# How far a control's own frame may move and still stand, in body sizes and radians.
_STANDS = 1e-3


class Source:
    """The values of what is keyed: by its curves, or as it was seen where strips play."""

    def __init__(self, keyed: Keyed, frames: Array, samples: Samples | None) -> None:
        self._keyed, self._frames, self._samples = keyed, frames, samples

    def of(self, one: Property) -> Values:
        """Return the values of a property."""
        if self._samples is None:
            return lambda frames: self._keyed.values(one, frames)
        seen = self._samples[one]
        return lambda frames: np.stack(
            [np.interp(frames, self._frames, column) for column in seen.T], axis=-1
        )


class Frame:
    """In what a bone's own place and rotation are told: its parent's, as it stands at rest."""

    def __init__(self, bone: Any, parent: Array | None) -> None:
        def posed(local: Matrix) -> Array:
            known: dict[str, Any] = {}
            if parent is not None:
                known["parent_matrix"] = Matrix(parent.tolist())
                known["parent_matrix_local"] = bone.parent.bone.matrix_local
            return np.array(bone.bone.convert_local_to_pose(local, bone.bone.matrix_local, **known))

        plain = posed(Matrix.Identity(4))
        self.origin = plain[:3, 3]
        moved = [posed(Matrix.Translation(axis))[:3, 3] for axis in np.eye(3).tolist()]
        self.axes = np.stack(moved, axis=1) - self.origin[:, None]
        linear = plain[:3, :3]
        self.turn = rot.from_matrix(linear / np.linalg.norm(linear, axis=0))

    def away(self, other: Frame, size: float) -> float:
        """Return how far another frame is from this one, in body sizes and radians."""
        moved = float(np.linalg.norm(other.origin - self.origin)) / size
        return max(moved, float(rot.angle_between(self.turn, other.turn)))


def standing_frame(bone: Any, parents: Array | None, size: float) -> Frame | None:
    """Return a bone's frame if it stands in the armature; parents (V, 4, 4) may be none."""
    if parents is None:
        return Frame(bone, None)
    first = Frame(bone, parents[0])
    looked = np.linspace(0, len(parents) - 1, min(len(parents), _LOOKED)).astype(int)
    frames = (Frame(bone, parents[row]) for row in looked)
    return first if all(first.away(each, size) < _STANDS for each in frames) else None


_LOOKED = 12


def averaged(keyed: Keyed, source: Source, windows: Windows) -> Iterator[Track]:
    """Yield the tracks of properties that are averaged as they are."""
    for one in keyed.curves:
        yield plain_track(one, keyed, source, windows)


def plain_track(one: Property, keyed: Keyed, source: Source, windows: Windows) -> Track:
    """Average a property as it is."""
    values = source.of(one)
    if keyed.stepped(one):
        rows = windows.middle(values)
        return Track.of(one, keyed, rows, stepped=True)
    if one.turns and one.name != "rotation_euler":
        turns = windows.mean_turn(_turns(one, values))
        return Track.of(one, keyed, rows_of(turns, one.name))
    turn = 2.0 * np.pi if one.name == "rotation_euler" else 0.0
    rows = windows.mean(values, windows.runs_on(values), turn)
    return Track.of(one, keyed, rows)


class Controls:
    """The controls of a rig, of whose bones some go along with the body."""

    def __init__(
        self, body: Body, keyed: Keyed, source: Source, ground: Ground, parents: dict[str, Array]
    ) -> None:
        self._body, self._keyed, self._source = body, keyed, source
        self._ground, self._parents = ground, parents

    def tracks(self, *, held: bool, moved: bool) -> Iterator[Track]:
        """Yield the tracks of all that is keyed.

        Parameters
        ----------
        held : bool
            Hold what stands.
        moved : bool
            The way is not that of the capture: whatever could go along does.
        """
        for one in self._keyed.curves:
            track = None
            frame = self._frame(one) if self._ground.moves or moved else None
            if frame is not None and one.name == "location":
                track = self._placed(one, frame, held, moved)
            elif frame is not None and one.turns:
                track = self._turned(one, frame)
            yield track or plain_track(one, self._keyed, self._source, self._ground.windows)

    def _frame(self, one: Property) -> Frame | None:
        if not one.bone:
            return None
        bone = one.holder
        parents = self._parents[bone.parent.name] if bone.parent else None
        return standing_frame(bone, parents, self._ground.size)

    def _placed(self, one: Property, frame: Frame, held: bool, moved: bool) -> Track | None:
        values, body, ground = self._source.of(one), self._body, self._ground

        def places(frames: Array) -> Array:
            return body.at(frame.origin + values(frames) @ frame.axes.T)

        along = moved and not ground.moves
        if not along and not ground.goes_along(places):
            return None
        mean = ground.mean(places, held=held)
        own = rot.rotate(rot.conjugate(body.turn), mean) - frame.origin
        return Track.of(one, self._keyed, own @ np.linalg.inv(frame.axes).T)

    def _turned(self, one: Property, frame: Frame) -> Track | None:
        """Average rotations without the drift of the heading, if they go with it."""
        values, ground = _turns(one, self._source.of(one)), self._ground
        base = rot.multiply(self._body.turn, frame.turn)

        def turns(frames: Array) -> Array:
            return rot.multiply(base, values(frames))

        if not ground.turns_along(turns):
            return None
        mean = ground.windows.mean_turn(ground.unturned(turns))
        own = rot.continuous(rot.multiply(rot.conjugate(base), mean))
        if one.name == "rotation_euler":
            return Track.of(one, self._keyed, angles_of(own, one.holder.rotation_mode))
        return Track.of(one, self._keyed, rows_of(own, one.name))


def _turns(one: Property, values: Values) -> Values:
    """Return the quaternions (..., 4) of a rotation in any mode."""
    if one.name == "rotation_quaternion":
        return lambda frames: rot.normalize(values(frames))
    if one.name == "rotation_axis_angle":
        return lambda frames: _by_axis(values(frames))
    # Blender's XYZ turns about X first: Rz Ry Rx.
    order = one.holder.rotation_mode[::-1]
    axes = ["XYZ".index(axis) for axis in order]
    return lambda frames: rot.from_euler(values(frames)[..., axes], order)


def _by_axis(values: Array) -> Array:
    length = np.linalg.norm(values[..., 1:], axis=-1, keepdims=True)
    return rot.from_rotation_vector(values[..., :1] * values[..., 1:] / np.maximum(length, 1e-9))
