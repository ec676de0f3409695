"""Thresholds of what is found in a take: search, proposals, evidence, verdict."""

from __future__ import annotations

from dataclasses import dataclass

from roundelay.base.thresholds import BY_EYE, Thresholds, constant

__all__ = [
    "ACCOUNT",
    "ALIGNMENT",
    "CHANCE",
    "CLOSING",
    "CLOUD",
    "EVIDENCE",
    "EXCITATION",
    "GESTURES",
    "JUDGEMENT",
    "LIMBS",
    "MERGING",
    "NESTING",
    "PREDICTABILITY",
    "PREDICTION",
    "SEARCH",
    "TEMPO",
]

_SKETCH = "a sketch on 7 sources of captures"


@dataclass(frozen=True)
class _Search(Thresholds):
    """How closely a take is looked at."""

    fewest: int = constant(8, unit="frames", origin=BY_EYE)
    still: float = constant(1e-9, unit="body sizes", origin="rounding of positions")
    rate: float = constant(
        60.0, unit="frames a second", origin="against .3 s cycles, for speed; " + BY_EYE
    )
    long_rate: float = constant(30.0, unit="frames a second", origin=BY_EYE)
    long: float = constant(
        15.0, unit="seconds", origin="longer takes are thinned to long_rate, for speed; " + BY_EYE
    )


SEARCH = _Search()


@dataclass(frozen=True)
class _Cloud(Thresholds):
    """The cloud of poses that topology sees."""

    landmarks: int = constant(
        500, unit="points", origin="exact topology of so many takes about 20 ms"
    )
    pool: int = constant(2000, unit="points", origin=BY_EYE)
    rests: float = constant(
        1e-6,
        unit="share of the largest standard deviation",
        origin="a column that varies less rests; [A] 6.4 says nothing of it",
    )


CLOUD = _Cloud()


@dataclass(frozen=True)
class _Excitation(Thresholds):
    """Where the coordinates of a whole capture turn."""

    landmarks: int = constant(500, unit="points", origin="as for the cloud of one motion")
    frames: int = constant(1000, unit="frames", origin="a longer capture is thinned; " + BY_EYE)
    rate: float = constant(24.0, unit="frames a second", origin="thinned to no fewer; " + BY_EYE)
    level: float = constant(
        0.05, unit="corrected p-value", origin="the usual level; Bobrowski and Skraba 2023"
    )
    share: float = constant(
        0.8,
        unit="share of a coordinate's variation",
        origin="[A] 4.6 takes regions of large variation without a number; " + BY_EYE,
    )
    slower: float = constant(
        0.5,
        unit="share of that rate",
        origin="so that a region with slower frames stays one; " + BY_EYE,
    )
    least: float = constant(0.3, unit="turns", origin=BY_EYE)
    window: float = constant(
        0.5, unit="seconds", origin="shorter rests do not divide a region; " + BY_EYE
    )


EXCITATION = _Excitation()


@dataclass(frozen=True)
class _Gestures(Thresholds):
    """Which excitation regions are occurrences of a gesture."""

    whole: float = constant(0.75, unit="turns", origin=BY_EYE)
    margin: float = constant(0.1, unit="share of a turn's time", origin=BY_EYE)
    gap: float = constant(0.25, unit="share of a turn's time", origin=BY_EYE)
    often: int = constant(3, unit="occurrences", origin="of a gesture, at least; " + BY_EYE)


GESTURES = _Gestures()


@dataclass(frozen=True)
class _Evidence(Thresholds):
    """What topology measures of one behaviour."""

    often: float = constant(
        4.0, unit="turns", origin="from so many on a class may have companions; " + BY_EYE
    )
    nearly: float = constant(
        1.5, unit="factor of bars and of turns", origin="how unlike companions may be; " + BY_EYE
    )
    steady: float = constant(
        0.8,
        unit="net turns over all turns",
        origin="of the coordinate that is the phase; noise turns back and forth",
    )
    turns: float = constant(
        0.2, unit="share of the repetitions", origin="by which its turns may differ; " + BY_EYE
    )
    classes: int = constant(5, unit="longest bars", origin="that are tried; " + BY_EYE)
    usual_period: float = constant(
        1.0, unit="seconds", origin="where nothing repeats: a stride; as for excitations"
    )


EVIDENCE = _Evidence()


