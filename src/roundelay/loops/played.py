"""What the record of a loop tells the program that plays it, beside what any engine needs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roundelay.cycles.cycle import Cycle
from roundelay.geometry.skeleton import Skeleton
from roundelay.geometry.symmetry import sides
from roundelay.loops.exported import placement, root_bone_name

if TYPE_CHECKING:
    from roundelay.loops.options import LoopOptions

__all__ = ["player_record"]


def player_record(told: dict[str, Any], cycle: Cycle, written: LoopOptions) -> dict[str, Any]:
    """Add to a record of playback what a file is like that was written for a program.

    Parameters
    ----------
    told : dict
        As `roundelay.loops.profiles.Generic.record` tells of the loop in the capture's world.
    cycle : Cycle
    written : LoopOptions

    Returns
    -------
    dict
        ``target``; ``clip``, the animation's name; ``metres_a_unit``; ``root_bone``, its name
        where one was asked for; ``events``: names, frames, seconds and phases of the markers and
        of feet that come down and leave the ground and have no marker, in order of time; the root
        motion and depths in the file's world.
    """
    where = placement(cycle, written)
    carries = written.root_bone and not written.in_place
    motion = dict(told["root_motion"])
    motion |= {"travel": where.vector(cycle.travel).tolist(), "up": "XYZ"[where.up]}
    met = [one | {"depth": one["depth"] * where.scale} for one in told["collisions"]]
    return told | {
        "target": written.target,
        "clip": f"{cycle.name}-loop" if written.target == "godot" else cycle.name,
        "metres_a_unit": where.metres,
        "root_bone": root_bone_name(cycle.skeleton) if carries else None,
        "root_motion": motion,
        "collisions": met,
        "events": _events(told, cycle.skeleton),
    }


def _events(told: dict[str, Any], skeleton: Skeleton) -> list[dict[str, Any]]:
    """List moments of one period by name, in order of time."""
    count, rate = told["frames_per_period"], told["fps"]
    found = [(one["name"], one["frame"]) for one in told["markers"]]
    marked = _marked(told, skeleton)
    for foot, stands in told["contacts"].items():
        for start, stop in stands if foot not in marked else ():
            # A foot that never leaves the ground has no moment at which it comes down.
            if stop - start < count:
                found += [(f"{foot} down", start), (f"{foot} up", stop % count)]
    found.sort(key=lambda one: one[1])
    return [
        {"name": name, "frame": frame, "seconds": frame / rate, "phase": frame / count}
        for name, frame in found
    ]


def _marked(told: dict[str, Any], skeleton: Skeleton) -> set[str]:
    """Return the joints of the sides whose foot's contact or leaving a marker names already."""
    named = {one["name"].partition(" ")[0] for one in told["markers"]}
    pairs = zip(("left", "right"), sides(skeleton), strict=True)
    return {skeleton.names[joint] for side, joints in pairs if side in named for joint in joints}
