"""The null: how likely smooth random motion of the take's own dimension and tempo repeats so well.

For n independent numbers that agree by chance, the mean squared difference falls to a share e of
what it is for unlike poses with a probability of about exp(-n I(e)), I(e) = (e - 1 - ln e) / 2 (the
large deviations of a chi-squared variable). A take offers as many other places to try as it has
correlation times beside the repetitions.
"""

from __future__ import annotations

import numpy as np

from roundelay.timeline.limbs import Body
from roundelay.timeline.prediction import Predicted, dimension, microscale
from roundelay.timeline.thresholds import CHANCE

__all__ = ["excess"]


def excess(body: Body, one: Predicted) -> float:
    """Return the evidence in nats, beyond what the number of places to try brings by chance.

    Parameters
    ----------
    body : Body
    one : Predicted
        With at least one limb claimed, and its period refined.
    """
    own = body.columns_of(one.claimed)
    covariance = body.covariance[np.ix_(own, own)]
    numbers = one.again * dimension(covariance) / (np.pi * one.slowness)
    # Of R repetitions that are unlike, each differs from the mean of the others by R / (R - 1).
    showings = max(2.0, one.repetitions)
    unlike = (1.0 - one.explained) * (showings - 1.0) / showings
    # An alignment is free to warp time, a lag is not: what chance finds, it finds by warping.
    warped, plain = (max(each, CHANCE.exact) for each in (unlike, 1.0 - one.agrees))
    share = min(1.0, float(warped ** (1.0 - CHANCE.plain) * plain**CHANCE.plain))
    elsewhere = max(0.0, len(body) - sum(stop - start for start, stop in one.runs))
    scale = microscale(float(np.trace(covariance)), float(body.changes[own].sum()))
    places = 1.0 + elsewhere / (np.pi * scale)
    information = 0.5 * (share - 1.0 - np.log(share))
    return float(numbers * information - np.log(places))