@dataclass(frozen=True)
class _Limbs(Thresholds):
    """Which parts of a body are limbs, and their signals."""

    rate: float = constant(
        30.0,
        unit="frames a second",
        origin="of the search for what repeats, for speed; " + _SKETCH,
    )
    branch: float = constant(
        0.12,
        unit="body sizes",
        origin="shorter branches of the body are fingers and toes; " + _SKETCH,
    )
    long: float = constant(
        0.2,
        unit="body sizes",
        origin="shorter chains belong to the trunk; " + _SKETCH,
    )
    low: float = constant(
        0.12,
        unit="body sizes",
        origin="a leg ends this near to the lowest joint, in the median; " + _SKETCH,
    )
    held: float = constant(
        0.98,
        unit="share of the variance",
        origin="of a limb that its axes hold; " + _SKETCH,
    )
    axes: int = constant(5, unit="principal axes", origin="of a limb at most; " + _SKETCH)
    near: float = constant(
        1.5, unit="seconds", origin="whose steps are compared with a jump; " + BY_EYE
    )
    jump: float = constant(
        5.0,
        unit="steps",
        origin="a frame at either end that lies so much farther off is no part of the movement",
    )


LIMBS = _Limbs()


@dataclass(frozen=True)
class _Predictability(Thresholds):
    """Stretches in which a period predicts the next."""

    shortest: float = constant(0.2, unit="seconds", origin="of a period; " + _SKETCH)
    longest: float = constant(60.0, unit="seconds", origin="of a period; " + _SKETCH)
    octave: int = constant(
        24,
        unit="lags an octave",
        origin="3 % from one to the next; " + _SKETCH,
    )
    fills: float = constant(
        0.75,
        unit="share of a take",
        origin="that its longest period may fill; " + _SKETCH,
    )
    again: float = constant(
        0.2,
        unit="periods",
        origin="that a take of less than two must show twice; gaits of 1.3 periods",
    )
    samples: int = constant(
        24,
        unit="samples a lag",
        origin="on a coarser clock, at least; " + _SKETCH,
    )
    least: float = constant(
        0.012,
        unit="body sizes",
        origin="least amplitude, root mean square over joints; " + _SKETCH,
    )
    hop: float = constant(0.1, unit="seconds", origin="from one place to the next; " + _SKETCH)
    explained: float = constant(
        0.55,
        unit="S",
        origin="from which a hop is better explained as periodic; .40 to .55 find as much",
    )
    longer: float = constant(
        0.05,
        unit="S an octave",
        origin="the shortest of equals is taken; " + _SKETCH,
    )
    wobble: float = constant(0.02, unit="S a lag", origin="cost of a change of lag; " + _SKETCH)
    switch: float = constant(
        0.25,
        unit="S times periods",
        origin="cost of entering or leaving a period; " + _SKETCH,
    )
    other: float = constant(
        1.5,
        unit="times the switch",
        origin="cost of going to another period at once; " + _SKETCH,
    )
    reach: int = constant(
        2,
        unit="lags",
        origin="of change from hop to hop, at most; " + _SKETCH,
    )
    steady: int = constant(
        5,
        unit="lags",
        origin="from the median within a steady stretch; " + _SKETCH,
    )
    periods: float = constant(1.2, unit="periods", origin="that a stretch must be long; " + _SKETCH)
    same: float = constant(
        0.8,
        unit="share of frames",
        origin="that two stretches share which are one; " + _SKETCH,
    )
    near: float = constant(
        0.05,
        unit="log of periods",
        origin="apart, of two stretches which are one; " + _SKETCH,
    )
    clearer: float = constant(
        0.02,
        unit="S",
        origin="by which a stretch e times as long may be less clear; " + _SKETCH,
    )


PREDICTABILITY = _Predictability()


@dataclass(frozen=True)
class _Alignment(Thresholds):
    """Alignment of a stretch to its own repeating template."""

    states: int = constant(64, unit="phases", origin="of the template; " + _SKETCH)
    samples: int = constant(32, unit="samples a period", origin=_SKETCH)
    grid: int = constant(
        48,
        unit="phases",
        origin="at which repetitions are compared; " + _SKETCH,
    )
    tempo: tuple[float, ...] = constant(
        (0.06, 0.03, 0.0, 0.012, 0.03),
        unit="variances",
        origin="costs of 0, 1/2, 1, 3/2 and 2 times the usual tempo; thrice as much finds as much",
    )
    unexplained: float = constant(
        0.35,
        unit="variances",
        origin="beyond which a sample is not explained; " + _SKETCH,
    )
    farthest: float = constant(
        4.0,
        unit="variances",
        origin="the largest distance that counts; " + _SKETCH,
    )
    rounds: int = constant(2, unit="rounds", origin="of alignment and averaging; " + _SKETCH)
    piece: int = constant(
        16, unit="periods", origin="decoded at once, for speed; with pieces of 64 it is the same"
    )
    shared: int = constant(
        4, unit="periods", origin="of a piece and the next, within which their paths meet"
    )
    turns: float = constant(
        0.5,
        unit="turns",
        origin="of a run that counts, at least; " + _SKETCH,
    )
    passed: float = constant(
        0.75,
        unit="share of the circle",
        origin="that must be passed; " + _SKETCH,
    )
    fewest: int = constant(4, unit="phases", origin="that a repetition must pass; " + _SKETCH)


