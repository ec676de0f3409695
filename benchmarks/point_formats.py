"""Reading and writing files of points: speed, round trips, broken files and real ones.

Usage: python -m benchmarks.point_formats --data FOLDER [--json] [--keep]

The real files are those below ``other/c3d`` and ``other/trc``; what each gives is listed. Frames a
second are of a C3D, and of the same points in the other formats, beside the library that a user
would take: ezc3d and c3d for C3D, pandas for tables, movement for DeepLabCut, NumPy for arrays; the
best of several runs counts, by CPU time. What one of these wrote is read by us and what we wrote by
them. Broken files are read in a process of their own, with limits on time and memory. What cuts a
file within a row or a frame, or lies about what is there, is to be refused, or told of where it is
read all the same.
"""

from __future__ import annotations

import functools
import struct
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

import roundelay as rl
from benchmarks import sandbox
from benchmarks._harness import Target, parser, report

# What is said of sound files, too.
_USUAL = ("missing parameter", "No analog data", "tells no frame rate")
_GOOD = ("refused", "told")
FORMATS = (".c3d", ".trc", ".sto", ".tsv", ".csv", ".npz")
RUNS = 5
SECONDS = 20.0
TARGETS = (
    Target("formats_read", ">=", 10, "kinds of file of points that are read"),
    Target("malformed_refused.share", "==", 1, "share of broken files that are refused or told of"),
    Target("malformed_refused.hangs", "==", 0, "broken files that hang or crash"),
    Target("round_trip.worst", "<=", 1e-6, "largest error of a round trip, of the largest place"),
    Target("round_trip.gaps_kept", "==", 1, "share of round trips that keep all gaps"),
    Target("agree_with_peers", "<=", 1e-6, "largest difference to what peers read"),
    Target("real.unexplained", "==", 0, "real files that end in anything but points or one error"),
)


def main() -> None:
    arguments = parser(__doc__, data="folder that holds other/c3d, other/trc").parse_args()
    warnings.simplefilter("ignore")
    result = measured(arguments.data)
    report("point_formats", result, TARGETS, arguments, table=_table(result))


