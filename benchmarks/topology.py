"""Time, memory and agreement of circular coordinates beside the peers that install.

    python -m benchmarks.topology --data FOLDER [--json] [--keep] [--quick] [--limit 120]

Every figure is the median of five runs (fewer where they are long) in a process of its own,
which has imported the library and run it once on a small circle. A peer over the limit has no time.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import roundelay as rl
from benchmarks._common import measure
from benchmarks._harness import Target, parser, report
from benchmarks._topology_methods import METHODS

Points = NDArray[np.float64]
Row = dict[str, Any]

LIBRARIES = {"gudhi": "gudhi", "DREiMac": "dreimac", "redzed": "redzed_tda", "canns": "canns_lib"}
MEMORY_FIXED, MEMORY_PER_PAIR = 50e6, 16
# How many points are measured by landmarks.
LANDMARKS = 8000
TARGETS = (
    Target("bars", "<=", 1e-6, "largest difference of bars from those of ripser.py"),
    Target("ripser_times", ">=", 100, "times faster than ripser.py and least squares"),
    Target("memory_share", "<=", 1, "memory over the 50 MB and 16 bytes a pair allowed"),
)


def closed_curve(n: int, seed: int = 0) -> Points:
    """A noisy closed curve in 62 dimensions, run through once at random times."""
    rng = np.random.default_rng(seed)
    angle = 2 * np.pi * np.sort(rng.random(n))[:, None] * np.arange(1, 4)
    waves = np.concatenate((np.cos(angle), np.sin(angle)), axis=1) / [1, 3, 10, 1, 3, 10]
    frame = np.linalg.qr(rng.normal(size=(62, 6)))[0]
    return waves @ frame.T + 0.05 / np.sqrt(62) * rng.normal(size=(n, 62))


def capture(data: Path, name: str, frames: int | None) -> Points:
    """Quaternions of all joints but the root."""
    path = data / "cmu" / "acclaim" / name[:2] / f"{name}.amc"
    rotations = rl.read(path).rotations[:frames, 1:]
    return np.asarray(rotations.reshape(len(rotations), -1), np.float64)


def inputs(data: Path, quick: bool) -> dict[str, Points]:
    found = {
        "curve 500": closed_curve(500),
        "86_01 500": capture(data, "86_01", 500),
        "13_29 1200": capture(data, "13_29", 1200),
    }
    if not quick:
        found["curve 2000"] = closed_curve(2000)
        found["02_07"] = capture(data, "02_07", None)
        found["86_01"] = capture(data, "86_01", None)
    return found


def installed(name: str) -> bool:
    return all(find_spec(module) for key, module in LIBRARIES.items() if name.startswith(key))


def run(name: str, points: Points, folder: Path, *, repeats: int, limit: float) -> Row:
    path = folder / "points.npy"
    np.save(path, points)
    function = f"benchmarks._topology_methods:{name}"
    return measure(function, path, repeats=repeats, limit=limit)


def compare(data: Path, folder: Path, *, quick: bool, limit: float) -> list[Row]:
    rows = []
    for case, points in inputs(data, quick).items():
        results = {
            method: run(work.__name__, points, folder, repeats=1 if quick else 5, limit=limit)
            for method, work in METHODS.items()
            if installed(method)
        }
        ours = results["roundelay, all bars"]
        for method, result in results.items():
            agreement = agree(ours, result)
            row = {key: result[key] for key in ("cpu", "wall", "bytes", "failed") if key in result}
            rows.append({"case": case, "n": len(points), "method": method, **row, **agreement})
    return rows


def agree(ours: Row, theirs: Row) -> Row:
    """Largest difference of bars, relative to the largest death, and of phases, in cycles."""
    found = {}
    if "bars" in theirs and "bars" in ours:
        found["bars"] = bar_difference(np.array(ours["bars"]), np.array(theirs["bars"]))
    if "phase" in theirs and "phase" in ours:
        found["phase"] = phase_difference(np.array(ours["phase"]), np.array(theirs["phase"]))
    return found


def bar_difference(a: Points, b: Points) -> float:
    """Largest difference of ordered lives; bars that one side lacks have life 0."""
    lives = [np.sort(x[:, 1] - x[:, 0])[::-1] for x in (a, b)]
    size = max(map(len, lives))
    padded = [np.pad(x, (0, size - len(x))) for x in lives]
    return float(abs(padded[0] - padded[1]).max() / a[:, 1].max())


def phase_difference(a: Points, b: Points) -> float:
    """Largest difference up to rotation and reflection."""
    worst = []
    for sign in (1, -1):
        turned = np.exp(2j * np.pi * (a - sign * b))
        worst.append(abs(np.angle(turned / turned.mean())).max() / (2 * np.pi))
    return float(min(worst))


def growth(folder: Path, *, quick: bool) -> list[Row]:
    """Time and memory of frames -> coordinate, and of 8000 frames by landmarks."""
    rows = []
    for n in (250, 500, 1000) if quick else (250, 500, 1000, 2000, 4000):
        for method in ("roundelay", "roundelay_all_bars"):
            result = run(method, closed_curve(n), folder, repeats=5, limit=120)
            allowed = MEMORY_FIXED + MEMORY_PER_PAIR * n * n
            rows.append({"n": n, "method": method, **timing(result), "allowed": allowed})
    result = run("roundelay_landmarks", closed_curve(LANDMARKS), folder, repeats=5, limit=120)
    rows.append({"n": LANDMARKS, "method": "roundelay_landmarks", **timing(result)})
    return rows


def timing(result: Row) -> Row:
    return {key: result[key] for key in ("cpu", "wall", "bytes", "failed") if key in result}


def summary(compared: list[Row], faster: list[Row], grown: list[Row]) -> dict[str, Any]:
    """CPU seconds by method and case, "> limit" where there are none; agreement and memory."""
    seconds: dict[str, dict[str, Any]] = {}
    for row in compared:
        late = row.get("failed", "").startswith("over ")
        shown = row["failed"].replace("over ", "> ").removesuffix(" s") if late else "none"
        seconds.setdefault(row["method"], {})[row["case"]] = row.get("cpu", shown)
    times = [row["ripser + lsqr"] for row in faster if row["ripser + lsqr"]]
    ripser = [row for row in compared if row["method"] == "ripser.py + lsqr"]
    largest = max((row for row in grown if "allowed" in row), key=lambda row: row["n"])
    return {
        "seconds": seconds,
        "bars": max((row["bars"] for row in ripser if "bars" in row), default=None),
        "phase": max((row["phase"] for row in ripser if "phase" in row), default=None),
        "ripser_times": min(times, default=None),
        "memory_share": max(row["bytes"] / row["allowed"] for row in grown if "allowed" in row),
        "memory": {"points": largest["n"], "megabytes": largest["bytes"] / 1e6},
        "landmarks": {"points": grown[-1]["n"], "seconds": grown[-1]["cpu"]},
    }


def times_faster(rows: list[Row]) -> list[Row]:
    """How many times faster than ripser.py + lsqr, and than the fastest exact bars-only peer."""
    found = []
    for case in dict.fromkeys(row["case"] for row in rows):
        cpu = {row["method"]: row["cpu"] for row in rows if row["case"] == case and "cpu" in row}
        ours = cpu["roundelay"]
        peers = [cpu[name] for name in cpu if name.endswith(("(bars)", "mod 2)"))]
        ripser = cpu.get("ripser.py + lsqr")
        found.append(
            {"case": case, "seconds": ours, "ripser + lsqr": ripser and ripser / ours,
             "fastest bars-only peer": min(peers) / ours if peers else None}
        )  # fmt: skip
    return found


def lines(result: dict[str, list[Row]]) -> Iterator[str]:
    for title, rows in result.items():
        yield f"\n{title}"
        for row in rows:
            cells = [f"{v:.4g}" if isinstance(v, float) else str(v) for v in row.values()]
            yield "  " + "  ".join(map(" ".join, zip(row, cells, strict=True)))


def main() -> None:
    arguments = parser(__doc__)
    arguments.add_argument(
        "--limit", type=float, default=120, help="CPU seconds for one measurement"
    )
    arguments.add_argument(
        "--quick", action="store_true", help="small inputs, one run each, 15 s at most"
    )
    options = arguments.parse_args()
    limit = 15 if options.quick else options.limit
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        compared = compare(options.data, folder, quick=options.quick, limit=limit)
        grown = growth(folder, quick=options.quick)
    faster = times_faster(compared)
    result = {"compared": compared, "times faster (CPU)": faster, "growth": grown}
    told = {"summary": summary(compared, faster, grown), **result}
    report("topology", told, TARGETS, options, table=lines(result))


if __name__ == "__main__":
    main()
