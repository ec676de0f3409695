"""The extension on a matrix of rigs, as its tests measured it in versions of Blender.

Usage: python -m benchmarks.blender VERSION=FIGURES ... [--json] [--keep]

The figures are what ``blender/tests/run.py`` writes to the file that ROUNDELAY_FIGURES names: of
each rig whether the loop keys what the capture keys, how far it plays from the mean of the
capture's repetitions (of a body of 1.7 m), the join as played, and the seconds of the button.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from benchmarks._harness import Target, parser, report

TARGETS = (
    Target("keyed", "==", 1.0, "share of rigs whose loop keys what the capture keys"),
    Target("away_cm", "<=", 1.0, "centimetres from the mean repetition, the worst rig"),
    Target("join", "<=", 1.1, "join as played, the worst rig"),
    Target("rigify_seconds", "<=", 3.0, "seconds of the button on Rigify"),
    Target("long_seconds", "<=", 20.0, "seconds of the button, 20,000 frames"),
)


def main() -> None:
    """Gather and report."""
    arguments = parser(__doc__, data=None)
    arguments.add_argument("figures", nargs="+", metavar="VERSION=FIGURES")
    given = arguments.parse_args()
    rows = [row for one in given.figures for row in _rows(*one.split("=", 1))]
    table = (f"{row['blender']:8s} {row['rig']:20s} {row}" for row in rows)
    report("blender", {"summary": _summary(rows), "rows": rows}, TARGETS, given, table=table)


def _rows(version: str, path: str) -> list[dict[str, Any]]:
    found = json.loads(Path(path).read_text())
    return [{"blender": version, "rig": name, **figures} for name, figures in found.items()]


def _summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    rigs = [row for row in rows if "keyed" in row]
    rigify = [row["seconds"] for row in rows if row["rig"].startswith("Rigify")]
    long = [row["seconds"] for row in rows if row["rig"] == "20,000 frames"]
    return {
        "versions": len({row["blender"] for row in rows}),
        "rigs": len({row["rig"] for row in rigs}),
        "keyed": sum(row["keyed"] for row in rigs) / len(rigs),
        "away_cm": round(100 * max(row["away"] for row in rigs), 2),
        "join": round(max(row["join"] for row in rigs), 2),
        "rigify_seconds": round(max(rigify), 1) if rigify else None,
        "long_seconds": round(max(long), 1) if long else None,
    }


if __name__ == "__main__":
    main()
