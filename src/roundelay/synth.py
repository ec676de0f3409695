"""Motions whose phase, period and cuts are known: an oracle for tests, an example for reading.

::

    made = synth.gait("walk", repetitions=2.5)
    cycle = roundelay.find_cycles(made.motion)[0]
    cycle.period, made.period       # nearly equal
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from roundelay.base.brief import brief
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.floating import points_of_motion
from roundelay.motion.motion import Motion, concatenate
from roundelay.motion.points import Points

__all__ = [
    "Gait",
    "Stepped",
    "Synthetic",
    "Varied",
    "as_points",
    "gait",
    "humanoid",
    "quadruped",
    "sequence",
    "steps",
    "varied",
    "wander",
]

_Array = NDArray[np.float64]
_Rng = int | np.random.Generator
Gait = Literal["walk", "run", "jacks", "punch", "spin", "trot"]

# Joint: amplitudes in radians of (swing about x, raise about z) and phase of the swing.
_SWINGS: dict[str, dict[str, tuple[float, float, float]]] = {
    "walk": {
        "UpLeg": (0.45, 0.04, 0.0),
        "Leg": (0.35, 0.0, 0.2),
        "Foot": (0.2, 0.0, 0.35),
        "Arm": (-0.35, 0.05, 0.0),
        "ForeArm": (-0.2, 0.0, 0.1),
    },
    "run": {
        "UpLeg": (0.8, 0.05, 0.0),
        "Leg": (0.9, 0.0, 0.25),
        "Foot": (0.35, 0.0, 0.4),
        "Arm": (-0.7, 0.1, 0.0),
        "ForeArm": (-0.4, 0.0, 0.1),
    },
    "jacks": {"UpLeg": (0.1, 0.35, 0.0), "Leg": (0.3, 0.0, 0.5), "Arm": (0.1, 1.2, 0.0)},
    "punch": {"Arm": (0.9, 0.3, 0.0), "ForeArm": (1.1, 0.0, 0.15), "UpLeg": (0.08, 0.0, 0.3)},
    "spin": {"Arm": (0.1, 0.6, 0.0), "UpLeg": (0.3, 0.1, 0.0), "Leg": (0.4, 0.0, 0.1)},
    # Legs that are opposite each other swing together.
    "trot": {
        "UpLeg": (0.4, 0.03, 0.0),
        "Leg": (0.5, 0.0, 0.2),
        "Foot": (0.3, 0.0, 0.35),
        "ForeUpLeg": (0.4, 0.03, 0.5),
        "ForeLeg": (0.5, 0.0, 0.7),
        "ForeFoot": (0.3, 0.0, 0.85),
        "Tail": (0.05, 0.15, 0.0),
    },
}
_LEG = ("LeftUpLeg", "LeftLeg", "LeftFoot")
# Seconds a period and body heights travelled in it.
_PACE = {
    "walk": (1.1, 0.75),
    "run": (0.75, 1.4),
    "jacks": (1.2, 0.0),
    "punch": (0.9, 0.0),
    "spin": (1.4, 0.0),
    "trot": (0.6, 0.6),
}


@dataclass(frozen=True, eq=False)
class Synthetic:
    """A made motion and the truth about it.

    Attributes
    ----------
    motion : Motion
    phase : (F,) ndarray
        Unwrapped phase proportional to time, in periods; NaN where the motion is not periodic.
    period : float
        Seconds; NaN where several or none.
    cuts : tuple of int
        Frames at which another behaviour begins.
    labels : tuple of str
        One a segment: one more than cuts.
    """

    motion: Motion
    phase: _Array
    period: float
    cuts: tuple[int, ...] = ()
    labels: tuple[str, ...] = ()

    __repr__ = brief


@dataclass(frozen=True, eq=False)
class Stepped:
    """A made walk whose feet stand still, and when they come down and leave.

    Attributes
    ----------
    motion : Motion
    strikes, offs : dict of (n,) ndarray
        Frames, not whole, at which the foot "left" or "right" comes down and leaves, in order; of
        who walks backward toes come down and heels leave.
    """

    motion: Motion
    strikes: dict[str, _Array]
    offs: dict[str, _Array]

    __repr__ = brief


@dataclass(frozen=True, eq=False)
class Varied:
    """A made walk whose repetitions differ in known ways.

    Attributes
    ----------
    motion : Motion
    phase : (F,) ndarray
        Unwrapped, in turns, from 0.
    durations : (R,) ndarray
        Seconds of each repetition.
    scores : (R, 2) ndarray
        How much each repetition has of both ways, in standard deviations.
    """

    motion: Motion
    phase: _Array
    durations: _Array
    scores: _Array

    __repr__ = brief


def humanoid() -> Skeleton:
    """Return a plain human skeleton of 19 joints, 1.75 tall, Y up, facing +Z."""
    joints: list[tuple[str, int, tuple[float, float, float]]] = [
        ("Hips", -1, (0.0, 0.0, 0.0)),
        ("Spine", 0, (0.0, 0.12, 0.0)),
        ("Chest", 1, (0.0, 0.2, 0.0)),
        ("Neck", 2, (0.0, 0.22, 0.0)),
        ("Head", 3, (0.0, 0.1, 0.02)),
    ]
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        arm = len(joints)
        joints += [
            (f"{side}Shoulder", 2, (0.05 * sign, 0.18, 0.0)),
            (f"{side}Arm", arm, (0.13 * sign, 0.0, 0.0)),
            (f"{side}ForeArm", arm + 1, (0.0, -0.28, 0.0)),
            (f"{side}Hand", arm + 2, (0.0, -0.25, 0.0)),
        ]
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        leg = len(joints)
        joints += [
            (f"{side}UpLeg", 0, (0.09 * sign, -0.05, 0.0)),
            (f"{side}Leg", leg, (0.0, -0.42, 0.0)),
            (f"{side}Foot", leg + 1, (0.0, -0.4, 0.0)),
        ]
    names, parents, offsets = zip(*joints, strict=True)
    ends = [("Head", (0.0, 0.18, 0.0))]
    ends += [(f"{side}Hand", (0.0, -0.18, 0.0)) for side in ("Left", "Right")]
    ends += [(f"{side}Foot", (0.0, -0.06, 0.18)) for side in ("Left", "Right")]
    sites = tuple((names.index(joint), np.array(offset)) for joint, offset in ends)
    return Skeleton(names, parents, np.array(offsets), sites)


def quadruped() -> Skeleton:
    """Return a plain skeleton of a dog's kind: 18 joints, Y up, facing +Z."""
    joints: list[tuple[str, int, tuple[float, float, float]]] = [
        ("Hips", -1, (0.0, 0.0, 0.0)),
        ("Spine", 0, (0.0, 0.02, 0.25)),
        ("Withers", 1, (0.0, 0.04, 0.3)),
        ("Neck", 2, (0.0, 0.15, 0.15)),
        ("Head", 3, (0.0, 0.05, 0.12)),
        ("Tail", 0, (0.0, 0.0, -0.12)),
    ]
    for front, above, ahead in (("", 0, 0.0), ("Fore", 2, 0.02)):
        for side, sign in (("Left", 1.0), ("Right", -1.0)):
            leg = len(joints)
            joints += [
                (f"{side}{front}UpLeg", above, (0.08 * sign, -0.04, ahead)),
                (f"{side}{front}Leg", leg, (0.0, -0.26, 0.0)),
                (f"{side}{front}Foot", leg + 1, (0.0, -0.26, 0.0)),
            ]
    names, parents, offsets = zip(*joints, strict=True)
    feet = [joint for joint, name in enumerate(names) if name.endswith("Foot")]
    ends = [(names.index("Head"), (0.0, -0.03, 0.14)), (names.index("Tail"), (0.0, -0.05, -0.25))]
    ends += [(foot, (0.0, -0.05, 0.06)) for foot in feet]
    sites = tuple((joint, np.array(offset)) for joint, offset in ends)
    return Skeleton(names, parents, np.array(offsets), sites)


