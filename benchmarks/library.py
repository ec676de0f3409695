"""A library of all captures: made, made again, grouped, named and searched; and a large one.

Usage: python -m benchmarks.library --data FOLDER [--json] [--keep] [--sizes 10000 100000]
       [--captures N] [--library LIBRARY]

``made`` is the library of all captures below the folder, or of so many drawn evenly, in one process
of its own: clips a second of processor time, beside what `roundelay loop` does with the same
captures; peak memory; size. ``whole`` is the library of all captures, or one that is there already:
its size, and the processor seconds of a rerun with nothing to do.

``large`` are libraries of so many behaviours, varied from the captured ones: blends of each with
one of its ten nearest, in phase; their harmonics scattered by a tenth, as repetitions scatter;
begun anywhere. Told are the seconds of grouping, with the exponent of their growth; the share of
the true ten nearest that a search finds (of 25 queries, against all exact distances), its time and
that of opening, of the processor. Of 1000 of them: whether names stay when a fifth is added; the
adjusted Rand index of groups found in another order, and of groups found in two steps against those
found at once.

``names``: behaviours that fill most of a clip of a class in ``truth/captures.csv``. The groups of
half of them, drawn ten times, are named after their class; told is of the other half how many pairs
of one class share a name, and how many of two classes, without any names (by groups alone) and with
these.
"""

from __future__ import annotations

import csv
import json
import multiprocessing
import os
import re
import resource
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import roundelay as rl
from benchmarks._harness import Target, parser, report
from roundelay.compare.neighbours import has_usearch
from roundelay.compare.packed import Packed, pair_distances
from roundelay.library.captures import find_captures
from roundelay.library.groups import assigned, clusters, nearest_named
from roundelay.library.shelves import Shelf, read_shelves, write_shelves

TARGETS = (
    Target("clips_a_second_ratio", ">=", 1.0, "clips a second beside roundelay loop"),
    Target("rerun_seconds", "<=", 0.5, "seconds of a rerun with nothing to do"),
    Target("dask_ratio", "<=", 1.2, "time by Dask on two workers beside two processes"),
    Target("exponent", "<=", 1.2, "growth of grouping with the number of behaviours"),
    Target("recall", ">=", 0.97, "share of the ten nearest that a search finds"),
    Target("search_ms", "<=", 2.0, "milliseconds of a search"),
    Target("open_seconds", "<=", 0.2, "seconds of opening what is searched"),
    Target("names_stable", ">=", 0.98, "share of behaviours whose name stays"),
    Target("rand_other_order", ">=", 0.98, "adjusted Rand index of groups in another order"),
    Target("same_name", ">=", 0.8, "pairs of one class with one name"),
    Target("different_name", "<=", 0.05, "pairs of two classes with one name"),
    Target("raised", ">=", 0.05, "more of these by names of the other half"),
    Target("dead_ends", "<=", 0, "dead ends of random walks over a playable set"),
)
QUERIES, NEAREST, NEAR, FEW = 25, 10, 10, 1000
# Words of the classes of `truth/captures.csv`, and the names they are of.
NAMES = (
    ("walk-turn|walk, 90", ""),
    ("sneak", "sneak"),
    ("^walk", "walk"),
    ("^run|dash|^jog|^Run", "run"),
    ("hop|Jump|jump", "jump"),
    ("squat", "squat"),
    ("kick", "kick"),
    ("bye|wave", "wave"),
    ("^bow", "bow"),
    ("raise-up", "raise hands"),
    ("throw", "throw"),
    ("deposit", "deposit"),
    ("grab", "grab"),
    ("elbowTo", "elbow to knee"),
    ("rotateArms", "rotate arms"),
)


