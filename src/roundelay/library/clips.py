"""One clip of a library: read, cut, its cycles found and written as loops, all told in a record."""

from __future__ import annotations

import warnings
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from roundelay.base.errors import FormatError, NoPeriod, RoundelayError, RoundelayWarning, TooShort
from roundelay.base.files import name_of
from roundelay.base.version import __version__
from roundelay.compare.spectra import Spectra
from roundelay.formats import files_of, read
from roundelay.library.store import Entry
from roundelay.loops.options import LoopOptions
from roundelay.loops.recipe import Loop
from roundelay.motion.motion import Motion
from roundelay.output.records import loop_record
from roundelay.pipeline import make_loops, segment, understand
from roundelay.timeline.behaviours import Timeline
from roundelay.timeline.thresholds import SEARCH

__all__ = ["LOOPS", "Clip", "lost_clip", "made_entry"]

# The folder of a library that holds the loops.
LOOPS = "loops"
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
    """

    path: Path
    name: str
    folder: Path
    options: LoopOptions

    @property
    def loops(self) -> Path:
        """The folder of its loops, and of nothing else."""
        return self.folder / LOOPS / self.name

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
    for old in clip.loops.glob("*_loop*"):
        old.unlink()
    stamp = clip.stamp()
    with warnings.catch_warnings(record=True) as raised:
        warnings.simplefilter("always", RoundelayWarning)
        try:
            motion = read(clip.path)
        except (RoundelayError, OSError) as error:
            return _refused(clip, error, None if isinstance(error, OSError) else stamp)
        try:
            record, spectra = _analysed(clip, motion)
        except OSError:
            raise
        # One clip that nothing is prepared for must not end the work on thousands.
        except Exception as error:
            return _refused(clip, error, stamp)
    notes = [str(note.message) for note in raised if note.category is RoundelayWarning]
    return Entry(record | {"notes": notes}, stamp, spectra)


def _analysed(clip: Clip, motion: Motion) -> tuple[dict[str, Any], Spectra | None]:
    told = understand(motion) if len(motion) >= SEARCH.fewest else None
    try:
        loops, reason = make_loops(motion, render=clip.options, timeline=told), None
    except (NoPeriod, TooShort) as refusal:
        loops, reason = [], str(refusal)
    record = {
        "file": clip.name,
        "frames": len(motion),
        "fps": round(motion.fps, 6),
        "seconds": round(motion.duration, 6),
        "joints": motion.skeleton.n_joints,
        "segments": _segments(motion, told),
        "cycles": [_written(clip, *numbered) for numbered in enumerate(loops, 1)],
        "reason": reason,
        "error": None,
    }
    return record, Spectra.of([loop.cycle for loop in loops]) if loops else None


def lost_clip(clip: Clip) -> Entry:
    """Return the entry of a clip whose process died."""
    return _refused(clip, MemoryError("its process died, perhaps for want of memory"), None)


def _refused(clip: Clip, error: Exception, stamp: dict[str, Any] | None) -> Entry:
    """Tell why a clip is left out; without a stamp it is tried again next time."""
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    known = isinstance(error, RoundelayError | OSError | MemoryError)
    reason = reason if known else f"{type(error).__name__}: {reason}"
    # An error of the format begins with the file and the line.
    named = reason.removeprefix(str(clip.path))
    line = f"{clip.name}: {reason}" if named == reason else f"{clip.name}{named}"
    record = {"file": clip.name, "frames": 0, "seconds": 0.0, "segments": [], "cycles": []}
    return Entry(record | {"reason": None, "error": line}, stamp)


def _segments(motion: Motion, told: Timeline | None) -> list[dict[str, Any]]:
    """Cut the capture into behaviours, if it has the joints for it and is long enough."""
    try:
        found = segment(motion, timeline=told)
    except RoundelayError:
        return []
    kept = ("start_frame", "end_frame", "label")
    return [{key: row[key] for key in kept} for row in found.bouts()]


def _written(clip: Clip, number: int, loop: Loop) -> dict[str, Any]:
    """Write a loop; describe it as `roundelay loop` does, more briefly, with its mean speed."""
    ending = "" if number == 1 else str(number)
    path = clip.loops / f"{name_of(clip.path)}_loop{ending}.{clip.options.file_format}"
    path.parent.mkdir(parents=True, exist_ok=True)
    loop.write(path)
    kept = {key: value for key, value in loop_record(loop).items() if key not in _LEFT_OUT}
    speed = float(np.linalg.norm(loop.cycle.velocity.constant)) / loop.cycle.period
    return kept | {
        "speed": speed,
        "speed_in_sizes": speed / loop.cycle.skeleton.size,
        "loop": path.relative_to(clip.folder).as_posix(),
        "mended": [list(one.bones) for one in loop.parted],
    }