def as_points(
    motion: Motion,
    *,
    dimensions: Literal[2, 3] = 3,
    gaps: float = 0.0,
    outliers: float = 0.0,
    noise: float = 0.0,
    rng: _Rng = 0,
) -> Points:
    """Show a motion as markers, or as keypoints of a camera that looks at it from its side.

    Parameters
    ----------
    motion : Motion
        Y up.
    dimensions : {2, 3}
        In 2 the camera looks along X, so that what walks goes across the picture; in units of the
        body, as a picture's pixels would be.
    gaps : float
        Share of all positions that is missing, in stretches of a tenth of a second to a third.
    outliers : float
        Share of all positions that lies off by half a body.
    noise : float
        Standard deviation of white noise on every coordinate, in the motion's unit.
    rng : int or numpy.random.Generator
        Draws gaps, outliers and noise.

    Returns
    -------
    Points
    """
    draw, points = np.random.default_rng(rng), points_of_motion(motion)
    positions = points.positions + draw.normal(scale=noise or 1.0, size=points.positions.shape) * (
        noise > 0.0
    )
    shape, size = positions.shape[:2], motion.skeleton.size
    off = draw.random(shape) < outliers
    positions[off] += draw.normal(scale=0.5 * size, size=(int(off.sum()), 3))
    missing = np.zeros(shape, bool)
    for point in range(shape[1]):
        while missing[:, point].mean() < gaps:
            length = max(1, round(draw.uniform(0.1, 0.33) * motion.fps))
            start = int(draw.integers(-length + 1, shape[0]))
            missing[max(0, start) : start + length, point] = True
    seen = positions if dimensions == 3 else positions[..., [2, 1]] * (1.0, -1.0)
    return Points(
        points.names,
        seen,
        motion.fps,
        missing=missing,
        image=dimensions == 2,
        units="px" if dimensions == 2 else "m",
        name=motion.name,
    )


