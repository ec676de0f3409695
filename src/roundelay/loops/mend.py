"""Loops mended with the least change: frames counted right, ends that meet, no climb."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from roundelay.base.threads import one_thread
from roundelay.cycles.closing import closing_curve
from roundelay.geometry import rotations as rot
from roundelay.loops.lint import lint, period_of, repeating
from roundelay.loops.unrolled import body_path, climb_of, seen
from roundelay.motion.motion import Motion, concatenate

__all__ = ["continued", "mended"]


@one_thread
def mended(motion: Motion, wraps: bool) -> Motion:
    """Mend what can be mended of a loop without another capture.

    Frames too many are left out, missing ones put in between; where the ends do not meet, in pose
    or in speed, the difference is spread over the period; a climb is taken out. What has none of
    these faults is given back as it is.

    Parameters
    ----------
    motion : Motion
    wraps : bool
        See `roundelay.loops.lint.lint`.

    Raises
    ------
    TooShort
        If there are fewer than 8 frames.
    """
    faults = {fault.name for fault in lint(motion, wraps)}
    if not faults & {"frame too many", "frame missing", "pop", "drift"}:
        return motion
    result = _open_period(motion, wraps)
    if "pop" in faults:
        result = _closed_each(result)
    if "drift" in faults:
        result = _level(result)
    return continued(result, 1) if wraps else result


def _open_period(motion: Motion, wraps: bool) -> Motion:
    """Return one period, the frame after whose last is the first again.

    Missing frames are put between the last and the first.

    Parameters
    ----------
    motion : Motion
        Of 8 frames or more.
    wraps : bool
        See `roundelay.loops.lint.lint`.

    Returns
    -------
    Motion
    """
    period = period_of(seen(motion), wraps)
    core = motion[: period.count]
    if not period.missing:
        return core
    more = continued(core, 1, steps=period.missing + 1)
    between = np.arange(1, period.missing + 1) / (period.missing + 1)
    return more.at(np.concatenate([np.arange(period.count), period.count - 1 + between]))


def continued(motion: Motion, frames: int, *, steps: int = 1) -> Motion:
    """Return a period with its first frames again behind its last, moved on by the body's way.

    Parameters
    ----------
    motion : Motion
        One period, without a repeated first frame.
    frames : int
        How many of the first frames are repeated, at most all.
    steps : int
        How many frames the first is behind the last.
    """
    up, (body, ahead) = motion.up_vector, body_path(motion)
    turned = ahead[-1] + 0.5 * steps * (ahead[-1] - ahead[-2] + ahead[1] - ahead[0])
    turn = rot.from_rotation_vector(turned * up)
    first = rot.rotate(turn, body[1] - body[0])
    way = 0.5 * steps * (body[-1] - body[-2] + first)
    start = (body[-1] + way) * (1.0 - up) + body[0] * up
    again = motion[:frames]
    rotations = again.rotations.copy()
    rotations[:, 0] = rot.multiply(turn, rotations[:, 0])
    moved = start + rot.rotate(turn, again.root_path - body[0])
    return concatenate([motion, replace(again, rotations=rotations, root_path=moved)])


def _closed_each(motion: Motion) -> Motion:
    """Close a period, and lay the others of its kind behind it again."""
    period = repeating(seen(motion).poses, len(motion))
    result = _closed(motion[:period])
    for _ in range(1, len(motion) // period):
        result = continued(result, period)
    return result


def _closed(motion: Motion) -> Motion:
    """Spread the differences of the ends, in rotation and in its speed, over a period."""
    count = len(motion)
    around = continued(motion, 2).rotations
    ending = rot.vector_between(around[-4], around[-3])
    starting = rot.vector_between(around[-2], around[-1])
    reached = rot.multiply(around[-3], rot.from_rotation_vector(0.5 * (ending + starting)))
    # The join lies half a frame before the first.
    x = (np.arange(count) + 0.5) / count
    lack = rot.vector_between(reached, around[-2])
    turns = closing_curve(lack, count * (starting - ending), x)
    return replace(
        motion, rotations=rot.multiply(motion.rotations, rot.from_rotation_vector(turns))
    )


def _level(motion: Motion) -> Motion:
    """Take the climb of a period out of the root's path."""
    loop = seen(motion)
    climb = climb_of(loop.height, len(motion)) * motion.skeleton.size
    share = np.arange(len(motion))[:, None] / len(motion)
    return replace(motion, root_path=motion.root_path - climb * share * motion.up_vector)
