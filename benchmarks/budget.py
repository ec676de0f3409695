"""What small hostile files cost: time and memory of every command, beside a walk of as many joints.

Usage: python -m benchmarks.budget [--json] [--keep] [--seconds N] [--only NAME,...]

Files of up to 1.4 MB are made that cost much where cost is not bounded: half a million frames of
one channel, 20,000 frames that alternate between two poses, a thousand joints in 35 kB, equal
frames, noise, numbers at the ends of what a file may hold. Each is given to `loop`, `segment`,
`timeline`, `view`, `inspect` and `library`, a process each. The time a frame is that beyond a
capture of 16 frames; it is divided by that of a walk with as many joints, whose time for as many
frames counts as half a second at least. Memory is the peak beyond that of the same small capture.
A file may be refused where it is beyond the limits that the documentation names.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks._harness import Target, parser, report

COMMANDS = {
    "loop": ["loop", "{}", "-o", "out/"],
    "segment": ["segment", "{}", "-o", "out/"],
    "timeline": ["timeline", "{}", "-o", "out/"],
    "view": ["view", "{}", "-o", "out/"],
    "inspect": ["inspect", "{}", "-o", "out/"],
    "library": ["library", "{}", "-o", "out", "--jobs", "1"],
}
TARGETS = (
    Target("worst_ratio", "<=", 2, "time a frame over that of a walk with as many joints"),
    Target("worst_memory", "<=", 1, "peak memory over 50 MB and 40 times the file"),
    Target("worst_reading", "<=", 1, "peak memory of reading over 50 MB and 6 times the file"),
    Target("other_exceptions", "<=", 0, "runs that end with a traceback or not at all"),
)
# Seconds below which nobody minds, and megabytes.
FEW_SECONDS, FEW_MEGABYTES = 0.5, 50.0
TIMES_FILE, TIMES_READ = 40.0, 6.0
WALK_FRAMES = 2000
Rows = Iterator[str]


@dataclass(frozen=True)
class Case:
    """A file: joints, frames, and how to write it."""

    joints: int
    frames: int
    write: Callable[[Path], None]


@dataclass(frozen=True)
class Cost:
    """What a process took: CPU seconds, megabytes at its peak, and how it ended."""

    seconds: float
    megabytes: float
    code: int
    said: str


def hierarchy(joints: int, *, wide: bool = False, channels: int = 3) -> str:
    """A root with positions, and a chain of joints, or a bush."""
    turns = {
        0: "CHANNELS 0",
        1: "CHANNELS 1 Zrotation",
        3: "CHANNELS 3 Zrotation Xrotation Yrotation",
    }
    pieces = [
        "HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\n"
        "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
    ]
    own = [f"JOINT {i:x}{{OFFSET 0 1 0 {turns[channels]} " for i in range(joints - 1)]
    depth = 1 if wide else 200
    for start in range(0, len(own), depth):
        chain = own[start : start + depth]
        pieces.append("".join(chain) + "End Site{OFFSET 0 1 0}" + "}" * len(chain) + "\n")
    return "".join([*pieces, "}\n"])


def saved(head: str, rows: Sequence[str], time: str = "0.01") -> Callable[[Path], None]:
    text = f"{head}MOTION\nFrames: {len(rows)}\nFrame Time: {time}\n" + "\n".join(rows) + "\n"
    return lambda path: path.write_text(text) and None


def walk_rows(frames: int, joints: int, channels: int = 3) -> list[str]:
    """A root that travels, and joints that swing with a period of 126 frames."""
    turn = np.arange(frames)[:, None] / 20.0
    swings = 20 * np.sin(turn + np.arange(channels * (joints - 1) + 3))
    path = np.column_stack([np.zeros(frames), np.ones(frames), 0.2 * turn[:, 0]])
    return [" ".join(f"{x:.6g}" for x in row) for row in np.hstack([path, swings])]


def walk(joints: int, channels: int = 3) -> Case:
    rows = walk_rows(WALK_FRAMES, joints, channels)
    return Case(joints, WALK_FRAMES, saved(hierarchy(joints, channels=channels), rows))


def of_rows(joints: int, rows: Sequence[Sequence[float]], **head: Any) -> Case:
    texts = [" ".join(f"{x:g}" for x in row) for row in rows]
    return Case(joints, len(texts), saved(hierarchy(joints, **head), texts))


def one_channel(rows: Sequence[int]) -> Case:
    """Three joints, one of which turns about one axis: the most frames a byte."""
    head = (
        "HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\nCHANNELS 0\nJOINT b{OFFSET 0 1 0 CHANNELS 1 Zrotation "
        "JOINT c{OFFSET 0 1 0 CHANNELS 0 End Site{OFFSET 0 1 0}}}}\n"
    )
    return Case(3, len(rows), saved(head, [str(x) for x in rows]))


@cache
def cases() -> dict[str, Case]:
    rng = np.random.default_rng(0)
    at_once = [[0] * 3 + [10 + 40 * (i % 2)] * 6 for i in range(20_000)]
    blocks = [[0] * 3 + [10 + 40 * (i // 50 % 2)] * 6 for i in range(20_000)]
    wobble = (40 * np.sin(np.arange(30_000)[:, None] / 30 + np.arange(15))).round().astype(int)
    quick = (40 * np.sin(np.arange(30_000)[:, None] * np.pi / 4 + np.arange(15))).round()
    drift = np.cumsum(rng.normal(size=(30_000, 15)), axis=0).round()
    grid = rng.integers(0, 2, (20_000, 9)) * 90
    made = {
        "alternating poses": of_rows(2, at_once),
        "alternating blocks": of_rows(2, blocks),
        "equal frames": of_rows(2, [[1, 2, 3, 4, 5, 6, 7, 8, 9]] * 20_000),
        "poses of a grid": of_rows(2, grid.tolist()),
        "noise": of_rows(4, rng.integers(0, 99, (20_000, 15)).tolist()),
        "a random walk": of_rows(4, drift.tolist()),
        "a slow period": of_rows(4, wobble.tolist()),
        "a period of 8 frames": of_rows(4, quick.tolist()),
        "saw of one channel": one_channel([i % 10 for i in range(480_000)]),
        "period of one channel": one_channel(
            (4.5 + 4.5 * np.sin(np.arange(480_000) / 40)).astype(int)
        ),
        "noise of one channel": one_channel(rng.integers(0, 10, 480_000).tolist()),
        "1000 joints in 35 kB": thousand_joints(),
        "1000 joints": of_rows(1000, wobble[:30, :6].tolist(), wide=True, channels=0),
        "numbers at the end": at_the_end(),
        "no length": no_length(),
    }
    return made


def thousand_joints() -> Case:
    """A bush of a thousand joints, few of which turn, for as many frames as 35 kB hold."""
    head = hierarchy(1000, wide=True, channels=0).replace("End Site{OFFSET 0 1 0}", "")
    rows = [f"0 1 {i} {20 * np.sin(i / 5):.3g} 0 0" for i in range(48)]
    return Case(1000, len(rows), saved(head, rows))


def at_the_end() -> Case:
    rows = [f"0 {x:.9g} 0 0 0 0 {x:.9g} 0 0" for x in 9e11 * np.sin(np.arange(3000) / 20)]
    return Case(2, 3000, saved(hierarchy(2), rows))


def no_length() -> Case:
    head = hierarchy(2).replace("OFFSET 0 1 0", "OFFSET 0 0 0")
    return Case(2, 3000, saved(head, walk_rows(3000, 2)))


def cost(command: Sequence[str], folder: Path, seconds: float) -> Cost:
    """Run a command with a limit of CPU time; tell what it took."""

    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds) + 2))

    with tempfile.TemporaryFile() as said:
        process = subprocess.Popen(
            command, cwd=folder, stdout=said, stderr=said, preexec_fn=limited
        )
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        text = said.read().decode(errors="replace")
    return Cost(used.ru_utime + used.ru_stime, used.ru_maxrss / 1e3, process.returncode, text)


def of_command(name: str, path: Path, folder: Path, seconds: float) -> Cost:
    words = [word.format(path) for word in COMMANDS[name]]
    with tempfile.TemporaryDirectory(dir=folder) as place:
        return cost([sys.executable, "-m", "roundelay", *words], Path(place), seconds)


def of_reading(path: Path, folder: Path, seconds: float) -> Cost:
    code = "import sys, roundelay as rl; rl.read(sys.argv[1])"
    return cost([sys.executable, "-W", "ignore", "-c", code, str(path)], folder, seconds)


def measured(case: Case, folder: Path, seconds: float) -> dict[str, Any]:
    """Give a case to all commands; return what each took, and how large the file is."""
    path = folder / "case.bvh"
    case.write(path)
    size = path.stat().st_size / 1e6
    found = {name: asdict(of_command(name, path, folder, seconds)) for name in COMMANDS}
    reading = asdict(of_reading(path, folder, seconds))
    return {"megabytes": size, "joints": case.joints, "frames": case.frames} | {
        "reading": reading,
        "commands": found,
    }


def judged(found: dict[str, Any], walked: dict[str, Any], small: dict[str, Any]) -> dict[str, Any]:
    """Add to each command of a case its ratios to what it may take."""
    room = FEW_MEGABYTES + TIMES_FILE * found["megabytes"]
    for name, own in found["commands"].items():
        start, like = small["commands"][name], walked["commands"][name]
        a_frame = max(like["seconds"] - start["seconds"], 0.0) / walked["frames"]
        usual = max(a_frame * found["frames"], FEW_SECONDS)
        own["ratio"] = (own["seconds"] - start["seconds"]) / usual
        own["memory"] = (own["megabytes"] - start["megabytes"]) / room
    reading = found["reading"]
    room = FEW_MEGABYTES + TIMES_READ * found["megabytes"]
    reading["memory"] = (reading["megabytes"] - small["reading"]["megabytes"]) / room
    return found


def ended_badly(one: dict[str, Any]) -> bool:
    return one["code"] not in (0, 2, 3) or "Traceback" in one["said"]


def summary(results: dict[str, Any]) -> dict[str, Any]:
    commands = [one for found in results.values() for one in found["commands"].values()]
    ended = [one for one in commands if not ended_badly(one)]
    return {
        "cases": len(results),
        "runs": len(commands),
        "worst_ratio": max(one["ratio"] for one in commands),
        "worst_memory": max(one["memory"] for one in commands),
        "worst_reading": max(found["reading"]["memory"] for found in results.values()),
        "refused": sum(one["code"] == 2 for one in ended),
        "other_exceptions": len(commands) - len(ended),
    }


def table(results: dict[str, Any]) -> Iterator[str]:
    yield f"{'':22}{'MB':>6}{'frames':>8}" + "".join(f"{name:>20}" for name in COMMANDS)
    for name, found in results.items():
        cells = [
            f"{one['seconds']:7.1f} s {one['ratio']:5.1f} {one['memory']:4.1f}"
            + ("!" if ended_badly(one) else " ")
            for one in found["commands"].values()
        ]
        head = f"{name:22}{found['megabytes']:6.2f}{found['frames']:8d}"
        yield head + "".join(cells) + f" reading {found['reading']['memory']:4.1f}"


def main() -> None:
    options = parser(__doc__, data=None)
    options.add_argument("--seconds", type=float, default=60.0, help="CPU seconds a run")
    options.add_argument("--only", default="", help="names of cases, with commas between")
    arguments: argparse.Namespace = options.parse_args()
    chosen = {
        n: c
        for n, c in cases().items()
        if arguments.only in ("", n) or n in arguments.only.split(",")
    }
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        tiny = Case(2, 16, saved(hierarchy(2), walk_rows(16, 2)))
        small = measured(tiny, folder, arguments.seconds)
        walks = {
            n: measured(walk(n), folder, arguments.seconds)
            for n in sorted({c.joints for c in chosen.values()})
        }
        results = {}
        for name, case in chosen.items():
            found = measured(case, folder, arguments.seconds)
            results[name] = judged(found, walks[case.joints], small)
            print(*list(table({name: results[name]}))[1:], file=sys.stderr, flush=True)
    for found in (*results.values(), *walks.values()):
        for one in (*found["commands"].values(), found["reading"]):
            one["said"] = one["said"][-300:] if ended_badly(one) else ""
    told = {"summary": summary(results), "cases": results, "walks": walks}
    told["minutes"] = (time.monotonic() - started) / 60
    report("budget", told, TARGETS, arguments, table=table(results))


if __name__ == "__main__":
    main()