def gait(
    kind: Gait = "walk",
    *,
    repetitions: float = 3.0,
    period: float | None = None,
    fps: float = 120.0,
    start: float = 0.0,
    turning: float = 0.0,
    unevenness: float = 0.0,
    noise: float = 0.0,
    rng: _Rng = 0,
    seed: _Rng | None = None,
) -> Synthetic:
    """Make a periodic motion.

    Parameters
    ----------
    kind : {"walk", "run", "jacks", "punch", "spin", "trot"}
        The spin turns the root by 360 degrees a period; the trot is that of a `quadruped`.
    repetitions : float
        How many periods.
    period : float, optional
        Seconds; by default what suits the kind.
    fps : float
        Frames a second.
    start : float
        Phase of the first frame.
    turning : float
        Radians the path turns in a period.
    unevenness : float
        Relative amplitude, below 1, by which the poses' pace varies within a period.
    noise : float
        Standard deviation of white noise on every joint, in radians.
    rng : int or numpy.random.Generator
        Draws the noise and the small details that set one seed's gait apart.
    seed : int, optional
        The same by its former name.

    Returns
    -------
    Synthetic

    Raises
    ------
    ValueError
        If the kind is unknown.
    """
    if kind not in get_args(Gait):
        raise ValueError(f"expected a gait among {get_args(Gait)}, found {kind!r}")
    draw = np.random.default_rng(rng if seed is None else seed)
    seconds, stride = _PACE[kind]
    seconds = seconds if period is None else period
    frames = max(2, round(repetitions * seconds * fps))
    phase = start + np.arange(frames) / (seconds * fps)
    # Poses run ahead of time and fall behind, once a period.
    shape = phase + unevenness * np.sin(2 * np.pi * phase) / (2 * np.pi)
    skeleton = quadruped() if kind == "trot" else humanoid()
    rotations = _poses(kind, skeleton, shape, draw)
    if noise > 0.0:
        shake = draw.normal(scale=noise, size=(frames, skeleton.n_joints, 3))
        rotations = rot.multiply(rotations, rot.from_rotation_vector(shake))
    heading = turning * phase + (2 * np.pi * phase if kind == "spin" else 0.0)
    up = np.array([0.0, 1.0, 0.0])
    rotations[:, 0] = rot.multiply(rot.from_rotation_vector(heading[:, None] * up), rotations[:, 0])
    height = _hips(skeleton)
    path = _path(stride * 1.75, height, phase, turning, shape)
    motion = Motion(skeleton, rotations, path, 1.0 / fps, name=kind)
    return Synthetic(motion, phase, seconds, (), (kind,))


