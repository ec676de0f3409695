# SPDX-License-Identifier: GPL-3.0-or-later
"""From a cycle to an action on what is keyed, played back before it is kept."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from roundelay import Cycle, Loop, Motion, RoundelayError
from roundelay.geometry import rotations as rot
from roundelay.geometry.kinematics import forward_kinematics

from .averaging import Windows, windows_of
from .capture import Capture
from .checking import Played, against_capture, against_motion
from .controls import Controls, Source, plain_track
from .ground import Ground, ground_of
from .keyed import Property
from .loops import by_axis, loop_of
from .playing import play
from .rig import Rig
from .tracks import Track
from .writing import add_strip, bone_tracks, mark, show, show_capture, steady_track, write_tracks

Array = NDArray[np.float64]
# Yields while the loop is played, and returns how it plays.
Playing = Generator[float, None, Played]


class NotKept(RoundelayError):
    """A loop does not play as was meant."""


def make_action(
    capture: Capture, made: Loop, name: str, scene: bpy.types.Scene, settings: Any
) -> Generator[float, None, tuple[bpy.types.Action, Played]]:
    """Write a loop on what is keyed, play it, and return it with how it plays.

    Raises
    ------
    NotKept
        If it does not play as was meant; nothing is left of it.
    """
    trials = _bone_trials if capture.rig is not None else _control_trials
    worst: Played | None = None
    for tracks, compare in trials(capture, made, scene, settings):
        action = write_tracks(
            capture.armature, tracks, name, start=capture.first, key_step=settings.key_step
        )
        mark(action, capture.take, capture.armature, capture.place)
        played = yield from _played_back(capture, action, scene, compare)
        if played.kept and played.calmer == 0:
            return action, played
        bpy.data.actions.remove(action)
        if played.kept:
            action = write_tracks(
                capture.armature,
                [track.begun(played.calmer) for track in tracks],
                name,
                start=capture.first,
                key_step=settings.key_step,
            )
            mark(action, capture.take, capture.armature, capture.place)
            return action, replace(played, join=played.calm)
        worst = worst if worst is not None and worst.away < played.away else played
    raise NotKept(f"not kept: played back, {worst.told if worst else 'nothing moves'}")


def _played_back(
    capture: Capture, action: bpy.types.Action, scene: bpy.types.Scene, compare: Any
) -> Playing:
    """Play a loop and compare; then the capture drives the armature again."""
    armature, names = capture.armature, _names(capture)
    show(armature, action)
    frames = range(int(action.frame_start), int(action.frame_end) + 1)
    try:
        seen = yield from play(armature, scene, frames, names)
    finally:
        show_capture(armature, action)
    played: Played = compare(seen.matrices)
    return played


def _names(capture: Capture) -> list[str]:
    if capture.body is not None:
        return list(capture.body.names)
    assert capture.rig is not None
    return [bone.name for bone in capture.rig.bones]


def _bone_trials(
    capture: Capture, made: Loop, scene: bpy.types.Scene, settings: Any
) -> Iterator[tuple[list[Track], Any]]:
    """Yield the loop bone by bone."""
    rig, fps = capture.rig, scene.render.fps / scene.render.fps_base
    assert rig is not None
    loop = loop_of(made, capture.motion, settings, fps)
    tracks = list(bone_tracks(rig, loop, capture.keyed, mirror=settings.mirror))
    done = {track.target for track in tracks}
    rest = [one for one in capture.keyed.curves if one not in done]
    tracks += _others(capture, made.cycle, rest, len(loop), settings)
    yield tracks, partial(_bones_compared, rig, loop, settings.key_step, capture.in_part)


def _bones_compared(
    rig: Rig, loop: Motion, key_step: int, in_part: bool, matrices: Array
) -> Played:
    """Compare bones as played (N + 1, J, 4, 4) with a loop, at its keys; in part from the root."""
    # A mirror image is played by the bones that are there, alike on both sides or not.
    skeleton = rig.skeleton if loop.translations is None else loop.skeleton
    meant, turns = forward_kinematics(
        skeleton, loop.rotations, loop.root_path, translations=loop.translations
    )
    count, base = len(rig.bones), np.linalg.inv(rig.base)
    places = matrices[..., :3, 3] @ base[:3, :3].T + base[:3, 3]
    meant = meant[:, :count]
    if in_part:
        linear = matrices[:, 0, :3, :3] / np.linalg.norm(matrices[:, 0, :3, :3], axis=1)[:, None]
        turned = rot.multiply(rot.from_matrix(base[:3, :3] @ linear), rot.conjugate(rig.rest[0]))
        places, meant = _from_root(places, turned), _from_root(meant, turns[:, 0])
    keys = [*range(0, len(loop) - 1, key_step), len(loop) - 1]
    names = [bone.name for bone in rig.bones]
    return against_motion(places, meant, names, rig.skeleton.size, keys)


def _from_root(places: Array, turns: Array) -> Array:
    return rot.rotate(rot.conjugate(turns)[:, None], places - places[:, :1])


def _others(
    capture: Capture, cycle: Cycle, rest: list[Property], count: int, settings: Any
) -> Iterator[Track]:
    """Yield the tracks of what moves no bone: shape keys, and what does not change."""
    moving = [
        one for one in rest if capture.keyed.spans(one) > 0.0 and one.owner != capture.armature
    ]
    windows = _windows(capture, cycle, count - 1, settings) if moving else None
    source = Source(capture.keyed, capture.frames, capture.samples)
    for one in rest:
        if windows is not None and one in moving:
            yield plain_track(one, capture.keyed, source, windows)
        elif capture.place is None or one.bone or one.owner != capture.armature:
            yield steady_track(one, capture.keyed, count)


def _windows(capture: Capture, cycle: Cycle, count: int, settings: Any) -> Windows:
    evidence: Any = cycle.evidence
    phase: Any = cycle.phase
    return windows_of(phase, capture.frames, evidence.runs, count, settings.start_phase)


def _control_trials(
    capture: Capture, made: Loop, scene: bpy.types.Scene, settings: Any
) -> Iterator[tuple[list[Track], Any]]:
    """Yield the mean of the repetitions on the controls, then the one nearest to it."""
    cycle, fps = made.cycle, scene.render.fps / scene.render.fps_base
    count = max(1, round(cycle.period * fps))
    windows = _windows(capture, cycle, count, settings)
    nearest = windows.only(_nearest(capture, windows))
    ways = [windows] if cycle.method != "take" else []
    for chosen in (*ways, nearest):
        ground = _ground(capture, cycle, chosen, settings)
        yield _on_controls(capture, ground, settings), _comparing(capture, ground)


def _ground(capture: Capture, cycle: Cycle, windows: Windows, settings: Any) -> Ground:
    standing: Any = capture.standing

    def travel(way: Array, still: Array) -> Array:
        return by_axis(settings, way, still, np.tile(still.mean(axis=0), (len(still), 1)))

    return ground_of(cycle, standing, capture.frames, windows, travel)


def _on_controls(capture: Capture, ground: Ground, settings: Any) -> list[Track]:
    body: Any = capture.body
    source = Source(capture.keyed, capture.frames, capture.samples)
    controls = Controls(body, capture.keyed, source, ground, capture.parents)
    moved = settings.travel != "TRAVEL"
    return list(controls.tracks(held=settings.foot_lock, moved=moved))


def _comparing(capture: Capture, ground: Ground) -> Any:
    body: Any = capture.body
    standing: Any = capture.standing

    def compare(matrices: Array) -> Played:
        return against_capture(body.at(matrices[..., :3, 3]), body, standing, ground)

    return compare


def _nearest(capture: Capture, windows: Windows) -> int:
    """Return the repetition whose poses are nearest to the mean of all."""
    standing: Motion = capture.standing  # type: ignore[assignment]
    places = standing.positions()
    own = (places - places[:, :1] * (1.0, 1.0, 0.0)).reshape(len(places), -1)
    frames = capture.frames

    def values(at: Array) -> Array:
        return np.stack([np.interp(at, frames, column) for column in own.T], axis=-1)

    each = windows.each(values)
    return int(np.argmin(((each - each.mean(axis=0)) ** 2).sum(axis=(1, 2))))


def finish(capture: Capture, action: bpy.types.Action, settings: Any, *, first: bool) -> None:
    """Show the first loop, and put each on a track of the NLA if asked for."""
    if settings.use_strip:
        add_strip(capture.armature, action, settings.repeat)
    if first:
        show(capture.armature, action)
