"""The feet of a take: where heels and toes are over the ground, and which way they go.

Of a skeleton a foot is found by its bones and by where it comes near the ground, of points by
their names. On a treadmill, or in a take that stays in place, standing feet go backward: that is
the speed of the ground. It is taken out, so that all that follows is as over ground.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import SkeletonMismatch
from roundelay.base.numeric import TINY
from roundelay.gait.thresholds import STEPS
from roundelay.geometry import rotations as rot
from roundelay.geometry.contacts import find_feet, foot_pairs, foot_points
from roundelay.geometry.kinematics import forward_kinematics
from roundelay.geometry.symmetry import is_left, other_side
from roundelay.geometry.thresholds import CONTACTS
from roundelay.motion.floating import PointsLayout
from roundelay.motion.motion import Motion
from roundelay.motion.point_sets import plain_name

__all__ = ["Foot", "Walker", "feet_of_motion", "velocity", "walker_of"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_HEELS = re.compile(r"(?<!w)hee|calc|fcc|ft1$")
_TOES = re.compile(r"toe|met|mt\d|mtp|mth|fm\d|footindex|ball|ft[23]$")
_ANKLES = re.compile(r"ank|mall?\d?$|fal$|foot|paw|hoof")
_PELVIS = re.compile(r"asi|psi|sacr|hip|pelv|ias$|ips$|pv\d$")
_FORE = re.compile(r"fore|front")


@dataclass(frozen=True, eq=False)
class Foot:
    """A foot over all frames.

    Attributes
    ----------
    name : str
        "left", "right"; of four feet "left hind", "right fore" and so on.
    side : {"left", "right"}
    heel, toe, pelvis : (F, 3) ndarray
        In the motion's unit.
    joints : tuple of str
        Names of the joints or points that it was read from.
    seen : (F,) ndarray of bool
        Frames in which these are known.
    gaps : (F,) ndarray of bool
        Frames in which one of these was missing, filled or not.
    whole : bool
        Whether heel and toe are two points; else one stands for both.
    """

    name: str
    side: str
    heel: Array = field(repr=False)
    toe: Array = field(repr=False)
    pelvis: Array = field(repr=False)
    joints: tuple[str, ...]
    seen: Mask = field(repr=False)
    gaps: Mask = field(repr=False)
    whole: bool = True


@dataclass(frozen=True, eq=False)
class Walker:
    """All feet of a take over the ground that they walk on, and their way.

    Attributes
    ----------
    feet : tuple of Foot
        Partners stand side by side: the left one, then the right one.
    way : (F, 3) ndarray
        Level unit vectors along which the body goes; 0 where it goes nowhere.
    belt : float
        Speed of the ground below, in the motion's unit a second; 0 over ground.
    backward : bool
        Whether the body goes where its back is.
    fps, size, up
        As of the motion and its skeleton.
    """

    feet: tuple[Foot, ...]
    way: Array = field(repr=False)
    belt: float
    backward: bool
    fps: float
    size: float
    up: int


def feet_of_motion(motion: Motion) -> list[Foot]:
    """Find the feet of a motion: the left and the right one of each pair.

    Parameters
    ----------
    motion : Motion

    Raises
    ------
    SkeletonMismatch
        If it has no left and right foot; the message lists joints or points.
    """
    feet = _of_points(motion) if motion.skeleton.free else _of_skeleton(motion)
    if not feet:
        names = motion.skeleton.names[1:] if motion.skeleton.free else motion.skeleton.names
        shown = ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
        raise SkeletonMismatch(
            "expected a left and a right foot, called such as LeftFoot and RightFoot, or LHEE and "
            f"RHEE, found {shown}"
        )
    return feet


def walker_of(motion: Motion, feet: list[Foot], frames: Mask) -> Walker:
    """Put feet on the ground that they walk on, and find their way.

    Parameters
    ----------
    motion : Motion
    feet : list of Foot
        As from `feet_of_motion`.
    frames : (F,) ndarray of bool
        In which they walk.
    """
    fps, up, level = motion.fps, motion.up_vector, 1.0 - motion.up_vector
    belt = _belt(feet, frames, fps, level, motion.up)
    shift = -belt * np.arange(len(motion))[:, None] / fps
    feet = [_shifted(foot, shift) for foot in feet]
    slow = STEPS.slow * motion.skeleton.size
    way = _way(np.mean([foot.pelvis for foot in feet], axis=0), fps, level, slow)
    across = np.mean([foot.heel * (1 if foot.side == "left" else -1) for foot in feet], axis=0)
    # The left foot is on the left of the way of those who go ahead.
    backward = bool(np.mean(np.sum(across * np.cross(up, way), axis=1)[frames]) < 0.0)
    named = _named(feet, -way if backward else way)
    speed = float(np.linalg.norm(belt))
    return Walker(tuple(named), way, speed, backward, fps, motion.skeleton.size, motion.up)


def velocity(places: Array, fps: float, seconds: float) -> Array:
    """Return how fast places (F, 3) move a second, from so many seconds before to as many behind.

    Parameters
    ----------
    places : (F, 3) ndarray
    fps, seconds : float
    """
    reach, last = max(1, round(seconds * fps)), len(places) - 1
    ahead = np.minimum(np.arange(last + 1) + reach, last)
    behind = np.maximum(np.arange(last + 1) - reach, 0)
    return (places[ahead] - places[behind]) * fps / np.maximum(ahead - behind, 1)[:, None]


def _shifted(foot: Foot, shift: Array) -> Foot:
    moved = {name: getattr(foot, name) + shift for name in ("heel", "toe", "pelvis")}
    return replace(foot, **moved)


def _belt(feet: list[Foot], frames: Mask, fps: float, level: Array, up: int) -> Array:
    """Return the velocity (3,) of the ground: of low feet, where the body goes nowhere by itself.

    Feet that slide a little beneath a body that travels stand still.
    """
    low = [foot.toe[:, up] <= np.quantile(foot.toe[frames, up], STEPS.low) for foot in feet]
    speeds = [velocity(foot.toe, fps, CONTACTS.reach) for foot in feet]
    standing = [x[mask & frames] * level for x, mask in zip(speeds, low, strict=True)]
    below = np.concatenate(standing)
    ground = np.median(below, axis=0)
    going = velocity(feet[0].pelvis, fps, CONTACTS.stride)[frames] * level
    body = float(np.median(np.linalg.norm(going, axis=1)))
    speed = float(np.linalg.norm(ground))
    steady = np.median(np.linalg.norm(below - ground, axis=1)) < STEPS.steady * speed
    return ground if steady and body < STEPS.travels * speed else 0.0 * ground


def _way(pelvis: Array, fps: float, level: Array, slow: float) -> Array:
    """Return level unit vectors (F, 3) along which a pelvis goes, 0 where it is slow."""
    going = velocity(pelvis, fps, CONTACTS.stride) * level
    speed = np.linalg.norm(going, axis=1, keepdims=True)
    return np.where(speed > slow, going / np.maximum(speed, TINY), 0.0)


def _named(feet: list[Foot], ahead: Array) -> Iterator[Foot]:
    """Yield the feet with their names: of several pairs by how far ahead they are."""
    if len(feet) == 2:
        yield from (replace(foot, name=foot.side) for foot in feet)
        return
    places = [float(np.mean(np.sum(foot.heel * ahead, axis=1))) for foot in feet]
    pairs = np.add(places[::2], places[1::2])
    ranks = np.argsort(np.argsort(pairs)).tolist()
    words = ["hind", "fore"] if len(pairs) == 2 else [str(rank + 1) for rank in sorted(ranks)]
    for place, foot in enumerate(feet):
        yield replace(foot, name=f"{foot.side} {words[ranks[place // 2]]}")


def _of_skeleton(motion: Motion) -> list[Foot]:
    skeleton = motion.skeleton
    places, turns = forward_kinematics(
        skeleton, motion.rotations, motion.root_path, translations=motion.translations
    )
    legs = find_feet(skeleton, places, motion.up)
    tips = foot_points(legs, places, turns)
    found = []
    for pair in foot_pairs(skeleton, legs):
        hips = places[:, [legs[leg].hip for leg in pair]].mean(axis=1)
        for side, leg in zip(("left", "right"), pair, strict=True):
            joints = {legs[leg].ankle, legs[leg].joint}
            names = tuple(skeleton.names[joint] for joint in sorted(joints))
            ankle = legs[leg].ankle
            heel = _heel(places[:, ankle], turns[:, ankle], tips[:, leg], motion.up)
            found.append(Foot("", side, heel, tips[:, leg], hips, names, *_known(motion, names)))
    return found


def _heel(ankle: Array, turns: Array, tip: Array, up: int) -> Array:
    """Return the point (F, 3) of the sole below and a little behind the ankle."""
    height = np.maximum(ankle[:, up], tip[:, up])
    flat = height <= np.quantile(height, STEPS.low)
    below = -STEPS.behind * (tip - ankle)
    below[:, up] = tip[:, up] - ankle[:, up]
    inside = rot.rotate(rot.conjugate(turns[flat]), below[flat])
    return ankle + rot.rotate(turns, np.median(inside, axis=0))


def _of_points(motion: Motion) -> list[Foot]:
    """Find feet by the names of points: heel or ankle, and toes; fore feet by themselves."""
    names, places = motion.skeleton.names[1:], motion.positions()[:, 1:]
    middle = [place for place, name in enumerate(names) if _PELVIS.search(plain_name(name))]
    pelvis = places[:, middle].mean(axis=1) if middle else motion.root_path
    sided = [(name, other_side(name, names)) for name in names]
    left = [(a, str(b)) for a, b in sided if b in names and is_left(a, str(b))]
    found = []
    for fore in (False, True):
        pairs = [pair for pair in left if bool(_FORE.search(plain_name(pair[0]))) is fore]
        heels, toes, ankles = (_like(pairs, words) for words in (_HEELS, _TOES, _ANKLES))
        # What a set of points lacks of a foot, another part of it stands for.
        back, front = heels or ankles or toes, toes or ankles or heels
        for number, side in enumerate(("left", "right") if back else ()):
            own = [[pair[number] for pair in part] for part in (back, front)]
            heel, toe = (places[:, [names.index(x) for x in part]].mean(axis=1) for part in own)
            known = tuple(dict.fromkeys(own[0] + own[1]))
            gaps, whole = _known(motion, known), own[0] != own[1]
            found.append(Foot("", side, heel, toe, pelvis, known, *gaps, whole))
    return found


def _like(pairs: list[tuple[str, str]], words: re.Pattern[str]) -> list[tuple[str, str]]:
    return [pair for pair in pairs if words.search(plain_name(pair[0]))]


def _known(motion: Motion, names: tuple[str, ...]) -> tuple[Mask, Mask]:
    """Return when (F,) all of some joints are known, and when one had a gap, filled or not."""
    columns = [motion.skeleton.index(name) for name in names]
    missing = np.zeros((len(motion), motion.skeleton.n_joints), bool)
    open_gaps = missing if motion.missing is None else motion.missing
    layout = motion.skeleton.layout
    gaps = layout.gaps if isinstance(layout, PointsLayout) else ()
    gone = np.zeros(len(motion), bool)
    for gap in gaps:
        if gap.point in names:
            gone[gap.start : gap.stop] = True
    return np.logical_not(open_gaps[:, columns].any(axis=1)), gone
