"""Read C3D, the format of motion laboratories: markers, analog channels, force plates.

What the model of a program computed (angles, forces, moments, powers) is no point and is left out,
and so are the axes of Plug-in Gait's segments; their origins, which are joint centres, stay. Why
this reader is our own is told in the documentation ("Points").
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError
from roundelay.base.files import content
from roundelay.formats.analog import Analog, Plate
from roundelay.formats.c3d_parameters import BLOCK, C3dFile, decoded_reals, open_file
from roundelay.formats.contents import Contents
from roundelay.formats.options import ReadOptions
from roundelay.formats.point_files import (
    Notes,
    checked_size,
    distinct,
    made,
    of_one_body,
    plain,
    subjects_of,
)
from roundelay.formats.points import ChoosesPoints
from roundelay.motion.points import Points

__all__ = ["C3dLayout", "C3dReader"]

Array = NDArray[np.float64]

# Lists of what is computed and has no place, under POINT.
_OUTPUTS = ("ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS", "REACTIONS")
_LENGTHS = {"mm", "cm", "dm", "m", "km", "in", "ft", "mete", "meter", "meters", "metre", "um"}
# What Vicon calls trajectories that nobody labelled.
_NAMELESS = re.compile(r"\*\d+")
# A header counts frames up to this; a file of more tells them in its parameters.
_MOST_COUNTED = 65535


@dataclass(frozen=True)
class C3dLayout:
    """What a C3D holds besides points.

    Parameters
    ----------
    first : int
        The number of its first frame.
    analog : Analog, optional
        Analog channels.
    plates : tuple of Plate
        Force plates.
    screen : tuple of str
        Which axes pointed right and up on the laboratory's screen, as in ("+X", "+Z").
    """

    first: int = 1
    analog: Analog | None = field(default=None, repr=False)
    plates: tuple[Plate, ...] = field(default=(), repr=False)
    screen: tuple[str, str] | None = None


class C3dReader(ChoosesPoints):
    """The reader of C3D files."""

    name = "c3d"
    suffixes = (".c3d",)
    choices = frozenset({"character", "salvage"})

    def read_points(self, path: Path, wanted: ReadOptions | None = None) -> Points:
        """Read a C3D file.

        Parameters
        ----------
        path : Path
        wanted : ReadOptions, optional
            Which subject, by the prefix of its labels, and whether to keep the whole frames of a
            file that was cut off; by default the subject with most points.

        Returns
        -------
        Points
            In the file's unit; `Points.layout` is a `C3dLayout` with analog channels and plates.

        Raises
        ------
        FormatError
            If the file is not sound or not whole, with the byte, or holds no point.
        OSError
            If it cannot be read.
        """
        notes, wanted = Notes(path), wanted or ReadOptions()
        file = open_file(path, content(path), notes)
        scale = _scale(file)
        if not file.header.points:
            raise _without_points(file)
        frames = _frames(file, scale, notes, salvage=wanted.salvage)
        checked_size(path, frames, file.header.points)
        places, words = _read_frames(file, frames, scale)
        missing, residuals = _seen(places, words, abs(scale))
        names = _names(file)
        places_of = _places_of(file, names, notes)
        seen = np.logical_not(missing.all(axis=0))[places_of].tolist()
        body = of_one_body([names[n] for n in places_of], seen, notes, wanted.character)
        kept = [places_of[n] for n in body]
        return made(
            path,
            [names[point] for point in kept],
            places[:, kept],
            _rate(file),
            notes=notes,
            missing=missing[:, kept],
            residuals=residuals[:, kept] if residuals.any() else None,
            units=_unit(file),
            up=_up(file),
            layout=_layout(file, frames, scale),
        )

    def contents(self, path: Path) -> Contents:
        """List the subjects of a file, and what it says of itself."""
        file = open_file(path, content(path), Notes(path))
        up = _up(file)
        told = {"unit": _unit(file), "up": "" if up is None else "XYZ"[up]}
        conventions = {key: value for key, value in told.items() if value}
        return Contents(characters=subjects_of(_names(file)), conventions=conventions)

    def besides_motion(self, path: Path) -> tuple[str, ...]:
        """Name what a file holds that its motion does not: see `Reader`."""
        file = open_file(path, content(path), Notes(path))
        found = {"analog channels": file.header.samples, "outputs of a model": _outputs(file)}
        return tuple(what for what, held in found.items() if held)


def _without_points(file: C3dFile) -> FormatError:
    channels = file.header.samples // max(1, file.header.per_frame)
    found = f"{channels} analog channels alone" if channels else "none"
    return file.source.error(f"expected points, found {found}", 2)


def _scale(file: C3dFile) -> float:
    """Return what whole numbers are multiplied by; negative where there are none.

    The header tells which they are. Where it and the parameters differ on the scale, the header
    makes people of the right size; for residuals the parameter does.
    """
    scale = file.header.scale
    told = file.number("POINT", "SCALE", scale)
    if not (np.isfinite(scale) and scale) or (scale < 0 and np.isfinite(told) and told < 0):
        scale = told
    if not (np.isfinite(scale) and scale):
        raise file.source.error(f"expected a scale other than 0, found {scale:g}", 12)
    return scale


def _frames(file: C3dFile, scale: float, notes: Notes, *, salvage: bool) -> int:
    """Return the number of frames, all of which are there."""
    header, source = file.header, file.source
    told = file.counts("POINT", "USED")
    if told and told[0] != header.points:
        found = f"expected the {told[0]} points of POINT:USED, found {header.points}"
        raise source.error(found, 2)
    promised = _promised(file, notes)
    size = (2 if scale > 0 else 4) * (4 * header.points + header.samples)
    left = len(source.data) - header.start
    held = max(0, left) // size
    if salvage and 0 < held < promised:
        notes.add(f"{held} of {promised} frames, cut off, kept")
        return held
    if held < promised:
        found = f"expected {promised} frames of {size} bytes from byte {header.start} on"
        raise source.error(f"{found}, found {held}", len(source.data))
    # The last block is filled up.
    if held > promised and left - promised * size >= BLOCK:
        notes.add(f"{held - promised} frames more than the {promised} promised, left out")
    return promised


def _promised(file: C3dFile, notes: Notes) -> int:
    """Return the number of frames: parameters tell it where the header cannot count so far."""
    header = file.header
    counted = header.last - header.first + 1
    if header.last < _MOST_COUNTED and counted > 0:
        return counted
    first, last = (_of_two(file.counts("TRIAL", f"ACTUAL_{x}_FIELD")) for x in ("START", "END"))
    if first and last and last >= first:
        return last - first + 1
    long = file.number("POINT", "LONG_FRAMES", 0.0)
    if np.isfinite(long) and 1.0 <= long < 2**31:
        return int(long)
    told = file.counts("POINT", "FRAMES")
    promised = max(counted, told[0] if told else 0)
    if promised < 1:
        found = f"expected frames, found the first {header.first} and the last {header.last}"
        raise file.source.error(found, 6)
    if counted < 1:
        counted_so = f"from {header.first} to {header.last} in the header"
        notes.add(f"frames counted {counted_so}, {promised} in the parameters")
    return promised


def _of_two(halves: list[int]) -> int:
    """Return the whole number of two of two bytes, the lower one first; 0 for others."""
    return halves[0] + (halves[1] << 16) if len(halves) == 2 and min(halves) >= 0 else 0


def _read_frames(file: C3dFile, frames: int, scale: float) -> tuple[Array, Array]:
    """Return places (F, P, 3), and the fourth word (F, P): camera mask and residual."""
    points = file.header.points
    rows = _rows(file, frames, scale)[:, : (8 if scale > 0 else 16) * points]
    if scale > 0:
        values = file.source.wholes(rows.tobytes()).reshape(frames, points, 4).astype(float)
        values[..., :3] *= scale
    else:
        values = decoded_reals(rows, file.source.processor).reshape(frames, points, 4)
    return values[..., :3], values[..., 3]


def _rows(file: C3dFile, frames: int, scale: float) -> NDArray[np.uint8]:
    """Return the bytes (F, n) of all frames."""
    header = file.header
    size = (2 if scale > 0 else 4) * (4 * header.points + header.samples)
    raw = np.frombuffer(file.source.data, np.uint8, frames * size, header.start)
    return raw.reshape(frames, size)


def _seen(places: Array, words: Array, scale: float) -> tuple[NDArray[np.bool_], Array]:
    """Return what is missing (F, P), and the residuals (F, P).

    Missing is what has a negative residual, and what lies exactly at the origin: so write those
    programs a gap that know no residuals.
    """
    missing = ~(words >= 0.0) | ~np.all(np.isfinite(places), axis=2) | ~places.any(axis=2)
    words = np.array(np.where(missing | (words > 1e9), 0.0, words), float)
    # The upper byte tells the cameras. Programs that write fractions write residuals as they are.
    whole = words.astype(np.int64)
    fractions = not np.array_equal(words, whole)
    return missing, words if fractions else (whole & 0xFF).astype(float) * scale


def _rate(file: C3dFile) -> float:
    """Return frames a second: the number of fewest digits that is the same in single precision."""
    return float(str(np.float32(file.number("POINT", "RATE", file.header.rate))))


def _names(file: C3dFile) -> list[str]:
    labels = file.texts("POINT", "LABELS")[: file.header.points]
    return list(distinct([*labels, *[""] * (file.header.points - len(labels))]))


def _unit(file: C3dFile) -> str:
    told = next(iter(file.texts("POINT", "UNITS")), "").strip().lower()
    return "m" if told.startswith("met") else told


def _up(file: C3dFile) -> int | None:
    """Return the axis that points up on the screen of the laboratory."""
    told = "".join(file.texts("POINT", "Y_SCREEN"))
    return {"+X": 0, "+Y": 1, "+Z": 2}.get(told.strip().upper())


def _places_of(file: C3dFile, names: list[str], notes: Notes) -> list[int]:
    """Return the numbers of points that are places; tell what else there is."""
    outputs, axes = _outputs(file), _axes(names)
    units = file.texts("POINT", "UNITS")
    units = units if len(units) >= len(names) > 1 else [""] * len(names)
    computed, places = list[str](), list[int]()
    for number, (name, unit) in enumerate(zip(names, units, strict=False)):
        if {name, _bare(name)} & outputs or unit.strip().lower() not in {"", *_LENGTHS}:
            computed.append(name)
        elif name not in axes:
            places.append(number)
    notes.add_named(computed, "outputs of a model, no points, left out")
    notes.add_named(sorted(axes), "axes of segments, left out")
    nameless = [number for number in places if _NAMELESS.fullmatch(names[number])]
    if len(nameless) < len(places):
        # They come and go on any marker.
        notes.add_named([names[number] for number in nameless], "without a label, left out")
        places = [number for number in places if number not in nameless]
    if not places:
        told = f"{len(computed)} outputs of a model alone"
        raise file.source.error(f"expected points, found {told}", 2)
    return places


def _bare(name: str) -> str:
    return name.rsplit(":", 1)[-1]


def _outputs(file: C3dFile) -> set[str]:
    """Return the names of what is computed and is not a place."""
    groups = list(_OUTPUTS)
    types = file.texts("POINT", "TYPE_GROUPS")
    for group, kind in zip(types[::2], types[1::2], strict=False):
        unit = next(iter(file.texts("POINT", f"{kind.upper()}_UNITS")), "")
        if unit and unit.strip().lower() not in _LENGTHS:
            groups.append(group.upper())
    return {plain(name) for group in groups for name in file.texts("POINT", group)}


def _axes(names: list[str]) -> set[str]:
    """Return the ends of segments' axes: three beside each origin, as HEDA, HEDL, HEDP by HEDO."""
    known = set(names)
    ends = ({name[:-1] + letter for letter in "ALP"} for name in names if name.endswith("O"))
    return {end for three in ends if three <= known for end in three}


