"""One idea of sane for all readers and writers: which rates, lengths and names a file may hold.

What is read lies within it, and so does what is written: a file that was written can be read.
"""

from __future__ import annotations

from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import FASTEST, Motion

__all__ = ["LARGEST", "SHORTEST", "SLOWEST", "fault_of"]

LARGEST = 1e12
"""No length, place or angle of a file is larger; products of some such are still finite."""
SHORTEST = 1e-5
"""The longest bone is at least that long, if any has a length: text has eight decimals."""
SLOWEST = 1e-4
"""Frames a second; fewer are no capture, but a slip in a header."""


def fault_of(motion: Motion) -> str | None:
    """Tell what is not sane of a motion: what was expected, and what was found; None if all is."""
    if not SLOWEST <= motion.fps <= FASTEST:
        rates = f"from {SLOWEST:g} to {FASTEST:g} frames a second, found {motion.fps:g}"
        return f"expected {rates}; give the true rate (--capture-fps)"
    return _fault_of_names(motion.skeleton) or _fault_of_lengths(motion)


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
