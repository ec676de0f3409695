"""Every table and figure of [A], [B] and [C] that the data at hand allow, beside the printed ones.

Usage: python -m benchmarks.papers --data FOLDER [--out FOLDER] [--json] [--keep]

Told of each by its number: whether it is made, of how many of its rows, the largest deviation from
a printed value and of what, and CPU seconds. Where [B]'s or [A]'s own captures are not to be had,
others that show the same stand in, and are named. `benchmarks.fetch_cmu` fetches what is missing.
Pictures go to ``--out``. Captions: which of the behaviours that [A]'s figures 9 to 11 and table 1
name are found, by the default (half of a cycle's frames lie in the behaviour's) and by the classes
of each metric (half of a class's turning does).
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import roundelay as rl
from benchmarks import _papers_a as a
from benchmarks import _papers_b as b
from benchmarks import _papers_c as c
from benchmarks._harness import Target, parser, report

TARGETS = (
    Target("tables.made", "==", 7, "tables of the papers"),
    Target("figures.made", "==", 17, "figures of the papers"),
    Target("captions_found", ">=", 7, "behaviours that [A] shows"),
    Target("joined_slashes.most_left", "<=", 0.05, "pose variance that the mean slash leaves"),
    Target("boxing_14_02", "<=", 0.5, "template error of the default on [C]'s window of 14_02"),
    Target("dimensions.share", ">=", 0.85, "named behaviours of at most 6 dimensions ([B])"),
)


def main() -> None:
    options = parser(__doc__, data="folder that holds cmu/, labels/")
    options.add_argument("--out", type=Path, default=Path("out/papers"), help="for pictures")
    arguments = options.parse_args()
    warnings.simplefilter("ignore", rl.RoundelayWarning)
    data, out = arguments.data, arguments.out
    begun = time.process_time()
    first = a.table_1(data)
    first["seconds"] = round(time.process_time() - begun, 2)
    others_tables, others = c.tables(data)
    tables = {"A 1": first, **others_tables}
    figures = {**a.figures(data, out), **b.figures(data, out), **c.figures(data, out)}
    found, joined = a.captions(data), a.joined(data)
    boxing = others["boxing"]["default"].get("14_02", {})
    summary = {
        "tables": {"made": _made(tables), "rows": _rows(tables)},
        "figures": {"made": _made(figures), "rows": _rows(figures)},
        "captions_found": sum(bool(who) for told in found.values() for who in told.values()),
        "captions_in_paper": sum(map(len, a.IN_PAPER.values())),
        "captions": found,
        "joined_slashes": joined,
        "boxing_14_02": boxing.get("error"),
        "dimensions": b.dimensions(data),
        "discussed": others,
        "by_number": {
            number: {key: value for key, value in told.items() if key != "table"}
            for number, told in {**tables, **figures}.items()
        },
        "table_1": {row["capture"]: _beside(row) for row in first["table"]},
    }
    report("papers", {"summary": summary}, TARGETS, arguments, table=_table(summary))


def _made(told: dict[str, Any]) -> int:
    return sum(bool(row["made"]) for row in told.values())


def _rows(told: dict[str, Any]) -> str:
    return (
        f"{sum(row['rows'] for row in told.values())} of {sum(row['of'] for row in told.values())}"
    )


def _beside(row: dict[str, Any]) -> dict[str, Any]:
    """The printed figures of a row of table 1, and ours."""
    keys = ("born", "simplices", "dimensions", "cohomology_seconds", "processing_seconds")
    ours = {key: row["ours"].get(key) for key in keys}
    rounded = {
        key: round(value, 3) if isinstance(value, float) else value for key, value in ours.items()
    }
    return {"printed": {key: row["printed"][key] for key in keys}, "ours": rounded}


def _table(summary: dict[str, Any]) -> Iterator[str]:
    for number, told in summary["by_number"].items():
        deviation = told.get("deviation")
        shown = "" if deviation is None else f", {deviation:.3g}: {told['deviation_of']}"
        made = "made" if told["made"] else "not made"
        yield f"{number}: {made}, {told['rows']} of {told['of']} rows{shown}"


if __name__ == "__main__":
    main()