def steps(
    count: int = 8,
    *,
    stride: float = 1.1,
    spread: float = 0.02,
    related: float = 0.0,
    speed: float = 1.1,
    landing: float = 0.5,
    fps: float = 120.0,
    treadmill: bool = False,
    backward: bool = False,
    rng: _Rng = 0,
) -> Stepped:
    """Make a walk of a `humanoid` whose strides differ in time, and whose feet do not slide.

    The heel comes down, the foot turns flat about it, later turns about its tip, and swings on
    from there; hips go at a constant speed.

    Parameters
    ----------
    count : int
        Strides.
    stride : float
        Mean time of one in seconds.
    spread : float
        Standard deviation of these times over their mean.
    related : float
        Correlation of a stride's time with that of the next.
    speed : float
        Of the hips, in metres a second.
    landing : float
        Speed at which the heel goes forward when it comes down, in metres a second.
    fps : float
    treadmill : bool
        The hips stay in place.
    backward : bool
        The walk is played from its end.
    rng : int or numpy.random.Generator
        Draws the times.

    Returns
    -------
    Stepped
    """
    draw = np.random.default_rng(rng)
    times = {"left": _related(draw, count + 1, related) * spread * stride + stride}
    moments = np.cumsum(times["left"]) - 0.7 * times["left"][0]
    middle = 0.5 * (moments[1:] + moments[:-1])
    shaken = 0.25 * spread * stride * draw.normal(size=len(middle))
    strikes = {"left": moments, "right": middle + shaken}
    offs = {side: at[:-1] + _STANCE * np.diff(at) for side, at in strikes.items()}
    last = int((strikes["right"][-1] - 0.05) * fps) - 1
    motion = _stepping(np.arange(last + 1) / fps, strikes, offs, speed, landing)
    offs = {side: _all_offs(at, offs[side]) for side, at in strikes.items()}
    path = motion.root_path * ((1.0, 1.0, 0.0) if treadmill else (1.0, 1.0, 1.0))
    rotations = motion.rotations
    if backward:
        rotations, path = rotations[::-1], path[::-1]
        strikes, offs = ({k: x[::-1] for k, x in one.items()} for one in (offs, strikes))
    inside = [
        {k: _within(last - x * fps if backward else x * fps, last) for k, x in one.items()}
        for one in (strikes, offs)
    ]
    return Stepped(Motion(motion.skeleton, rotations, path, 1.0 / fps, name="steps"), *inside)


def _stepping(
    seconds: _Array,
    strikes: dict[str, _Array],
    offs: dict[str, _Array],
    speed: float,
    landing: float,
) -> Motion:
    """Return the walk whose feet come down and leave at given seconds."""
    skeleton = humanoid()
    vectors = np.zeros((len(seconds), skeleton.n_joints, 3))
    beats = strikes["left"]
    turn = np.interp(seconds, beats, 2 * np.pi * np.arange(len(beats)))
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        leg = _leg(seconds, strikes[side.lower()], offs[side.lower()], speed, landing)
        for joint, angle in zip(("UpLeg", "Leg", "Foot"), leg.T, strict=True):
            vectors[:, skeleton.index(f"{side}{joint}"), 0] = angle
        vectors[:, skeleton.index(f"{side}Arm"), 0] = 0.35 * sign * np.cos(turn)
    path = np.zeros((len(seconds), 3))
    path[:, 1], path[:, 2] = _HIPS, speed * seconds
    return Motion(skeleton, rot.from_rotation_vector(vectors), path, float(seconds[1]))


def _all_offs(strikes: _Array, offs: _Array) -> _Array:
    """Return offs with those of the stances before the first and behind the last strike."""
    stood = offs - strikes[:-1]
    first = 2 * strikes[0] - strikes[1] + stood[0]
    return np.concatenate([[first], offs, [strikes[-1] + stood[-1]]])