def main() -> None:
    options = parser(__doc__, data="folder of captures, with truth/")
    options.add_argument("--sizes", type=int, nargs="+", default=[10_000, 100_000])
    options.add_argument("--captures", type=int, help="how many are made; all by default")
    options.add_argument("--library", type=Path, help="one of all captures that is made already")
    arguments = options.parse_args()
    with tempfile.TemporaryDirectory() as place:
        captures = list(find_captures([arguments.data.resolve()]).captures.values())
        step = max(1, len(captures) // (arguments.captures or len(captures)))
        made = _made(captures[step // 2 :: step], Path(place))
        whole = _whole(arguments.data, arguments.library or Path(place) / "whole")
        library = rl.Library.open(arguments.library or Path(place) / "whole")
        names = _names(library, arguments.data)
        large = [_large(library, size, Path(place)) for size in arguments.sizes]
        few = _varied(_people(library).packed, FEW)
        stable = _stable(few, clusters(few))
    smallest, largest = large[0], large[-1]
    growth = np.log(largest["group_seconds"] / smallest["group_seconds"])
    summary = {
        "clips_a_second": made.get("clips_a_second"),
        "clips_a_second_ratio": made.get("ratio"),
        "rerun_seconds": whole["rerun_seconds"],
        "dask_ratio": made.get("dask_ratio"),
        "exponent": round(float(growth / np.log(largest["size"] / smallest["size"])), 2),
        "recall": min(one["recall"] for one in large),
        "search_ms": max(one["search_ms"] for one in large),
        "open_seconds": max(one["open_seconds"] for one in large),
        **stable,
        **names,
        "dead_ends": None,
    }
    not_run = ["dead_ends: playable sets are not made yet", "dask_ratio: not timed"]
    not_run += ["more behaviours than the sizes given"]
    not_run += [] if has_usearch() else ["graphs of near neighbours: usearch is not installed"]
    result = {"summary": summary, "made": made, "whole": whole, "large": large, "not_run": not_run}
    report("library", result, TARGETS, arguments, table=[f"not run: {line}" for line in not_run])


def _apart(work: Callable[..., None], *arguments: Any) -> dict[str, float]:
    """Run a function in a process of its own; return what it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    started = time.perf_counter()
    process = multiprocessing.get_context("spawn").Process(target=work, args=arguments)
    process.start()
    process.join()
    if process.exitcode:
        raise RuntimeError(f"{work.__name__} ended with {process.exitcode}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    # Kilobytes, but on macOS bytes; of the largest child so far.
    unit = 1 if sys.platform == "darwin" else 1024
    return {
        "cpu_seconds": round(spent, 1),
        "wall_seconds": round(time.perf_counter() - started, 1),
        "peak_mb": round(after.ru_maxrss * unit / 1e6),
    }


def _made(captures: list[Path], place: Path) -> dict[str, Any]:
    """Make a library of some captures; loop the same ones."""
    folder = place / "library"
    loop = _apart(_loop_all, captures, place / "loops")
    made = _apart(_build, captures, folder)
    summary = rl.Library.open(folder).summary
    return summary | {
        "clips_a_second": round(summary["clips"] / made["cpu_seconds"], 2),
        "ratio": round(loop["cpu_seconds"] / made["cpu_seconds"], 3),
        "loop": loop,
        "library": made,
    }


def _whole(data: Path, folder: Path) -> dict[str, Any]:
    """Make what is missing of the library of all captures, then run again."""
    _build(data, folder)
    started, spent = time.perf_counter(), time.process_time()
    _build(data, folder)
    sizes = {path: path.stat().st_size for path in folder.rglob("*") if path.is_file()}
    return rl.Library.open(folder).summary | {
        "rerun_seconds": round(time.process_time() - spent, 2),
        "rerun_wall_seconds": round(time.perf_counter() - started, 2),
        "bytes": sum(sizes.values()),
        "bytes_of_log": (folder / "clips.jsonl").stat().st_size,
        "bytes_of_tables": sum(x for path, x in sizes.items() if path.suffix == ".parquet"),
    }


def _build(captures: Path | list[Path], folder: Path) -> None:
    with warnings.catch_warnings(action="ignore"):
        rl.build_library(captures, folder, jobs=1)


def _loop_all(captures: list[Path], folder: Path) -> None:
    """Read each capture and write its loops, as `roundelay loop` does without a picture."""
    folder.mkdir()
    with warnings.catch_warnings(action="ignore"):
        for number, path in enumerate(captures):
            try:
                loops = rl.make_loops(rl.read(path))
            except (rl.RoundelayError, OSError, ValueError):
                continue
            for count, loop in enumerate(loops):
                loop.write(folder / f"{number}_{count}.bvh")


def _people(library: rl.Library) -> Shelf:
    return max(library.shelves, key=lambda shelf: len(shelf.numbers))


def _large(library: rl.Library, size: int, place: Path) -> dict[str, Any]:
    """Group and search a library of so many behaviours."""
    packed = _varied(_people(library).packed, size)
    started, spent = time.perf_counter(), time.process_time()
    labels = clusters(packed)
    result: dict[str, Any] = {
        "size": size,
        "group_seconds": round(time.process_time() - spent, 2),
        "group_wall_seconds": round(time.perf_counter() - started, 2),
        "groups": int(labels.max()) + 1,
    }
    folder = place / str(size)
    folder.mkdir()
    write_shelves([Shelf(np.arange(size), packed)], folder)
    result |= _searched(packed, folder)
    print(json.dumps(result), file=sys.stderr, flush=True)
    return result


def _searched(packed: Packed, folder: Path) -> dict[str, Any]:
    started = time.process_time()
    (shelf,) = read_shelves(folder)
    shelf.finder.nearest(packed[:1], NEAREST)
    opened = time.process_time() - started
    asked = np.random.default_rng(5).permutation(len(packed))[:QUERIES]
    queries = _varied(packed[asked], QUERIES, seed=7)
    taken, right = [], 0
    for number in range(QUERIES):
        started = time.process_time()
        _, rows = shelf.finder.nearest(queries[number : number + 1], NEAREST)
        taken.append(time.process_time() - started)
        every = np.arange(len(packed))
        apart = pair_distances(queries, packed, np.full(len(packed), number), every)
        right += len(set(np.argsort(apart, kind="stable")[:NEAREST]) & set(rows[0].tolist()))
    return {
        "recall": round(right / (QUERIES * NEAREST), 4),
        "search_ms": round(1e3 * float(np.median(taken)), 2),
        "open_seconds": round(opened, 3),
        "bytes": sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()),
    }


def _stable(packed: Packed, labels: np.ndarray) -> dict[str, Any]:
    """Add a fifth in five orders; group in another order."""
    count, kept, agreed = len(packed), [], []
    for seed in range(5):
        order = np.random.default_rng(seed).permutation(count)
        old = np.sort(order[: int(0.8 * count)])
        first = assigned([Shelf(np.arange(len(old)), packed[old])], np.full(len(old), -1), {})
        known = np.full(count, -1)
        known[old] = first.labels
        second = assigned([Shelf(np.arange(count), packed)], known, first.founded)
        kept.append(float(np.mean(second.labels[old] == first.labels)))
        agreed.append(_rand(second.labels, labels))
    other = np.random.default_rng(9).permutation(count)
    return {
        "names_stable": round(min(kept), 4),
        "rand_other_order": round(_rand(clusters(packed[other]), labels[other]), 4),
        "rand_two_steps": round(float(np.mean(agreed)), 4),
    }


def _rand(first: np.ndarray, second: np.ndarray) -> float:
    """Adjusted Rand index (Hubert and Arabie 1985)."""

    def pairs(counts: np.ndarray) -> float:
        return float(np.sum(counts * (counts - 1.0)) / 2)

    both = np.unique(np.column_stack([first, second]), axis=0, return_counts=True)[1]
    one, other = (np.unique(x, return_counts=True)[1] for x in (first, second))
    expected = pairs(one) * pairs(other) / pairs(np.array([len(first)]))
    most = 0.5 * (pairs(one) + pairs(other))
    return (pairs(both) - expected) / (most - expected)


def _varied(packed: Packed, count: int, seed: int = 0) -> Packed:
    """Vary signatures: blends of near ones in phase, scattered, begun anywhere."""
    rng = np.random.default_rng(seed)
    near = _near(packed)
    base = np.concatenate([np.arange(len(packed)), rng.integers(0, len(packed), count)])[-count:]
    other = near[base, rng.integers(0, near.shape[1], count)]
    share = rng.random(count).astype(np.float32)
    values = np.empty((count, packed.values.shape[1]), np.float32)
    for start in range(0, count, 4096):
        own = slice(start, start + 4096)
        block = _blended(packed, base[own], other[own], share[own])
        values[own] = _scattered(packed, block, rng)
    return replace(packed, values=values)


def _near(packed: Packed) -> np.ndarray:
    vectors = packed.vectors()
    apart = np.sum((vectors[:, None] - vectors) ** 2, axis=2)
    return np.argsort(apart, axis=1)[:, 1 : NEAR + 1]


def _split(packed: Packed, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    wide = 3 * len(packed.body.joints)
    parts = values[:, wide:].reshape(len(values), 2, -1, wide)
    return values[:, :wide], parts[:, 0] + 1j * parts[:, 1]


def _joined(means: np.ndarray, waves: np.ndarray) -> np.ndarray:
    flat = np.stack([waves.real, waves.imag], axis=1).reshape(len(means), -1)
    return np.hstack([means, flat]).astype(np.float32)


def _blended(packed: Packed, base: np.ndarray, other: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Blend signatures at the offset at which they are most alike."""
    (means, waves), (ours, theirs) = (_split(packed, packed.values[rows]) for rows in (base, other))
    harmonics = np.arange(1, waves.shape[1] + 1)
    offsets = np.exp(2j * np.pi * np.outer(np.arange(64) / 64, harmonics))
    cross = np.einsum("nhd,nhd->nh", theirs.conj(), waves)
    best = offsets[np.argmax((cross @ offsets.T).real, axis=1)]
    turned = theirs * best.conj()[:, :, None]
    mixed = share[:, None]
    return _joined(
        (1 - mixed) * means + mixed * ours,
        (1 - mixed[..., None]) * waves + mixed[..., None] * turned,
    )


def _scattered(packed: Packed, values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Scatter each harmonic by a tenth of its mean size, and begin anywhere."""
    means, waves = _split(packed, values)
    sizes = 0.1 * np.mean(np.abs(waves), axis=2, keepdims=True)
    noise = rng.standard_normal((2, *waves.shape), np.float32)
    begun = 2 * np.pi * rng.random((len(values), 1)) * np.arange(1, waves.shape[1] + 1)
    scattered = (waves + sizes * (noise[0] + 1j * noise[1])) * np.exp(1j * begun)[:, :, None]
    return _joined(means, scattered)


def _names(library: rl.Library, data: Path) -> dict[str, float]:
    """Name half of the clips; look at the other half."""
    rows, kinds = _classed(library, data)
    shelf = _people(library)
    labels = np.full(len(library.behaviours), -1)
    for number, (_, record) in enumerate(library.behaviours):
        labels[number] = record["group"]
    before, with_names, found = [], [], []
    for seed in range(10):
        order = np.random.default_rng(seed).permutation(len(rows))
        told, asked = np.split(order, [len(order) // 2])
        votes: dict[int, Counter[str]] = {}
        for row in told:
            votes.setdefault(int(labels[rows[row]]), Counter())[kinds[row]] += 1
        given = {group: votes[group].most_common(1)[0][0] for group in votes}
        called = nearest_named([shelf], labels, given) | given
        names = [called.get(int(labels[rows[row]]), f"?{row}") for row in asked]
        groups = [str(labels[rows[row]]) for row in asked]
        truth = [kinds[row] for row in asked]
        before.append(_pairs(groups, truth))
        with_names.append(_pairs(names, truth))
        found.append(np.mean([name == kind for name, kind in zip(names, truth, strict=True)]))
    (same_before, other_before), (same, other) = (
        np.mean(before, axis=0),
        np.mean(with_names, axis=0),
    )
    return {
        "same_name": round(float(same), 3),
        "different_name": round(float(other), 4),
        "right_name": round(float(np.mean(found)), 3),
        "same_group": round(float(same_before), 3),
        "different_group": round(float(other_before), 4),
        "raised": round(float(same - same_before), 3),
        "named_behaviours": len(rows),
    }


def _classed(library: rl.Library, data: Path) -> tuple[list[int], list[str]]:
    """Return the numbers of behaviours that fill most of clips of a class, and their names."""
    with (data / "truth" / "captures.csv").open(newline="", encoding="utf-8") as file:
        classes = {f"truth/{row['file']}": row["class"] for row in csv.DictReader(file)}
    people = set(_people(library).numbers.tolist())
    longest: dict[str, tuple[int, int]] = {}
    for number, (file, record) in enumerate(library.behaviours):
        if number in people and "truth/dog" not in file:
            best = longest.get(file, (0, -1))
            longest[file] = max(best, (_frames(record), -number - 1))
    rows, kinds = [], []
    for file, (_, number) in longest.items():
        kind = next((name for word, name in NAMES if re.search(word, classes.get(file, ""))), "")
        if kind:
            rows.append(-number - 1)
            kinds.append(kind)
    return rows, kinds


def _frames(record: dict[str, Any]) -> int:
    if "parts" in record:
        return sum(stop - start for start, stop in record["parts"])
    return record["end_frame"] - record["start_frame"]


def _pairs(names: list[str], kinds: list[str]) -> tuple[float, float]:
    """Return the shares of pairs of one kind, and of two, that have one name."""
    one, other = np.triu_indices(len(names), 1)
    called, truth = np.array(names), np.array(kinds)
    alike, same = called[one] == called[other], truth[one] == truth[other]
    return float(alike[same].mean()), float(alike[~same].mean())


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main()
