"""Thresholds of segmentation. What a user can set of the methods of [B] stands in their options."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = ["GAUSSIAN", "GMM", "LIKENESS", "MODEL", "PCA", "PPCA", "SCORING", "TREE"]


@dataclass(frozen=True)
class _Model(Thresholds):
    """The likelihood of stretches of a capture."""

    rate: float = constant(
        30.0, unit="frames a second", origin="movement of the body has little above 5 Hz"
    )
    smoothing: float = constant(
        0.05, unit="seconds, standard deviation", origin="measurement noise lies above 5 Hz"
    )
    kernel: float = constant(
        3.0, unit="standard deviations", origin="where the Gaussian window ends: weights below .012"
    )
    resolution: float = constant(
        0.15, unit="radians", origin="smaller differences make no behaviours; " + BY_EYE
    )
    relative: float = constant(
        0.15,
        unit="share of the total standard deviation",
        origin="the resolution of channels whose unit is not known; " + BY_EYE,
    )
    turn: float = constant(
        4.0,
        unit="of a quaternion, for a body size",
        origin="joints as points against joints that turn: 2.6 to 5.6, 3.9 in the median of six "
        "captures of two sources",
    )
    negligible: float = constant(
        0.5, unit="share of the resolution", origin="axes that vary less are left out; " + BY_EYE
    )
    axes: int = constant(
        400, unit="axes", origin="more than any body has: beyond, only the largest; for speed"
    )
    passes: int = constant(4, unit="passes", origin="find them to rounding; for speed")
    window: float = constant(
        2.0, unit="seconds", origin="in which the correlation time is measured; " + BY_EYE
    )
    evidence: float = constant(
        5.5,
        unit="log-likelihood ratio, an effective dimension and independent pose",
        origin="what a cut must gain; chosen on the captures of the segmentation benchmark",
    )


MODEL = _Model()


@dataclass(frozen=True)
class _Gaussian(Thresholds):
    """The search for cuts."""

    grid: float = constant(1 / 3, unit="seconds", origin="where cuts are first sought; for speed")
    reach: float = constant(
        1.0, unit="seconds", origin="by which cuts are then moved at most; " + BY_EYE
    )
    calm: float = constant(
        2.0, unit="power of 1 / speed", origin="prior of cuts for little motion; " + BY_EYE
    )
    slow: float = constant(
        0.01, unit="share of the median speed", origin="below, all is calm; " + BY_EYE
    )
    memory: float = constant(
        12.0, unit="seconds", origin="older starts must be among the best; for speed"
    )
    veterans: int = constant(15, unit="starts", origin="so many of the old are kept; for speed")
    penalties: float = constant(
        7.0,
        unit="logarithm of the evidence asked",
        origin="a number of segments is sought within a factor of a thousand",
    )
    bisections: int = constant(
        14, unit="steps", origin="leave the logarithm within .001; " + BY_EYE
    )


GAUSSIAN = _Gaussian()


@dataclass(frozen=True)
class _Likeness(Thresholds):
    """How alike two stretches are, and from where on they are two behaviours."""

    posture: float = constant(
        1.0, unit="seconds, standard deviation", origin="slower posture is taken off; SCIENCE 10"
    )
    window: float = constant(0.4, unit="seconds", origin="length of what is predicted; SCIENCE 10")
    poses: int = constant(5, unit="poses a window", origin="enough for a curve; SCIENCE 10")
    asked: int = constant(100, unit="windows a stretch", origin="that are predicted; for speed")
    windows: int = constant(400, unit="windows a stretch", origin="that predict; for speed")
    sketched_asked: int = constant(20, unit="windows a stretch", origin="of a sketch; for speed")
    sketched_windows: int = constant(80, unit="windows a stretch", origin="of a sketch; for speed")
    sketched: float = constant(
        0.15,
        unit="logarithm of errors",
        origin="sketches of what is alike err by .08 at most (LAFAN1): what they tell farther "
        "apart is not compared; for speed",
    )
    apart: float = constant(
        0.5, unit="seconds", origin="nearer windows of a stretch are the same moment; SCIENCE 10"
    )
    error: float = constant(
        4 / 3, unit="resolutions", origin="smaller errors of a prediction do not matter; SCIENCE 10"
    )
    offset: float = constant(
        2 / 3, unit="resolutions", origin="nearer postures are one; SCIENCE 10"
    )
    far: float = constant(
        20 / 3, unit="resolutions", origin="distance of postures that tells nothing; SCIENCE 10"
    )
    share: float = constant(
        0.2, unit="of a logarithm of errors", origin="weight of the posture's; SCIENCE 10"
    )
    filled: float = constant(
        0.6, unit="share of the frames", origin="what repeats in so many is what a stretch shows"
    )
    same: float = constant(
        -1.0, unit="logarithm of errors", origin="of two in which the same repeats: surely alike"
    )
    members: int = constant(4, unit="stretches", origin="that stand for a behaviour; for speed")
    cut: float = constant(
        -0.05,
        unit="logarithm of errors",
        origin="the odds of a cut are even here; fitted to heights by logistic regression, on CMU, "
        "HDM05, Bandai-Namco and joined clips of LAFAN1",
    )
    scale: float = constant(
        0.2,
        unit="logarithm of errors",
        origin="by which the odds of a cut grow e-fold; fitted with it",
    )
    label: float = constant(
        0.05,
        unit="logarithm of errors",
        origin="below, two stretches are one behaviour; chosen on CMU, HDM05 and Bandai-Namco",
    )


LIKENESS = _Likeness()


@dataclass(frozen=True)
class _Tree(Thresholds):
    """Cuts finer than the proposals."""

    proposed: float = constant(
        0.8,
        unit="times the evidence",
        origin="asked of a proposal; "
        "less cuts [B]'s captures too finely, more loses cuts of Bandai-Namco and HDM05",
    )
    steep: float = constant(
        4.0,
        unit="power of the evidence",
        origin="odds of cuts finer than the proposals; .2 and .03 at .7 and .35 of the evidence on "
        "joined clips of LAFAN1",
    )
    levels: int = constant(
        10, unit="halvings of the evidence", origin="a thousandth of it: all there is to be found"
    )


TREE = _Tree()


@dataclass(frozen=True)
class _PCA(Thresholds):
    """[B] 3.1."""

    span: float = constant(
        1e-7,
        unit="length of a pose",
        origin="a frame so near to the span of the earlier ones adds no dimension; rounding",
    )


PCA = _PCA()


@dataclass(frozen=True)
class _PPCA(Thresholds):
    """[B] 3.2."""

    descent: float = constant(
        0.1,
        unit="share of the rise",
        origin="[B] is silent on when a peak is over; " + BY_EYE,
    )
    rise: float = constant(15.0, unit="Mahalanobis distances", origin="[B] 3.2: R")
    floor: float = constant(
        1e-10,
        unit="share of the sum of variances",
        origin="[B] eq. 7 averages over structural zeros too: sigma^2 is kept above this",
    )
    rounding: float = constant(
        1e-15, unit="share of the sum of squares", origin="rounding of the sums"
    )


PPCA = _PPCA()


@dataclass(frozen=True)
class _GMM(Thresholds):
    """[B] 3.3."""

    floor: float = constant(
        1e-6, unit="mean variance", origin="[B] is silent; keeps covariances positive definite"
    )
    still: float = constant(1e-20, unit="largest variance", origin="rounding: nothing moves")
    gain: float = constant(
        1e-6, unit="log-likelihood a frame", origin="[B] is silent on when to stop; " + BY_EYE
    )


GMM = _GMM()


@dataclass(frozen=True)
class _Scoring(Thresholds):
    """How segmentations are scored."""

    tolerances: tuple[float, ...] = constant(
        (0.0, 0.25, 0.5, 1.0), unit="seconds", origin="strict, and the rows of the benchmark"
    )


SCORING = _Scoring()
