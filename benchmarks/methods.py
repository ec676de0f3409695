"""The methods side by side: what a loop keeps of its capture, and how smooth it is.

Usage: python -m benchmarks.methods --data FOLDER [--json] [--keep]

The captures are the 61 walks and runs of [C], and those of ``truth`` in which something repeats
that is told by a table. Each method makes the first cycle of each capture: the mean (``harmonic``),
the most typical repetition as it was played (``take``), [A]'s centroids (``centroid``), [C]'s M1
(``paper``), and the default (``auto``), which takes the second where the first loses a fifth of a
limb's movement. Told are medians: the amplitude that the limb keeps that loses most, beside its
usual repetition; jerk beside the capture's; template error in radians; the largest change of
velocity at the seam beside the usual one of the capture. ``accents`` is the share of captures in
which every limb that moves keeps .8 of its amplitude.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import roundelay as rl
from benchmarks._harness import Target, parser, report
from benchmarks._truth_data import captures
from benchmarks.raunio import TABLES, find_capture
from roundelay.cycles.swings import swings
from roundelay.pipeline import make_cycle

METHODS = ("harmonic", "take", "centroid", "paper", "auto")
KEPT = 0.8
"""Of a limb's amplitude, as the default asks for."""
LONGEST = 3000
"""Frames of the captures with truth that are looked at."""

TARGETS = (
    Target("captures", ">=", 150, "captures with a loop"),
    Target("auto.accents", ">=", 0.98, "share of loops that keep the accents"),
    Target("take.seam", "<=", 1.0, "change of velocity at the seam beside the capture's usual"),
)


def main() -> None:
    arguments = parser(__doc__, data="folder that holds cmu/ and truth/").parse_args()
    rows = [
        row for name, motion in _motions(arguments.data) if (row := _row(name, motion)) is not None
    ]
    summary: dict[str, Any] = {
        "captures": len(rows),
        "taken": sum(row["auto"]["method"] == "take" for row in rows),
    }
    for method in METHODS:
        own = [row[method] for row in rows if "failed" not in row[method]]
        summary[method] = {
            key: round(float(np.median([one[key] for one in own])), 3)
            for key in ("amplitude", "jerk", "template_error", "seam")
        }
        kept = [one["amplitude"] >= KEPT for one in own]
        summary[method] |= {"accents": round(float(np.mean(kept)), 3), "loops": len(own)}
    report("methods", {"summary": summary, "rows": rows}, TARGETS, arguments, table=_table(rows))


def _table(rows: list[dict[str, Any]]) -> Iterator[str]:
    for row in rows:
        told = [f"{row[method].get('amplitude', float('nan')):.2f}" for method in METHODS]
        yield f"{row['capture']}  kept {' '.join(told)}  by {row['auto'].get('method')}"


def _motions(data: Path) -> Iterator[tuple[str, rl.Motion]]:
    for name in TABLES:
        yield name, find_capture(data, name)
    for one in captures(data / "truth"):
        if (one.period is not None or one.stretches) and one.frames <= LONGEST:
            yield one.file, rl.read(data / "truth" / one.file)


def _row(name: str, motion: rl.Motion) -> dict[str, Any] | None:
    try:
        evidence = rl.find_periodic(motion)[0]
    except rl.RoundelayError:
        return None
    return {"capture": name} | {method: _made(motion, evidence, method) for method in METHODS}


def _made(motion: rl.Motion, evidence: Any, method: str) -> dict[str, Any]:
    """Make the cycle by one method, and measure it."""
    try:
        cycle = make_cycle(motion, evidence, rl.Options(method=method))
    except (rl.RoundelayError, ValueError) as error:
        return {"failed": str(error)}
    figures = rl.quality(cycle, motion)
    loop = cycle.sample(foot_lock=False).with_root_motion()
    own = evidence.partial
    moved = swings(loop, motion.with_root_motion(), evidence)
    kept = [swing.kept for swing in moved if not own or swing.limb in own]
    return {
        "method": cycle.method,
        "amplitude": min(kept, default=1.0),
        "jerk": figures.loop_jerk / figures.capture_jerk,
        "template_error": figures.template_error,
        "seam": figures.seam_velocity / figures.capture_velocity,
    }


if __name__ == "__main__":
    main()
