"""Thresholds of solving skeletons from points."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = ["BENDS", "FITTING", "PERSON", "RIGID", "SHAPES", "SMOOTHING", "STANDING"]


@dataclass(frozen=True)
class _Fitting(Thresholds):
    """The least squares of poses and shapes."""

    far: float = constant(
        2.5, unit="standard deviations", origin="markers farther off weigh less; " + BY_EYE
    )
    limit: float = constant(
        0.05, unit="radians", origin="by which knees and elbows bend backward; " + BY_EYE
    )
    damping: float = constant(1e-3, unit="of the diagonal", origin="Marquardt 1963")
    change: float = constant(10.0, unit="times", origin="of the damping a step: Marquardt 1963")
    steepest: float = constant(
        1e3, unit="standard deviations a radian", origin="beyond is a fold of angles; for soundness"
    )
    stuck: float = constant(1e3, unit="of the diagonal", origin="steps so small end the search")
    ridge: float = constant(1e-9, unit="of the diagonal", origin="for a sound solution")
    gain: float = constant(1e-4, unit="share of the cost", origin="smaller gains end the search")
    shape_gain: float = constant(
        1e-4, unit="share of the cost", origin="smaller gains end the search"
    )
    first_rounds: int = constant(10, unit="steps", origin="of poses by themselves; " + BY_EYE)
    shape_rounds: int = constant(30, unit="steps", origin="the most; " + BY_EYE)


FITTING = _Fitting()


@dataclass(frozen=True)
class _Person(Thresholds):
    """Where joints of a person are, before the fit."""

    knee: float = constant(
        0.06, unit="metres", origin="half a knee's width and a marker; Winter 2009, table 4.1"
    )
    ankle: float = constant(
        0.042, unit="metres", origin="half an ankle's width and a marker; " + BY_EYE
    )
    elbow: float = constant(
        0.04, unit="metres", origin="half an elbow's width and a marker; " + BY_EYE
    )
    hip_back: tuple[float, ...] = constant(
        (0.24, 0.0099),
        unit="pelvis depth, metres",
        origin="of the hip behind both ASIS: Harrington et al. 2007",
    )
    hip_down: tuple[float, ...] = constant(
        (0.30, 0.0109),
        unit="pelvis width, metres",
        origin="of the hip below both ASIS: Harrington et al. 2007",
    )
    hip_aside: tuple[float, ...] = constant(
        (0.33, 0.0073),
        unit="pelvis width, metres",
        origin="of the hip from the middle: Harrington et al. 2007",
    )
    below_acromion: float = constant(
        0.17, unit="of the distance of both", origin="of the shoulder: Rab et al. 2002"
    )
    stretched: float = constant(
        0.9, unit="quantile of the frames", origin="in which a leg is straight; " + BY_EYE
    )
    leg: float = constant(
        0.92, unit="metres", origin="of an adult's pelvis above the feet; where no unit is told"
    )
    children: float = constant(
        0.4, unit="legs of an adult", origin="a unit by which a leg is shorter is wrong; " + BY_EYE
    )
    giants: float = constant(
        1.6, unit="legs of an adult", origin="a unit by which a leg is longer is wrong; " + BY_EYE
    )
    ankle_ahead: float = constant(0.25, unit="of heel to toe", origin=BY_EYE)
    ankle_above: float = constant(0.06, unit="metres", origin="above the sole; " + BY_EYE)
    shoulders: float = constant(0.38, unit="metres", origin="of both acromia; Winter 2009")
    lumbar: float = constant(0.2, unit="of the trunk", origin="where the back bends; " + BY_EYE)
    collar: float = constant(0.2, unit="of neck to shoulder", origin=BY_EYE)
    skull: float = constant(0.5, unit="of neck to head", origin=BY_EYE)
    hinge: float = constant(
        0.2, unit="sine of the bend", origin="from which a limb tells its hinge; " + BY_EYE
    )
    standing: float = constant(
        0.3, unit="quantile of the toe's height", origin="of a foot flat on the ground; " + BY_EYE
    )


PERSON = _Person()


@dataclass(frozen=True)
class _Bends(Thresholds):
    """How far joints of a person bend: swing about X, twist about Y, swing about Z, in radians.

    Standard deviations about a person who stands with hanging arms: they decide what markers do not
    tell, and keep knees and elbows hinges.
    """

    spine: tuple[float, ...] = constant((0.35, 0.25, 0.25), unit="radians", origin=BY_EYE)
    neck: tuple[float, ...] = constant((0.4, 0.4, 0.3), unit="radians", origin=BY_EYE)
    head: tuple[float, ...] = constant((0.4, 0.4, 0.3), unit="radians", origin=BY_EYE)
    collar: tuple[float, ...] = constant((0.2, 0.2, 0.2), unit="radians", origin=BY_EYE)
    shoulder: tuple[float, ...] = constant((2.0, 0.8, 2.0), unit="radians", origin=BY_EYE)
    elbow: tuple[float, ...] = constant((2.0, 1.0, 0.1), unit="radians", origin=BY_EYE)
    wrist: tuple[float, ...] = constant((0.7, 0.2, 0.4), unit="radians", origin=BY_EYE)
    hip: tuple[float, ...] = constant((2.0, 0.5, 1.0), unit="radians", origin=BY_EYE)
    knee: tuple[float, ...] = constant((2.0, 0.1, 0.07), unit="radians", origin=BY_EYE)
    ankle: tuple[float, ...] = constant((0.6, 0.25, 0.25), unit="radians", origin=BY_EYE)


BENDS = _Bends()


@dataclass(frozen=True)
class _Shapes(Thresholds):
    """How sure lengths are before the fit, and what is a marker of the body."""

    fixed: float = constant(0.001, unit="metres", origin="of what is zero by choice of the axes")
    bone: float = constant(0.03, unit="metres", origin="of the length of a limb's bone; " + BY_EYE)
    hip: float = constant(
        0.012, unit="metres", origin="error of the regression: Harrington et al. 2007, Sangeux 2015"
    )
    joint: float = constant(0.03, unit="metres", origin="of joints of the trunk; " + BY_EYE)
    marker: float = constant(0.03, unit="metres", origin="of markers on bones; " + BY_EYE)
    pelvis: float = constant(
        0.005, unit="metres", origin="of its markers, by which hips are told; " + BY_EYE
    )
    near: float = constant(
        0.01, unit="metres", origin="of a marker at a joint, as at a knee; " + BY_EYE
    )
    independent: int = constant(
        30, unit="frames", origin="that tell something new: skin moves alike; " + BY_EYE
    )
    alike: float = constant(
        0.005, unit="metres", origin="by which bones of both sides differ; " + BY_EYE
    )
    sides: float = constant(
        0.08, unit="of the length", origin="bones that differ more are not alike; " + BY_EYE
    )
    loose: float = constant(
        0.03, unit="metres", origin="a point that moves more on every bone is no marker; " + BY_EYE
    )
    often: float = constant(
        0.9, unit="quantile of the frames", origin="in which it does; " + BY_EYE
    )
    stray: float = constant(
        0.04, unit="metres", origin="a marker that far off in the mean is on no bone; " + BY_EYE
    )
    skin: float = constant(
        0.01, unit="metres", origin="by which markers move on bones: Leardini et al. 2005"
    )
    keypoint: float = constant(
        0.02, unit="metres", origin="by which keypoints are off; issue of points"
    )
    strays: float = constant(
        0.4, unit="share of the markers", origin="if more stray, there is no body; " + BY_EYE
    )
    person: float = constant(1.75, unit="metres", origin="a person's height; for outliers")
    fewest: int = constant(8, unit="frames", origin="fewer tell no shape; " + BY_EYE)
    frames: int = constant(120, unit="frames", origin="from which the shape is learned; for speed")
    seen: float = constant(
        0.2, unit="share of the frames", origin="a point seen less often is left out; " + BY_EYE
    )
    most: int = constant(500, unit="markers", origin="beyond, equations would not fit in memory")
    present: float = constant(
        0.5, unit="share of the markers", origin="a frame that shows fewer ends the take; " + BY_EYE
    )


SHAPES = _Shapes()


@dataclass(frozen=True)
class _Smoothing(Thresholds):
    """How smooth a motion is, and how that is solved."""

    turning: float = constant(
        80.0, unit="radians a second squared", origin="of joints in walks; " + BY_EYE
    )
    moving: float = constant(
        10.0, unit="metres a second squared", origin="of hips in walks and jumps; " + BY_EYE
    )
    least: float = constant(
        0.01, unit="share of the markers' deviation", origin="noise is taken for more; " + BY_EYE
    )
    window: int = constant(600, unit="frames", origin="solved together; for memory")
    joints: int = constant(30, unit="joints", origin="of more the windows are shorter; for memory")
    lap: int = constant(60, unit="frames", origin="by which windows overlap; for memory")
    damping: float = constant(1e-6, unit="of the diagonal", origin="Marquardt 1963")
    change: float = constant(30.0, unit="times", origin="of the damping a step; " + BY_EYE)
    gain: float = constant(1e-3, unit="share of the cost", origin="smaller gains end the search")
    rounds: int = constant(6, unit="steps", origin="the most; " + BY_EYE)
    calm: float = constant(
        0.15, unit="seconds", origin="over which first guesses of turns are averaged; " + BY_EYE
    )
    fastest: float = constant(
        40.0, unit="radians a second", origin="no joint of a person turns faster; " + BY_EYE
    )
    told: float = constant(
        0.3,
        unit="of the usual information",
        origin="a joint of which less is known is bridged; " + BY_EYE,
    )
    guess: float = constant(
        0.5, unit="radians", origin="by which first guesses of turns are off; " + BY_EYE
    )


SMOOTHING = _Smoothing()


@dataclass(frozen=True)
class _Standing(Thresholds):
    """Feet that stand in noisy keypoints."""

    noise: float = constant(
        0.004, unit="metres", origin="feet are held where more is measured; " + BY_EYE
    )
    firm: float = constant(0.002, unit="metres", origin="by which a held foot moves; " + BY_EYE)
    fewest: int = constant(3, unit="frames", origin="in which a foot is seen to stand; " + BY_EYE)


STANDING = _Standing()


@dataclass(frozen=True)
class _Rigid(Thresholds):
    """Bones and joints of markers whose names tell nothing; lengths as of a person in metres."""

    loose: float = constant(
        0.01, unit="metres", origin="by which distances on a bone change; " + BY_EYE
    )
    broad: float = constant(
        0.015, unit="metres", origin="from a line, of the markers of a bone; " + BY_EYE
    )
    line: float = constant(
        0.01, unit="metres", origin="from a line, of the markers seen in a frame; " + BY_EYE
    )
    rounds: int = constant(4, unit="rounds", origin="of weights of frames; they change no more")
    reach: float = constant(
        0.15, unit="metres", origin="of a joint from the middle of its bones; " + BY_EYE
    )
    joint: float = constant(0.05, unit="metres", origin="of joints before the fit; " + BY_EYE)
    nearness: float = constant(
        0.1, unit="misfit for distance", origin="of joints that fit alike the nearer; " + BY_EYE
    )
    size: float = constant(
        0.8, unit="metres", origin="from the middle of a person to the farthest marker; " + BY_EYE
    )
    apart: float = constant(
        0.15, unit="metres", origin="bones that meet no better are of two bodies; " + BY_EYE
    )
    frames: int = constant(300, unit="frames", origin="in which distances are watched; for speed")
    fewest: int = constant(8, unit="frames", origin="in which both are seen; " + BY_EYE)
    common: float = constant(
        0.2, unit="share of the frames", origin="in which both are seen; " + BY_EYE
    )


RIGID = _Rigid()