ALIGNMENT = _Alignment()


@dataclass(frozen=True)
class _Prediction(Thresholds):
    """Prediction of each repetition by the others."""

    beyond: float = constant(
        1.5,
        unit="periods",
        origin="beyond a candidate's ends that are looked at; " + _SKETCH,
    )
    held: float = constant(
        0.98,
        unit="share of the variance",
        origin="of a group that its axes hold; " + _SKETCH,
    )
    axes: int = constant(6, unit="principal axes", origin="of a group at most; " + _SKETCH)
    repeats: float = constant(
        0.3, unit="R^2", origin="from which a limb repeats; .5 leaves out one leg of many a walk"
    )
    coarse: float = constant(
        1.5,
        unit="samples a step",
        origin="beyond which samples are averaged; " + _SKETCH,
    )
    certain: float = constant(
        1e-3,
        unit="1 - R^2",
        origin="beyond which a prediction is not clearer; " + _SKETCH,
    )


PREDICTION = _Prediction()


@dataclass(frozen=True)
class _Chance(Thresholds):
    """The null of smooth random motion."""

    exact: float = constant(
        0.005, unit="share", origin="of the difference of unlike poses that counts as none; noise"
    )
    plain: float = constant(
        0.3,
        unit="share",
        origin="of poses a period apart beside aligned ones; .5 loses varying tempo",
    )
    least: float = constant(
        -0.25,
        unit="nats",
        origin="beyond the tries; at .5 a twentieth of the stretches of LAFAN1 is lost, at -1 "
        "twice as much random motion repeats",
    )
    most: float = constant(
        4.0, unit="nats", origin="beyond which the probability gains no more; " + BY_EYE
    )


CHANCE = _Chance()


@dataclass(frozen=True)
class _Account(Thresholds):
    """The best account of every frame of every limb."""

    fewest: float = constant(1.2, unit="repetitions", origin="at least; " + _SKETCH)
    change: float = constant(
        1.5, unit="nats", origin="that a change of the account must bring; .5 to 6 find as much"
    )
    counts: float = constant(
        0.45,
        unit="R^2",
        origin="of a limb in a repetition that counts; .3 to .6 find as much in 408 captures",
    )
    clearest: float = constant(
        50.0,
        unit="1 / (1 - R^2)",
        origin="beyond which a repetition is not clearer; " + _SKETCH,
    )
    run: float = constant(0.6, unit="periods", origin="that a run must be long; " + _SKETCH)
    end: float = constant(
        0.06, unit="periods", origin="from the end of a take that are none; two steps of a phase"
    )
    whole: float = constant(
        0.97,
        unit="share of the samples",
        origin="from which a candidate is not measured again; " + _SKETCH,
    )
    fresh: float = constant(
        0.5,
        unit="share of the samples",
        origin="in which a limb must be unexplained before; " + _SKETCH,
    )


ACCOUNT = _Account()


@dataclass(frozen=True)
class _Tempo(Thresholds):
    """Pieces in which the tempo is steady."""

    steady: float = constant(
        0.2,
        unit="share of the period",
        origin="within which a tempo is steady; .12 cuts walks to pieces",
    )
    worth: float = constant(
        0.3,
        unit="share of the deviation",
        origin="that a cut must take away; " + _SKETCH,
    )
    periods: float = constant(1.2, unit="periods", origin="of a piece, at least; as of a stretch")
    gap: float = constant(
        2.0,
        unit="periods",
        origin="beyond which two passages are of different runs; " + _SKETCH,
    )
    near: float = constant(
        0.08,
        unit="share of the period",
        origin="within which the lag is refined; " + _SKETCH,
    )
    tried: int = constant(17, unit="lags", origin="that are tried; " + _SKETCH)
    pause: float = constant(
        0.35, unit="periods", origin="a pause lasts longer than this; " + BY_EYE
    )
    slower: float = constant(
        1.0,
        unit="usual times of a phase, in addition",
        origin="a pause takes twice as long as usual",
    )


