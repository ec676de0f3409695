"""Thresholds of retargeting."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = ["FINDING", "MOVING", "REFERENCE", "STANDING", "TOUCHING", "TWIST"]


@dataclass(frozen=True)
class _Finding(Thresholds):
    """Which joint is which of the canonical body."""

    equal: float = constant(
        0.01, unit="of a name that fits has 3", origin="limbs that fit alike so far are rivals"
    )
    unlike: float = constant(10.0, unit="names", origin="bones of no length are no limb; " + BY_EYE)
    depth: float = constant(
        0.02, unit="names a joint", origin="of two names alike in line the upper; " + BY_EYE
    )
    again: float = constant(
        0.5, unit="share of a name's weight", origin="of a name that an upper joint has; " + BY_EYE
    )
    least: float = constant(0.01, unit="body sizes", origin="no bone of a limb is shorter")
    longest: int = constant(16, unit="joints", origin="of a limb that are looked at; for speed")
    frames: int = constant(64, unit="frames", origin="that tell how a trunk is held; for speed")
    level: float = constant(
        0.7, unit="cosine", origin="of an animal's trunk with the vertical; " + BY_EYE
    )
    told: int = constant(12, unit="names", origin="in a message; " + BY_EYE)


FINDING = _Finding()


@dataclass(frozen=True)
class _Reference(Thresholds):
    """How the joints' axes stand to the body: a pose that is upright, or the mean of a motion."""

    fewest: int = constant(30, unit="frames", origin="of a motion to learn from; " + BY_EYE)
    frames: int = constant(400, unit="frames", origin="that are learned from; for speed")
    erect: float = constant(0.8, unit="cosine", origin="of the trunk with the vertical; " + BY_EYE)
    level: float = constant(0.6, unit="cosine", origin="of an animal's trunk with it; " + BY_EYE)
    askew: float = constant(0.3, unit="cosine", origin="of the hips with it; " + BY_EYE)
    straight: float = constant(0.6, unit="cosine", origin="of a leg's bones with it; " + BY_EYE)
    folded: float = constant(-0.2, unit="cosine", origin="of an arm's two bones; " + BY_EYE)
    axis: float = constant(
        0.9, unit="cosine", origin="a direction so near to an axis is that axis; " + BY_EYE
    )
    bent: float = constant(
        0.1, unit="sine of the angle", origin="bones bent less tell no axis; " + BY_EYE
    )
    clearly_bent: float = constant(
        0.3, unit="sine of the angle", origin="bones bent more tell an axis surely; " + BY_EYE
    )
    often: float = constant(0.1, unit="share of the frames", origin="in which they are; " + BY_EYE)
    other_axis: float = constant(
        40.0,
        unit="degrees",
        origin="an axis this far off the one at rest is believed: palms may face any way; "
        + BY_EYE,
    )
    in_line: float = constant(
        0.85, unit="cosine", origin="of fingers with the forearm, where a hand is straight"
    )
    least: float = constant(1e-3, unit="body sizes", origin="a shorter foot has no direction")
    flat: float = constant(
        0.26,
        unit="level share of a foot's bone",
        origin="a steeper foot does not stand: 75 degrees",
    )
    ahead: float = constant(0.5, unit="cosine", origin="of a foot with the way faced; " + BY_EYE)
    low: float = constant(0.2, unit="quantile of heights", origin="of feet that stand; " + BY_EYE)
    pitch: float = constant(
        30.0, unit="degrees", origin="of a foot's bone below the level: LAFAN1, CMU, Mixamo"
    )


REFERENCE = _Reference()


@dataclass(frozen=True)
class _Twist(Thresholds):
    """How bends and twists are shared out."""

    alike: float = constant(
        0.05, unit="lengths of the trunk", origin="joints of two spines this near are the same"
    )
    lean: float = constant(
        25.0, unit="degrees", origin="by which a spine leans at most to carry the arms; " + BY_EYE
    )
    least: float = constant(
        0.5, unit="share of a hand's twist", origin="of a joint beside the forearm; " + BY_EYE
    )


TWIST = _Twist()


@dataclass(frozen=True)
class _Moving(Thresholds):
    """How the end of a limb is moved."""

    straight: float = constant(
        0.05, unit="sine of the angle", origin="limbs bent less tell no axis surely; " + BY_EYE
    )
    reach: float = constant(
        0.9995, unit="share of a limb's length", origin="a limb is never quite straight; " + BY_EYE
    )


MOVING = _Moving()


@dataclass(frozen=True)
class _Standing(Thresholds):
    """How feet stand on the ground on another body."""

    ground: float = constant(
        0.05, unit="quantile of the feet's heights", origin="the ground where no foot stands"
    )
    rounds: int = constant(2, unit="rounds", origin="of legs that are moved; they move no more")
    reach: float = constant(
        0.998, unit="share of a leg's length", origin="farther, the hips are lowered; " + BY_EYE
    )
    ease: float = constant(
        0.15, unit="seconds", origin="over which the hips are lowered; " + BY_EYE
    )


STANDING = _Standing()


@dataclass(frozen=True)
class _Touching(Thresholds):
    """When a hand touches the body."""

    trunk: float = constant(
        0.2,
        unit="leg lengths",
        origin="of a wrist from the middle of a trunk that it is on; " + BY_EYE,
    )
    limb: float = constant(
        0.11, unit="leg lengths", origin="of a wrist from the bone of a thigh or a head; " + BY_EYE
    )
    hands: float = constant(
        0.12, unit="leg lengths", origin="of wrists whose hands meet; " + BY_EYE
    )
    bent: float = constant(
        20.0,
        unit="degrees",
        origin="an elbow bent less hangs, one bent twice as much may touch; " + BY_EYE,
    )
    fades: float = constant(
        0.04, unit="leg lengths", origin="farther off, over which a touch fades; " + BY_EYE
    )
    slow: float = constant(
        0.2, unit="leg lengths a second", origin="a hand that is faster passes by; " + BY_EYE
    )
    reach: float = constant(0.1, unit="seconds to either side", origin="over which speed is taken")
    rounds: int = constant(2, unit="rounds", origin="of arms that are moved; they move no more")


TOUCHING = _Touching()
