"""The tables of a library's catalogue: what their columns hold, and rows of what is known of clips.

The catalogue is derived: everything in it stands in the log and in ``library.json``, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from roundelay.compare.packed import Packed
from roundelay.gait.table import Stride
from roundelay.library.log import Entry
from roundelay.loops.quality import Quality

__all__ = ["SCHEMA", "TABLES", "Source", "Table", "as_text", "source_of"]

SCHEMA = 1
"""The number of the tables' format."""

Row = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Source:
    """What the tables are made of.

    Attributes
    ----------
    clips : sequence of dict
        Records of clips as in ``library.json``.
    groups : sequence of dict
        The vocabulary.
    strides : mapping
        The strides of clips, by the clips' names.
    vectors : sequence
        Of each behaviour with a signature, in order: the names of the body's points, and numbers.
    runs : sequence of dict
        What each run of ``roundelay library`` did.
    """

    clips: Sequence[Row]
    groups: Sequence[Row]
    strides: Mapping[str, Sequence[Row]]
    vectors: Sequence[tuple[Sequence[str], Sequence[float]]]
    runs: Sequence[Row]


@dataclass(frozen=True)
class Table:
    """A table of the catalogue.

    Attributes
    ----------
    name : str
    words : str
        What a row is.
    columns : dict
        By name: the type in SQL, and what it holds.
    key : tuple of str
        Columns whose values no two rows share; rows are in their order.
    rows : callable
        Gives the rows of a `Source`; what a row lacks is null.
    """

    name: str
    words: str
    columns: dict[str, tuple[str, str]]
    key: tuple[str, ...]
    rows: Callable[[Source], Iterable[Row]]


def source_of(record: Row, entries: Sequence[Entry], runs: Sequence[Row]) -> Source:
    """Gather what the tables are made of.

    Parameters
    ----------
    record : dict
        All that ``library.json`` tells.
    entries : sequence of Entry
        Of its clips.
    runs : sequence of dict
    """
    strides = {entry.name: entry.record["strides"] for entry in entries}
    spectra = [entry.spectra for entry in entries if entry.spectra is not None]
    packed = [Packed.of(one) for one in spectra]
    vectors = [(one.body.joints, row) for one in packed for row in one.vectors().tolist()]
    return Source(record["clips"], record["groups"], strides, vectors, runs)


