"""What every benchmark shares: its arguments, its targets, its report.

A report is JSON. ``summary`` holds the figures of the targets by name, and ``short``, the targets
that were missed. Beside it stand the machine, the threads of BLAS, the commit and the date; then
whatever else was measured. ``--keep`` writes it to ``benchmarks/results/NAME.json``, from which
`benchmarks.figures` fills in the figures of the README and of the documentation.
"""

from __future__ import annotations

import argparse
import json
import operator
import os
import platform
import subprocess
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["RESULTS", "Target", "figure", "parser", "report"]

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "benchmarks" / "results"

_SENSES = {"<=": operator.le, ">=": operator.ge, "==": operator.eq}


@dataclass(frozen=True)
class Target:
    """What a figure of the summary should be: its path, with dots; sense; value; in words."""

    path: str
    sense: str
    value: float
    words: str

    def missed(self, summary: dict[str, Any]) -> str | None:
        """Say by how much the target is missed; None where it is met."""
        found = figure(summary, self.path)
        if isinstance(found, int | float) and _SENSES[self.sense](found, self.value):
            return None
        shown = "not measured" if found is None else f"{found:g}"
        return f"{self.words}: expected {self.path} {self.sense} {self.value:g}, found {shown}"


def figure(found: Any, path: str) -> Any:
    """Return what stands at a path of keys with dots between; None where there is nothing."""
    if not path or found is None:
        return found
    if isinstance(found, list):
        place, _, rest = path.partition(".")
        return figure(found[int(place)], rest) if int(place) < len(found) else None
    # A key may hold dots itself.
    for key, value in found.items() if isinstance(found, dict) else ():
        if path == key or path.startswith(f"{key}."):
            return figure(value, path[len(key) + 1 :])
    return None


def parser(words: str, *, data: str | None = "folder that holds cmu/") -> argparse.ArgumentParser:
    """Return the arguments of every benchmark; `data` says what its folder holds."""
    result = argparse.ArgumentParser(description=words.splitlines()[0])
    if data is not None:
        result.add_argument("--data", type=Path, required=True, help=data)
    result.add_argument("--json", action="store_true", help="print the whole report as JSON")
    result.add_argument("--keep", action="store_true", help="write benchmarks/results/NAME.json")
    return result


def report(
    name: str,
    result: dict[str, Any],
    targets: Sequence[Target],
    arguments: argparse.Namespace,
    *,
    table: Iterable[str] = (),
    bulk: Sequence[str] = (),
) -> None:
    """Print what was measured, for people or as JSON, and keep it where asked to.

    ``result["summary"]`` holds the figures of the targets; `table` are the lines for people, after
    which the summary follows as JSON; `bulk` names what is not kept.
    """
    short = [missed for target in targets if (missed := target.missed(result["summary"]))]
    summary = {"short": short, **result["summary"]}
    head = {"benchmark": name, **_circumstances(arguments), "summary": summary}
    whole = {**head, **{key: value for key, value in result.items() if key != "summary"}}
    if arguments.keep:
        kept = {key: value for key, value in whole.items() if key not in bulk}
        RESULTS.mkdir(exist_ok=True)
        (RESULTS / f"{name}.json").write_text(json.dumps(kept, indent=1) + "\n")
    if not arguments.json:
        for line in table:
            print(line)
    print(json.dumps(whole if arguments.json else head, indent=1))


def _circumstances(arguments: argparse.Namespace) -> dict[str, Any]:
    """Say where, when and of what a measurement was taken; no path of this machine."""
    options = {
        key: value
        for key, value in vars(arguments).items()
        if key not in ("json", "keep") and isinstance(value, int | float)
    }
    return {
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "commit": _commit(),
        "machine": {
            "processor": _processor(),
            "cores": os.cpu_count(),
            "system": f"{platform.system()} {platform.machine()}",
            "python": platform.python_version(),
            "numpy": np.__version__,
        },
        "threads": _threads(),
        "options": options,
    }


def _commit() -> dict[str, Any]:
    """Name the commit, and whether what is measured or measures differs from it."""
    commit = _git("rev-parse", "HEAD")
    changed = _git("status", "--porcelain", "--", "src", "benchmarks", ":!benchmarks/results")
    return {
        "name": commit and commit.strip()[:12],
        "changed": None if changed is None else bool(changed),
    }


def _git(*words: str) -> str | None:
    try:
        done = subprocess.run(
            ["git", *words], cwd=ROOT, capture_output=True, text=True, check=True, timeout=30
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor())


def _threads() -> dict[str, Any]:
    """Say how many threads BLAS uses: as threadpoolctl finds it, else as the environment asks."""
    try:
        from threadpoolctl import threadpool_info
    except ImportError:
        asked = {key: value for key, value in os.environ.items() if key.endswith("_NUM_THREADS")}
        return {"blas": None, "environment": asked}
    pools = [pool for pool in threadpool_info() if pool["user_api"] == "blas"]
    return {"blas": max((pool["num_threads"] for pool in pools), default=None)}