def _within(frames: _Array, last: int) -> _Array:
    return frames[(frames >= 0.0) & (frames <= last)]


def _related(draw: np.random.Generator, count: int, related: float) -> _Array:
    """Draw numbers of variance 1, each related to the one before."""
    values = draw.normal(size=count)
    for place in range(1, count):
        values[place] = related * values[place - 1] + np.sqrt(1 - related**2) * values[place]
    return values


# Share of a stride in which a foot stands; of that, until it is flat, and until it turns on its
# tip; the pitch at which it lands and leaves, in radians.
_STANCE, _FLAT, _RISES, _LANDS, _LEAVES = 0.62, 0.15, 0.5, 0.3, -1.1
# Height of the hips; tip and heel as seen from the ankle, as (up, ahead). The ball of the foot then
# leaves about as fast as markers do where force plates tell that moment.
_HIPS, _TIP, _HEEL = 0.8, np.array([-0.06, 0.26]), np.array([-0.06, -0.04])


def _leg(seconds: _Array, strikes: _Array, offs: _Array, speed: float, landing: float) -> _Array:
    """Return the angles (F, 3) of hip, knee and ankle about the axis across, from planar IK."""
    pitch, ankle = _foot_path(seconds, strikes, offs, speed, landing)
    thigh, shank = 0.42, 0.4
    down, ahead = _HIPS - 0.05 - ankle[:, 0], ankle[:, 1] - speed * seconds
    reach = np.minimum(np.hypot(down, ahead), 0.9999 * (thigh + shank))
    aim = np.arctan2(ahead, down)
    above = np.arccos((thigh**2 + reach**2 - shank**2) / (2 * thigh * reach))
    below = np.arccos((shank**2 + reach**2 - thigh**2) / (2 * shank * reach))
    hip, shin = -(aim + above), -(aim - below)
    return np.stack([hip, shin - hip, -pitch - shin], axis=1)


def _foot_path(
    seconds: _Array, strikes: _Array, offs: _Array, speed: float, landing: float
) -> tuple[_Array, _Array]:
    """Return pitch (F,) and place of the ankle (F, 2), up and ahead, of a foot."""
    pitch, ankle = np.zeros(len(seconds)), np.zeros((len(seconds), 2))
    lengths = offs - strikes[:-1]
    # Stances before the first and behind the last strike are like their neighbours.
    begins = np.concatenate([[2 * strikes[0] - strikes[1]], strikes])
    lengths = np.concatenate([lengths[:1], lengths, lengths[-1:]])
    places = speed * (begins + 0.5 * lengths)
    for number, (begin, length, place) in enumerate(zip(begins, lengths, places, strict=True)):
        inside = (seconds >= begin) & (seconds < begin + length)
        pitch[inside], ankle[inside] = _stance((seconds[inside] - begin) / length, place)
        if number + 1 == len(begins):
            break
        left = begin + length
        swing = (seconds >= left) & (seconds < begins[number + 1])
        took = begins[number + 1] - left
        u = (seconds[swing] - left) / took
        ends = [_stance(np.array([x]), y) for x, y in ((1.0, place), (0.0, places[number + 1]))]
        before = _stance(np.array([1.0 - 1e-5]), place)
        rate = [(ends[0][k] - before[k]) / (1e-5 * length) * took for k in (0, 1)]
        pitch[swing] = _between_ends(u, ends[0][0], ends[1][0], rate[0], np.zeros(1))[:, 0]
        ankle[swing] = _between_ends(
            u, ends[0][1][0], ends[1][1][0], rate[1][0], np.array([-0.25, landing]) * took
        )
    return pitch, ankle


def _stance(share: _Array, place: float) -> tuple[_Array, _Array]:
    """Return pitch (n,) and ankle (n, 2) of a standing foot whose flat ankle is at a place."""
    lands = np.clip(1.0 - share / _FLAT, 0.0, 1.0)
    rises = np.clip((share - _RISES) / (1.0 - _RISES), 0.0, 1.0)
    pitch = _LANDS * lands**2 + _LEAVES * rises**3
    pivot = np.where((rises > 0.0)[:, None], _TIP, _HEEL)
    flat = np.array([0.06, place])
    cos, sin = np.cos(pitch), np.sin(pitch)
    # The foot turns about its pivot, which stays where it is.
    turned = np.stack(
        [cos * pivot[:, 0] + sin * pivot[:, 1], cos * pivot[:, 1] - sin * pivot[:, 0]], axis=1
    )
    return pitch, flat + pivot - turned


