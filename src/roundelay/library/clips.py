"""One clip of a library: read, cut, its cycles found and written as loops, all told in a record."""

from __future__ import annotations

import errno
import os
import re
import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from roundelay.base.errors import (
    FormatError,
    NoPeriod,
    RoundelayError,
    RoundelayWarning,
    TooLarge,
    TooShort,
)
from roundelay.base.files import fitting, name_of
from roundelay.base.version import __version__
from roundelay.compare.spectra import Spectra
from roundelay.cycles.cycle import Cycle
from roundelay.formats import files_of, files_written, read
from roundelay.gait.strides import strides
from roundelay.library.captures import LOOPS
from roundelay.library.log import Entry
from roundelay.library.sealed import checksum_of
from roundelay.loops.options import LoopOptions
from roundelay.loops.recipe import Loop
from roundelay.motion.motion import Motion
from roundelay.output.records import loop_record
from roundelay.pipeline import make_loops, segment, understand
from roundelay.timeline.behaviours import Timeline
from roundelay.timeline.thresholds import SEARCH

__all__ = ["Clip", "late_clip", "lost_clip", "made_entry"]

# Bytes of the path of a clip's folder and of a loop's name: Windows takes 259 characters in all.
_LONGEST, _ENDING = 90, 20
# With these nothing more can be written at all; any other fault is the clip's own.
_NO_ROOM = {errno.ENOSPC, errno.EDQUOT}
# What only the record of `roundelay loop` tells of a cycle: too long for thousands.
_LEFT_OUT = ("barcode", "turns", "files", "playback")


@dataclass(frozen=True)
class Clip:
    """A capture that belongs to a library.

    Parameters
    ----------
    path : Path
        Where it is.
    name : str
        Its path below the library's sources, with slashes: no two clips share one.
    folder : Path
        The library's.
    options : LoopOptions
    old : mapping of str to list or None
        The library's files of this clip by their paths below it, with sizes and checksums where
        they are known; they make place for new ones.
    """

    path: Path
    name: str
    folder: Path
    options: LoopOptions
    old: Mapping[str, list[int | str] | None] = field(default_factory=dict)

    @property
    def loops(self) -> Path:
        """The folder of its loops: named after the clip, or after its end if that is long."""
        if len(os.fsencode(self.name)) <= _LONGEST:
            return self.folder / LOOPS / self.name
        return self.folder / LOOPS / fitting(self.name.replace("/", "-"), "", _LONGEST)

    @property
    def stem(self) -> str:
        """How the names of its loops begin."""
        return fitting(name_of(self.path), "", _LONGEST - _ENDING)

    def named_like_loops(self) -> set[str]:
        """List the files in the folder of its loops that are named as its loops are."""
        if not self.loops.is_dir():
            return set()
        like = re.compile(re.escape(self.stem) + r"_loop\d*\.\w+")
        found = (path for path in self.loops.iterdir() if like.fullmatch(path.name))
        return {self.below(path) for path in found}

    def below(self, path: Path) -> str:
        """Return the path of a file below the library, with slashes."""
        return path.relative_to(self.folder).as_posix()

    @property
    def size(self) -> int:
        """Bytes of the file; 0 if it cannot be reached."""
        return self.path.stat().st_size if self.path.exists() else 0

    def stamp(self) -> dict[str, Any] | None:
        """Tell which version of the file is used, and how; None if it cannot be reached."""
        files = [self.path]
        try:
            with suppress(FormatError):
                files = files_of(self.path)
            versions = [[file.stat().st_size, file.stat().st_mtime_ns] for file in files]
        except OSError:
            return None
        return {"files": versions, "roundelay": __version__, "options": asdict(self.options)}


def made_entry(clip: Clip) -> Entry:
    """Read a clip, cut it, find its cycles and write their loops.

    Returns
    -------
    Entry
        With the reason in its record if the clip could not be used.

    Raises
    ------
    OSError
        If a loop cannot be written.
    """
    stamp = clip.stamp()
    with warnings.catch_warnings(record=True) as raised:
        warnings.simplefilter("always", RoundelayWarning)
        others = set[str]()
        try:
            _make_place(clip)
            others = clip.named_like_loops()
            record, spectra = _analysed(clip, read(clip.path))
        # One clip that nothing is prepared for must not end the work on thousands.
        except Exception as error:
            for name in clip.named_like_loops() - others:
                (clip.folder / name).unlink()
            if isinstance(error, OSError) and error.errno in _NO_ROOM:
                raise
            lasting = not isinstance(error, OSError | MemoryError | TooLarge)
            return _refused(clip, error, stamp if lasting else None)
    notes = [str(note.message) for note in raised if note.category is RoundelayWarning]
    return Entry(record | {"notes": notes}, stamp, spectra)


def _make_place(clip: Clip) -> None:
    """Remove what an earlier run made of a clip; what was changed since then is put aside."""
    for name, known in clip.old.items():
        path = clip.folder / name
        if known is not None and path.exists() and checksum_of(path) != known:
            path.replace(path.with_name(f"{path.name}.changed"))
        path.unlink(missing_ok=True)


