"""Walks and runs of [C] told apart by `roundelay.compare.distances`; a library made and searched.

Usage: python -m benchmarks.signatures --data FOLDER [--json] [--keep]

For each distance: how many of the captures have a nearest other one of their own kind, the same
where captures of the same person do not count, and how many are in a group of their own kind
when clustered into two groups.

Of the library of all captures below the folder: clips, loops and seconds with one process and with
two; seconds to open and search it, to do so with one enlarged to 10,000 cycles, and to group that
one. Kinds are the descriptions of the CMU database: of the cycles of clips that show one kind, how
many have a nearest other clip of it, also where clips of the same person do not count, and in which
groups they are. Cycles that can be compared with no other person's are left out.
"""

from __future__ import annotations

import csv
import os
import tempfile
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import roundelay as rl
from benchmarks._harness import Target, parser, report
from benchmarks.raunio import RUNS, TABLES, find_capture
from roundelay.compare.distances import (
    bottleneck_distance,
    cluster,
    cycle_distance,
    distance_matrix,
    wasserstein_distance,
)
from roundelay.compare.packed import pair_distances
from roundelay.library.groups import assigned
from roundelay.library.shelves import Shelf, write_shelves
from roundelay.library.store import write_catalogue

# Words of the descriptions, and the kinds they speak of.
KINDS = {"walk": "walk", "run": "run", "boxing": "boxing"}
ENLARGED = 10_000
TARGETS = (
    Target("cycle.nearest_of_its_kind", ">=", 46, "walks and runs whose nearest is of their kind"),
    Target("library.kinds.run.nearest_of_another_person", ">=", 31, "runs next to a run"),
    Target("library.kinds.walk.nearest_of_its_kind", ">=", 35, "walks next to a walk"),
    Target("library.search_enlarged.search_cpu_seconds", "<=", 0.2, "seconds to search 10,000"),
    Target("library.groups_of_walks_and_runs", "<=", 0, "groups that hold walks and runs"),
)


def main() -> None:
    arguments = parser(__doc__).parse_args()
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
    result["library"] = _library(arguments.data, cycles[0])
    report("signatures", {"summary": result}, TARGETS, arguments)


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


def _library(data: Path, query: rl.Cycle) -> dict[str, Any]:
    """Make the library with one process and two, enlarge it, search both."""
    result: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for jobs in (1, 2):
            started, spent = time.perf_counter(), sum(os.times()[:4])
            library = rl.build_library(data, folder / str(jobs), jobs=jobs)
            result[f"jobs_{jobs}"] = {
                "wall_seconds": round(time.perf_counter() - started, 1),
                "cpu_seconds": round(sum(os.times()[:4]) - spent, 1),
            }
        large = _enlarged(library, folder / "large")
        result |= library.summary | {"search": _searched(library.folder, query)}
        result["search_enlarged"] = _searched(large.folder, query)
        count = sum(len(shelf.numbers) for shelf in large.shelves)
        started = time.process_time()
        assigned(large.shelves, np.full(count, -1), {})
        result["group_enlarged_cpu_seconds"] = round(time.process_time() - started, 1)
    kinds = _kinds(library, _descriptions(data))
    mixed = set(kinds["walk"]["groups"]) & set(kinds["run"]["groups"])
    for found in kinds.values():
        found["groups"] = list(found["groups"].values())
    return result | {"kinds": kinds, "groups_of_walks_and_runs": len(mixed)}


def _enlarged(library: rl.Library, folder: Path) -> rl.Library:
    """Write a library that holds the behaviours again and again, each a little changed."""
    times = -(-ENLARGED // library.summary["loops"])
    rng, shelves = np.random.default_rng(0), []
    for shelf in library.shelves:
        many = np.tile(shelf.packed.values, (times, 1))
        many *= 1.0 + 0.05 * rng.standard_normal(many.shape, np.float32)
        numbers = np.arange(times)[:, None] * len(library.behaviours) + shelf.numbers
        shelves.append(Shelf(numbers.ravel(), replace(shelf.packed, values=many)))
    folder.mkdir()
    record = {name: value for name, value in library.record.items() if name != "format"}
    write_shelves(shelves, folder)
    write_catalogue(record | {"clips": library.clips * times}, folder, ())
    return rl.Library.open(folder)


def _searched(folder: Path, query: rl.Cycle) -> dict[str, float]:
    started = time.process_time()
    library = rl.Library.open(folder)
    opened = time.process_time()
    library.search(query)
    searched = time.process_time()
    return {
        "cycles": len(library.behaviours),
        "open_cpu_seconds": round(opened - started, 4),
        "search_cpu_seconds": round(searched - opened, 4),
    }


def _descriptions(data: Path) -> dict[str, str]:
    """The kind of each trial of CMU that shows one, by its description, else its category."""
    result = {}
    with (data / "cmu" / "scarlet_motion_labels.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            for text in (row["short_label"].lower(), row["long_label"].lower()):
                kinds = {kind for word, kind in KINDS.items() if word in text}
                if len(kinds) == 1:
                    result[row["motion_id"]] = kinds.pop()
    return result


def _kinds(library: rl.Library, kinds: dict[str, str]) -> dict[str, Any]:
    cycles = library.behaviours
    apart = _apart(library)
    trials = np.array(["_".join(Path(file).stem.split("_")[:2]) for file, _ in cycles])
    people = np.array([trial.partition("_")[0] for trial in trials])
    kind = np.array([kinds.get(trial, "") for trial in trials])
    result = {}
    for name in sorted(set(KINDS.values())):
        others = np.where(people[:, None] == people, np.inf, apart)
        own = np.flatnonzero((kind == name) & np.isfinite(others).any(axis=1))
        near = np.where(trials[own, None] == trials, np.inf, apart[own]).argmin(axis=1)
        far = others[own].argmin(axis=1)
        result[name] = {
            "cycles": len(own),
            "nearest_of_its_kind": int((kind[near] == name).sum()),
            "nearest_of_another_person": int((kind[far] == name).sum()),
            "groups": dict(Counter(cycles[row][1]["group"] for row in own).most_common()),
        }
    return result


def _apart(library: rl.Library) -> np.ndarray:
    """Distances of all behaviours; of those that are no cycles nothing is compared."""
    count = len(library.behaviours)
    result = np.full((count, count), np.inf)
    for shelf in library.shelves:
        one, other = (x.ravel() for x in np.indices((len(shelf.numbers),) * 2))
        apart = pair_distances(shelf.packed, shelf.packed, one, other)
        result[shelf.numbers[one], shelf.numbers[other]] = apart
    once = ["loop" not in record for _, record in library.behaviours]
    result[once] = result[:, once] = np.inf
    return result


if __name__ == "__main__":
    main()