def _between_ends(u: _Array, start: _Array, stop: _Array, first: _Array, last: _Array) -> _Array:
    """Return the cubic (n, d) between two ends with given slopes."""
    u = u[:, None]
    return np.asarray(
        (2 * u**3 - 3 * u**2 + 1) * start
        + (u**3 - 2 * u**2 + u) * first
        + (3 * u**2 - 2 * u**3) * stop
        + (u**3 - u**2) * last
    )


# The phase of `gait` at which a walker's left foot comes down.
_CONTACT = 0.8
# The ways in which repetitions of `varied` differ: joints, with radians of (swing, raise).
_WAYS: tuple[dict[str, tuple[float, float]], ...] = (
    {"LeftArm": (0.0, 0.3), "RightArm": (0.0, -0.3), "LeftForeArm": (-0.3, 0.0)},
    {"Spine": (0.1, 0.0), "Neck": (-0.15, 0.0), "RightUpLeg": (-0.08, 0.0)},
)


def varied(
    repetitions: int = 12,
    *,
    period: float = 1.1,
    spread: float = 0.03,
    noise: float = 0.002,
    fps: float = 60.0,
    rng: _Rng = 0,
) -> Varied:
    """Make a walk whose repetitions differ in two ways, independent of each other, and in time.

    In one arms are lifted, in the other, a smaller one, the trunk leans and a leg is raised. Both
    are those of a mean repetition where one ends and the next begins: where the left foot comes
    down.

    Parameters
    ----------
    repetitions : int
    period : float
        Mean duration in seconds.
    spread : float
        Standard deviation of durations over their mean.
    noise : float
        Standard deviation of white noise on every joint, in radians.
    fps : float
    rng : int or numpy.random.Generator
        Draws all of it.

    Returns
    -------
    Varied
    """
    draw, skeleton = np.random.default_rng(rng), humanoid()
    scores = draw.normal(size=(repetitions, len(_WAYS)))
    durations = period * (1.0 + spread * draw.normal(size=repetitions))
    ends = np.concatenate([[0.0], np.cumsum(durations)])
    phase = np.interp(np.arange(int(ends[-1] * fps)) / fps, ends, np.arange(repetitions + 1))
    rotations = _poses("walk", skeleton, phase + _CONTACT, draw)
    vectors = draw.normal(scale=noise, size=(len(phase), skeleton.n_joints, 3))
    shown = scores[phase.astype(int)] * np.sin(np.pi * phase[:, None]) ** 2
    for way, own in zip(_WAYS, shown.T, strict=True):
        for name, (swing, lift) in way.items():
            vectors[:, skeleton.index(name)] += own[:, None] * np.array([swing, 0.0, lift])
    rotations = rot.multiply(rotations, rot.from_rotation_vector(vectors))
    path = _path(_PACE["walk"][1] * 1.75, _hips(skeleton), phase, 0.0, phase)
    motion = Motion(skeleton, rotations, path, 1.0 / fps, name="varied")
    return Varied(motion, phase, durations, scores)


def wander(
    seconds: float = 10.0, *, fps: float = 120.0, rng: _Rng = 0, seed: _Rng | None = None
) -> Synthetic:
    """Make a motion with no period: every joint drifts about its rest by itself.

    A smooth stationary process, an Ornstein-Uhlenbeck process filtered once more, with a
    correlation time of half a second. `rng` and `seed` are as for `gait`.
    """
    draw = np.random.default_rng(rng if seed is None else seed)
    skeleton, frames = humanoid(), max(2, round(seconds * fps))
    vectors = draw.normal(size=(frames + round(5 * fps), skeleton.n_joints, 3))
    keep = np.exp(-1.0 / (0.5 * fps))
    for _ in range(2):
        for frame in range(1, len(vectors)):
            vectors[frame] = keep * vectors[frame - 1] + (1.0 - keep) * vectors[frame]
    vectors = vectors[-frames:] * (0.4 / vectors.std())
    path = np.tile([0.0, 0.92, 0.0], (frames, 1))
    motion = Motion(skeleton, rot.from_rotation_vector(vectors), path, 1.0 / fps, name="wander")
    return Synthetic(motion, np.full(frames, np.nan), float("nan"), (), ("wander",))


