# SPDX-License-Identifier: GPL-3.0-or-later
"""What an armature plays: an action of its own, or strips of the NLA, and the curves in them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil, floor
from typing import Any

import bpy

from roundelay import SkeletonMismatch

from . import compat
from .compat import Armature

# FBX files end at frames such as 31.99997.
_NEARLY = 1e-3


@dataclass(frozen=True)
class Take:
    """What is played.

    Attributes
    ----------
    action : bpy.types.Action
        The one it is named after: the armature's own, else that of the lowest strip that plays.
    bare : bool
        Whether only strips play.
    strips : tuple of bpy.types.NlaStrip
        Those that play.
    """

    action: bpy.types.Action
    bare: bool
    strips: tuple[Any, ...]

    @property
    def frames(self) -> range:
        """The whole frames in which anything is keyed."""
        ends = [(s.frame_start, s.frame_end) for s in self.strips]
        if not self.bare:
            ends.append((self.action.frame_range[0], self.action.frame_range[1]))
        first, last = min(a for a, _ in ends), max(b for _, b in ends)
        return range(ceil(first - _NEARLY), floor(last + _NEARLY) + 1)


def take_of(armature: Armature) -> Take:
    """Return what an armature plays.

    Raises
    ------
    SkeletonMismatch
        If that is nothing.
    """
    data = armature.animation_data
    if data is None:
        raise SkeletonMismatch(f"{armature.name} has no action: give it one in the Action Editor")
    strips = tuple(_playing(data))
    if data.action is not None:
        return Take(data.action, False, strips)
    if strips:
        return Take(strips[0].action, True, strips)
    why = "no action"
    if any(track.strips for track in data.nla_tracks):
        why = "no action, and its NLA tracks are muted: unmute one"
    raise SkeletonMismatch(f"{armature.name} has {why}")


def _playing(data: Any) -> Iterator[Any]:
    """Yield the strips of actions that have a say, from the lowest up."""
    if not data.use_nla or data.use_tweak_mode:
        return
    alone = any(track.is_solo for track in data.nla_tracks)
    for track in data.nla_tracks:
        if track.is_solo if alone else not track.mute:
            yield from (s for s in track.strips if s.action is not None and not s.mute)


def curves_of(armature: Armature) -> list[Any]:
    """Return the curves that drive an armature, those of strips included; muted ones are not."""
    data = armature.animation_data
    if data is None:
        return []
    found = [] if data.action is None else list(compat.fcurves(data))
    for strip in _playing(data):
        found += compat.curves_of_slot(strip.action, compat.slot_of(strip))
    return [curve for curve in found if not curve.mute]


def require_writable(armature: Armature) -> None:
    """Check that a loop can be given to an armature.

    Raises
    ------
    SkeletonMismatch
        If it is linked from another file, or overridden but not editable.
    """
    if armature.library is not None:
        raise SkeletonMismatch(
            f"{armature.name} is linked from {bpy.path.basename(armature.library.filepath)}: make "
            "a library override of it, or open that file"
        )
    override = armature.override_library
    if override is not None and override.is_system_override:
        raise SkeletonMismatch(
            f"{armature.name} is an override that is not editable: make it editable first "
            "(Library Override > Make)"
        )
