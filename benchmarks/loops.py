"""The main job on the 61 walks and runs of [C] tables A.2 and A.3: does it find the stride?

Usage: python -m benchmarks.loops --data FOLDER [--json] [--keep]

A period is right when it is a whole stride. Two yardsticks:

- ``table``: within 3 % of frames / period count of [C], for rows where [C] found more than one
  repetition with a template error below .8 rad;
- ``feet``: within 5 % of the lag at which the fore-and-aft distance of the two feet repeats
  inside the part found: what one judges by eye, and independent of topology. It decides where
  [C] has no sound figure, and where [C]'s differs: the slope of a line through the coordinate
  ([C] 3.6) is biased below two repetitions.
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

import roundelay as rl
from benchmarks._harness import Target, parser, report
from benchmarks.raunio import TABLES, find_capture

TARGETS = (
    Target("captures", "==", 61, "walks and runs of [C] that are there"),
    Target("right", ">=", 61, "walks and runs of [C] whose stride is found"),
)


def main() -> None:
    arguments = parser(__doc__).parse_args()
    rows = [_row(arguments.data, name) for name in TABLES]
    summary = {
        "captures": len(rows),
        "with_a_cycle": sum(row["period"] is not None for row in rows),
        "right": sum(row["right"] for row in rows),
        "right_by_the_table": sum(row["yardstick"] == "table" for row in rows),
        "by_alignment": sum(row.get("aligned", False) for row in rows),
        "published": sum(_sound(name) for name in TABLES),
        "seconds": round(sum(row["seconds"] for row in rows), 3),
    }
    table = (
        f"{row['capture']}  period {row['period']}  [C] {row['table']}  "
        f"feet {row['feet']}  {'right' if row['right'] else 'WRONG'} by {row['yardstick']}"
        for row in rows
    )
    report("loops", {"summary": summary, "rows": rows}, TARGETS, arguments, table=table)


def _sound(name: str) -> bool:
    """Whether [C] found more than one repetition, with a template error below .8 rad."""
    count, error = TABLES[name]
    return count > 1.0 and error < 0.8


def _row(data: Path, name: str) -> dict[str, object]:
    motion = find_capture(data, name)
    started = time.perf_counter()
    try:
        cycle = rl.find_cycles(motion)[0]
    except rl.NoPeriod as refusal:
        return {
            "capture": name, "period": None, "table": None, "feet": None,
            "right": False, "yardstick": str(refusal), "seconds": time.perf_counter() - started,
        }  # fmt: skip
    seconds = time.perf_counter() - started
    period, evidence = cycle.period * motion.fps, cycle.evidence
    # A T-pose in front is no frame of [C]'s.
    frames = len(motion) - (1 if evidence.runs[0][0] == 1 else 0)
    table = frames / TABLES[name][0] if _sound(name) else None
    feet = _feet(motion, evidence.runs)
    by_table = table is not None and abs(period / table - 1.0) <= 0.03
    yardstick, right = ("table", True) if by_table else ("feet", abs(period / feet - 1.0) <= 0.05)
    return {
        "capture": name,
        "period": round(period, 1),
        "repetitions": round(evidence.repetitions, 2),
        "parts": [list(run) for run in evidence.runs],
        "table": None if table is None else round(table, 1),
        "feet": round(feet, 1),
        "right": right,
        "yardstick": yardstick,
        "confidence": round(evidence.confidence or 0.0, 2),
        "aligned": evidence.aligned,
        "seconds": round(seconds, 4),
    }


def _feet(motion: rl.Motion, runs: tuple[tuple[int, int], ...]) -> float:
    """Lag in frames at which the fore-and-aft distance of the feet comes back."""
    names = [name.lower() for name in motion.skeleton.names]
    left, right = (
        next(i for i, name in enumerate(names) if name in (side[0] + "toes", side + "toebase"))
        for side in ("left", "right")
    )
    start, stop = max(runs, key=lambda run: run[1] - run[0])
    places = motion.positions()[start:stop]
    ahead = places[-1, 0] - places[0, 0]
    apart = (places[:, left] - places[:, right]) @ (ahead * [1, 0, 1]) / np.linalg.norm(ahead)
    lags = np.arange(40, len(apart) - 5)
    misfit = np.array([np.mean((apart[lag:] - apart[:-lag]) ** 2) for lag in lags])
    misfit /= np.array([np.var(apart[lag:]) + np.var(apart[:-lag]) for lag in lags])
    # The first lag that is nearly as good as the best: not two strides.
    good = np.flatnonzero(misfit <= misfit.min() + 0.05)
    first = good[: np.argmax(np.diff(good, append=len(lags) + 2) > 1) + 1]
    return float(lags[first[np.argmin(misfit[first])]])


if __name__ == "__main__":
    main()