TEMPO = _Tempo()


@dataclass(frozen=True)
class _Merging(Thresholds):
    """Stretches that are one behaviour."""

    tempo: float = constant(
        0.1, unit="share of the period", origin="within which two tempos are one; " + BY_EYE
    )
    alike: float = constant(
        0.75, unit="correlation of templates", origin="from which two are one; " + BY_EYE
    )
    limbs: float = constant(
        0.8, unit="share of the motion", origin="that limbs of both must hold; " + BY_EYE
    )


MERGING = _Merging()


@dataclass(frozen=True)
class _Nesting(Thresholds):
    """Longer periods of what repeats already."""

    left: float = constant(
        0.5, unit="share of what is unexplained", origin="that a phrase may leave; " + BY_EYE
    )
    fewest: float = constant(2.0, unit="repetitions", origin="of a phrase, at least; " + BY_EYE)


NESTING = _Nesting()


@dataclass(frozen=True)
class _Judgement(Thresholds):
    """Named tests of a candidate."""

    correlation: float = constant(
        0.6,
        unit="correlation",
        origin="of poses a period apart, at least: the yardstick of `benchmarks.truth`",
    )
    less: float = constant(
        -0.05,
        unit="correlation",
        origin="by which it may be less than at half and twice the period; same yardstick",
    )
    fails: float = constant(
        -0.3,
        unit="correlation",
        origin="below the limit, beyond which a test says no more; " + _SKETCH,
    )
    passes: float = constant(
        0.1,
        unit="correlation",
        origin="above the limit, beyond which a test says no more; " + _SKETCH,
    )
    width: float = constant(
        0.02, unit="correlation", origin="by which two ways to measure it differ; " + BY_EYE
    )
    far: float = constant(10.0, unit="widths", origin="beyond which all or nothing passes")
    apart: float = constant(
        0.5,
        unit="periods",
        origin="that runs must overlap; shorter ones are laid one after the other; yardstick",
    )
    around: float = constant(
        0.03,
        unit="share of the lag",
        origin="by which half and twice the period may be off; " + _SKETCH,
    )
    share: float = constant(
        0.01, unit="share of the motion", origin="below which limbs are as few as can be; " + BY_EYE
    )
    slowest: float = constant(
        0.05,
        unit="speed of phase",
        origin="over the usual, below which it says no more; " + _SKETCH,
    )
    likely: float = constant(
        0.5, unit="probability", origin="from which a behaviour is told; the even chance"
    )
    half: float = constant(
        0.1,
        unit="share of the period",
        origin="by which half of a closed pass may be off; " + _SKETCH,
    )
    exact: float = constant(
        0.95,
        unit="correlation",
        origin="that half of a closed pass must reach; " + _SKETCH,
    )


JUDGEMENT = _Judgement()


@dataclass(frozen=True)
class _Closing(Thresholds):
    """One pass whose ends meet."""

    longest: float = constant(
        10.0,
        unit="seconds",
        origin="a longer take that ends as it began is no loop; " + BY_EYE,
    )
    many: float = constant(
        0.12,
        unit="share of the frames",
        origin="at the end that may be too many; " + _SKETCH,
    )
    seam: float = constant(
        2.5,
        unit="times",
        origin="by which velocity may change more at the seam than elsewhere; loops closed by hand",
    )
    nearly: float = constant(
        95.0,
        unit="percentile",
        origin="of the changes of velocity; " + _SKETCH,
    )
    gap: float = constant(
        2.2, unit="steps", origin="between the ends; the worst of 20 loops closed by hand has 1.9"
    )
    apart: float = constant(
        0.05,
        unit="deviations of the poses",
        origin="between the ends, beyond so many of their own steps; bows reach .07",
    )
    chosen: float = constant(
        4.0, unit="steps", origin="the same, of frames chosen by hand; " + BY_EYE
    )
    clock: int = constant(
        32,
        unit="samples a pass",
        origin="at which velocities are compared; " + _SKETCH,
    )
    least: float = constant(
        0.008, unit="body sizes", origin="least amplitude; an idle closed by hand has .0105"
    )
    fewest: int = constant(8, unit="frames", origin=BY_EYE)


CLOSING = _Closing()
