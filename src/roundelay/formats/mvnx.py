"""Read MVNX, the XML of Xsens suits: orientations of segments and where they begin, frame by frame.

Positions and orientations are those of the world, quaternions (w, x, y, z), lengths in metres and Z
up ("MVNX version 4", Xsens MVN User Manual).
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from roundelay.base.errors import FormatError
from roundelay.base.files import content, name_of
from roundelay.formats.contents import Contents
from roundelay.formats.moving import leave
from roundelay.formats.nodes import called, different, listed, note
from roundelay.formats.options import ReadOptions
from roundelay.formats.point_files import rate_assumed
from roundelay.formats.sane import LARGEST, fault_of_size, require_memory
from roundelay.geometry import rotations as rot
from roundelay.geometry.skeleton import Skeleton
from roundelay.motion.motion import Motion

__all__ = ["MvnxReader"]

Array = NDArray[np.float64]

# What each segment hangs on, where the file lists no joints.
_PARENTS = {
    "L5": "Pelvis",
    "L3": "L5",
    "T12": "L3",
    "T8": "T12",
    "Neck": "T8",
    "Head": "Neck",
    **{f"{side}Shoulder": "T8" for side in ("Right", "Left")},
    **{f"{side}UpperArm": f"{side}Shoulder" for side in ("Right", "Left")},
    **{f"{side}ForeArm": f"{side}UpperArm" for side in ("Right", "Left")},
    **{f"{side}Hand": f"{side}ForeArm" for side in ("Right", "Left")},
    **{f"{side}UpperLeg": "Pelvis" for side in ("Right", "Left")},
    **{f"{side}LowerLeg": f"{side}UpperLeg" for side in ("Right", "Left")},
    **{f"{side}Foot": f"{side}LowerLeg" for side in ("Right", "Left")},
    **{f"{side}Toe": f"{side}Foot" for side in ("Right", "Left")},
}
# Frames of calibration poses have other types.
_FRAME = ("normal", None)


class MvnxReader:
    """The reader of MVNX files."""

    name = "mvnx"
    suffixes = (".mvnx",)
    choices = frozenset({"character"})

    def read(self, path: Path, wanted: ReadOptions | None = None) -> Motion:
        """Read an MVNX file.

        Parameters
        ----------
        path : Path
        wanted : ReadOptions, optional
            Which of several subjects.

        Returns
        -------
        Motion
            Lengths in metres, Z up.

        Raises
        ------
        FormatError
            If the file is no whole MVNX, or the subject has no frames with orientations.
        OSError
            If it cannot be read.
        """
        subjects = _subjects(path)
        names = different([_label(one) for one in subjects])
        number = 0
        if wanted is not None and wanted.character is not None:
            number = called("a subject (--character)", names, wanted.character, path)
        elif len(names) > 1:
            others = listed([repr(name) for name in names[1:]])
            note(path, f"subject {names[0]!r} is read, not {others} (--character names another)")
        return _motion(path, subjects[number])

    def contents(self, path: Path) -> Contents:
        """List the subjects of a file."""
        names = different([_label(one) for one in _subjects(path)])
        return Contents(
            characters=names, conventions={"up": "Z", "unit": "1 m", "program": "Xsens"}
        )


def _subjects(path: Path) -> list[ElementTree.Element]:
    """Return the subjects of a file; definitions that could grow without end are refused."""
    data = content(path)
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        raise FormatError("expected MVNX without definitions, found <!DOCTYPE", path=path)
    try:
        found = []
        for _, element in ElementTree.iterparse(io.BytesIO(data)):
            element.tag = element.tag.rpartition("}")[2] if "}" in element.tag else element.tag
            if element.tag == "subject":
                found.append(element)
    except ElementTree.ParseError as error:
        line, column = error.position
        told = str(error).partition(":")[0]
        raise FormatError(
            f"expected whole XML, found {told}", path=path, line=line, column=column + 1
        ) from None
    except (ValueError, LookupError) as error:
        raise FormatError(f"expected XML, found {error}", path=path) from None
    if not found:
        raise FormatError("expected an MVNX with a subject, found none", path=path)
    return found


def _label(subject: ElementTree.Element) -> str:
    return subject.get("label") or "subject"


def _motion(path: Path, subject: ElementTree.Element) -> Motion:
    names = _segments(path, subject)
    order, parents = _tree(path, subject, names)
    turns, places = _frames(path, subject, len(names))
    turns, places = turns[:, order], places[:, order]
    above = np.array(parents[1:], int)
    local, offsets = turns.copy(), np.zeros_like(places)
    inverse = rot.conjugate(turns[:, above])
    local[:, 1:] = rot.multiply(inverse, turns[:, 1:])
    offsets[:, 1:] = rot.rotate(inverse, places[:, 1:] - places[:, above])
    rest = offsets.mean(axis=0)
    skeleton = Skeleton(tuple(names[n] for n in order), tuple(parents), rest)
    moved = bool(leave(offsets[:, 1:], rest[1:], skeleton.size).any())
    step, root = 1.0 / _rate(path, subject), places[:, 0]
    return Motion(skeleton, local, root, step, offsets if moved else None, name_of(path), 2)


def _rate(path: Path, subject: ElementTree.Element) -> float:
    told = subject.get("frameRate")
    if told is None:
        return rate_assumed(path)
    try:
        rate = float(told)
    except ValueError:
        rate = 0.0
    if not 0.0 < rate < LARGEST:
        raise FormatError(f"expected a positive frameRate, found {told!r}", path=path)
    return rate


def _segments(path: Path, subject: ElementTree.Element) -> list[str]:
    listed_here = subject.find("segments")
    labels = [one.get("label") or "" for one in ([] if listed_here is None else listed_here)]
    if not labels or "" in labels:
        raise FormatError("expected segments with labels, found none", path=path)
    return list(different(labels))


def _tree(
    path: Path, subject: ElementTree.Element, names: list[str]
) -> tuple[list[int], list[int]]:
    """Return the segments, parents first, and the parent of each in that order."""
    above = {child: parent for child, parent in _PARENTS.items() if child in names}
    for joint in subject.iterfind("joints/joint"):
        first, second = (joint.findtext(f"connector{n}") or "" for n in (1, 2))
        above[second.partition("/")[0]] = first.partition("/")[0]
    roots = [name for name in names if above.get(name) not in names]
    if len(roots) != 1:
        told = f"expected segments that hang on one, found {listed(roots) or 'a circle'}"
        raise FormatError(told, path=path)
    order = [names.index(roots[0])]
    for segment in order:  # it grows
        order += [n for n, name in enumerate(names) if above.get(name) == names[segment]]
    if len(order) < len(names):
        raise FormatError("expected a tree of segments, found one below itself", path=path)
    # The file's own order, if parents stand first in it.
    plain = list(range(len(names)))
    if all(names.index(above[names[n]]) < n for n in plain[1:] if n != order[0]) and order[0] == 0:
        order = plain
    place = {segment: n for n, segment in enumerate(order)}
    return order, [-1, *(place[names.index(above[names[n]])] for n in order[1:])]


def _frames(path: Path, subject: ElementTree.Element, segments: int) -> tuple[Array, Array]:
    """Return orientations (F, J, 4) and places (F, J, 3) of the world."""
    frames = [one for one in subject.iterfind("frames/frame") if one.get("type") in _FRAME]
    if not frames:
        raise FormatError("expected frames, found none", path=path)
    fault = fault_of_size(len(frames), segments)
    if fault is not None:
        raise FormatError(fault, path=path)
    require_memory(len(frames), segments)
    turns = _numbers(path, (one.findtext("orientation") for one in frames), 4 * segments)
    places = _numbers(path, (one.findtext("position") for one in frames), 3 * segments)
    turns = turns.reshape(len(frames), segments, 4)
    if np.any(np.linalg.norm(turns, axis=2) < 1e-6):
        raise FormatError("expected quaternions of length 1, found one of length 0", path=path)
    return rot.normalize(turns), places.reshape(len(frames), segments, 3)


def _numbers(path: Path, texts: Iterator[str | None], count: int) -> Array:
    """Return so many finite numbers of each frame."""
    rows = []
    for number, text in enumerate(texts):
        try:
            row = np.array((text or "").split(), float)
        except ValueError:
            row = np.full(count, np.nan)
        if len(row) != count:
            told = f"expected {count} numbers in frame {number}, found {len(row)}"
            raise FormatError(told, path=path)
        if not np.all(np.abs(row) <= LARGEST):
            told = f"expected finite numbers of at most {LARGEST:g} in frame {number}, found others"
            raise FormatError(told, path=path)
        rows.append(row)
    return np.array(rows)
