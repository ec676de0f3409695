"""Files of points by a grammar: mostly as programs write them, here and there as none does."""

from __future__ import annotations

import io

import numpy as np
from tests.formats.point_samples import DEC, INTEL, SGI, c3d
from tests.fuzz.chance import Chance, Files, encoded

__all__ = ["POINTS"]

_LABELS = ["LASI", "RASI", "RKNE", "RKNE", "Anna:C7", "Ben:C7", "*12", "", "PELO", "LHipAngles"]


def _places(chance: Chance) -> np.ndarray:
    """Return places (F, J, 3), some of which are missing."""
    frames, points = chance.randint(1, 12), chance.randint(1, 6)
    places = np.random.default_rng(chance.randrange(2**32)).uniform(-900, 900, (frames, points, 3))
    places[np.random.default_rng(chance.randrange(2**32)).random((frames, points)) < 0.1] = np.nan
    if chance.is_wild():
        places *= chance.choice((0.0, 1e13, 1e-30, np.nan))
    return places


def _labels(chance: Chance, count: int) -> list[str]:
    return [chance.name(n) if chance.is_wild() else chance.choice(_LABELS) for n in range(count)]


def _c3d(chance: Chance) -> Files:
    places = _places(chance)
    frames, points = places.shape[:2]
    words = np.where(np.isnan(places[..., 0]), -1, chance.choice((0, 3, 0x0501)))
    analog = None
    if chance.random() < 0.5:
        shape = (frames, chance.randint(1, 3), chance.randint(1, 4))
        analog = np.full(shape, chance.uniform(-9, 9))
    more = [("POINT", "USED", chance.count(points) % 65536)]
    if chance.random() < 0.3:
        more += [
            ("POINT", "ANGLES", ["LHipAngles", chance.choice(_LABELS) or "x"]),
            ("FORCE_PLATFORM", "USED", chance.count(1) % 65536),
            ("FORCE_PLATFORM", "TYPE", np.array([chance.randint(0, 5)])),
            ("FORCE_PLATFORM", "CORNERS", np.ones((1, 4, 3))),
            ("FORCE_PLATFORM", "ORIGIN", np.ones((1, 3))),
            ("FORCE_PLATFORM", "CHANNEL", np.array([[1, 2, 3, chance.count(4) % 999]])),
            ("ANALOG", "SCALE", np.ones(chance.randint(1, 5))),
        ]
    header = {chance.randrange(4): chance.randrange(65536)} if chance.is_wild() else {}
    data = c3d(
        np.clip(np.nan_to_num(places), -1e30, 1e30),
        _labels(chance, points),
        processor=chance.choice((INTEL, DEC, SGI)),
        whole=chance.random() < 0.3 and bool(np.nanmax(np.abs(places), initial=0.0) < 4000.0),
        words=words,
        analog=analog,
        rate=chance.choice((0.0, -1.0, 1e9, np.nan)) if chance.is_wild() else 100.0,
        more=more,
        header=header,
        width=chance.choice((0, 4, 30)),
    )
    return {"a.c3d": data[: chance.randrange(len(data))] if chance.is_wild() else data}


def _field(chance: Chance, value: float) -> str:
    if chance.is_wild():
        return chance.number()
    return "" if np.isnan(value) else chance.choice((f"{value:.5f}", f"{value:g}"))


def _rows(chance: Chance, places: np.ndarray, separator: str, first: int = 1) -> str:
    """Return rows of frame, time and places."""
    lines = []
    for frame, row in enumerate(places.reshape(len(places), -1)):
        fields = [str(chance.count(frame + first)), f"{frame / 100:.3f}"]
        fields += [_field(chance, value) for value in row]
        if chance.is_wild():
            fields = fields[: chance.randrange(len(fields))] if chance.is_wild() else [*fields, "1"]
        lines.append(separator.join(fields) + chance.blank())
    return "".join(lines)


def _trc(chance: Chance) -> Files:
    places = _places(chance)
    frames, points = places.shape[:2]
    names = "\t\t\t".join(_labels(chance, points))
    axes = "\t".join(f"{axis}{n + 1}" for n in range(chance.count(points) % 50) for axis in "XYZ")
    text = (
        f"{chance.word('PathFileType')}\t4\t(X/Y/Z)\ta.trc\n"
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n"
        f"{chance.word('100.00')}\t100\t{chance.count(frames)}\t{chance.count(points)}\tmm\n"
        f"Frame#\tTime\t{names}\t\t\n\t\t{axes}\n{chance.blank()}"
    )
    return {"a.trc": encoded(chance, text + _rows(chance, places, "\t"))}


