"""Segmentation against people's: our methods, other programs, a second person; joined takes.

Usage: python -m benchmarks.segmentation --data FOLDER [--json] [--keep] [--peers PYTHON]

Cuts are matched one to one with the windows of [B] ([B]'s usual width where the labels have
none), strictly and with tolerances. Other programs run in the Python given by --peers (this one
by default); those it does not hold are left out. No parameter of ours is set anywhere.

Takes are joined from cuts and clips that people named (HDM05, Bandai-Namco, LAFAN1), with parts
that come back, as they are and with a posture that wanders; clips of one behaviour and made walks
that drift are cut falsely wherever they are cut. See `benchmarks._behaviour_takes`.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import roundelay as rl
from benchmarks import _behaviour_takes as takes
from benchmarks._behaviour_scores import CHANGES, JOINED, measured
from benchmarks._harness import Target, parser, report
from benchmarks.segmentation_data import Capture, labelled, single_behaviours
from roundelay.segmentation import (
    TOLERANCES,
    BehaviourOptions,
    GaussianOptions,
    OnlinePCA,
    Score,
    pooled,
    score,
    segment_channels,
)

# What a user of [B]'s methods must set; the default needs nothing.
OURS = {
    "behaviours": 0,
    "gaussian": 0,
    "pca": 5,
    "pca-paper": 5,
    "ppca": 4,
    "ppca-paper": 4,
    "gmm": 2,
    "gmm-paper": 2,
}
RADIANS = {
    "behaviours": BehaviourOptions(resolution=0.15),
    "gaussian": GaussianOptions(resolution=0.15),
}
"""What `segment` uses for motions; the four channels are angles in radians too."""

TARGETS = (
    Target("strict", ">=", 0.83, "F against people's windows, strict"),
    Target("half_second", ">=", 0.97, "F within half a second"),
    Target("labels", ">=", 0.92, "frames whose label is right"),
    Target("joins.hdm05", ">=", 0.94, "F within half a second, joined takes of HDM05"),
    Target("joins.bandai", ">=", 0.98, "F within half a second, joined takes of Bandai-Namco"),
    Target("joined_labels.hdm05", ">=", 0.93, "frames whose label is right, HDM05"),
    Target("joined_labels.bandai", ">=", 0.93, "frames whose label is right, Bandai-Namco"),
    Target("false_cuts", "<=", 0, "cuts in captures of one walk or run"),
    Target("false_cuts_a_minute", "<=", 1.0, "in clips of one behaviour"),
    Target("joined_recall", ">=", 0.8, "cuts within half a second, the same clips joined"),
    Target("drifting_walks", "<=", 0.2, "cuts a minute in one walk whose posture wanders"),
    *(
        Target(f"labels_same.{name}", ">=", 0.7 if "clips" in name else 0.9, "one label")
        for name in JOINED
    ),
    *(
        Target(f"labels_different.{name}", "<=", 0.1 if "clips" in name else 0.05, "one label")
        for name in JOINED
    ),
    *(
        Target(f"short_behaviours.{seconds:g} s", ">=", 0.8, "cuts within .3 s")
        for seconds in (1.0, 1.5, 2.0)
    ),
    Target("nested", ">=", 1.0, "takes whose finer sections hold all cuts of coarser ones"),
    *(Target(f"robust.{name}", ">=", 0.9, "cuts that stay within .5 s") for name in CHANGES),
    Target("hour.seconds", "<=", 20, "70 minutes at 30 frames a second"),
    Target("hour.megabytes", "<=", 600, "70 minutes at 30 frames a second"),
)


@dataclass(frozen=True)
class Row:
    """One program on one capture."""

    capture: str
    score: Score
    seconds: float
    labelled: bool


def main() -> None:
    options = parser(__doc__, data="folder that holds cmu/, labels/")
    options.add_argument(
        "--peers", default=sys.executable, help="Python that has the peers; empty to leave them out"
    )
    arguments = options.parse_args()
    captures = labelled(arguments.data)
    programs = [(name, _ours(captures, name), count) for name, count in OURS.items()]
    programs += _peers(captures, arguments.peers)
    programs.append(("second person", _second_person(captures), 0))
    programs_found = [_summary(name, rows, count) for name, rows, count in programs]
    ours = {name: rows for name, rows, _ in programs}
    result = {
        "programs": programs_found,
        "better_than_ppca": _bootstrap(ours["behaviours"], ours["ppca"]),
        "invariance": _invariance(captures),
        "noise": _noise(captures),
        "single_behaviours": _false_cuts(arguments.data),
        "speed": _speed(captures),
        "behaviours": measured(arguments.data),
        "hour": _hour(arguments.data),
    }
    result["summary"] = _figures(result)
    report("segmentation", result, TARGETS, arguments, table=_table(result), bulk=("programs",))


def _figures(result: dict[str, Any]) -> dict[str, Any]:
    """The figures of all captures by program, and what else is stated."""
    programs = {
        row["program"]: {
            "parameters": row["parameters_to_set"],
            "strict": row["all"]["strict"],
            "half_second": row["all"]["+0.5 s"],
            "labels": row["all"]["label_accuracy"],
        }
        for row in result["programs"]
    }
    first, told = result["programs"][0], result["behaviours"]
    usual = next(row for row in told["curve"] if row["sensitivity"] == 1.0)
    own = programs["behaviours"]
    joined = told["joined"]
    return {
        "strict": own["strict"][2],
        "half_second": own["half_second"][2],
        "labels": own["labels"],
        "joins": {name: joined[name]["half_second"] for name in ("hdm05", "bandai", "clips")},
        "joined_labels": {name: joined[name]["labels"] for name in ("hdm05", "bandai", "clips")},
        "false_cuts_a_minute": usual["false_a_minute"],
        "joined_recall": usual["recall"],
        "drifting_walks": told["drifting_walks"],
        "labels_same": {name: row["same"] for name, row in joined.items()},
        "labels_different": {name: row["different"] for name, row in joined.items()},
        "short_behaviours": told["short"],
        "nested": told["nested"],
        "robust": told["robust"],
        "hour": result["hour"],
        **programs,
        "captures": first["captures"],
        "cuts": sum(one["cuts"][0]["true"] for one in first["per_capture"]),
        "false_cuts": result["single_behaviours"]["false_cuts"],
    }


def _ours(captures: Sequence[Capture], name: str) -> list[Row]:
    rows = []
    for capture in captures:
        started = time.perf_counter()
        found = _found(capture, name)
        seconds = time.perf_counter() - started
        rows.append(Row(capture.name, score(found, capture.truth), seconds, True))
    return rows


def _found(capture: Capture, name: str) -> rl.Segmentation:
    """Cut as a user would: a motion where there is one."""
    if capture.motion is not None:
        return rl.segment(capture.motion, method=name)
    return segment_channels(capture.values, capture.fps, method=RADIANS.get(name, name))


def _peers(captures: Sequence[Capture], python: str) -> list[tuple[str, list[Row], int]]:
    if not python:
        return []
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder, "in.npz"), Path(folder, "out.json")
        np.savez(source, **{capture.name: capture.values for capture in captures})
        script = Path(__file__).with_name("segmentation_peers.py")
        subprocess.run([python, script, source, target], check=True, stdout=subprocess.DEVNULL)
        peers = json.loads(target.read_text())
    programs = []
    for name, peer in peers.items():
        rows = [
            Row(c.name, score(peer["cuts"][c.name], c.truth), peer["seconds"][c.name], False)
            for c in captures
        ]
        programs.append((name, rows, peer["parameters"]))
    return programs


def _second_person(captures: Sequence[Capture]) -> list[Row]:
    return [
        Row(capture.name, score(capture.second, capture.truth), 0.0, False)
        for capture in captures
        if capture.second is not None
    ]


def _summary(name: str, rows: Sequence[Row], parameters: int) -> dict[str, Any]:
    full = [row for row in rows if not row.capture.endswith("(4)")]
    four = [row for row in rows if row.capture.endswith("(4)")]
    return {
        "program": name,
        "parameters_to_set": parameters,
        "captures": len(rows),
        "all": _pooled(rows),
        "full": _pooled(full),
        "four_channels": _pooled(four),
        "per_capture": [
            {
                "capture": row.capture,
                "seconds": round(row.seconds, 3),
                **row.score.to_dict(),
            }
            for row in rows
        ],
    }


def _pooled(rows: Sequence[Row]) -> dict[str, Any]:
    measures: dict[str, Any] = {}
    for tolerance in TOLERANCES:
        total = pooled([row.score.at(tolerance) for row in rows])
        figures = (total.precision, total.recall, total.f)
        measures[f"+{tolerance:g} s" if tolerance else "strict"] = [round(x, 3) for x in figures]
    measures["covering"] = _mean([row.score.covering for row in rows])
    for measure in ("label_accuracy", "nmi", "ari"):
        values = [getattr(row.score, measure) for row in rows]
        measures[measure] = _mean(values) if all(row.labelled for row in rows) else None
    measures["seconds"] = round(sum(row.seconds for row in rows), 3)
    return measures


def _mean(values: Sequence[float]) -> float:
    return round(float(np.mean(values)), 3)


def _bootstrap(ours: Sequence[Row], theirs: Sequence[Row], draws: int = 10000) -> dict[str, Any]:
    """Draw captures with replacement: interval of the difference of pooled F."""
    rng, result = np.random.default_rng(0), {}
    for tolerance in (0.0, 0.5):
        ours_then_theirs = [
            np.array([[a.hits, a.found + a.true] for a in (r.score.at(tolerance) for r in rows)])
            for rows in (ours, theirs)
        ]
        drawn = rng.integers(0, len(ours), (draws, len(ours)))
        f = [2.0 * x[drawn, 0].sum(axis=1) / x[drawn, 1].sum(axis=1) for x in ours_then_theirs]
        low, middle, high = np.quantile(f[0] - f[1], [0.025, 0.5, 0.975]).round(3).tolist()
        result[f"F +{tolerance:g} s"] = {"low": low, "median": middle, "high": high}
    return result


def _f(captures: Sequence[Capture], change: Callable[[Capture], list[int]]) -> dict[str, float]:
    """Pooled F of cuts that `change` finds, expressed in frames of the capture as it is."""
    scores = [score(change(capture), capture.truth) for capture in captures]
    return {
        name: round(pooled([one.at(tolerance) for one in scores]).f, 3)
        for name, tolerance in (("strict", 0.0), ("+0.5 s", 0.5))
    }


def _cuts(
    values: np.ndarray, fps: float, options: BehaviourOptions = RADIANS["behaviours"]
) -> list[int]:
    return list(segment_channels(values, fps, method=options).cuts)


def _invariance(captures: Sequence[Capture]) -> dict[str, Any]:
    bare = BehaviourOptions()

    def thinned(capture: Capture, step: int) -> list[int]:
        return [step * cut for cut in _cuts(capture.values[::step], capture.fps / step)]

    def reversed_(capture: Capture) -> list[int]:
        cuts = _cuts(capture.values[::-1], capture.fps)
        return [len(capture.values) - cut for cut in cuts[::-1]]

    return {
        "as it is": _f(captures, lambda c: _cuts(c.values, c.fps)),
        "60 fps": _f(captures, lambda c: thinned(c, 2)),
        "30 fps": _f(captures, lambda c: thinned(c, 4)),
        "reversed": _f(captures, reversed_),
        "unit not told, radians": _f(captures, lambda c: _cuts(c.values, c.fps, bare)),
        "unit not told, degrees": _f(captures, lambda c: _cuts(np.degrees(c.values), c.fps, bare)),
    }


def _noise(captures: Sequence[Capture], draws: int = 5) -> dict[str, Any]:
    """White noise of .03 rad on every channel."""
    results = []
    for seed in range(draws):
        rng = np.random.default_rng(seed)
        results.append(
            _f(
                captures,
                lambda c, r=rng: _cuts(c.values + r.normal(0, 0.03, c.values.shape), c.fps),
            )
        )
    return {key: _mean([result[key] for result in results]) for key in results[0]}


def _false_cuts(data: Path) -> dict[str, Any]:
    motions = single_behaviours(data)
    cuts = {motion.name: rl.segment(motion).cuts for motion in motions}
    minutes = sum(motion.duration for motion in motions) / 60.0
    count = sum(len(found) for found in cuts.values())
    return {
        "captures": len(motions),
        "minutes": round(minutes, 2),
        "false_cuts": count,
        "per_minute": round(count / minutes, 3),
        "where": {name: list(found) for name, found in cuts.items() if found},
    }


def _speed(captures: Sequence[Capture]) -> dict[str, Any]:
    """Best of three, in seconds, for the default; frames of the full captures over and over."""
    full = [capture.values for capture in captures if capture.values.shape[1] == 56]
    many = np.concatenate(full * 11)
    one = np.tile(full[0][:600], (200, 1))
    return {
        "5000 frames": _seconds(many[:5000]),
        "100000 frames": _seconds(many[:100000]),
        "200000 frames": _seconds(many[:200000]),
        "100000 frames of one behaviour": _seconds(one[:100000]),
        "online PCA, ms a frame": _online(full[0]),
    }


def _hour(data: Path, minutes: float = 70.0) -> dict[str, float]:
    """Cut takes of LAFAN1 joined to more than an hour, in a process of its own."""
    script = (
        "import resource, sys, time\n"
        "import roundelay as rl\n"
        "motion = rl.read(sys.argv[1])\n"
        "before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "started = time.process_time()\n"
        "found = rl.segment(motion)\n"
        "seconds = time.process_time() - started\n"
        "after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "print(seconds, after / 1024, len(found))\n"
    )
    whole = takes.long_take(data / "truth" / "lafan1", minutes)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "long.bvh")
        rl.write(whole, path)
        done = subprocess.run(
            [sys.executable, "-c", script, path], check=True, capture_output=True, text=True
        )
    seconds, megabytes, count = done.stdout.split()
    return {
        "frames": len(whole),
        "seconds": round(float(seconds), 2),
        "megabytes": round(float(megabytes), 1),
        "segments": int(count),
    }


def _online(frames: np.ndarray) -> float:
    times = []
    for _ in range(3):
        online = OnlinePCA(120.0)
        started = time.perf_counter()
        for frame in frames:
            online.push(frame)
        times.append(time.perf_counter() - started)
    return round(min(times) / len(frames) * 1e3, 4)


def _seconds(values: np.ndarray) -> float:
    times = []
    for _ in range(3):
        started = time.perf_counter()
        _cuts(values, 120.0)
        times.append(time.perf_counter() - started)
    return round(min(times), 3)


def _table(result: dict[str, Any]) -> Iterator[str]:
    yield "pooled over all captures: P R F strict; P R F at +0.5 s; covering, labels, seconds"
    for row in result["programs"]:
        for group in ("all", "full", "four_channels"):
            m = row[group]
            figures = " ".join(f"{x:.2f}" for x in (*m["strict"], *m["+0.5 s"], m["covering"]))
            label = "-" if m["label_accuracy"] is None else f"{m['label_accuracy']:.3f}"
            yield (
                f"{row['program']:22s} ({row['parameters_to_set']}) {group:14s} {figures}  "
                f"{label}  {m['seconds']:.2f} s"
            )
    for name, row in result["behaviours"]["joined"].items():
        yield f"{name:14s} {json.dumps(row)}"
    for row in result["behaviours"]["curve"]:
        yield json.dumps(row)
    for key in ("better_than_ppca", "invariance", "noise", "single_behaviours", "speed"):
        yield f"{key}: {json.dumps(result[key])}"


if __name__ == "__main__":
    main()
