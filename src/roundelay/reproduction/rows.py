"""What the papers tell of a capture in their tables, measured on one: rows of [A] and [C]."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import RoundelayError
from roundelay.base.options import declared
from roundelay.cycles.models.constrained import M1, M2, M3
from roundelay.motion.motion import Motion
from roundelay.phase.harmonic import HarmonicCurve
from roundelay.reproduction.alternatives import fit_reweighted, fit_ridge
from roundelay.reproduction.cohomology import typical_trajectory
from roundelay.reproduction.configuration import configuration, euler_angles
from roundelay.reproduction.correlated import fit_correlated, unequal_shares
from roundelay.reproduction.options import ExtractionOptions, TrajectoryOptions
from roundelay.reproduction.raunio import PaperCycle, PaperOptions, template_error, with_primes

__all__ = ["extraction_rows", "trajectory_row"]

Array = NDArray[np.float64]
Row = dict[str, Any]


def trajectory_row(motion: Motion, options: TrajectoryOptions | None = None) -> Row:
    """Return the row of table 1 of [A] for a capture.

    Parameters
    ----------
    motion : Motion
    options : TrajectoryOptions, optional

    Returns
    -------
    dict
        ``born``, ``simplices``, ``dimensions``, ``cohomology_seconds``, ``processing_seconds``,
        ``frames_a_second``, ``period`` in frames; or why there is none, as ``failed``.
    """
    options = options or TrajectoryOptions()
    try:
        found = typical_trajectory(configuration(motion), options)
    except RoundelayError as error:
        return {"failed": str(error)}
    seconds = found.cohomology_seconds + found.processing_seconds
    return {
        "born": found.born,
        "end": options.scale,
        "dimensions": options.dimensions,
        "simplices": found.simplices,
        "cohomology_seconds": found.cohomology_seconds,
        "processing_seconds": found.processing_seconds,
        "frames_a_second": len(motion) / max(seconds, 1e-9),
        "period": len(found.loop),
    }


def extraction_rows(motion: Motion, options: ExtractionOptions | None = None) -> dict[str, Row]:
    """Return the rows of tables A and B of [C] for a capture, and those of what it leaves out.

    Parameters
    ----------
    motion : Motion
    options : ExtractionOptions, optional

    Returns
    -------
    dict
        By name: ``M1``, ``M2``, ``M3``; ``complete`` (M1 of complete periods, chapter 7),
        ``correlated`` (M1 with errors that follow each other, 3.4), ``ridge`` (eq. 6.1),
        ``reweighted`` (chapter 6), each with ``error`` and ``index`` of the template match, the
        ``periods``, and ``rmse`` where it has one; and ``spread``, the share of channels in which
        the variances of values, velocities and accelerations differ, ``before`` and ``after``
        weighting. A row that fails says why, as ``failed``.
    """
    asked = options or ExtractionOptions()
    chosen = PaperOptions(**{one.name: getattr(asked, one.name) for one in declared(type(asked))})
    angles = euler_angles(motion, motion.rotations).reshape(len(motion), -1)
    rows = {
        name: _extracted(angles, replace(chosen, model=model))
        for name, model in (("M1", M1), ("M2", M2), ("M3", M3))
    }
    rows["complete"] = _extracted(angles, replace(chosen, model=M1, complete=True))
    try:
        found = with_primes(angles, replace(chosen, model=M1))
    except RoundelayError as error:
        return rows | {name: {"failed": str(error)} for name in _OTHERS}
    values = angles[: len(found.phase)]
    for name, fitted in _OTHERS.items():
        curve = fitted(found, values)
        loop = curve(np.arange(int(found.period)) / found.period)
        rows[name] = _matched(angles, loop) | {"periods": found.period_count}
    shares = unequal_shares(found.phase, values, found.period)
    before, after = (share if np.isfinite(share) else None for share in shares)
    return rows | {"spread": {"before": before, "after": after}}


def _extracted(angles: Array, options: PaperOptions) -> Row:
    try:
        found = with_primes(angles, options)
    except RoundelayError as error:
        return {"failed": str(error)}
    row = _matched(angles, found.sample())
    # M2 has no errors of velocities and accelerations.
    rmse = [error if np.isfinite(error) else None for error in found.errors]
    return row | {"periods": found.period_count, "rmse": rmse}


def _matched(angles: Array, loop: Array) -> Row:
    error, index = template_error(angles, loop)
    return {"error": error, "index": index}


def _correlated(found: PaperCycle, values: Array) -> HarmonicCurve:
    return fit_correlated(found.phase, values, found.period).curve


def _ridge(found: PaperCycle, values: Array) -> HarmonicCurve:
    return fit_ridge(found.phase, values, M1.harmonics)[0]


def _reweighted(found: PaperCycle, values: Array) -> HarmonicCurve:
    return fit_reweighted(found.phase, values, M1.harmonics)[0]


_OTHERS = {"correlated": _correlated, "ridge": _ridge, "reweighted": _reweighted}
