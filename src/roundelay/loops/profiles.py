"""Export profiles: what the program that plays a loop is told, a record an engine or player."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from roundelay.base.registry import Registry
from roundelay.base.spans import closed_spans
from roundelay.cycles.contacts import standing_feet
from roundelay.cycles.cycle import Cycle
from roundelay.cycles.edit.separate import Mended
from roundelay.cycles.events import event_markers
from roundelay.geometry.collision import collisions
from roundelay.loops.played import player_record
from roundelay.motion.motion import Motion

if TYPE_CHECKING:
    from roundelay.loops.options import LoopOptions

__all__ = ["Generic", "Profile", "foot_contacts", "limb_record", "profiles"]

_MARKERS = 4


class Profile(Protocol):
    """Tell the program that plays a loop what it needs to know."""

    @property
    def name(self) -> str:
        """How ``roundelay loop --profile`` names it."""
        ...

    def record(
        self, cycle: Cycle, written: LoopOptions, mended: Sequence[Mended] = ()
    ) -> dict[str, Any]:
        """Describe a loop as plain data, for JSON.

        Parameters
        ----------
        cycle : Cycle
        written : LoopOptions
            How the loop is sampled.
        mended : sequence of Mended
            What `roundelay.cycles.edit.separate.repaired` changed to make the cycle.
        """
        ...


class Generic:
    """What any engine needs: root motion, phase markers, contacts, limbs that meet."""

    name = "generic"

    def record(
        self, cycle: Cycle, written: LoopOptions, mended: Sequence[Mended] = ()
    ) -> dict[str, Any]:
        """Describe a loop as `Cycle.sample` makes it, for the engine that plays it.

        Returns
        -------
        dict
            ``loop``: that the frame after the last is the first, moved on by the root motion;
            ``frames`` of all periods and of one, without a repeated first; ``root_motion`` of one
            period: displacement in the file's world and unit, turning in degrees, whether it is
            in the file; ``markers``: frames of quarter phases and of the feet's
            events; ``contacts``: a list a foot, by
            its joint, of half-open ranges of frames in which it stands, the second number beyond
            the period where it stands across the seam; what `limb_record` tells of one period,
            and `roundelay.loops.played.player_record` of the file.
        """
        rate = cycle.fps if written.fps is None else written.fps
        count = max(1, round(cycle.period * rate))
        markers = [(k / _MARKERS, k * count / _MARKERS) for k in range(_MARKERS)]
        told = {
            "loop": True,
            "fps": rate,
            "frames": count * written.periods,
            "frames_per_period": count,
            "first_repeated": written.first_repeated,
            "root_motion": {
                "travel": cycle.travel.tolist(),
                "turning_degrees": float(np.degrees(cycle.turning)),
                "up": "XYZ"[cycle.up],
                "in_file": not written.in_place,
            },
            "markers": [
                {"name": f"phase {phase:g}", "phase": phase, "frame": frame}
                for phase, frame in markers
            ]
            + event_markers(cycle, count),
            "contacts": foot_contacts(cycle, rate),
        } | limb_record(cycle.sample(rate, foot_lock=written.foot_lock), mended)
        return player_record(told, cycle, written)


profiles: Registry[Profile] = Registry("profile", "roundelay.profiles", Profile)
profiles.add(Generic())


def limb_record(motion: Motion, mended: Sequence[Mended] = ()) -> dict[str, Any]:
    """Tell which limbs may pass through each other, and which were moved apart.

    Returns
    -------
    dict
        ``collisions``: pairs of bones, by the joints at their lower ends, with a half-open
        range of frames, the frame where they are deepest in each other and how deep;
        ``mended``: pairs that were moved apart, with the ranges of frames in which they met more
        than in the capture and the largest angle in degrees by which a joint was turned.
    """
    motion = motion.with_root_motion()
    met = collisions(motion.skeleton, motion.rotations, translations=motion.translations)
    return {
        "collisions": [
            {
                "bones": list(one.bones),
                "frames": [one.start, one.stop],
                "deepest": one.frame,
                "depth": one.depth,
            }
            for one in met
        ],
        "mended": [
            {
                "bones": list(one.bones),
                "frames": [_frames(span, motion.fps) for span in one.seconds],
                "largest_degrees": float(np.degrees(one.angle)),
            }
            for one in mended
        ],
    }


def _frames(seconds: tuple[float, float], fps: float) -> list[int]:
    start = round(seconds[0] * fps)
    return [start, max(start + 1, round(seconds[1] * fps))]


def foot_contacts(cycle: Cycle, fps: float) -> dict[str, list[list[int]]]:
    """Return when each foot stands, by the name of the joint that touches the ground.

    Returns
    -------
    dict
        Lists of ``[start, stop]`` in frames of one period, ``start`` within it.
    """
    count = max(1, round(cycle.period * fps))
    feet, standing = standing_feet(cycle, count)
    names = [cycle.skeleton.names[foot.joint] for foot in feet]
    stands = [[list(span) for span in closed_spans(mask)] for mask in standing.T]
    return dict(zip(names, stands, strict=True))
