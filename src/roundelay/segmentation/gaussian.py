"""What the default method proposes: piecewise Gaussian, by penalised likelihood.

A behaviour is a Gaussian cloud of poses, as for the probabilistic PCA of [B] 3.2, but all cuts
are found together, as those that minimise

    sum over segments of  N log det(C + s^2 I)  +  5.5 tau D,

with N frames of covariance C. Three measures take the place of parameters: the resolution s, a
difference between poses that is too small to matter; the correlation time tau, in frames,
after which poses are as good as independent; and the effective dimension D = sum v / (v + s^2)
over the capture's principal variances v. See `roundelay.segmentation.model`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from roundelay.base.numeric import SMALLEST
from roundelay.base.options import Checked, option
from roundelay.segmentation.model import GaussianModel
from roundelay.segmentation.thresholds import GAUSSIAN

__all__ = [
    "GaussianOptions",
    "cut_evidence",
    "evidence_curve",
    "gaussian_cuts",
    "search",
    "settled",
]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class GaussianOptions(Checked):
    """Choices of the piecewise Gaussian method; none needs to be made.

    Parameters
    ----------
    sensitivity : float
        Divides the evidence asked of a cut: 2 finds finer behaviours, .5 coarser.
    n_segments : int, optional
        Make exactly this many segments instead.
    resolution : float, optional
        Standard deviation that is too small to matter: in radians for motions, by default .15;
        for bare channels in their unit, by default .15 of the total standard deviation.
    shortest : float
        Seconds a behaviour lasts at least.

    Raises
    ------
    ValueError
        If an option is out of range, or both a sensitivity and a number are given.
    """

    title: ClassVar[str] = "Cuts by change of posture (gaussian)"

    sensitivity: float = option(1.0, "2 finds finer behaviours, 0.5 coarser ones.", above=0)
    n_segments: int | None = option(None, "Make exactly so many.", least=1, flag="segments")
    resolution: float | None = option(
        None, "Standard deviation of poses that is too small to matter.", unit="radians", above=0
    )
    shortest: float = option(1.0, "A behaviour lasts at least so long.", unit="seconds", above=0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.n_segments is not None and self.sensitivity != 1.0:
            raise ValueError(
                "expected --sensitivity or --segments (in Python: sensitivity or n_segments), "
                f"found both, {self.sensitivity:g} and {self.n_segments}"
            )


def gaussian_cuts(model: GaussianModel, options: GaussianOptions) -> list[int]:
    """Find the cuts of a capture.

    Parameters
    ----------
    model : GaussianModel
    options : GaussianOptions

    Returns
    -------
    list of int
        First thinned frame of every segment but the first.

    Raises
    ------
    ValueError
        If the capture cannot be cut into ``options.n_segments``.
    """
    count = options.n_segments
    if model.still or len(model) < 2.0 * options.shortest * model.fps:
        if count not in (None, 1):
            raise ValueError(f"expected a moving capture of {count} segments, found one")
        return []
    if count is None:
        cuts = search(model, options.shortest, 1.0 / options.sensitivity)
    else:
        cuts = _exactly(model, options.shortest, count)
    return settled(model, cuts, options.shortest)


def search(
    model: GaussianModel,
    shortest: float,
    evidence: float,
    between: tuple[int, int] | None = None,
) -> list[int]:
    """Minimise the penalised cost over all cuts on a grid (PELT: Killick et al. 2012).

    Parameters
    ----------
    model : GaussianModel
    shortest : float
        Seconds of a segment at least.
    evidence : float
        What is asked of a cut, in times of the model's penalty.
    between : (int, int), optional
        Thinned frames to cut; all by default.

    Returns
    -------
    list of int
        First thinned frame of every segment but the first.
    """
    first, last = (0, len(model)) if between is None else between
    grid, least = _grid(model, shortest, first, last)
    penalty = evidence * model.penalty
    best, previous = np.full(len(grid), np.inf), np.zeros(len(grid), dtype=int)
    best[0] = -penalty
    starts, doomed = np.zeros(1, dtype=int), np.array([np.inf])
    for stop in range(least, len(grid)):
        if stop >= 2 * least:
            starts, doomed = np.append(starts, stop - least), np.append(doomed, np.inf)
        reached = best[starts] + model.cost_between(grid[starts], grid[stop])
        winner = int(np.argmin(reached))
        best[stop], previous[stop] = reached[winner] + penalty, starts[winner]
        # A start worse than a cut here stays so, once a segment from here is long enough.
        doomed[(reached > best[stop]) & np.isinf(doomed)] = stop + least
        alive = (doomed > stop) & _remembered(reached, (stop - starts) * GAUSSIAN.grid)
        starts, doomed = starts[alive], doomed[alive]
    return [int(grid[place]) for place in _traced(previous)]


def _grid(
    model: GaussianModel, shortest: float, first: int, last: int
) -> tuple[NDArray[np.intp], int]:
    """Return the boundaries cuts are sought at, and how many steps the shortest segment has."""
    step = max(1, round(GAUSSIAN.grid * model.fps))
    inner = np.arange(first, last - step + 1, step)
    return np.append(inner, last), max(1, int(np.ceil(shortest * model.fps / step)))


def _remembered(reached: Array, age: Array) -> NDArray[np.bool_]:
    """Keep recent starts and the best of the old ones: time then grows with length only."""
    old = np.flatnonzero(age > GAUSSIAN.memory)
    keep = np.ones(len(age), dtype=bool)
    if len(old) > GAUSSIAN.veterans:
        keep[old[np.argsort(reached[old], kind="stable")[GAUSSIAN.veterans :]]] = False
    return keep


def _traced(previous: NDArray[np.intp]) -> list[int]:
    places, place = [], int(previous[-1])
    while place > 0:
        places.append(place)
        place = int(previous[place])
    return places[::-1]


def _exactly(model: GaussianModel, shortest: float, count: int) -> list[int]:
    """Find `count` segments: bisect the penalty, then drop the weakest cuts too many."""
    cuts = search(model, shortest, 0.0)
    if len(cuts) + 1 < count:
        raise ValueError(
            f"expected at most {len(cuts) + 1} segments of at least {shortest:g} s in "
            f"{len(model) / model.fps:.1f} s, found n_segments={count}"
        )
    low, high = -GAUSSIAN.penalties, GAUSSIAN.penalties
    for _ in range(GAUSSIAN.bisections):
        middle = 0.5 * (low + high)
        trial = search(model, shortest, np.exp(middle))
        low, high = (middle, high) if len(trial) + 1 >= count else (low, middle)
        cuts = trial if len(trial) + 1 >= count else cuts
        if len(trial) + 1 == count:
            break
    while len(cuts) + 1 > count:
        cuts.pop(int(np.argmin(cut_evidence(model, cuts))))
    return cuts


def cut_evidence(model: GaussianModel, cuts: list[int]) -> Array:
    """Return the evidence (len(cuts),) for each cut, given its neighbours."""
    bounds = np.array([0, *cuts, len(model)])
    return model.evidence(bounds[:-2], bounds[1:-1], bounds[2:]) if cuts else np.zeros(0)


def evidence_curve(model: GaussianModel, cuts: list[int]) -> tuple[Array, Array]:
    """Return places (m,) and the evidence (m,) for a cut at each.

    At a cut it is the cut's own; elsewhere that of one more cut in the segment, below 1.
    """
    if model.still:
        return np.array([0.0]), np.array([0.0])
    step = max(1, round(GAUSSIAN.grid * model.fps))
    places = np.union1d(np.arange(step, len(model) - step + 1, step), np.array(cuts, dtype=int))
    bounds = np.array([0, *cuts, len(model)])
    after = np.searchsorted(bounds, places, side="right")
    before = np.searchsorted(bounds, places, side="left") - 1
    return places, model.evidence(bounds[before], places, bounds[after])


def settled(
    model: GaussianModel,
    cuts: list[int],
    shortest: float,
    between: tuple[int, int] | None = None,
) -> list[int]:
    """Move each cut to its most probable frame, with a prior for moments of little motion.

    Parameters
    ----------
    model : GaussianModel
    cuts : list of int
        First thinned frame of every segment but the first.
    shortest : float
        Seconds that segments keep at least.
    between : (int, int), optional
        Thinned frames that are cut; all by default.
    """
    speed = np.linalg.norm(np.gradient(model.points, axis=0), axis=1)
    calm = -GAUSSIAN.calm * np.log(speed + GAUSSIAN.slow * np.median(speed) + SMALLEST)
    first, last = (0, len(model)) if between is None else between
    bounds, least = [first, *cuts, last], int(shortest * model.fps)
    reach = int(GAUSSIAN.reach * model.fps)
    for i in range(1, len(bounds) - 1):
        before, cut, after = bounds[i - 1 : i + 2]
        earliest = max(cut - reach, min(before + least, cut))
        latest = min(cut + reach, max(after - least, cut))
        places = np.arange(earliest, latest + 1)
        fit = -model.cost_between(before, places) - model.cost_between(places, after)
        bounds[i] = int(places[np.argmax(0.5 * fit / model.correlation_time + calm[places])])
    return bounds[1:-1]
