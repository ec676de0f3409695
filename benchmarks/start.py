"""Loops begin at the left foot's contact: on walks and runs, by Zeni's rule written here anew.

Usage: python -m benchmarks.start --data FOLDER [--json] [--keep]

The walks and runs are the 61 of [C] and those of ``truth`` that are one gait from end to end. A
foot makes contact where its ankle is farthest ahead of the hips along the way (Zeni et al. 2008):
of the capture's frames, by names of joints, without the library's feet or events. The phase of the
cycle at these frames should be 0; ``start`` is the share of captures with a loop in which its
median is within .03 periods.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from benchmarks._harness import Target, parser, report
from benchmarks._truth_data import captures
from benchmarks.raunio import TABLES, find_capture

Array = NDArray[np.float64]

TARGETS = (
    Target("captures", ">=", 100, "walks and runs that are there"),
    Target("start", ">=", 0.95, "share of captures whose left contact lies at phase 0"),
)

NEAR = 0.03
# What the left ankle and the hips are called: CMU's two exports, Bandai Namco, HDM05, dogs.
ANKLES = ("lfoot", "leftfoot", "foot_l", "leftankle", "lankle", "l_foot", "lefttoebase", "ltoes")
HIPS = ("hips", "hip", "pelvis", "root", "joint_root")


def main() -> None:
    arguments = parser(__doc__, data="folder that holds cmu/ and truth/").parse_args()
    rows = [row for row in _rows(arguments.data) if row is not None]
    found = [row for row in rows if row["contacts"]]
    summary = {
        "captures": len(rows),
        "with_a_contact": len(found),
        "start": round(sum(abs(row["phase"]) <= NEAR for row in found) / len(found), 3),
        "contacts": sum(len(row["contacts"]) for row in found),
        "contacts_near": round(
            float(np.mean([abs(x) <= NEAR for row in found for x in row["contacts"]])), 3
        ),
    }
    table = (f"{row['capture']}  {row['phase']}  {row['contacts']}" for row in rows)
    report("start", {"summary": summary, "rows": rows}, TARGETS, arguments, table=table)


def _rows(data: Path) -> list[dict[str, Any] | None]:
    rows = [_row(name, find_capture(data, name)) for name in TABLES]
    gaits = (one for one in captures(data / "truth") if one.period is not None)
    return rows + [_row(one.file, rl.read(data / "truth" / one.file)) for one in gaits]


def _row(name: str, motion: rl.Motion) -> dict[str, Any] | None:
    """Say at which phases of its first cycle a capture shows left contacts; None without feet."""
    names = [joint.lower() for joint in motion.skeleton.names]
    ankle = next((names.index(one) for one in ANKLES if one in names), None)
    if ankle is None:
        return None
    hips = next((names.index(one) for one in HIPS if one in names), 0)
    try:
        cycle = rl.find_cycles(motion)[0]
    except rl.NoPeriod as refusal:
        return {"capture": name, "phase": None, "contacts": [], "reason": str(refusal)}
    places = motion.positions() * (1.0 - motion.up_vector)
    phases = [
        float(cycle.phase[frame])
        for start, stop in cycle.evidence.runs
        for frame in start + _contacts(places[start:stop], ankle, hips, cycle)
    ]
    away = [round((x + 0.5) % 1.0 - 0.5, 3) for x in phases]
    middle = round(float(np.median(away)), 3) if away else None
    return {"capture": name, "phase": middle, "contacts": away}


def _contacts(places: Array, ankle: int, hips: int, cycle: rl.Cycle) -> NDArray[np.intp]:
    """Return the frames of positions (n, J, 3) at which the foot is farthest ahead of the hips."""
    reach = max(1, round(0.5 * cycle.period * cycle.fps))
    frames = np.arange(len(places))
    later, earlier = np.minimum(frames + reach, frames[-1]), np.maximum(frames - reach, 0)
    way = places[later, hips] - places[earlier, hips]
    way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-9)
    ahead = np.sum((places[:, ankle] - places[:, hips]) * way, axis=1)
    near = max(1, round(0.2 * cycle.period * cycle.fps))
    middle = 0.5 * (ahead.min() + ahead.max())
    return np.array(
        [
            frame
            for frame in range(near, len(ahead) - near)
            if ahead[frame] > middle
            and ahead[frame] == ahead[frame - near : frame + near + 1].max()
        ],
        np.intp,
    )


if __name__ == "__main__":
    main()
