"""Thresholds of bodies: feet on the ground, limbs that meet, limbs that are parted."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = ["COLLISION", "CONTACTS", "LIMBS", "SEPARATION", "UPRIGHT"]


@dataclass(frozen=True)
class _Upright(Thresholds):
    """Which axis points up."""

    floor: float = constant(
        0.05, unit="body sizes", origin="a floor varies so much at least: toes roll, heels lift"
    )
    better: float = constant(3.0, unit="times the fit of Y", origin=BY_EYE)
    height: float = constant(0.2, unit="body sizes", origin=BY_EYE)


UPRIGHT = _Upright()


@dataclass(frozen=True)
class _Limbs(Thresholds):
    """Which joints are feet and arms."""

    low: float = constant(
        0.06,
        unit="body sizes",
        origin="the end of a limb that comes so near to the lowest is a foot; " + BY_EYE,
    )
    lowest: float = constant(0.1, unit="quantile of heights", origin=BY_EYE)
    limb: float = constant(
        0.12, unit="body sizes", origin="shorter limbs are fingers and toes; " + BY_EYE
    )
    long: float = constant(
        0.22, unit="body sizes", origin="longer ones are arms and legs, not necks; " + BY_EYE
    )
    least: float = constant(
        1e-3, unit="body sizes", origin="a joint nearer to the ankle is the ankle; " + BY_EYE
    )


LIMBS = _Limbs()


@dataclass(frozen=True)
class _Contacts(Thresholds):
    """When feet stand, and how much they skate."""

    begins_below: float = constant(0.025, unit="body sizes", origin=BY_EYE)
    ends_above: float = constant(0.04, unit="body sizes", origin=BY_EYE)
    begins_slower: float = constant(0.2, unit="body sizes a second", origin=BY_EYE)
    ends_faster: float = constant(0.4, unit="body sizes a second", origin=BY_EYE)
    reach: float = constant(
        0.02, unit="seconds to either side", origin="over which speed is taken; " + BY_EYE
    )
    shortest: float = constant(
        0.06, unit="seconds", origin="shorter contacts and gaps are none; " + BY_EYE
    )
    skate_height: float = constant(
        0.013,
        unit="body sizes",
        origin="2.5 cm for a person: Zhang et al. 2018, mode-adaptive neural networks",
    )
    stride: float = constant(
        0.75, unit="seconds to either side", origin="in which a foot comes down; " + BY_EYE
    )
    unlevel: float = constant(
        0.04, unit="body sizes", origin="by which the floor of a capture is uneven; " + BY_EYE
    )


CONTACTS = _Contacts()


@dataclass(frozen=True)
class _Collision(Thresholds):
    """Capsules about bones."""

    slender: float = constant(
        0.12, unit="radius in lengths of the bone", origin="about a forearm; " + BY_EYE
    )
    thickest: float = constant(
        0.02, unit="radius in body sizes", origin="about a forearm; " + BY_EYE
    )
    neighbours: int = constant(
        2, unit="joints between", origin="bones with fewer touch always; " + BY_EYE
    )
    shortest: float = constant(0.04, unit="body sizes", origin="no finger is so long; " + BY_EYE)


COLLISION = _Collision()


@dataclass(frozen=True)
class _Separation(Thresholds):
    """Turns that part limbs."""

    bump: float = constant(
        0.1,
        unit="seconds, standard deviation",
        origin="a turn comes and goes as fast as limbs change direction; " + BY_EYE,
    )
    largest: float = constant(
        15.0, unit="degrees", origin="a larger turn would change the motion; " + BY_EYE
    )
    overshoot: float = constant(
        1.5, unit="times the largest turn", origin="beyond, a pair is given up; " + BY_EYE
    )
    clearance: float = constant(
        0.002,
        unit="body sizes",
        origin="feet are not locked alike at all frame rates; " + BY_EYE,
    )
    lacking: float = constant(
        0.5, unit="clearances", origin="gaps that lack less are open; " + BY_EYE
    )
    settled: float = constant(0.1, unit="clearances", origin="tolerance of the solver; " + BY_EYE)
    watched: float = constant(0.01, unit="body sizes", origin="nearer bones are watched; " + BY_EYE)
    lever: float = constant(
        0.02, unit="body sizes", origin="a shorter lever opens no gap; " + BY_EYE
    )
    ridge: float = constant(
        1e-6,
        unit="share of the mean diagonal",
        origin="neighbouring frames ask for nearly the same; for a sound solution",
    )
    rounds: int = constant(8, unit="linearisations", origin=BY_EYE)
    most: int = constant(500, unit="gaps", origin="those that lack most; for speed")


SEPARATION = _Separation()