def as_text(value: Any) -> Any:
    """Return plain data as every program reads it; bytes of names that are no text are escaped."""
    if isinstance(value, dict):
        return {as_text(name): as_text(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [as_text(one) for one in value]
    if isinstance(value, str):
        return value.encode("utf-8", "backslashreplace").decode()
    return value


def _clips(source: Source) -> Iterator[Row]:
    for clip in source.clips:
        kept = ("frames", "fps", "seconds", "joints", "reason", "error", "notes")
        counted = {"behaviours": len(clip["segments"]), "cycles": len(clip["cycles"])}
        yield {"clip": clip["file"]} | {name: clip.get(name) for name in kept} | counted


def _behaviours(source: Source) -> Iterator[Row]:
    for clip in source.clips:
        fps = clip.get("fps")
        for number, segment in enumerate(clip["segments"], 1):
            start, stop = segment["start_frame"], segment["end_frame"]
            yield {
                "clip": clip["file"],
                "behaviour": number,
                "start_frame": start,
                "end_frame": stop,
                "start_seconds": start / fps,
                "end_seconds": stop / fps,
                "label": segment["label"],
                "cycle": segment["cycle"],
                "group_number": segment["group"],
                "name": segment["name"],
            }


def _numbered(source: Source) -> Iterator[tuple[Row, int, Row]]:
    for clip in source.clips:
        for number, cycle in enumerate(clip["cycles"], 1):
            yield clip, number, cycle


_OF_CYCLES = (
    "period_seconds",
    "period_frames",
    "repetitions",
    "confidence",
    "kind",
    "limbs",
    "parts",
    "method",
    "speed",
    "speed_in_sizes",
    "turning_degrees",
    "travel",
)


def _cycles(source: Source) -> Iterator[Row]:
    for clip, number, cycle in _numbered(source):
        told = {name: cycle.get(name) for name in _OF_CYCLES}
        named = {"clip": clip["file"], "cycle": number, "group_number": cycle["group"]}
        named["name"] = cycle["name"]
        yield named | told | {"record": cycle}


def _loops(source: Source) -> Iterator[Row]:
    for clip, number, cycle in _numbered(source):
        size, mark = clip["files"][cycle["loop"]]
        yield {
            "clip": clip["file"],
            "cycle": number,
            "file": cycle["loop"],
            "frames": cycle["loop_frames"],
            "verdict": cycle["verdict"]["word"],
            "reasons": cycle["verdict"]["reasons"],
            "mended": [" ".join(bones) for bones in cycle["mended"]],
            "bytes": size,
            "crc32": mark,
            **{name: cycle["quality"][name] for name in _FIGURES},
        }


def _strides(source: Source) -> Iterator[Row]:
    for clip in source.clips:
        for number, stride in enumerate(source.strides.get(clip["file"], ()), 1):
            yield {"clip": clip["file"], "stride": number} | dict(stride)


def _signatures(source: Source) -> Iterator[Row]:
    vectors = iter(source.vectors)
    for clip in source.clips:
        cycles = [{"cycle": number} for number in range(1, len(clip["cycles"]) + 1)]
        once = [
            {"behaviour": number}
            for number, one in enumerate(clip["segments"], 1)
            if one["cycle"] is None
        ]
        for number, named in enumerate([*cycles, *once], 1):
            points, vector = next(vectors)
            told = {"clip": clip["file"], "signature": number}
            yield told | named | {"points": list(points), "vector": list(vector)}


def _groups(source: Source) -> Iterator[Row]:
    for group in source.groups:
        yield group | {"group_number": group["group"], "example_loop": group["example"]}


def _runs(source: Source) -> Iterator[Row]:
    for number, run in enumerate(source.runs, 1):
        yield {"run": number} | run


_CLIP = {"clip": ("VARCHAR", "path of the capture below the sources, with slashes")}
_CYCLE = _CLIP | {"cycle": ("INTEGER", "number within the clip, from 1")}
_GROUP = {
    "group_number": ("INTEGER", "the same for alike behaviours of all clips; see `groups`"),
    "name": ("VARCHAR", "of the group"),
}
_FIGURES = tuple(Quality.__dataclass_fields__)
_UNITS = {"foot": "VARCHAR"}

TABLES = (
    Table(
        "clips",
        "a capture",
        _CLIP
        | {
            "frames": ("INTEGER", "0 if it was refused"),
            "fps": ("DOUBLE", "frames a second"),
            "seconds": ("DOUBLE", "duration"),
            "joints": ("INTEGER", "of its skeleton"),
            "behaviours": ("INTEGER", "rows of it in `behaviours`"),
            "cycles": ("INTEGER", "rows of it in `cycles`"),
            "reason": ("VARCHAR", "why there is no cycle"),
            "error": ("VARCHAR", "why it was refused"),
            "notes": ("VARCHAR[]", "of its reader"),
        },
        ("clip",),
        _clips,
    ),
    Table(
        "behaviours",
        "a stretch of a clip in which one thing is done",
        _CLIP
        | {
            "behaviour": ("INTEGER", "number within the clip, from 1"),
            "start_frame": ("INTEGER", "first frame"),
            "end_frame": ("INTEGER", "the frame after the last"),
            "start_seconds": ("DOUBLE", ""),
            "end_seconds": ("DOUBLE", ""),
            "label": ("INTEGER", "the same for alike stretches of the clip"),
            "cycle": ("INTEGER", "the cycle that fills at least half of it"),
        }
        | _GROUP,
        ("clip", "behaviour"),
        _behaviours,
    ),
    Table(
        "cycles",
        "a periodic motion of a clip",
        _CYCLE
        | _GROUP
        | {
            "period_seconds": ("DOUBLE", ""),
            "period_frames": ("DOUBLE", ""),
            "repetitions": ("DOUBLE", "how many were seen"),
            "confidence": ("DOUBLE", "that it repeats, from 0 to 1"),
            "kind": ("VARCHAR", "cyclic, or closed: one pass whose ends meet"),
            "limbs": ("VARCHAR[]", "the limbs that do it, if not all"),
            "parts": ("INTEGER[][]", "stretches of frames, half-open"),
            "method": ("VARCHAR", "how the cycle was made"),
            "speed": ("DOUBLE", "units of the file a second"),
            "speed_in_sizes": ("DOUBLE", "body sizes a second"),
            "turning_degrees": ("DOUBLE", "a period"),
            "travel": ("DOUBLE[]", "of a period, in units of the file"),
            "record": ("JSON", "all that library.json tells of it"),
        },
        ("clip", "cycle"),
        _cycles,
    ),
    Table(
        "loops",
        "a loop that was written",
        _CYCLE
        | {
            "file": ("VARCHAR", "path below the library"),
            "frames": ("INTEGER", ""),
            "verdict": ("VARCHAR", "good, look or do not use"),
            "reasons": ("VARCHAR[]", "of the verdict"),
            "mended": ("VARCHAR[]", "bones that were parted"),
            "bytes": ("BIGINT", "of the file"),
            "crc32": ("VARCHAR", "of the file"),
        }
        | dict.fromkeys(_FIGURES, ("DOUBLE", "as in the records")),
        ("clip", "cycle"),
        _loops,
    ),
    Table(
        "strides",
        "a stride: from one strike of a foot to its next",
        _CLIP
        | {"stride": ("INTEGER", "number within the clip, from 1")}
        | {
            name: (_UNITS.get(name, "DOUBLE"), "as of roundelay strides")
            for name in Stride.__dataclass_fields__
        },
        ("clip", "stride"),
        _strides,
    ),
    Table(
        "signatures",
        "what a cycle, or a behaviour that shows none, is compared by",
        _CLIP
        | {
            "signature": ("INTEGER", "number within the clip, from 1"),
            "cycle": ("INTEGER", "its number, if it is a cycle"),
            "behaviour": ("INTEGER", "its number, if it is none"),
            "points": ("VARCHAR[]", "the body's points, by name"),
            "vector": ("FLOAT[]", "the same wherever the cycle begins"),
        },
        ("clip", "signature"),
        _signatures,
    ),
    Table(
        "groups",
        "a word of the vocabulary: alike behaviours of all clips",
        {
            "group_number": ("INTEGER", "stays the same when clips are added"),
            "name": ("VARCHAR", "what it is called, if anything"),
            "named_by": ("VARCHAR", "person, likeness (to a group with a name) or files"),
            "behaviours": ("INTEGER", "that are of it"),
            "cycles": ("INTEGER", "of these"),
            "clips": ("INTEGER", "that show it"),
            "period_seconds": ("DOUBLE", "median of its cycles"),
            "example_loop": ("VARCHAR", "of its most typical behaviour"),
            "example_clip": ("VARCHAR", ""),
            "example_frames": ("INTEGER[]", "half-open"),
        },
        ("group_number",),
        _groups,
    ),
    Table(
        "runs",
        "a run of roundelay library that did something",
        {
            "run": ("INTEGER", "number, from 1"),
            "began": ("TIMESTAMP WITH TIME ZONE", ""),
            "seconds": ("DOUBLE", "that it took"),
            "roundelay": ("VARCHAR", "the version"),
            "options": ("JSON", "how loops were written"),
            "clips": ("INTEGER", "that were done"),
            "refused": ("INTEGER", "of these"),
            "jobs": ("INTEGER", "processes"),
        },
        ("run",),
        _runs,
    ),
)
"""All tables."""
