"""Repetitions drawn anew: how they join, and whether they vary as much as those of the capture.

Usage: python -m benchmarks.variation --data FOLDER [--json] [--keep]

Every capture of FOLDER/truth that is one gait from end to end and shows at least four whole
repetitions. ``join`` is the largest acceleration of a joint where four drawn repetitions begin
again, over the largest elsewhere; ``spread`` the standard deviation of the joints' places over
twenty drawn repetitions, phase by phase, over that of the capture's own, which is taken from its
frames. Both are in the body's place and heading.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from benchmarks._harness import Target, parser, report
from benchmarks._truth_data import captures

Array = NDArray[np.float64]

TARGETS = (
    Target("captures", ">=", 30, "captures with four repetitions or more"),
    Target("join", "<=", 1.1, "worst join over the hardest elsewhere"),
    Target("spread_within_a_fifth", ">=", 0.9, "share whose spread is within 20 %"),
)
FEWEST, DRAWN, PHASES = 4, 20, 32


def main() -> None:
    arguments = parser(__doc__, data="folder that holds truth/").parse_args()
    warnings.simplefilter("ignore", rl.RoundelayWarning)
    rows = []
    for one in captures(arguments.data / "truth"):
        row = None if one.period is None else _row(one.file, arguments.data / "truth" / one.file)
        if row is not None:
            rows.append(row)
    ratios = np.array([row["spread"] for row in rows])
    summary = {
        "captures": len(rows),
        "join": round(max(row["join"] for row in rows), 3),
        "spread": round(float(np.median(ratios)), 3),
        "spread_within_a_fifth": round(float(np.mean(np.abs(ratios - 1.0) <= 0.2)), 3),
    }
    table = (
        f"{row['capture']:45s} {row['repetitions']:3d} repetitions, join {row['join']:.2f}, "
        f"spread {row['spread']:.2f}"
        for row in rows
    )
    report("variation", {"summary": summary, "rows": rows}, TARGETS, arguments, table=table)


def _row(name: str, path: Any) -> dict[str, Any] | None:
    motion = rl.read(path)
    try:
        cycle = rl.find_cycles(motion)[0]
        own = rl.repetitions(cycle, motion)
    except rl.RoundelayError:
        return None
    if len(own) < FEWEST:
        return None
    return {
        "capture": name,
        "repetitions": len(own),
        "join": round(_join(own.vary(4, rng=0)), 3),
        "spread": round(_drawn(own) / _seen(own, motion), 3),
    }


def _join(loop: rl.Motion) -> float:
    points = rl.point_cloud(loop.with_root_motion())
    around = np.concatenate([points[-2:], points, points[:2]])
    bends = np.linalg.norm(np.diff(around, n=2, axis=0).reshape(len(points) + 2, -1, 3), axis=2)
    hardest = bends.max(axis=1)
    return float(max(hardest[:2].max(), hardest[-2:].max()) / hardest[2:-2].max())


def _seen(own: rl.Repetitions, motion: rl.Motion) -> float:
    """Return the spread of the capture's repetitions, from its frames."""
    points, phase = rl.point_cloud(motion.with_root_motion()), own.cycle.phase
    assert phase is not None
    assert own.cycle.evidence is not None
    shown = []
    for start, stop in own.cycle.evidence.runs:
        turned = np.maximum.accumulate(phase[start:stop])
        for number in np.arange(np.ceil(turned[0]), np.floor(turned[-1])):
            at = np.interp(number + np.arange(PHASES) / PHASES, turned, np.arange(start, stop))
            before = np.minimum(at.astype(int), len(points) - 2)
            part = (at - before)[:, None]
            shown.append((1.0 - part) * points[before] + part * points[before + 1])
    return _spread(np.array(shown))


def _drawn(own: rl.Repetitions) -> float:
    """Return the spread of drawn ones at even times of each, feet not held as the frames' are not.

    Each is drawn by itself, as a loop of one.
    """
    shown = []
    for seed in range(DRAWN):
        loop = own.vary(1, rng=seed, foot_lock=False).with_root_motion()
        at = np.arange(PHASES) * len(loop) / PHASES
        points = rl.point_cloud(loop)
        points = np.concatenate([points, points[:1]])
        before = at.astype(int)
        part = (at - before)[:, None]
        shown.append((1.0 - part) * points[before] + part * points[before + 1])
    return _spread(np.array(shown))


def _spread(shown: Array) -> float:
    return float(np.sqrt(np.mean(np.var(shown, axis=0, ddof=1))))


if __name__ == "__main__":
    main()
