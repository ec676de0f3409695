"""What happens in a cycle, and at which of it a loop begins.

A foot makes contact where it is farthest ahead of the pelvis, and leaves the ground where it is
farthest behind (Zeni, Richards, Higginson 2008, "Two simple methods for determining gait events
during treadmill and overground walking using kinematic data"): along the way, or, of those who stay
in place, along their facing. Cycles begin at the left foot's contact, so that all loops of a gait
are in step; where no foot steps, at the pose that is farthest from the mean one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.spans import closed_spans
from roundelay.base.threads import one_thread
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.edit.align import shifted
from roundelay.cycles.thresholds import CYCLE, EVENTS
from roundelay.geometry.contacts import Foot, find_feet, foot_points, left_and_right
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.geometry.symmetry import facing
from roundelay.motion.features import point_cloud
from roundelay.motion.motion import Motion
from roundelay.phase.tempo import lowest_between

__all__ = ["Event", "begun", "checked_start", "event_markers", "events_of", "started"]

Array = NDArray[np.float64]

_SIDES = ("left", "right")
_FRAME = "frame:"


@dataclass(frozen=True)
class Event:
    """What happens at a phase of a cycle.

    Attributes
    ----------
    name : {"left contact", "right contact", "left off", "right off"}
    phase : float
        In [0, 1).
    """

    name: str
    phase: float


@dataclass(frozen=True, eq=False)
class _Stride:
    """How far ahead of the pelvis the left and the right foot are, at even phases of a cycle.

    Attributes
    ----------
    heels, toes : (n, 2) ndarray
        In body sizes.
    """

    heels: Array
    toes: Array


@one_thread
def events_of(cycle: Cycle) -> tuple[Event, ...]:
    """Return when the feet of a cycle make contact and leave the ground, in order of phase.

    Parameters
    ----------
    cycle : Cycle

    Returns
    -------
    tuple of Event
        Empty where no foot steps, the skeleton has no left and right foot, or a body that stays in
        place has its hips at one place or above each other, so that no way is ahead.
    """
    stride = _stride(cycle)
    found = [] if stride is None else list(_events(stride))
    return tuple(sorted(found, key=lambda event: event.phase))


def event_markers(cycle: Cycle, count: int) -> list[dict[str, Any]]:
    """Return the events of a cycle as plain data.

    Parameters
    ----------
    cycle : Cycle
    count : int
        Frames of a period.

    Returns
    -------
    list of dict
        Name, phase in turns, and the frame of the period, which need not be whole, of each.
    """
    return [
        {"name": event.name, "phase": event.phase, "frame": event.phase * count}
        for event in events_of(cycle)
    ]


def begun(cycle: Cycle) -> Cycle:
    """Return the cycle that begins at the left foot's contact.

    Parameters
    ----------
    cycle : Cycle

    Returns
    -------
    Cycle
        Where no left foot steps, it begins at the pose that is farthest from the mean one.
    """
    stride = _stride(cycle)
    stepping = stride is not None and np.ptp(stride.heels[:, 0]) >= EVENTS.steps
    return shifted(cycle, _contact(stride, 0) if stride and stepping else _largest(cycle))


def checked_start(start: float | str) -> None:
    """Refuse a start that has none of the forms that `started` takes.

    Raises
    ------
    ValueError
        If it has none.
    """
    number = start.removeprefix(_FRAME) if isinstance(start, str) else ""
    named = start in _SIDES or (number != start and number.isdecimal())
    if isinstance(start, str) and not named:
        raise ValueError(
            "expected a start of left, right, a phase from 0 to below 1, or frame:N, "
            f"found {start!r}"
        )


@one_thread
def started(cycle: Cycle, start: float | str, capture: Motion | None = None) -> Cycle:
    """Return the cycle that begins elsewhere.

    Parameters
    ----------
    cycle : Cycle
    start : float or str
        "left" or "right" for the contact of that foot; a phase of the cycle, 0 being where it
        begins; "frame:N" for what a frame of the capture shows.
    capture : Motion, optional
        The capture: a frame of it is looked for in the cycle by its pose. By default by its phase
        alone, from which a single repetition strays.

    Raises
    ------
    ValueError
        If the start has no form that is known, the skeleton has no left and right foot, or none
        side by side, or the frame does not show the motion.
    """
    checked_start(start)
    if start in _SIDES:
        stride = _stride(cycle)
        if stride is None:
            raise ValueError(
                f"expected a left and a right foot, side by side, to start at, found none: {start}"
            )
        return shifted(cycle, _contact(stride, _SIDES.index(str(start))))
    if isinstance(start, str):
        frame = int(start.removeprefix(_FRAME))
        told = _phase_of(cycle, frame)
        return shifted(cycle, told if capture is None else _nearest(cycle, capture, frame))
    return shifted(cycle, start)


def _phase_of(cycle: Cycle, frame: int) -> float:
    """Return the phase that a frame of the capture shows, in [0, 1)."""
    if cycle.phase is None or cycle.evidence is None:
        raise ValueError(f"expected a cycle of one capture to start at frame {frame}, found none")
    if not (frame < len(cycle.phase) and np.isfinite(cycle.phase[frame])):
        raise ValueError(f"expected a start within frames {cycle.evidence.runs}, found {frame}")
    return float(cycle.phase[frame]) % 1.0


def _nearest(cycle: Cycle, capture: Motion, frame: int) -> float:
    """Return the phase of the pose that is nearest to that of a frame, in [0, 1).

    What goes to and fro shows each pose twice. Pose and speed together tell about where the frame
    is, the pose alone which phase it is of those that go the same way.
    """
    count = EVENTS.phases
    body = replace(cycle, above=None).at(np.arange(count) / count, frame_time=1.0, in_place=True)
    around = np.clip([frame - 1, frame, frame + 1], 0, len(capture) - 1)
    before, pose, behind = point_cloud(capture.with_root_motion())[around]
    poses = point_cloud(body)
    # Ways a radian of phase weigh as much as poses.
    ways = (np.roll(poses, -1, axis=0) - np.roll(poses, 1, axis=0)) * count / (4 * np.pi)
    way = (behind - before) / (around[2] - around[0]) * cycle.period * capture.fps / (2 * np.pi)
    apart = np.sum((poses - pose) ** 2, axis=1)
    about = int(np.argmin(apart + np.sum((ways - way) ** 2, axis=1)))
    onward = ways @ ways[about] > 0.0
    return _between(-apart, int(np.argmin(np.where(onward, apart, np.inf))))


def _stride(cycle: Cycle) -> _Stride | None:
    """Look where the feet are; None without a left and a right one, or any way that is ahead."""
    phases = np.arange(EVENTS.phases) / EVENTS.phases
    body = replace(cycle, above=None).at(phases, frame_time=1.0, in_place=True)
    places, turns = forward_kinematics(
        body.skeleton, body.rotations, body.root_path, translations=body.translations
    )
    feet = find_feet(body.skeleton, places, body.up)
    pair = left_and_right(body.skeleton, feet)
    if pair is None:
        return None
    legs = tuple(feet[place] for place in pair)
    way = _ahead(cycle, body, places, legs)
    if way is None:
        return None
    ahead = way / body.skeleton.size
    pelvis = places[:, body.skeleton.trunk[-1], None]
    heels = places[:, [foot.ankle for foot in legs]] - pelvis
    toes = foot_points(legs, places, turns) - pelvis
    return _Stride(heels @ ahead, toes @ ahead)


def _ahead(cycle: Cycle, body: Motion, places: Array, legs: tuple[Foot, ...]) -> Array | None:
    """Return the direction (3,) of the way, or where it stays in place the one it faces, if any."""
    up = body.up_vector
    # A pelvis that hangs far from the root goes about it where the motion turns.
    arm = np.mean(places[:, body.skeleton.trunk[-1]] - body.root_path, axis=0)
    way = (cycle.velocity.constant + cycle.turning * np.cross(up, arm)) * (1.0 - up)
    length = float(np.linalg.norm(way))
    if length < CYCLE.travels * body.skeleton.size:
        left, right = (places[:, foot.hip] for foot in legs)
        return facing(left, right, body.up, body.skeleton.size)
    return np.asarray(way / length)


def _events(stride: _Stride) -> Iterator[Event]:
    for place, side in enumerate(_SIDES):
        if np.ptp(stride.heels[:, place]) < EVENTS.steps:
            continue
        for name, ahead in (("contact", stride.heels), ("off", -stride.toes)):
            yield from (Event(f"{side} {name}", x) for x in _peaks(ahead[:, place]))


def _peaks(values: Array) -> list[float]:
    """Return the phase of the largest value in each stretch above the middle of values (n,)."""
    above = values > 0.5 * (values.min() + values.max())
    twice = np.concatenate([values, values])
    tops = [start + int(np.argmax(twice[start:stop])) for start, stop in closed_spans(above)]
    return [_between(values, top % len(values)) for top in tops]


def _between(values: Array, top: int) -> float:
    """Return the phase of a maximum beside a place of values (n,) at even phases."""
    around = values[[top - 1, top, (top + 1) % len(values)]]
    # A tenth of a frame decides nothing, and what lies at 0 is told to be there.
    return round((top + lowest_between(-around)) / len(values), 4) % 1.0


def _contact(stride: _Stride, side: int) -> float:
    """Return the phase at which a foot is farthest ahead of all."""
    values = stride.heels[:, side]
    return _between(values, int(np.argmax(values)))


def _largest(cycle: Cycle) -> float:
    """Return the phase of the pose that is farthest from the mean one.

    What goes to and fro has two that are about as far; the one with the higher joints counts.
    """
    phases = np.arange(EVENTS.phases) / EVENTS.phases
    body = replace(cycle, above=None).at(phases, frame_time=1.0, in_place=True)
    poses = point_cloud(body)
    away = np.sqrt(np.sum((poses - poses.mean(axis=0)) ** 2, axis=1))
    tops = (away >= np.roll(away, 1)) & (away >= np.roll(away, -1))
    high = body.positions()[..., body.up].mean(axis=1)
    far = np.flatnonzero(tops & (away >= EVENTS.alike * away.max()))
    return _between(away, int(far[np.argmax(high[far])]))
