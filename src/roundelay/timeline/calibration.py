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
from roundelay.timeline.chance import excess
from roundelay.timeline.limbs import Body
from roundelay.timeline.prediction import Predicted
from roundelay.timeline.thresholds import ALIGNMENT, CHANCE, JUDGEMENT, PREDICTION

__all__ = ["figures_of", "judged_by", "tests_of"]

Array = NDArray[np.float64]


def figures_of(one: Predicted, tests: tuple[Test, ...]) -> dict[str, float]:
    """Return the figures by which a candidate is judged.

    Parameters
    ----------
    one : Predicted
    tests : tuple of Test
        As from `tests_of`.

    Returns
    -------
    dict of str to float
        By name; each dimensionless.
    """
    *agreements, chance = tests
    spread, warp = _unsteadiness(one.times)
    over = {test.name: test.value - test.limit for test in agreements}
    worst = min(over.values()) / JUDGEMENT.width
    return {
        name: float(np.clip(value, JUDGEMENT.fails, JUDGEMENT.passes))
        for name, value in over.items()
    } | {
        "all_pass": float(1.0 / (1.0 + np.exp(-np.clip(worst, -JUDGEMENT.far, JUDGEMENT.far)))),
        chance.name: min(chance.value, CHANCE.most),
        "limbs": float(np.log(one.claimed.sum())),
        "share": float(np.log(max(one.share, JUDGEMENT.share))),
        "spread": spread,
        "warp": warp,
    }


def tests_of(body: Body, one: Predicted) -> tuple[Test, ...]:
    """Compare poses a period apart, half a one and two, and the evidence with chance.

    Parameters
    ----------
    body : Body
    one : Predicted
    """
    once, above_half, above_twice = margins(body.seen_of(one.claimed, one.runs), one.period)
    return (
        Test("comes_back", once, JUDGEMENT.correlation),
        Test("above_half", above_half, JUDGEMENT.less),
        Test("above_twice", above_twice, JUDGEMENT.less),
        Test("chance", excess(body, one), CHANCE.least),
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
    """Return the probability that a candidate is periodic, in [0, 1], and the tests behind it."""
    tests, weights = tests_of(body, one), _weights()
    figures = figures_of(one, tests)
    score = sum(weight * figures.get(name, 1.0) for name, weight in weights.items())
    return float(1.0 / (1.0 + np.exp(-score))), tests