def _analysed(clip: Clip, motion: Motion) -> tuple[dict[str, Any], Spectra | None]:
    told = understand(motion) if len(motion) >= SEARCH.fewest else None
    try:
        loops, reason = make_loops(motion, render=clip.options, timeline=told), None
    except (NoPeriod, TooShort) as refusal:
        loops, reason = [], str(refusal)
    written = [_written(clip, *numbered) for numbered in enumerate(loops, 1)]
    cycles = [loop.cycle for loop in loops]
    segments = _segments(motion, told, written)
    record = {
        "file": clip.name,
        "frames": len(motion),
        "fps": round(motion.fps, 6),
        "seconds": round(motion.duration, 6),
        "joints": motion.skeleton.n_joints,
        "segments": segments,
        "cycles": written,
        "strides": _strides(motion, told),
        "reason": reason,
        "error": None,
        "files": {name: checksum_of(clip.folder / name) for name in _files(clip, len(loops))},
    }
    return record, _signatures(motion, cycles, segments)


def _signatures(
    motion: Motion, cycles: Sequence[Cycle], segments: Sequence[dict[str, Any]]
) -> Spectra | None:
    """Return the signatures of all cycles, then those of the segments that show none."""
    spans = [(x["start_frame"], x["end_frame"]) for x in segments if x["cycle"] is None]
    parts = [Spectra.of(cycles)] if cycles else []
    parts += [Spectra.of_stretches(motion, spans)] if spans else []
    return Spectra.joined(parts) if parts else None


def lost_clip(clip: Clip) -> Entry:
    """Return the entry of a clip whose process died."""
    return _refused(clip, MemoryError("its process died, perhaps for want of memory"), None)


def late_clip(clip: Clip) -> Entry:
    """Return the entry of a clip that took longer than it was given."""
    told = "not done in the time that a clip is given; give it more by --clip-seconds"
    return _refused(clip, TimeoutError(told), None)


def _refused(clip: Clip, error: Exception, stamp: dict[str, Any] | None) -> Entry:
    """Tell why a clip is left out; without a stamp it is tried again next time."""
    reason = _reason(clip, error) or "out of memory"
    known = isinstance(error, RoundelayError | OSError | MemoryError)
    reason = reason if known else f"{type(error).__name__}: {reason}"
    # An error of the format begins with the file and the line.
    named = reason.removeprefix(str(clip.path))
    line = f"{clip.name}: {reason}" if named == reason else f"{clip.name}{named}"
    record: dict[str, Any] = {"file": clip.name, "frames": 0, "seconds": 0.0}
    record |= {"segments": [], "cycles": [], "strides": []}
    left = {name: known for name, known in clip.old.items() if (clip.folder / name).exists()}
    return Entry(record | {"reason": None, "error": line, "files": left}, stamp)


def _reason(clip: Clip, error: Exception) -> str:
    """Say what went wrong, and with which file if that is not the clip's own."""
    if not isinstance(error, OSError) or not error.strerror:
        return str(error)
    other = error.filename is not None and Path(error.filename) != clip.path
    return f"{error.filename}: {error.strerror}" if other else error.strerror


def _segments(
    motion: Motion, told: Timeline | None, cycles: Sequence[dict[str, Any]]
) -> list[dict[str, Any]]:
    """Cut the capture into behaviours; one that cannot be cut is one itself."""
    kept = ("start_frame", "end_frame", "label")
    try:
        found = [{key: row[key] for key in kept} for row in segment(motion, timeline=told).bouts()]
    except RoundelayError:
        found = [dict(zip(kept, (0, len(motion), 0), strict=True))]
    return [one | {"cycle": _shown(one, cycles)} for one in found]


def _shown(segment: dict[str, Any], cycles: Sequence[dict[str, Any]]) -> int | None:
    """Return the number of the cycle, from 1, that fills at least half of a segment."""
    start, stop = segment["start_frame"], segment["end_frame"]
    filled = [
        (sum(max(0, min(b, stop) - max(a, start)) for a, b in cycle["parts"]), -number)
        for number, cycle in enumerate(cycles, 1)
    ]
    most, number = max(filled, default=(0, 0))
    return -number if 2 * most >= stop - start and number else None


def _strides(motion: Motion, told: Timeline | None) -> list[dict[str, Any]]:
    """Return the strides of a capture, if it has feet that walk."""
    if told is None:
        return []
    try:
        return strides(motion, timeline=told).to_dict()["strides"]
    except RoundelayError:
        return []


def _written(clip: Clip, number: int, loop: Loop) -> dict[str, Any]:
    """Write a loop; describe it as `roundelay loop` does, more briefly, with its mean speed."""
    path = _path_of(clip, number)
    path.parent.mkdir(parents=True, exist_ok=True)
    for file in files_written(path):
        if file.exists():
            told = "expected no file but the library's own here; move it away, and run again"
            raise FileExistsError(errno.EEXIST, told, str(file))
    loop.write(path)
    kept = {key: value for key, value in loop_record(loop).items() if key not in _LEFT_OUT}
    speed = float(np.linalg.norm(loop.cycle.velocity.constant)) / loop.cycle.period
    return kept | {
        "speed": speed,
        "speed_in_sizes": speed / loop.cycle.skeleton.size,
        "loop": clip.below(path),
        "mended": [list(one.bones) for one in loop.parted],
    }


def _path_of(clip: Clip, number: int) -> Path:
    """Return the path of a clip's loop, counted from 1."""
    ending = "" if number == 1 else str(number)
    return clip.loops / f"{clip.stem}_loop{ending}.{clip.options.file_format}"


def _files(clip: Clip, count: int) -> list[str]:
    """List the files of a clip's loops by their paths below the library."""
    loops = (_path_of(clip, number) for number in range(1, count + 1))
    return [clip.below(file) for loop in loops for file in files_written(loop)]
