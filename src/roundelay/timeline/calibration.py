"""From named figures of a candidate to one probability that it is periodic.

The weights are data, fitted by ``benchmarks.calibrate``.
"""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from roundelay.timeline.agreement import margins
from roundelay.timeline.behaviours import Test
from roundelay.timeline.limbs import Body
from roundelay.timeline.prediction import Predicted
from roundelay.timeline.thresholds import ALIGNMENT, JUDGEMENT, PREDICTION

__all__ = ["figures_of", "judged_by", "probability"]

Array = NDArray[np.float64]


def figures_of(body: Body, one: Predicted) -> dict[str, float]:
    """Return the figures by which a candidate is judged.

    Parameters
    ----------
    body : Body
    one : Predicted

    Returns
    -------
    dict of str to float
        By name; each dimensionless.
    """
    spread, warp = _unsteadiness(one.times)
    tested = {
        test.name: float(np.clip(test.value - test.limit, JUDGEMENT.fails, JUDGEMENT.passes))
        for test in _tests(body, one)
    }
    places = len(body) / (np.pi * one.slowness * one.period)
    return tested | {
        "nats": np.log(max(one.nats * one.share, JUDGEMENT.nats)),
        "places": np.log(max(places, 1.0)),
        "share": one.share,
        "spread": spread,
        "warp": warp,
    }


def _tests(body: Body, one: Predicted) -> tuple[Test, ...]:
    """Compare the poses of the claimed limbs a period apart, half a one and two."""
    seen = body.seen[:, body.joints(one.claimed)].reshape(len(body), -1).astype(float)
    once, above_half, above_twice = margins(seen, one.runs, one.period)
    return (
        Test("comes_back", once, JUDGEMENT.correlation),
        Test("above_half", above_half, JUDGEMENT.less),
        Test("above_twice", above_twice, JUDGEMENT.less),
    )


def _unsteadiness(times: Array) -> tuple[float, float]:
    """Return the spread of ln period between repetitions, and of ln speed of phase within them."""
    periods = np.diff(times, axis=0)
    periods = periods[np.isfinite(periods)]
    speeds = []
    for row in times:
        steps = np.diff(row)
        steps = steps[np.isfinite(steps)]
        if len(steps) > ALIGNMENT.fewest:
            speeds.append(steps / np.median(steps))
    spread = float(np.std(np.log(np.maximum(periods, PREDICTION.certain)))) if len(periods) else 0.0
    if not speeds:
        return spread, 0.0
    return spread, float(
        np.abs(np.log(np.maximum(np.concatenate(speeds), JUDGEMENT.slowest))).mean()
    )


@cache
def _weights() -> dict[str, float]:
    text = files("roundelay.timeline").joinpath("calibration.json").read_text(encoding="utf-8")
    weights: dict[str, float] = json.loads(text)["weights"]
    return weights


def judged_by(body: Body, one: Predicted) -> tuple[float, tuple[Test, ...]]:
    """Return the probability that a candidate is periodic, and the tests behind it."""
    weights, figures = _weights(), figures_of(body, one)
    score = sum(weight * figures.get(name, 1.0) for name, weight in weights.items())
    return float(1.0 / (1.0 + np.exp(-score))), _tests(body, one)


def probability(body: Body, one: Predicted) -> float:
    """Return the probability that a candidate is periodic, in [0, 1]."""
    return judged_by(body, one)[0]
