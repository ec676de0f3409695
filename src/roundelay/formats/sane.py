"""One idea of sane for all readers and writers: which rates, lengths and names a file may hold.

What is read lies within it, and so does what is written: a file that was written can be read.
"""

from __future__ import annotations

import numpy as np

from roundelay.base.memory import require_room
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import FASTEST, Motion
from roundelay.motion.points import Points

__all__ = [
    "LARGEST",
    "MOST_FRAMES",
    "MOST_JOINTS",
    "SHORTEST",
    "SLOWEST",
    "fault_of",
    "fault_of_points",
    "fault_of_size",
    "require_memory",
]

LARGEST = 1e12
"""No length, place or angle of a file is larger; products of some such are still finite."""
SHORTEST = 1e-5
"""The longest bone is at least that long, if any has a length: text has eight decimals."""
SLOWEST = 1e-4
"""Frames a second; fewer are no capture, but a slip in a header."""


MOST_JOINTS = 4096
"""More than any body has; the benchmark `budget` holds what is below to account."""
MOST_FRAMES = 4_000_000
"""Nine hours at 120 frames a second."""
# Of a joint in a frame while it is read: a quaternion, and what it is computed from.
_BYTES = 64


def fault_of_size(frames: int, joints: int) -> str | None:
    """Tell what is not sane of the size of a motion, before its poses take memory."""
    for count, most, what in ((frames, MOST_FRAMES, "frames"), (joints, MOST_JOINTS, "joints")):
        if count > most:
            return f"expected at most {most} {what}, found {count}"
    return None


def require_memory(frames: int, joints: int) -> None:
    """Check that there is memory for the poses of a file, before they take it.

    Raises
    ------
    TooLarge
        If less is free: how much it would take, and what to do.
    """
    what = f"{frames} frames of {joints} joints"
    advice = "close other programs, or cut the file into shorter ones"
    require_room(_BYTES * frames * joints, what, advice)


def fault_of(motion: Motion) -> str | None:
    """Tell what is not sane of a motion: what was expected, and what was found; None if all is."""
    if not SLOWEST <= motion.fps <= FASTEST:
        rates = f"from {SLOWEST:g} to {FASTEST:g} frames a second, found {motion.fps:g}"
        return f"expected {rates}; give the true rate (--capture-fps)"
    size = fault_of_size(len(motion), motion.skeleton.n_joints)
    return size or _fault_of_names(motion.skeleton) or _fault_of_lengths(motion)


def fault_of_points(points: Points) -> str | None:
    """Tell what is not sane of points: what was expected, and what was found; None if all is."""
    if not SLOWEST <= points.fps <= FASTEST:
        rates = f"from {SLOWEST:g} to {FASTEST:g} frames a second, found {points.fps:g}"
        return f"expected {rates}; give the true rate (--capture-fps)"
    size = fault_of_size(len(points), len(points.names))
    if size is not None:
        return size.replace("joints", "points")
    far = np.abs(points.positions).max(axis=2)
    if not far.max(initial=0.0) > LARGEST:
        return None
    frame, point = np.unravel_index(np.argmax(far), far.shape)
    where = f"in frame {frame + 1} of {points.names[point]!r}"
    return f"expected places of at most {LARGEST:g}, found {far.max():.3g} {where}"


def _fault_of_names(skeleton: Skeleton) -> str | None:
    for name in skeleton.names:
        if any("\ud800" <= letter <= "\udfff" for letter in name):
            return f"expected joint names that UTF-8 can hold, found {name!r}"
    return None


def _fault_of_lengths(motion: Motion) -> str | None:
    skeleton, moved = motion.skeleton, motion.translations
    places = [skeleton.offsets, motion.root_path, *([] if moved is None else [moved])]
    places += [offset for _, offset in skeleton.end_sites]
    largest = max(max(float(x.max(initial=0)), -float(x.min(initial=0))) for x in places)
    if largest > LARGEST:
        return f"expected lengths and places of at most {LARGEST:g}, found {largest:.3g}"
    bones = [skeleton.offsets[1:], *(offset for _, offset in skeleton.end_sites)]
    longest = max(float(abs(bone).max(initial=0.0)) for bone in bones)
    if 0.0 < longest < SHORTEST:
        return f"expected a bone of at least {SHORTEST:g} in length, found {longest:.3g} at most"
    return None