def _layout(file: C3dFile, frames: int, scale: float) -> C3dLayout:
    screen = [next(iter(file.texts("POINT", f"{axis}_SCREEN")), "") for axis in "XY"]
    told = (screen[0], screen[1]) if all(screen) else None
    analog = _analog(file, frames, scale)
    return C3dLayout(file.header.first, analog, _plates(file, analog), told)


def _analog(file: C3dFile, frames: int, scale: float) -> Analog | None:
    header = file.header
    per_frame = max(1, header.per_frame)
    count = header.samples // per_frame
    if not count:
        return None
    if header.samples % per_frame:
        told = f"expected samples of {per_frame} a channel and frame, found {header.samples}"
        raise file.source.error(told, 4)
    raw = _rows(file, frames, scale)[:, (8 if scale > 0 else 16) * header.points :]
    unsigned = scale > 0 and "UNSIGNED" in file.texts("ANALOG", "FORMAT")
    samples: Array
    if scale > 0:
        samples = file.source.wholes(raw.tobytes()).astype(float)
        samples = np.where((samples < 0) & unsigned, samples + 65536, samples)
    else:
        samples = decoded_reals(raw, file.source.processor)
    labels = file.texts("ANALOG", "LABELS")[:count]
    units = file.texts("ANALOG", "UNITS")[:count]
    return Analog(
        distinct([*labels, *[""] * (count - len(labels))], "channel"),
        (*units, *[""] * (count - len(units))),
        _rate(file) * per_frame,
        _in_units(file, samples.reshape(frames * per_frame, count), unsigned),
    )