def measured(data: Path) -> dict[str, Any]:
    """Measure files of points; `data` holds the real ones."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        real = _real(data / "other")
        sound = [path for path, told in real.items() if isinstance(told, rl.Points)]
        result = {
            "real": {path.name: _in_words(told) for path, told in real.items()},
            "frames_per_second": _speeds(folder, data),
            "round_trips": _round_trips(sound, folder),
            "peers": _peers(sound, folder),
            "broken": _broken(folder),
            "kinds": _kinds(folder),
        }
    return {"summary": _summary(**result), **result}


def _real(folder: Path) -> dict[Path, Any]:
    """Return the points of each real file, or the error."""
    paths = sorted([*folder.glob("c3d/*"), *folder.glob("trc/*")])
    return {path: _read(path) for path in paths}


def _read(path: Path) -> Any:
    try:
        return rl.read_points(path)
    except Exception as error:
        return error


def _in_words(told: Any) -> str:
    if isinstance(told, rl.Points):
        gaps = f"{told.missing.mean():.1%} missing"
        return f"{len(told)} frames of {len(told.names)} points at {told.fps:g} fps, {gaps}"
    if isinstance(told, rl.FormatError):
        return f"refused: {told.message}"
    return f"{type(told).__name__}: {told}"


def _speeds(folder: Path, data: Path) -> dict[str, dict[str, float]]:
    """Return frames a second by format, reader and writer."""
    points = rl.read_points(data / "other" / "c3d" / "mocap36.c3d")
    result = {}
    for suffix in FORMATS:
        path = folder / f"speed{suffix}"
        readers = {"roundelay": rl.read_points, **_PEERS.get(suffix, {})}
        rl.write(points, path)
        result[suffix] = {name: _rate(read, path, len(points)) for name, read in readers.items()}
        write = functools.partial(rl.write, points)
        result[suffix]["roundelay, writing"] = _rate(write, folder / f"again{suffix}", len(points))
    path = folder / "speed_deeplabcut.csv"
    path.write_text(_deeplabcut(points))
    readers = {"roundelay": rl.read_points, "pandas": _pandas_deeplabcut, "movement": _movement}
    result["DeepLabCut"] = {name: _rate(read, path, len(points)) for name, read in readers.items()}
    return result


def _rate(work: Callable[[Path], Any], path: Path, frames: int) -> float | None:
    """Return frames a second of the fastest run; None where the library is not there."""
    best = np.inf
    for _ in range(RUNS):
        start = time.process_time()
        try:
            work(path)
        except ImportError:
            return None
        best = min(best, time.process_time() - start)
    return round(frames / best)


def _ezc3d(path: Path) -> Any:
    import ezc3d

    found = ezc3d.c3d(str(path))["data"]["points"]
    return np.moveaxis(found[:3], 0, 2).swapaxes(0, 1)


def _c3d(path: Path) -> Any:
    import c3d

    with path.open("rb") as file:
        rows = np.array([points for _, points, _ in c3d.Reader(file).read_frames()])
    return np.where(rows[..., 3:4] < 0, np.nan, rows[..., :3])


def _pandas_trc(path: Path) -> Any:
    import pandas as pd

    return pd.read_csv(path, sep="\t", skiprows=6, header=None)


def _pandas_csv(path: Path) -> Any:
    import pandas as pd

    return pd.read_csv(path, comment="#")


def _pandas_deeplabcut(path: Path) -> Any:
    import pandas as pd

    return pd.read_csv(path, header=[0, 1, 2], index_col=0)


def _movement(path: Path) -> Any:
    from movement.io import load_dataset

    return load_dataset(path, source_software="DeepLabCut")


def _numpy(path: Path) -> Any:
    with np.load(path) as file:
        return {name: file[name] for name in file.files}


_PEERS: dict[str, dict[str, Callable[[Path], Any]]] = {
    ".c3d": {"ezc3d": _ezc3d, "c3d": _c3d},
    ".trc": {"pandas": _pandas_trc},
    ".csv": {"pandas": _pandas_csv},
    ".npz": {"numpy": _numpy},
}


def _deeplabcut(points: rl.Points) -> str:
    parts = [name for name in points.names for _ in range(3)]
    titles = [["scorer", *["net"] * len(parts)], ["bodyparts", *parts]]
    titles.append(["coords", *["x", "y", "likelihood"] * len(points.names)])
    table = np.nan_to_num(points.to_array()).reshape(len(points), -1)
    rows = ([f"{frame}", *map(repr, row)] for frame, row in enumerate(table.tolist()))
    return "".join(",".join(row) + "\n" for row in [*titles, *rows])


def _round_trips(paths: list[Path], folder: Path) -> dict[str, dict[str, float]]:
    """Return the largest error of real files by format, and how many keep gaps and names."""
    result = {}
    for suffix in FORMATS:
        errors, kept = [], []
        for path in paths:
            points = rl.read_points(path)
            rl.write(points, folder / f"again{suffix}")
            again = rl.read_points(folder / f"again{suffix}")
            # A TSV is in millimetres.
            scale = 1000.0 if (points.units, again.units) == ("m", "mm") else 1.0
            errors.append(_apart(scale * points.positions, again.positions))
            same = points.names == again.names
            kept.append(same and np.array_equal(points.missing, again.missing))
        result[suffix] = {"files": len(paths), "worst": max(errors), "kept": sum(kept)}
    return result


def _apart(ours: Any, theirs: Any) -> float:
    """Return how far places lie apart, of the largest one; what either lacks does not count."""
    if np.shape(ours) != np.shape(theirs):
        return float("inf")
    return float(np.nanmax(np.abs(ours - theirs)) / np.nanmax(np.abs(ours)))


def _peers(paths: list[Path], folder: Path) -> dict[str, dict[str, Any]]:
    """Compare with what ezc3d and c3d read: of the real files, and of those that we write."""
    real = [path for path in paths if path.suffix.lower() == ".c3d"]
    ours = [folder / f"ours {path.name}" for path in real]
    for path, copy in zip(real, ours, strict=True):
        rl.write(rl.read_points(path), copy)
    result = {}
    for name in _PEERS[".c3d"]:
        work = functools.partial(_compared, name)
        ends = dict(
            zip([*real, *ours], sandbox.run(work, map(str, [*real, *ours]), SECONDS), strict=True)
        )
        apart = [float(end.split()[1]) for end in ends.values() if end.startswith("apart ")]
        others = {p.name: end for p, end in ends.items() if not end.startswith("apart ")}
        result[name] = {"files": len(apart), "worst": max(apart), "others": others}
    return result


def _compared(name: str, path: str) -> str:
    """Read a file by a peer and by us: "apart" and how far, or what went wrong."""
    warnings.simplefilter("ignore")
    ours = rl.read_points(path)
    try:
        theirs = _PEERS[".c3d"][name](Path(path))
    except Exception as error:
        return f"{type(error).__name__}: {error}"[:80]
    theirs = np.asarray(theirs, float)
    # So write those programs a gap that know no residuals.
    theirs = np.where(theirs.any(axis=2, keepdims=True), theirs, np.nan)
    seen = np.isfinite(theirs).all(axis=2).any(axis=0)
    if seen.sum() != len(ours.names):
        return f"{len(ours.names)} points here, {seen.sum()} there"
    return f"apart {_apart(ours.to_array(), theirs[:, seen])}"


def _made() -> rl.Points:
    places = np.random.default_rng(0).uniform(-900.0, 900.0, (40, 4, 3))
    places[10:14, 1] = np.nan
    return rl.Points(("LASI", "RASI", "LKNE", "RKNE"), places, 100.0, units="mm")


def _texts(folder: Path) -> dict[str, bytes]:
    """Return sound files of all kinds that are small."""
    result = {}
    for suffix in FORMATS:
        rl.write(_made(), folder / f"sound{suffix}")
        result[f"sound{suffix}"] = (folder / f"sound{suffix}").read_bytes()
    rows = [[f"{x:.4f}" for x in row] for row in np.nan_to_num(_made().positions).reshape(40, -1)]
    tables = ["\t".join(row) for row in rows]
    axes = "\t".join(f"{name}_t{axis}" for name in _made().names for axis in "xyz")
    result["sound.sto"] = "\n".join(
        ["m", "nRows=40", "endheader", f"time\t{axes}"]
        + [f"{n / 100}\t{row}" for n, row in enumerate(tables)]
    ).encode()
    heading = ["NO_OF_FRAMES\t40", "NO_OF_MARKERS\t4", "FREQUENCY\t100", "DATA_INCLUDED\t3D"]
    names = "\t".join(["MARKER_NAMES", *_made().names])
    result["sound.tsv"] = "\n".join([*heading, names, *tables]).encode()
    three = [name for name in _made().names for _ in "xyz"]
    heads = [["Format Version", "1.23", "Export Frame Rate", "100", "Total Exported Frames", "40"]]
    heads += [[], ["", "", *["Marker"] * 12], ["", "", *three], ["", "", *["Position"] * 12]]
    heads += [["Frame", "Time (Seconds)", *"XYZ" * 4]]
    body = [[str(n), f"{n / 100}", *row] for n, row in enumerate(rows)]
    result["motive.csv"] = "\n".join(",".join(row) for row in [*heads, *body]).encode()
    result["deeplabcut.csv"] = _deeplabcut(_made()).encode()
    return result


def _kinds(folder: Path) -> dict[str, str]:
    """Read a sound file of each kind; an NPY and files of movement are made here."""
    files = _texts(folder)
    np.save(folder / "sound.npy", _made().to_array())
    files["sound.npy"] = (folder / "sound.npy").read_bytes()
    result = {}
    for name, data in files.items():
        (folder / name).write_bytes(data)
        result[name] = _in_words(_read(folder / name))
    for program in ("deeplabcut", "sleap"):
        path = folder / f"{program}.h5"
        try:
            _save_by_movement(path, program)
        except ImportError:
            continue
        result[path.name] = _in_words(_read(path))
    return result


def _save_by_movement(path: Path, program: str) -> None:
    from movement.io import load_poses, save_poses

    places = np.nan_to_num(_made().positions)[..., :2].transpose(0, 2, 1)[..., None]
    found = load_poses.from_numpy(places, keypoint_names=list(_made().names))
    if program == "sleap":
        save_poses.to_sleap_analysis_file(found, path)
    else:
        save_poses.to_dlc_file(found, path, split_individuals=False)


def _broken(folder: Path) -> dict[str, Any]:
    """Count broken files refused, by reader; name the others."""
    paths = {}
    for name, data in _texts(folder).items():
        lies = _lies_of_c3d(data) if name.endswith(".c3d") else _lies_of_text(name, data)
        for title, broken in {**_general(name, data), **lies}.items():
            path = folder / f"broken {len(paths)}{Path(name).suffix}"
            path.write_bytes(broken)
            paths[f"{name}: {title}"] = path
    result = {"files": len(paths)}
    for name in ("roundelay", *_PEERS[".c3d"]):
        own = {t: p for t, p in paths.items() if name == "roundelay" or p.suffix == ".c3d"}
        work = functools.partial(_outcome, name)
        found = dict(zip(own, sandbox.run(work, map(str, own.values()), SECONDS), strict=True))
        result[name] = {
            "files": len(own),
            "refused": sum(end == "refused" for end in found.values()),
            "told": sum(end == "told" for end in found.values()),
            "not_refused": {title: end for title, end in found.items() if end not in _GOOD},
        }
    return result


def _outcome(name: str, path: str) -> str:
    warnings.simplefilter("ignore")
    read = rl.read_points if name == "roundelay" else _PEERS[".c3d"][name]
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            found = read(Path(path))
        except MemoryError:
            return "out of memory"
        except rl.FormatError:
            return "refused"
        except Exception as error:
            return "refused" if name != "roundelay" else f"{type(error).__name__}"
    notes = [str(one.message) for one in told]
    notes = [note for note in notes if not any(usual in note for usual in _USUAL)]
    return "told" if notes else f"read: {np.shape(getattr(found, 'positions', found))}"


def _general(name: str, data: bytes) -> dict[str, bytes]:
    """Return what breaks a file of any kind; text is cut within a row."""
    lines = data.decode("latin-1").rstrip("\n").rfind("\n") + 5
    cuts = [lines] if name.endswith((".csv", ".tsv", ".trc", ".sto")) else []
    cuts += [] if cuts else [len(data) * n // 8 for n in range(1, 8)]
    result = {f"cut at byte {cut}": data[:cut] for cut in cuts}
    return {**result, "empty": b"", "another format": b"HIERARCHY\nROOT Hips\n{\n" * 60}


def _lies_of_text(name: str, data: bytes) -> dict[str, bytes]:
    """Return texts with a count that lies, a word for a number, and a decimal comma."""
    if name.endswith(".npz"):
        return {}
    last = data.rstrip(b"\n").rfind(b"\n") + 1
    row = data[last:]
    swapped = {"a word": row.replace(b".", b"x", 3), "infinity": row + b"inf"}
    result = {title: data[:last] + broken for title, broken in swapped.items()}
    result["a row less"] = data[:last]
    if name in ("sound.csv", "deeplabcut.csv"):
        del result["a row less"]
    if name.endswith(".csv"):
        result["decimal commas"] = data[:last] + row.replace(b".", b",")
    return result


def _lies_of_c3d(data: bytes) -> dict[str, bytes]:
    """Return C3D files whose header or parameters lie."""

    def put(at: int, pack: str, value: float) -> bytes:
        told = struct.pack(pack, value)
        return data[:at] + told + data[at + len(told) :]

    used = data.index(b"USED") + 8
    labels = data.index(b"LABELS") + 10
    return {
        "twice the frames": put(8, "<H", 80),
        "65535 frames": put(8, "<H", 65534),
        "frames that count back": put(6, "<H", 3000),
        "a point more": put(2, "<H", 5),
        "65535 points": put(2, "<H", 65535),
        "samples that are not there": put(4, "<H", 600),
        "frames beyond the end": put(16, "<H", 60000),
        "frames in the header": put(16, "<H", 0),
        "parameters beyond the end": put(0, "<B", 255),
        "another key": put(1, "<B", 0),
        "another processor": put(515, "<B", 99),
        "more points used": put(used, "<H", 40),
        "labels of 255 by 255": put(labels, "<H", 0xFFFF),
        "no rate": put(20, "<f", 0.0).replace(struct.pack("<f", 100.0), struct.pack("<f", 0.0)),
        "analog alone": put(2, "<H", 0),
    }


def _summary(
    real: Any, frames_per_second: Any, round_trips: Any, peers: Any, broken: Any, kinds: Any
) -> dict[str, Any]:
    """Return the figures of the targets."""
    ours = broken["roundelay"]
    odd = ours["not_refused"]
    read = {name: told for name, told in kinds.items() if told[0].isdigit()}
    return {
        "formats_read": len(read),
        "malformed_refused": {
            "share": (ours["refused"] + ours["told"]) / ours["files"],
            "files": ours["files"],
            "roundelay": ours["refused"],
            "c3d_files": broken["c3d"]["files"],
            "told": ours["told"],
            **{name: broken[name]["refused"] for name in _PEERS[".c3d"]},
            **{f"{name}_told": broken[name]["told"] for name in _PEERS[".c3d"]},
            "hangs": sum(end in ("hang", "crash", "out of memory") for end in odd.values()),
        },
        "round_trip": {
            "worst": max(one["worst"] for one in round_trips.values()),
            "gaps_kept": min(one["kept"] / one["files"] for one in round_trips.values()),
        },
        "agree_with_peers": max(one["worst"] for one in peers.values()),
        "real": {
            "files": len(real),
            "read": sum(told[0].isdigit() for told in real.values()),
            "refused": sum(told.startswith("refused") for told in real.values()),
            "unexplained": sum(
                not told.startswith("refused") and "frames of" not in told for told in real.values()
            ),
        },
        "frames_per_second": frames_per_second,
    }


def _table(result: dict[str, Any]) -> Iterator[str]:
    yield "frames a second"
    for suffix, speeds in result["frames_per_second"].items():
        told = ", ".join(f"{name} {rate or '-'}" for name, rate in speeds.items())
        yield f"  {suffix:12}{told}"
    yield "real files"
    for name, told in result["real"].items():
        yield f"  {name:30}{told}"
    yield "broken files refused, or read with a note"
    for name, found in result["broken"].items():
        if name != "files":
            yield f"  {name:12}{found['refused'] + found['told']} of {found['files']}"


if __name__ == "__main__":
    main()
