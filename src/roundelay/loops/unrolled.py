"""A loop as a linter sees it: poses apart from the body's way, and as many periods as need be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import TINY
from roundelay.geometry import rotations as rot
from roundelay.geometry.contacts import Foot, contacts, left_and_right
from roundelay.geometry.kinematics import forward_kinematics, heading
from roundelay.loops.thresholds import GAIT, LINT
from roundelay.motion.feet import feet_of
from roundelay.motion.motion import Motion

__all__ = [
    "Gait",
    "Seen",
    "Steps",
    "body_path",
    "climb_of",
    "gait_of",
    "seen",
    "steps_of",
]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Seen:
    """Frames of a motion apart from where they are and where they head, in body sizes.

    The body is where the skeleton branches first: the hips, also where they hang on a root bone.

    Attributes
    ----------
    motion : Motion
    joints : (F, J, 3) ndarray
        Joints relative to the body, in its heading.
    body : int
        Joint of the body; those before it lie between it and the root.
    root : (F,) ndarray
        Height of the root.
    height : (F,) ndarray
        Height of the body.
    feet : (F, n, 3) ndarray
        Where feet touch the ground, in the body's heading and relative to the point below it.
    ways : (F - 1, 3) ndarray
        The body's way over the ground to the next frame, in its heading.
    turns : (F - 1,) ndarray
        Radians that its heading turns meanwhile.
    legs : tuple of Foot
    """

    motion: Motion
    joints: Array
    body: int
    root: Array
    height: Array
    feet: Array
    ways: Array
    turns: Array
    legs: tuple[Foot, ...]

    @property
    def poses(self) -> Array:
        """Poses (F, d) of the body: its joints as one row a frame."""
        return self.joints[:, self.body :].reshape(len(self.joints), -1)


def seen(motion: Motion) -> Seen:
    """Take the frames of a motion apart.

    Parameters
    ----------
    motion : Motion
        Of two frames or more.

    Returns
    -------
    Seen
    """
    skeleton, up, size = motion.skeleton, motion.up_vector, motion.skeleton.size
    legs, points = feet_of(motion)
    path, ahead = body_path(motion)
    back = rot.from_rotation_vector(-ahead[:, None] * up)
    ground = path * (1.0 - up)
    return Seen(
        motion,
        rot.rotate(back[:, None], motion.positions() - path[:, None]) / size,
        skeleton.trunk[-1],
        motion.root_path[:, motion.up] / size,
        path[:, motion.up] / size,
        rot.rotate(back[:, None], points - ground[:, None]) / size,
        rot.rotate(back[:-1], np.diff(ground, axis=0)) / size,
        np.diff(ahead),
        legs,
    )


def body_path(motion: Motion) -> tuple[Array, Array]:
    """Return where the body is and heads.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    places : (F, 3) ndarray
        In the skeleton's length unit.
    heading : (F,) ndarray
        In radians, unwrapped, from that of the first frame on.
    """
    body = motion.skeleton.trunk[-1]
    places, turned = forward_kinematics(
        motion.skeleton, motion.rotations, motion.root_path, translations=motion.translations
    )
    since = rot.multiply(turned[:, body], rot.conjugate(turned[:1, body]))
    return places[:, body], np.unwrap(heading(since, motion.up))


@dataclass(frozen=True, eq=False)
class Steps:
    """How feet tread in a loop that is repeated.

    Attributes
    ----------
    standing : (n, f) ndarray of bool
        Whether feet stand, in each frame of a period.
    speeds : (n, f, 3) ndarray
        Velocity of the feet over the ground, in body sizes a second; of a loop in place, over the
        ground that passes below.
    below : (3,) ndarray
        Velocity of standing feet relative to the body, in its heading, in body sizes a second.
    in_place : bool
        Whether the ground passes below a body that stays.
    low : float
        Share of the frames in which a foot is near its lowest, whatever the frame rate.
    """

    standing: Mask
    speeds: Array
    below: Array
    in_place: bool
    low: float


def climb_of(heights: Array, count: int, missing: int = 0) -> float:
    """Return by how much heights rise in a period.

    Parameters
    ----------
    heights : (F,) ndarray
        Of the body or the root.
    count : int
        How many of the first frames are of the period; two or more.
    missing : int
        How many frames of the period are not there, behind those.

    Returns
    -------
    float
        In the unit of the heights.
    """
    height = heights[:count]
    speed = 0.5 * (height[-1] - height[-2] + height[1] - height[0])
    return float(height[-1] + (missing + 1) * speed - height[0])


def steps_of(loop: Seen, count: int) -> Steps:
    """Find when feet stand and how they move then.

    The body's climb is taken out first.

    Parameters
    ----------
    loop : Seen
    count : int
        How many of the first frames are a period; three or more.

    Returns
    -------
    Steps
    """
    up, fps = loop.motion.up, loop.motion.fps
    level = 1.0 - loop.motion.up_vector
    ways, turns = _closed(loop.ways, count), _closed(loop.turns, count)
    share = np.arange(count)[:, None, None] / count
    feet = loop.feet[:count] - climb_of(loop.height, count) * share * loop.motion.up_vector
    low = feet[:, :, up] < feet[:, :, up].min(axis=0) + LINT.low
    relative = fps * 0.5 * (np.roll(feet, -1, axis=0) - np.roll(feet, 1, axis=0)) * level
    below = np.median(relative[low], axis=0) if low.any() else np.zeros(3)
    speed = float(np.linalg.norm(ways.mean(axis=0))) * fps
    in_place = speed < LINT.in_place * float(np.linalg.norm(below))
    # Standing is told on ground that the feet agree with, sliding on that which is there.
    agreed = _placed(feet, np.broadcast_to(-below / fps, ways.shape), 0.0 * turns, loop)
    standing = contacts(agreed, fps=fps, size=1.0, up=up)[count : 2 * count]
    there = agreed if in_place else _placed(feet, ways, turns, loop)
    speeds = fps * 0.5 * (there[2:] - there[:-2])
    often = float(low.mean()) if low.size else 0.0
    return Steps(standing, speeds[count - 1 : 2 * count - 1], below, in_place, often)


def _closed(steps: Array, count: int) -> Array:
    """Return steps (count, ...) of a period, the one across the seam between its neighbours."""
    inside = steps[: count - 1]
    return np.concatenate([inside, [0.5 * (inside[-1] + inside[0])]])


def _placed(feet: Array, ways: Array, turns: Array, loop: Seen) -> Array:
    """Lay three periods of feet, given relative to the body, one behind the other."""
    around = rot.from_rotation_vector(_path(np.tile(turns, 3))[:, None] * loop.motion.up_vector)
    ground = _path(rot.rotate(around, np.tile(ways, (3, 1))))
    return np.asarray(ground[:, None] + rot.rotate(around[:, None], np.tile(feet, (3, 1, 1))))


def _path(steps: Array) -> Array:
    return np.concatenate([0.0 * steps[:1], np.cumsum(steps[:-1], axis=0)])


@dataclass(frozen=True)
class Gait:
    """Two feet that go to and fro by turns.

    Attributes
    ----------
    strides : int
        How many in the loop.
    reach : float
        How far the feet part along the way, both directions together, in body sizes.
    phase : float
        Where the left foot is farthest ahead, in turns of a stride from the first frame.
    """

    strides: int
    reach: float
    phase: float


def gait_of(loop: Seen, count: int, below: Array) -> Gait | None:
    """Find the gait of a loop.

    Parameters
    ----------
    loop : Seen
    count : int
        How many of the first frames are a period.
    below : (3,) ndarray
        Velocity of standing feet relative to the body, as in `Steps`.

    Returns
    -------
    Gait or None
        None where there is no left and right foot, or they do not alternate.
    """
    pair = left_and_right(loop.motion.skeleton, loop.legs)
    speed = float(np.linalg.norm(below))
    if pair is None or speed < TINY:
        return None
    along = loop.feet[:count] @ (-below / speed)
    apart = along[:, pair[0]] - along[:, pair[1]]
    waves = np.fft.rfft(apart - apart.mean())
    power = np.abs(waves) ** 2
    strides = int(np.argmax(power))
    reach = float(np.ptp(apart))
    if power[strides] < GAIT.share * power.sum() or reach < GAIT.reach:
        return None
    phase = float(-np.angle(waves[strides]) / (2 * np.pi)) % 1.0
    return Gait(strides, reach, phase)