def sequence(*parts: Synthetic, blend: float = 0.3) -> Synthetic:
    """Put motions one after the other, blended over `blend` seconds at each cut."""
    motion, cuts = parts[0].motion, []
    for part in parts[1:]:
        cuts.append(len(motion))
        shift = motion.root_path[-1] - part.motion.root_path[0]
        shift[1] = 0.0
        moved = Motion(
            part.motion.skeleton,
            part.motion.rotations,
            part.motion.root_path + shift,
            motion.frame_time,
        )
        motion = _blended(motion, moved, round(blend * motion.fps))
    return Synthetic(
        motion,
        np.concatenate([part.phase for part in parts]),
        parts[0].period if len(parts) == 1 else float("nan"),
        tuple(cuts),
        tuple(label for part in parts for label in part.labels),
    )


def _blended(first: Motion, second: Motion, frames: int) -> Motion:
    """Join two motions; the second starts from the first's last pose and eases into its own."""
    count = min(frames, len(second))
    ease = np.linspace(0.0, 1.0, count)
    ease = (ease * ease * (3 - 2 * ease))[:, None]
    rotations = second.rotations.copy()
    rotations[:count] = rot.slerp(first.rotations[-1], rotations[:count], ease)
    eased = Motion(second.skeleton, rotations, second.root_path, second.frame_time)
    return concatenate([first, eased])


def _poses(kind: str, skeleton: Skeleton, shape: _Array, rng: np.random.Generator) -> _Array:
    """Return rotations (F, J, 4) of a gait at unwrapped shape phases."""
    vectors = np.zeros((len(shape), skeleton.n_joints, 3))
    mirrored = kind in ("walk", "run", "punch", "trot")
    for joint, name in enumerate(skeleton.names):
        side = next((s for s in ("Left", "Right") if name.startswith(s)), "")
        swing, lift, lag = _SWINGS[kind].get(name.removeprefix(side), (0.02, 0.01, 0.3))
        lag += 0.5 if mirrored and side == "Right" else 0.0
        angle = 2 * np.pi * (shape - lag)
        detail = rng.normal(scale=0.04, size=4)
        vectors[:, joint, 0] = swing * (np.sin(angle) + 0.25 * np.sin(2 * angle + 1.0))
        vectors[:, joint, 0] += detail[0] * np.sin(2 * angle) + detail[1] * np.cos(3 * angle)
        sign = -1.0 if side == "Right" else 1.0
        vectors[:, joint, 2] = sign * lift * (1.0 - np.cos(angle)) + detail[2] * np.sin(angle)
    return rot.from_rotation_vector(vectors)


def _hips(skeleton: Skeleton) -> float:
    """Return how high the hips are when the legs are straight, less what knees bend."""
    legs = [joint for joint, name in enumerate(skeleton.names) if name in _LEG]
    ends = [offset for joint, offset in skeleton.end_sites if skeleton.names[joint] == "LeftFoot"]
    return -float(skeleton.offsets[legs, 1].sum() + ends[0][1]) - 0.01


def _path(stride: float, height: float, phase: _Array, turning: float, shape: _Array) -> _Array:
    """Return a path that bends by `turning` a period, with the hips' bob."""
    path = np.zeros((len(phase), 3))
    # Integral of the heading (sin, 0, cos) at constant speed.
    if abs(turning) < 1e-9:
        path[:, 2] = stride * phase
    else:
        path[:, 0] = stride * (1.0 - np.cos(turning * phase)) / turning
        path[:, 2] = stride * np.sin(turning * phase) / turning
    path[:, 1] = height + 0.02 * np.cos(4 * np.pi * shape)
    return path
