"""Walks and runs of [C] told apart by the signatures of `roundelay.signature`.

Usage: python -m benchmarks.signatures --data FOLDER [--json]

For each distance: how many of the captures have a nearest other one of their own kind, the same
where captures of the same person do not count, and how many are in a group of their own kind
when clustered into two groups.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np

import roundelay as rl
from benchmarks.raunio import RUNS, TABLES, find_capture
from roundelay.signature import (
    bottleneck_distance,
    cluster,
    cycle_distance,
    distance_matrix,
    wasserstein_distance,
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder that holds cmu/")
    parser.add_argument("--json", action="store_true", help="print JSON")
    arguments = parser.parse_args()
    names, cycles = _cycles(arguments.data)
    barcodes = [cycle.evidence.barcode for cycle in cycles if cycle.evidence is not None]
    result: dict[str, Any] = {"captures": len(names)}
    for label, items, distance in (
        ("cycle", cycles, cycle_distance),
        ("bottleneck", barcodes, bottleneck_distance),
        ("wasserstein", barcodes, wasserstein_distance),
    ):
        started = time.process_time()
        apart = distance_matrix(items, distance)
        spent = time.process_time() - started
        result[label] = _figures(names, apart) | {"cpu_seconds": round(spent, 2)}
    print(json.dumps(result, indent=1) if arguments.json else result)


def _cycles(data: Path) -> tuple[list[str], list[rl.Cycle]]:
    """Find the best cycle of each capture with Acclaim's skeleton."""
    motions = {name: find_capture(data, name) for name in TABLES}
    names = [name for name, motion in motions.items() if motion.skeleton.n_joints == 31]
    roots = [motions[name].skeleton.names[0] for name in names]
    names = [name for name, root in zip(names, roots, strict=True) if root == "root"]
    return names, [rl.find_cycles(motions[name])[0] for name in names]


def _figures(names: list[str], apart: np.ndarray) -> dict[str, int]:
    runs = np.array([name in RUNS for name in names])
    people = np.array([name.split("_")[0] for name in names])
    alone = apart + np.diag(np.full(len(names), np.inf))
    others = np.where(people[:, None] == people, np.inf, apart)
    labels = cluster(apart, 2) == 1
    right = int((labels == runs).sum())
    return {
        "nearest_of_its_kind": int((runs[alone.argmin(axis=1)] == runs).sum()),
        "nearest_of_another_person": int((runs[others.argmin(axis=1)] == runs).sum()),
        "clustered": max(right, len(names) - right),
    }


if __name__ == "__main__":
    main()
