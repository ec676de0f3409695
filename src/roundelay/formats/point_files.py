"""What readers of points share: names that differ, points that are never seen, one note a file."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roundelay.base.errors import FormatError, RateAssumed, RoundelayWarning
from roundelay.base.files import name_of
from roundelay.formats.nodes import called
from roundelay.formats.sane import SLOWEST, fault_of_points, fault_of_size, require_memory
from roundelay.motion.motion import FASTEST
from roundelay.motion.points import Points

__all__ = [
    "RATE",
    "Notes",
    "checked_size",
    "distinct",
    "in_space",
    "made",
    "of_one_body",
    "plain",
    "rate_assumed",
    "seen_beside_origin",
    "subjects_of",
]

Array = NDArray[np.float64]

RATE = 30.0
"""Frames a second where a file tells none: that of most videos."""
# Names in a note.
_NAMED = 4
# A subject with so many points is a body; with fewer, a rigid body that may be part of one.
_BODY = 10


@dataclass(frozen=True)
class Notes:
    """Collect what is to be said of a file, and say it as one warning."""

    path: Path
    told: list[str] = field(default_factory=list)

    def add(self, text: str) -> None:
        """Add a remark."""
        self.told.append(text)

    def add_named(self, names: Sequence[str], what: str) -> None:
        """Add a remark on some points, the first of which are named; none if there are none."""
        if names:
            more = ", ..." if len(names) > _NAMED else ""
            self.add(f"{len(names)} {what} ({', '.join(names[:_NAMED])}{more})")

    def give(self) -> None:
        """Warn, if there is anything to say."""
        if self.told:
            text = f"{self.path}: {'; '.join(self.told)}"
            warnings.warn(text, RoundelayWarning, stacklevel=5)


def plain(name: str) -> str:
    """Return a name without surrounding blanks and without what cannot be printed."""
    return " ".join("".join(c if c.isprintable() else " " for c in name).split())


def distinct(names: Iterable[str], unnamed: str = "point") -> tuple[str, ...]:
    """Return names that differ: "RKNE" and "RKNE 2"; "point 7" for a seventh without a name."""
    taken: set[str] = set()
    result, counts = [], dict[str, int]()
    for number, given in enumerate(names, 1):
        name = plain(given) or f"{unnamed} {number}"
        base = name
        while name in taken:
            counts[base] = counts.get(base, 1) + 1
            name = f"{base} {counts[base]}"
        taken.add(name)
        result.append(name)
    return tuple(result)


def checked_size(path: Path, frames: int, points: int) -> None:
    """Refuse more frames or points than any file has, before they take memory.

    Raises
    ------
    FormatError
        If there are too many, or none.
    TooLarge
        If there is no memory for them.
    """
    for count, what in ((frames, "frame"), (points, "point")):
        if count < 1:
            raise FormatError(f"expected at least one {what}, found none", path=path)
    fault = fault_of_size(frames, points)
    if fault is not None:
        raise FormatError(fault.replace("joints", "points"), path=path)
    require_memory(frames, points)


def rate_assumed(path: Path) -> float:
    """Return the rate of a file that tells none, and warn of it."""
    text = (
        f"{path}: tells no frame rate, {RATE:g} a second assumed; give another by --capture-fps "
        "(in Python by fps)"
    )
    warnings.warn(text, RateAssumed, stacklevel=5)
    return RATE


def made(
    path: Path,
    names: Iterable[str],
    positions: ArrayLike,
    fps: float,
    *,
    notes: Notes | None = None,
    **others: Any,
) -> Points:
    """Make the points that a file holds; what is never seen is left out and told.

    Parameters
    ----------
    path : Path
    names : iterable of str
        As they stand in the file.
    positions : (F, J, 2) or (F, J, 3) array_like
        NaN says that a point is missing.
    fps : float
    notes : Notes, optional
        Given when the points are known to be sound.
    **others
        As for `Points`.

    Raises
    ------
    FormatError
        If the rate or a place is not sane, or nothing is seen.
    """
    notes = notes or Notes(path)
    if not fps > 0.0:
        rates = f"from {SLOWEST:g} to {FASTEST:g} frames a second, found {fps:g}"
        raise FormatError(f"expected {rates}", path=path)
    places = np.asarray(positions, float)
    points = Points(distinct(names), places, fps, **{"name": name_of(path), **others})
    fault = fault_of_points(points)
    if fault is not None:
        raise FormatError(fault, path=path)
    seen = np.asarray(points.seen.any(axis=0)).tolist()
    if not any(seen):
        raise FormatError("expected points, found none that is seen in any frame", path=path)
    if not all(seen):
        unseen = [name for name, once in zip(points.names, seen, strict=True) if not once]
        notes.add_named(unseen, "never seen, left out")
        kept = [name for name, once in zip(points.names, seen, strict=True) if once]
        points = points.select(kept)
    notes.give()
    return points


def seen_beside_origin(places: Array) -> Array:
    """Return places (F, J, D) with NaN for what lies exactly at the origin.

    So write those programs of laboratories a gap that leave no field empty.
    """
    return np.where(places.any(axis=2, keepdims=True), places, np.nan)


def subjects_of(names: Sequence[str]) -> tuple[str, ...]:
    """List the subjects in names such as "Anna:LASI", each once."""
    return tuple(dict.fromkeys(name.rpartition(":")[0] for name in names if ":" in name))


def of_one_body(
    names: Sequence[str],
    seen: Sequence[bool],
    notes: Notes,
    wanted: str | None = None,
    *,
    least: int = _BODY,
) -> list[int]:
    """Return which points are those of one body, where names have subjects: "Anna:LASI".

    Of several subjects the one with most points is read, if it is a body: rigid bodies of a few
    points each are read together. Either is told.

    Parameters
    ----------
    names : sequence of str
    seen : sequence of bool
        Which points are ever seen.
    notes : Notes
    wanted : str, optional
        The subject that is read.
    least : int
        Points of a body.

    Raises
    ------
    FormatError
        If there is no subject of that name.
    """
    subjects = [name.rpartition(":")[0] for name in names]
    if wanted is not None:
        called("a subject (--character)", subjects_of(names), wanted, notes.path)
        return [number for number, subject in enumerate(subjects) if subject == wanted]
    counts = Counter(
        subject for subject, once in zip(subjects, seen, strict=True) if subject and once
    )
    if len(counts) < 2:
        return list(range(len(names)))
    found = f"points of {len(counts)} subjects ({', '.join(list(counts)[:_NAMED])}"
    found += ", ...)" if len(counts) > _NAMED else ")"
    most, count = counts.most_common(1)[0]
    if count < least:
        notes.add(f"{found} read as one")
        return list(range(len(names)))
    notes.add(f"{found}; those of {most} read, which has most (--character names another)")
    return [number for number, subject in enumerate(subjects) if subject == most]


def in_space(points: Points, least: float) -> Array:
    """Return places (F, J, 3), NaN where a point is missing, for formats of three coordinates.

    Points of a plane get a third coordinate of 0. What is seen exactly at the origin is moved by
    the `least` that can be written, since the origin says that a point is missing.
    """
    places = np.zeros((len(points), len(points.names), 3))
    places[..., : points.dimensions] = points.positions
    hidden = np.abs(places).max(axis=2) < 0.5 * least
    places[hidden] = (least, 0.0, 0.0)
    places[np.logical_not(points.seen)] = np.nan
    return places