def _in_units(file: C3dFile, samples: Array, unsigned: bool) -> NDArray[np.float32]:
    """Return (samples - OFFSET) * SCALE * GEN_SCALE."""
    count = samples.shape[1]
    offsets, scales = np.zeros(count), np.ones(count)
    told = file.numbers("ANALOG", "OFFSET")
    told = told if len(told) else file.numbers("ANALOG", "OFFSETS")
    told = np.where((told < 0) & unsigned, told + 65536, told)
    offsets[: len(told)] = told[:count]
    each = file.numbers("ANALOG", "SCALE")
    scales[: len(each)] = each[:count]
    with np.errstate(all="ignore"):
        scales *= file.number("ANALOG", "GEN_SCALE", 1.0)
        return ((samples - offsets) * scales).astype(np.float32)


def _plates(file: C3dFile, analog: Analog | None) -> tuple[Plate, ...]:
    """Return the plates that are told whole."""
    kinds = file.counts("FORCE_PLATFORM", "TYPE")
    used = int(min(len(kinds), max(0, *file.counts("FORCE_PLATFORM", "USED"), 0)))
    corners = file.numbers("FORCE_PLATFORM", "CORNERS")
    origins = file.numbers("FORCE_PLATFORM", "ORIGIN")
    used = min(used, len(corners) // 12, len(origins) // 3)
    channels = _columns(file, "CHANNEL", used)
    matrices = _columns(file, "CAL_MATRIX", used)
    count = len(analog.names) if analog else 0
    return tuple(
        Plate(
            kinds[plate],
            corners[12 * plate :][:12].reshape(4, 3),
            origins[3 * plate :][:3],
            tuple(int(c) - 1 for c in channels[plate] if 1 <= c <= count),
            _matrix(matrices[plate]),
        )
        for plate in range(used)
    )


def _columns(file: C3dFile, name: str, used: int) -> list[Array]:
    """Return what a parameter tells of each plate."""
    found = file.get("FORCE_PLATFORM", name)
    count = found.shape[-1] if found and found.shape else 0
    if found is None or count < used:
        return [np.empty(0)] * used
    return np.split(found.numbers(), count)[:used] if count else []


def _matrix(values: Array) -> Array | None:
    return values.reshape(6, -1).T if len(values) in (36, 48) else None
