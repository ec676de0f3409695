"""The animations of an FBX file: which curves move which objects."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import dataclass

from roundelay.formats.fbx_curves import Curve, read_curve, read_old_curve
from roundelay.formats.fbx_document import Fbx, Object, Properties
from roundelay.formats.fbx_elements import Element
from roundelay.formats.nodes import note

__all__ = ["Channel", "Take", "takes_of"]

_KINDS = {"Lcl Translation": "T", "Lcl Rotation": "R", "Lcl Scaling": "S"}
_AXES = ("X", "Y", "Z")


@dataclass(frozen=True)
class Channel:
    """What a take does to the translation, the rotation or the scale of an object.

    Parameters
    ----------
    curves : tuple of Curve or None
        Along X, Y and Z.
    defaults : tuple of float or None
        Where there is no curve; None for what the object has itself.
    """

    curves: tuple[Curve | None, ...]
    defaults: tuple[float | None, ...]

    @property
    def moves(self) -> bool:
        """Whether it has a key at all."""
        return any(curve is not None for curve in self.curves)


@dataclass(frozen=True)
class Take:
    """Name an animation; its channels are read when they are asked for."""

    fbx: Fbx
    name: str
    source: Object | Element

    def channels(self) -> dict[tuple[Hashable, str], Channel]:
        """Return the channels that have keys, by the object and by "T", "R" or "S".

        Raises
        ------
        FormatError
            If a curve is not sound.
        """
        if isinstance(self.source, Element):
            found = dict(_old_channels(self.fbx, self.source))
        else:
            found = _channels(self.fbx, self.source)
        return {key: channel for key, channel in found.items() if channel.moves}


def takes_of(fbx: Fbx) -> list[Take]:
    """List the animations of a file, in its order."""
    stacks = fbx.of_kind("AnimationStack")
    if stacks:
        return [Take(fbx, stack.name, stack) for stack in stacks]
    listed = fbx.root.first("Takes")
    return [
        Take(fbx, one.text(0, "") or "take", one)
        for one in (() if listed is None else listed.all("Take"))
        if one.first("Model") is not None
    ]


def _channels(fbx: Fbx, stack: Object) -> dict[tuple[Hashable, str], Channel]:
    """Read the channels of the first layer that has any; others are left out, with a note."""
    moved = _targets(fbx)
    layers = []
    for layer, _ in fbx.below(stack.identity, "AnimationLayer"):
        found = {
            target: _channel(fbx, group)
            for group, _ in fbx.below(layer.identity, "AnimationCurveNode")
            for target in moved.get(group.identity, ())
        }
        if any(channel.moves for channel in found.values()):
            layers.append(found)
    if len(layers) > 1:
        note(fbx.path, f"of {len(layers)} layers of {stack.name!r} the first is read; bake them")
    return layers[0] if layers else {}


def _targets(fbx: Fbx) -> dict[Hashable, list[tuple[Hashable, str]]]:
    """Return what each group of curves moves."""
    found: dict[Hashable, list[tuple[Hashable, str]]] = {}
    for child, parent, of in fbx.links:
        if of in _KINDS and parent in fbx.objects:
            found.setdefault(child, []).append((parent, _KINDS[of]))
    return found


def _channel(fbx: Fbx, group: Object) -> Channel:
    curves: list[Curve | None] = [None, None, None]
    for curve, of in fbx.below(group.identity, "AnimationCurve"):
        axis = of.removeprefix("d|")
        if axis in _AXES:
            curves[_AXES.index(axis)] = read_curve(curve.element, fbx.ticks)
    known = Properties.of(group.element)
    defaults = [
        known.number(f"d|{axis}", 0.0) if f"d|{axis}" in known.rows else None for axis in _AXES
    ]
    return Channel(tuple(curves), tuple(defaults))


def _old_channels(fbx: Fbx, take: Element) -> Iterator[tuple[tuple[Hashable, str], Channel]]:
    for model in take.all("Model"):
        identity = model.text(0, "")
        own, mark, kind = identity.partition("\0\1")
        identity = f"{kind}::{own}" if mark else identity
        for transform in model.all("Channel"):
            if transform.text(0, "") != "Transform":
                continue
            for channel in transform.all("Channel"):
                kind = channel.text(0, "")
                if kind in ("T", "R", "S"):
                    yield (identity, kind), _old_channel(fbx, channel)


def _old_channel(fbx: Fbx, channel: Element) -> Channel:
    curves: list[Curve | None] = [None, None, None]
    defaults: list[float | None] = [None, None, None]
    for one in channel.all("Channel"):
        axis = one.text(0, "")
        if axis in _AXES:
            number = _AXES.index(axis)
            curves[number] = read_old_curve(one, fbx.ticks)
            told = one.first("Default")
            if told is not None:
                defaults[number] = float(told.numbers(0, 1)[0])
    return Channel(tuple(curves), tuple(defaults))