def _sto(chance: Chance) -> Files:
    places = _places(chance)
    frames, points = places.shape[:2]
    vectors = chance.random() < 0.3
    names = [f"m{n}" for n in range(points)]
    ends = chance.choice((("_tx", "_ty", "_tz"), ("_X", "_Y", "_Z")))
    titles = names if vectors else [name + end for name in names for end in ends]
    titles += [chance.choice(("knee_angle_r", "m0_Ox", "f_vx"))] if chance.is_wild() else []
    lines = [f"nRows={chance.count(frames)}", "inDegrees=no", chance.word("endheader")]
    lines += ["DataType=Vec3"] if vectors and not chance.is_wild() else []
    lines = ["marks", *lines[:2], *lines[3:], lines[2], "\t".join([chance.word("time"), *titles])]
    for frame in range(frames):
        values = [["nan" if np.isnan(x) else f"{x:.4f}" for x in point] for point in places[frame]]
        told = [("," if vectors else "\t").join(point) for point in values]
        lines.append("\t".join([f"{frame / 100}", *told]))
    return {"a.sto": encoded(chance, chance.choice(("\n", "\r\n")).join(lines) + "\n")}


def _tsv(chance: Chance) -> Files:
    places = _places(chance)
    frames, points = places.shape[:2]
    text = (
        f"NO_OF_FRAMES\t{chance.count(frames)}\nNO_OF_MARKERS\t{chance.count(points)}\n"
        f"FREQUENCY\t{chance.word('100')}\nDATA_INCLUDED\t{chance.word('3D')}\n"
        f"MARKER_NAMES\t" + "\t".join(f"m{n}" for n in range(points)) + "\n"
    )
    return {"a.tsv": encoded(chance, text + _rows(chance, places, "\t"))}


def _csv(chance: Chance) -> Files:
    places = _places(chance)
    points = places.shape[1]
    columns = [f"{name}_{axis}" for name in map("m{}".format, range(points)) for axis in "xyz"]
    columns += [chance.choice(("speed", "m0_x", "m1_likelihood"))] if chance.is_wild() else []
    first = chance.choice(("", "# fps: 100, units: mm\n", "# image: yes\n#\n"))
    separator = chance.choice((",", ";", "\t"))
    head = separator.join([chance.word("frame"), "time", *columns]) + "\n"
    return {"a.csv": encoded(chance, first + head + _rows(chance, places, separator))}


def _motive(chance: Chance) -> Files:
    places = _places(chance)
    frames, points = places.shape[:2]
    kind = chance.choice(("Marker", "Bone", "Rigid Body"))
    three = [name for name in _labels(chance, points) for _ in "xyz"]
    rows = [
        [
            "Format Version",
            "1.23",
            "Export Frame Rate",
            chance.word("100"),
            "Length Units",
            "Meters",
        ],
        [],
        ["", chance.choice(("", "Type")), *[chance.word(kind)] * len(three)],
        ["", "", *three],
        ["", "", *[f"{n // 3}" for n in range(len(three))]],
        ["", "", *[chance.word("Position")] * len(three)],
        [chance.word("Frame"), "Time (Seconds)", *"XYZ" * points],
    ]
    rows[0] += ["Total Exported Frames", str(chance.count(frames)), "Length Units", "Meters"]
    text = "".join(",".join(row) + "\n" for row in rows)
    return {"a.csv": encoded(chance, text + _rows(chance, places, ",", 0))}


def _deeplabcut(chance: Chance) -> Files:
    places = np.abs(_places(chance))
    points = places.shape[1]
    parts = [f"part{chance.count(n) % 99}" for n in range(points) for _ in "xyz"]
    rows = [["scorer", *["net"] * len(parts)], ["bodyparts", *parts]]
    rows += [["coords", *[chance.word(one) for one in ("x", "y", "likelihood")] * points]]
    if chance.random() < 0.3:
        rows.insert(1, ["individuals", *[chance.choice(("one", "two"))] * len(parts)])
    text = "".join(",".join(row) + "\n" for row in rows)
    table = "".join(
        ",".join([str(frame), *[_field(chance, x) for x in row]]) + "\n"
        for frame, row in enumerate(places.reshape(len(places), -1))
    )
    return {"a.csv": encoded(chance, text + table)}


def _npz(chance: Chance) -> Files:
    places = _places(chance)
    frames, points = places.shape[:2]
    arrays = {"positions": places[..., : chance.choice((2, 3))]}
    if chance.random() < 0.7:
        names = [f"{n} {name}"[:40] for n, name in enumerate(_labels(chance, points))]
        arrays |= {"names": np.array(names), "fps": np.array(100.0), "units": np.array("mm")}
    if chance.random() < 0.3:
        arrays |= {"missing": np.zeros((frames, chance.count(points) % 99), bool)}
    if chance.is_wild():
        arrays[chance.choice(sorted(arrays))] = chance.choice((np.zeros(3), np.array("x"), places))
    file = io.BytesIO()
    np.savez(file, **arrays)
    return {"a.npz": file.getvalue()}


def _npy(chance: Chance) -> Files:
    places = _places(chance)
    file = io.BytesIO()
    np.save(file, places[0] if chance.is_wild() else places.astype(chance.choice("fd")))
    return {"a.npy": file.getvalue()}


POINTS = {
    "c3d": _c3d,
    "trc": _trc,
    "sto": _sto,
    "tsv": _tsv,
    "csv": _csv,
    "motive": _motive,
    "deeplabcut": _deeplabcut,
    "npz": _npz,
    "npy": _npy,
}
"""What makes the files of each format of points."""
