"""All kinds of file: speed and memory, beside other readers; what is read right, and what refused.

Usage: python -m benchmarks.formats --data FOLDER [--blenders PYTHONS] [--real FOLDER]
       [--fuzz FILE ...] [--json] [--keep]

BVH and AMC are measured here. Files of points, points with gaps and skeletons solved from markers
are measured by `point_formats`, `points` and `markers`, and FBX and glTF, where Pythons with bpy
are given, by `scenes`, which also says what ``--fuzz`` is: their figures stand in the summary, too.

Every reader runs in this process on the same files; the best of several runs counts, by CPU time.
Frames per second of reading include what each makes of the numbers: quaternions here, Euler angles
in pybvh and pymotion, transforms in bvhio. The odd and broken files of `bvh_samples` are read in a
process of their own. Memory is the peak of what Python and NumPy allocate during a read, less the
result, in multiples of the file's size.
"""

from __future__ import annotations

import argparse
import functools
import tempfile
import time
import tracemalloc
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import roundelay as rl
from benchmarks import markers, point_formats, points, sandbox, scenes
from benchmarks._harness import Target, parser, report
from benchmarks.bvh_samples import BROKEN, VALID, text

FRAMES, JOINTS = 3, 3
SECONDS = 10.0
ROUNDS = 3
TARGETS = (
    Target("refused.roundelay", "==", len(BROKEN), "broken files refused"),
    Target("valid_read.roundelay", "==", len(VALID), "odd files read right"),
    Target("fastest_strict", "==", 1, "the fastest reader of those that refuse all broken files"),
    Target("fastest", "==", 1, "the fastest reader of all"),
    Target("amc.read", ">=", 30000, "frames of an AMC read in a second"),
    Target("memory_of_the_file", "<=", 8, "most memory of a reading, in sizes of the file"),
    Target("formats_read", ">=", 20, "suffixes that are read"),
    Target("malformed_refused", "==", 1, "share of broken files that are refused or told of"),
    Target("round_trip.worst", "<=", 1e-6, "largest error of a round trip, of the largest place"),
    Target("points_period", ">=", 0.99, "share of made points whose period is within 2 %"),
    Target("markers_rms_mm", "<=", 15, "worst walk: markers against those on the skeleton, mm"),
    *scenes.TARGETS,
)


@dataclass(frozen=True)
class Peer:
    """A reader and writer: read(path) -> (motion, frames, joints), write(motion, path)."""

    read: Callable[[str], tuple[Any, int, int]]
    write: Callable[[Any, str], None]
    runs: int = 5


def _roundelay(path: str) -> tuple[Any, int, int]:
    motion = rl.read(path)
    return motion, len(motion), motion.skeleton.n_joints


def _pybvh(path: str) -> tuple[Any, int, int]:
    import pybvh

    motion = pybvh.read_bvh_file(path)
    return motion, motion.frame_count, motion.joint_count


def _write_pybvh(motion: Any, path: str) -> None:
    import pybvh

    pybvh.write_bvh_file(motion, path)


def _pymotion(path: str) -> tuple[Any, int, int]:
    from pymotion.io.bvh import BVH

    motion = BVH()
    motion.load(path)
    return motion, *motion.data["rotations"].shape[:2]


def _bvhio(path: str) -> tuple[Any, int, int]:
    import bvhio

    motion = bvhio.readAsBvh(path)
    return motion, len(motion.Root.Keyframes), len(motion.Root.layout())


def _write_bvhio(motion: Any, path: str) -> None:
    import bvhio

    bvhio.writeBvh(path, motion)


PEERS = {
    "roundelay": Peer(_roundelay, rl.write),
    "pybvh": Peer(_pybvh, _write_pybvh),
    "upc-pymotion": Peer(_pymotion, lambda motion, path: motion.save(path)),
    "bvhio": Peer(_bvhio, _write_bvhio, runs=1),
}


def main() -> None:
    asked = parser(__doc__, data="folder that holds cmu/, bundle/, other/")
    arguments = scenes.asking(asked, needed=False).parse_args()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        result = _measure(arguments.data, Path(folder))
    others = _others(arguments)
    summary = {**_summary(**result), **_of_all(result["samples"]["roundelay"], others)}
    told = {"summary": summary, **result, **others}
    report("formats", told, TARGETS, arguments, table=_table(result), bulk=list(others))


def _others(arguments: argparse.Namespace) -> dict[str, dict[str, Any]]:
    """Measure the other kinds of file."""
    return {
        "point_formats": point_formats.measured(arguments.data),
        "points": points.measured(),
        "markers": markers.measured(arguments.data),
        "scenes": scenes.measured(arguments),
    }


