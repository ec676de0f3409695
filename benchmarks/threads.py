"""Speed of `find_cycles` from Python with default threads, against one thread from the start.

    python -m benchmarks.threads [FOLDER] [--most 10] [--repeats 3] [--json] [--keep]

Takes the captures below a folder, or made gaits without one. Every run is a process of its own, by
turns with the libraries' default threads and with OPENBLAS_NUM_THREADS=1. A speed is the time of
one thread over the time of default threads, each the least of the repeats; the target is .9.
`unchanged` says whether the threads of the libraries are afterwards what they were before.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import roundelay as rl
from benchmarks._harness import Target, parser, report
from roundelay import synth

TARGETS = (
    Target("cpu_speed", ">=", 0.9, "CPU speed with default threads, of that with one"),
    Target("wall_speed", ">=", 0.9, "speed with default threads, of that with one"),
    Target("unchanged", "==", 1, "the caller's threads are what they were"),
)
NAMES = [f"{library}_NUM_THREADS" for library in ("OPENBLAS", "MKL", "OMP")]


def motions(folder: Path | None, most: int) -> Iterator[rl.Motion]:
    if folder is None:
        for kind in ("walk", "run", "jacks"):
            yield from (synth.gait(kind, seed=seed).motion for seed in range(8))
        return
    paths = sorted(path for path in folder.rglob("*") if path.suffix in (".bvh", ".amc"))[:most]
    if not paths:
        raise SystemExit(f"expected captures below {folder}, found none")
    yield from map(rl.read, paths)


def measured(folder: Path | None, most: int) -> dict[str, Any]:
    """CPU and wall seconds of this process in `find_cycles`, and the threads around it."""
    from threadpoolctl import threadpool_info

    takes, before = list(motions(folder, most)), threadpool_info()
    rl.find_cycles(synth.gait("walk").motion)
    cpu, wall = time.process_time(), time.perf_counter()
    for take in takes:
        try:
            rl.find_cycles(take)
        except (rl.NoPeriod, rl.TooShort):
            continue
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    return {
        "takes": len(takes),
        "threads": [one["num_threads"] for one in before],
        "cpu": cpu,
        "wall": wall,
        "unchanged": threadpool_info() == before,
    }


def child(one: bool, folder: Path | None, most: int) -> dict[str, Any]:
    """Measure in a process of its own."""
    environment = {name: value for name, value in os.environ.items() if name not in NAMES}
    environment |= dict.fromkeys(NAMES, "1") if one else {}
    command = [sys.executable, "-m", "benchmarks.threads", "--here", "--most", str(most)]
    command += [] if folder is None else [str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    result: dict[str, Any] = json.loads(done.stdout)
    return result


def compare(folder: Path | None, most: int, repeats: int) -> dict[str, Any]:
    kinds = {"default": False, "one": True}
    runs = [{kind: child(one, folder, most) for kind, one in kinds.items()} for _ in range(repeats)]
    least = {
        kind: {clock: min(run[kind][clock] for run in runs) for clock in ("cpu", "wall")}
        for kind in kinds
    }
    summary: dict[str, Any] = {
        f"{clock}_speed": least["one"][clock] / least["default"][clock] for clock in ("cpu", "wall")
    }
    summary["unchanged"] = all(run[kind]["unchanged"] for run in runs for kind in kinds)
    return {"runs": runs, "seconds": least, "summary": summary}


def main() -> None:
    asked = parser(__doc__, data=None)
    asked.add_argument("folder", type=Path, nargs="?")
    asked.add_argument("--most", type=int, default=10, help="captures of the folder")
    asked.add_argument("--repeats", type=int, default=3)
    asked.add_argument("--here", action="store_true", help="measure in this process")
    given = asked.parse_args()
    if given.here:
        print(json.dumps(measured(given.folder, given.most)))
    else:
        report("threads", compare(given.folder, given.most, given.repeats), TARGETS, given)


if __name__ == "__main__":
    main()
