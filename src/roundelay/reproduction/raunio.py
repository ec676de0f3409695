"""Harmonic regression as [C] has it, to the letter: the yardstick for the default method.

::

    angles -> delay embedding (3.26) -> most persistent class -> circular coordinate
           -> ranks (3.20) or mixture (3.21) -> unwrapped (fig. 3.8) -> line (3.6): N frames
           -> finite differences (3.23-3.25) -> M1 (3.14), M2 (3.8) or M3 (3.9)
           -> frames z_i (3.22), errors (4.1-4.5)

Everything is in the unit of the values given; [C] has Euler angles in radians. The models are
in `roundelay.cycles.models.constrained`, what its chapter 6 discusses instead in
`roundelay.reproduction.alternatives`; `roundelay.cycles.models.weighted` fits the same models to
the frames that the main job finds.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.brief import brief
from roundelay.base.errors import LiftError, NoPeriod, TooShort
from roundelay.base.threads import one_thread
from roundelay.cycles.models.constrained import M1, Model, fit_model
from roundelay.phase.harmonic import HarmonicCurve
from roundelay.phase.period import line_period
from roundelay.phase.phase_map import mixture_remap, rank_remap
from roundelay.phase.unwrap import unwrap
from roundelay.reproduction.options import ExtractionOptions
from roundelay.topology.coordinate import circular_coordinate
from roundelay.topology.rips import Barcode, persistent_cohomology

__all__ = [
    "PaperCycle",
    "PaperOptions",
    "delay_embedding",
    "extract",
    "template_error",
    "with_primes",
]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PaperOptions(ExtractionOptions):
    """What a user of [C] sets, and the model.

    Parameters
    ----------
    model : Model
        The regression: `roundelay.cycles.models.constrained.M1`, `M2`, `M3` or one of your own.
    """

    model: Model = M1


@dataclass(frozen=True, eq=False)
class PaperCycle:
    """Hold a periodic motion as [C] extracts it.

    Attributes
    ----------
    curve : HarmonicCurve
        h of eq. 3.6, 3.7.
    period : float
        N in frames.
    phase : (M,) ndarray
        x of each frame, in [0, 1).
    unwrapped : (M,) ndarray
        The same with whole periods counted (fig. 3.8), for the translation's model.
    errors : tuple of 3 float
        Of values, velocities and accelerations, see `roundelay.cycles.models.constrained.Fit`.
    barcode : Barcode
    """

    curve: HarmonicCurve
    period: float
    phase: Array = field(repr=False)
    unwrapped: Array = field(repr=False)
    errors: tuple[float, float, float]
    barcode: Barcode = field(repr=False)

    __repr__ = brief

    @property
    def period_count(self) -> float:
        """Periods in the frames used."""
        return len(self.phase) / self.period

    def sample(self) -> Array:
        """Return one period, z_i for whole i from 1 to N ([C] eq. 3.22), (floor N, d)."""
        return self.curve(np.arange(int(self.period)) / self.period)


@one_thread
def extract(values: ArrayLike, options: PaperOptions | None = None) -> PaperCycle:
    """Extract the periodic motion of a capture.

    Parameters
    ----------
    values : (F, d) array_like
        Joint angles, one row a frame.
    options : PaperOptions, optional

    Returns
    -------
    PaperCycle
        Of the first F - m frames, or those of them that make complete periods.

    Raises
    ------
    NoPeriod
        If no class is born below the scale.
    TooShort
        If the coordinate does not advance, or there are too few frames to differentiate.
    LiftError
        If the class lifts to no integer cocycle: another prime may do.
    """
    options = options or PaperOptions()
    y = np.asarray(values, float)
    cloud = delay_embedding(y, options.delay)
    y = y[: len(cloud)]
    barcode = persistent_cohomology(cloud, prime=options.prime)
    phase = _forward(_coordinate(barcode, options.scale))
    if options.complete:
        phase = phase[: _complete(phase)]
        y = y[: len(phase)]
    phase = (rank_remap if options.remap == "rank" else mixture_remap)(phase)
    run = [(0, len(phase))]
    unwrapped = unwrap(phase, run)
    period = line_period(unwrapped, run)
    fit = fit_model(phase, y, period, options.model)
    return PaperCycle(fit.curve, period, phase, unwrapped, fit.errors, barcode)


def with_primes(values: ArrayLike, options: PaperOptions | None = None) -> PaperCycle:
    """Extract; try another prime if the class does not lift, as [C] advises its user.

    Raises
    ------
    LiftError
        If it lifts with none of three; and what `extract` raises.
    """
    options = options or PaperOptions()
    for prime in (options.prime, 11):
        try:
            return extract(values, replace(options, prime=prime))
        except LiftError:
            continue
    return extract(values, replace(options, prime=23))


def delay_embedding(values: ArrayLike, delay: int) -> Array:
    """Return rows (F - delay, (delay + 1) d) of successive rows (F, d) ([C] eq. 3.26).

    Raises
    ------
    TooShort
        If there are no more frames than the delay.
    """
    y = np.asarray(values, float)
    count = len(y) - delay
    if count < 1:
        raise TooShort(f"a delay of {delay} needs more than {delay} frames, found {len(y)}")
    return np.hstack([y[lag : lag + count] for lag in range(delay + 1)])


def _coordinate(barcode: Barcode, scale: float) -> Array:
    """Return the circular coordinate of the class that persists longest up to a scale."""
    if not np.any(barcode.births < scale):
        raise NoPeriod(f"no class is born below the scale {scale:g}", barcode)
    deaths = np.minimum(barcode.deaths, scale)
    chosen = int(np.argmax(deaths - barcode.births))
    at = min(scale, float(np.nextafter(np.float32(barcode.deaths[chosen]), np.float32(0.0))))
    return circular_coordinate(barcode, k=chosen, scale=at, weights="uniform").phase


def _complete(phase: Array) -> int:
    """Return how many frames make complete periods; all where there is no whole one."""
    turns = unwrap(phase, [(0, len(phase))])
    turns = np.maximum.accumulate(turns - turns[0])
    whole = np.floor(turns[-1])
    return int(np.searchsorted(turns, whole)) if whole >= 1.0 else len(phase)


def _forward(phase: Array) -> Array:
    """Reverse a coordinate that runs backwards in time."""
    unwrapped = unwrap(phase, [(0, len(phase))])
    return phase if unwrapped[-1] >= unwrapped[0] else -phase % 1.0


def template_error(values: ArrayLike, loop: ArrayLike) -> tuple[float, int]:
    """Lay a repeated loop against a capture ([C] eq. 4.4, 4.5).

    Parameters
    ----------
    values : (M, d) array_like
        The capture.
    loop : (N, d) array_like
        One period, without the frame that repeats the first.

    Returns
    -------
    error : float
        Root mean square over frames of the distances, at the best offset.
    offset : int
        Frames by which the loop is shifted there: the least sum of distances.
    """
    y, z = np.asarray(values, float), np.asarray(loop, float)
    squares = np.sum(y**2, axis=1)[:, None] + np.sum(z**2, axis=1) - 2.0 * y @ z.T
    apart = np.sqrt(np.maximum(squares, 0.0))
    where = np.arange(len(y))
    sums = [apart[where, (where + n) % len(z)].sum() for n in range(len(z))]
    best = int(np.argmin(sums))
    return float(np.sqrt(np.mean(apart[where, (where + best) % len(z)] ** 2))), best