def _of_all(samples: dict[str, Any], others: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """Return the figures of all kinds of file together."""
    summary = {name: result["summary"] for name, result in others.items()}
    broken = summary["point_formats"]["malformed_refused"]
    refused = samples["broken_refused"] + broken["roundelay"] + broken["told"]
    return {
        **summary["scenes"],
        "formats_read": len(summary["scenes"]["formats_read"]),
        "malformed": len(BROKEN) + broken["files"],
        "malformed_refused": refused / (len(BROKEN) + broken["files"]),
        "round_trip": summary["point_formats"]["round_trip"],
        "points_period": summary["points"]["points_period"],
        "markers_rms_mm": summary["markers"]["markers_rms_mm"],
    }


def _measure(data: Path, folder: Path) -> dict[str, Any]:
    amc = data / "cmu" / "acclaim" / "86" / "86_01.amc"
    bvh = folder / "86_01.bvh"
    rl.write(rl.read(amc), bvh)
    files = {"86_01.bvh": bvh, "01_03.bvh": data / "bundle" / "01_03.bvh"}
    samples = {name: _samples(name, folder) for name in PEERS}
    speeds = {title: _race(path, folder, list(PEERS)) for title, path in files.items()}
    speeds["86_01.amc"] = _race(amc, folder, ["roundelay"])
    memory = {path.name: _memory(path) for path in (*files.values(), amc)}
    return {"frames_per_second": speeds, "samples": samples, "peak_memory": memory}


def _race(path: Path, folder: Path, names: list[str]) -> dict[str, Any]:
    """Time readers in turns, so that a busy machine slows all alike."""
    best: dict[str, dict[str, float]] = {}
    for _ in range(ROUNDS):
        for name in names:
            now = _speed(PEERS[name], path, folder / f"{name}{path.suffix}")
            before = best.get(name, now)
            best[name] = {key: max(value, before[key]) for key, value in now.items()}
    return best


def _speed(peer: Peer, path: Path, copy: Path) -> dict[str, float]:
    motion, frames, joints = peer.read(str(path))
    reading = min(_time(lambda: peer.read(str(path))) for _ in range(peer.runs))
    writing = min(_time(lambda: peer.write(motion, str(copy))) for _ in range(peer.runs))
    return {
        "frames": frames,
        "joints": joints,
        "read": round(frames / reading),
        "write": round(frames / writing),
    }


def _time(work: Callable[[], object]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


def _memory(path: Path) -> dict[str, float]:
    tracemalloc.start()
    motion = rl.read(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    size = path.stat().st_size
    result = motion.rotations.nbytes + motion.root_path.nbytes
    return {"file": size, "result": result, "times_the_file": round((peak - result) / size, 2)}


def _samples(name: str, folder: Path) -> dict[str, Any]:
    """Count odd files read right and broken files refused; name the others."""
    paths = {}
    for kind, samples in (("valid", VALID), ("broken", BROKEN)):
        for title, changes in samples.items():
            paths[kind, title] = folder / f"{kind} {title}.bvh".replace("^", "")
            paths[kind, title].write_bytes(text(changes).encode())
    work = functools.partial(_outcome, name)
    outcomes = dict(zip(paths, sandbox.run(work, map(str, paths.values()), SECONDS), strict=True))
    unread = [t for (kind, t), found in outcomes.items() if kind == "valid" and found != "right"]
    taken = {t: f for (kind, t), f in outcomes.items() if kind == "broken" and f != "refused"}
    return {
        "valid_read": len(VALID) - len(unread),
        "broken_refused": len(BROKEN) - len(taken),
        "valid_not_read": unread,
        "broken_not_refused": taken,
    }


def _outcome(name: str, path: str) -> str:
    warnings.simplefilter("ignore")
    try:
        _, frames, joints = PEERS[name].read(path)
    except MemoryError:
        return "out of memory"
    except Exception:
        return "refused"
    return "right" if (frames, joints) == (FRAMES, JOINTS) else f"{frames} x {joints}"


def _summary(frames_per_second: Any, samples: Any, peak_memory: Any) -> dict[str, Any]:
    """Frames a second, files read right and refused by reader, and how we stand among them."""
    bvh, amc = frames_per_second["86_01.bvh"], frames_per_second["86_01.amc"]["roundelay"]
    reading = {name: speed["read"] for name, speed in bvh.items()}
    strict = [name for name, sample in samples.items() if not sample["broken_not_refused"]]
    refused = {name: sample["broken_refused"] for name, sample in samples.items()}
    peers = [refused[name] for name in refused if name != "roundelay"]
    return {
        "frames": bvh["roundelay"]["frames"],
        "joints": bvh["roundelay"]["joints"],
        "read": reading,
        "write": {name: speed["write"] for name, speed in bvh.items()},
        "amc": {"read": amc["read"], "write": amc["write"]},
        "valid": len(VALID),
        "valid_read": {name: sample["valid_read"] for name, sample in samples.items()},
        "broken": len(BROKEN),
        "refused": refused,
        "refused_by_peers": {"fewest": min(peers), "most": max(peers)},
        "fastest_strict": reading["roundelay"] >= max((reading[x] for x in strict), default=0),
        "fastest": reading["roundelay"] >= max(reading.values()),
        "memory_of_the_file": max(file["times_the_file"] for file in peak_memory.values()),
    }


def _table(result: dict[str, Any]) -> Iterator[str]:
    for title, peers in result["frames_per_second"].items():
        yield f"{title}: frames per second read, written"
        for name, speed in peers.items():
            yield f"  {name:14}{speed['read']:>10}{speed['write']:>10}"
    yield f"odd files read right, of {len(VALID)}; broken files refused, of {len(BROKEN)}"
    for name, sample in result["samples"].items():
        yield f"  {name:14}{sample['valid_read']:>10}{sample['broken_refused']:>10}"
    yield "peak memory beyond the result, in file sizes"
    for name, memory in result["peak_memory"].items():
        yield f"  {name:14}{memory['times_the_file']:>10}"


if __name__ == "__main__":
    main()
