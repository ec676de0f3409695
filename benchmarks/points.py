"""Points with gaps and outliers: periods, strides, what is put into gaps; on made motions.

Usage: python -m benchmarks.points [--json] [--keep]

A trotting quadruped, a runner and a walker of `roundelay.synth` are shown as markers in space and
as keypoints of a camera at their side; a fifth of all positions is missing, in stretches of .1 to
.33 s, and a fiftieth lies off by half a body. ``points_period`` is the share of takes whose first
cycle has the true period within 2 %, ``points_strides`` the share of strides, from one multiple of
the phase to the next, that last as long as they should within a frame. Gaps are filled and
compared with what was taken away, beside straight lines; the simplest rival for the period is the
first peak of the autocorrelation of points filled by straight lines.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from benchmarks._harness import Target, parser, report
from roundelay import synth
from roundelay.motion.floating import motion_of_points, points_of_motion

Array = NDArray[np.float64]

TARGETS = (
    Target("points_period", ">=", 0.99, "share of takes whose period is within 2 %"),
    Target("points_strides", ">=", 0.95, "share of strides that are right within a frame"),
)
SEEDS, GAPS, OUTLIERS, NOISE = 8, 0.2, 0.02, 0.004
SCENES: tuple[tuple[synth.Gait, Literal[2, 3], float], ...] = (
    ("trot", 3, 60.0),
    ("trot", 2, 60.0),
    ("run", 3, 100.0),
    ("run", 2, 60.0),
    ("walk", 3, 100.0),
    ("walk", 2, 30.0),
)


def main() -> None:
    arguments = parser(__doc__, data=None).parse_args()
    result = measured()
    table = (
        f"{row['take']:12s} period {100 * row['period_off']:6.2f} %, rival "
        f"{100 * row['rival_off']:7.1f} %, strides {row['strides_off_frames']}, "
        f"gaps {row['gap_millimetres']:.1f} mm, {row['gap_error']:.2f} of lines"
        for row in result["rows"]
    )
    report("points", result, TARGETS, arguments, table=table)


def measured() -> dict[str, Any]:
    """Measure made takes with gaps and outliers."""
    warnings.simplefilter("ignore", rl.RoundelayWarning)
    rows = list(_rows())
    strides = [off for row in rows for off in row["strides_off_frames"]]
    summary = {
        "takes": len(rows),
        "points_period": _share(abs(row["period_off"]) <= 0.02 for row in rows),
        "rival_period": _share(abs(row["rival_off"]) <= 0.02 for row in rows),
        "strides": len(strides),
        "points_strides": _share(abs(off) <= 1.0 for off in strides),
        "gap_error": round(float(np.median([row["gap_error"] for row in rows])), 3),
        "gap_millimetres": round(float(np.median([row["gap_millimetres"] for row in rows])), 1),
    }
    return {"summary": summary, "rows": rows}


def _share(right: Iterator[bool]) -> float:
    return round(float(np.mean(list(right))), 3)


def _rows() -> Iterator[dict[str, Any]]:
    for kind, dimensions, fps in SCENES:
        for seed in range(SEEDS):
            made = synth.gait(kind, repetitions=6.3, fps=fps, unevenness=0.1, noise=0.01, rng=seed)
            hidden = synth.as_points(
                made.motion,
                dimensions=dimensions,
                gaps=GAPS,
                outliers=OUTLIERS,
                noise=NOISE,
                rng=seed,
            )
            whole = synth.as_points(made.motion, dimensions=dimensions)
            yield {"take": f"{kind} {dimensions}D {seed}"} | _measured(made, hidden, whole)


def _measured(made: synth.Synthetic, hidden: rl.Points, whole: rl.Points) -> dict[str, Any]:
    cycle = rl.find_cycles(hidden)[0]
    lines = motion_of_points(hidden, fill=False)
    errors = [
        _gap_error(points_of_motion(one), hidden, whole)
        for one in (motion_of_points(hidden), lines)
    ]
    return {
        "period_off": round(cycle.period / made.period - 1.0, 4),
        "rival_off": round(_first_peak(lines) / made.period - 1.0, 4),
        "strides_off_frames": _strides(cycle, made),
        "gap_millimetres": round(1000.0 * errors[0], 2),
        "gap_error": round(errors[0] / errors[1], 3),
    }


def _gap_error(filled: rl.Points, hidden: rl.Points, whole: rl.Points) -> float:
    """Return the root mean square distance from the truth where points were missing."""
    off = np.linalg.norm(filled.positions - whole.positions, axis=2)[~hidden.seen]
    return float(np.sqrt(np.mean(off**2)))


def _strides(cycle: rl.Cycle, made: synth.Synthetic) -> list[float]:
    """Return by how many frames each stride is too long, as the phase of the cycle tells it."""
    off: list[float] = []
    for start, stop in cycle.evidence.runs:
        phase, frames = cycle.phase[start:stop], np.arange(start, stop)
        marks = np.arange(np.ceil(phase[0]), np.floor(phase[-1]) + 1)
        at = np.interp(marks, phase, frames)
        true = np.interp(at, np.arange(len(made.phase)), made.phase)
        per_period = made.period * cycle.fps
        off += [round(float(one), 2) for one in (1.0 - np.diff(true)) * per_period]
    return off


def _first_peak(motion: rl.Motion) -> float:
    """Return the lag in seconds of the highest peak of the autocorrelation after its first dip."""
    points = rl.point_cloud(motion)
    points = points - points.mean(axis=0)
    spectrum = np.abs(np.fft.rfft(points, 2 * len(points), axis=0)) ** 2
    along = np.fft.irfft(spectrum.sum(axis=1))[: len(points) // 2]
    dip = int(np.argmax(np.diff(along) > 0.0))
    return float(dip + np.argmax(along[dip:])) / motion.fps


if __name__ == "__main__":
    main()
