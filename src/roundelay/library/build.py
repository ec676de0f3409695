"""Making a library: what is new is done in many processes, and all of it is put in order."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import asdict
from datetime import UTC, datetime
from os import PathLike
from pathlib import Path

from roundelay.base.checks import as_path, chosen
from roundelay.base.errors import FormatError
from roundelay.base.locks import locked
from roundelay.base.progress import Progress, report
from roundelay.base.threads import one_thread
from roundelay.base.version import __version__
from roundelay.library.captures import LOOPS, find_captures
from roundelay.library.catalogue import Library
from roundelay.library.clips import Clip, late_clip, lost_clip, made_entry
from roundelay.library.log import Entry, Log
from roundelay.library.mending import claimed, is_done, is_intact, opened, tell_mended
from roundelay.library.workers import Limits, spread
from roundelay.library.writing import beside, write_library
from roundelay.loops.options import LoopOptions

__all__ = ["build_library"]

Place = str | PathLike[str]
Tell = Callable[[str], object]
Spreading = Callable[[Iterable[Clip]], Generator[Entry]]


@one_thread
def build_library(
    sources: Place | Sequence[Place],
    folder: Place,
    options: LoopOptions | None = None,
    *,
    jobs: int | None = None,
    limits: Limits | None = None,
    again: bool = False,
    cluster: str | int | None = None,
    progress: Progress | None = None,
    refused: Tell | None = None,
) -> Library:
    """Cut, label and loop all captures below some folders, and make them searchable.

    What an earlier call did with the same file and options is kept; what is damaged since then is
    mended, with one warning. If the work is interrupted,
    the library of what is done by then is written all the same. With several jobs this is to be
    called below ``if __name__ == "__main__"``, as for `multiprocessing`.

    Parameters
    ----------
    sources : path-like or sequence of path-like
        Folders, searched to any depth for captures, and such files.
    folder : path-like
        Where the library is or shall be; its loops are not searched.
    options : LoopOptions, optional
        How loops are written.
    jobs : int, optional
        How many processes; one a CPU by default.
    limits : Limits, optional
        Seconds and bytes that a clip is given; they need a process of its own, so that one job
        without limits is done in this process. By default an hour, and all memory.
    again : bool
        Do again what is done.
    cluster : str or int, optional
        The address of a Dask scheduler, ``tcp://...``, whose workers see the sources and the
        library by the same paths; or how many workers to start here. Each clip is done in a child
        of its worker.
    progress : callable, optional
        Called with the fraction done and how many clips that is; returning False cancels.
    refused : callable, optional
        Called with one line for each file or folder that cannot be used, with the reason.

    Returns
    -------
    Library

    Raises
    ------
    OSError
        If there is no capture, a source cannot be read, the library cannot be written, or the
        folder holds files of the same names that are of no library.
    Locked
        If another run is at work on the library.
    FormatError
        If the library is of another version.
    RoundelayError
        If Dask is asked for and not installed.
    ValueError
        If a source is a file of another type, or `jobs` is not positive.
    Cancelled
        If `progress` returned False.

    Examples
    --------
    >>> library = rl.build_library("captures", "library", jobs=1)
    >>> sorted({file for file, _ in library.cycles})
    ['run.bvh', 'walk.bvh']
    """
    if jobs is not None and jobs < 1:
        raise ValueError(f"expected at least one job, found {jobs}")
    folder, options = as_path(folder).resolve(), chosen(LoopOptions, options)
    given = sources if isinstance(sources, Iterable) else [sources]
    given = [sources] if isinstance(sources, str | bytes) else given
    places = [_rooted(as_path(source)) for source in given]
    found = find_captures(places, besides=folder / LOOPS)
    captures, passed = found.captures, found.passed
    unread = [f"{fault.filename}: {fault.strerror}" for fault in found.faults]
    tell = refused or (lambda line: None)
    for line in unread:
        tell(line)
    clips = [Clip(path, name, folder, options) for name, path in captures.items()]
    folder.mkdir(parents=True, exist_ok=True)
    with locked(folder / "library.lock"):
        log = opened(folder)
        todo = [clip for clip in clips if again or not is_done(clip, log)]
        current = None if todo or log.damaged else _current(folder, list(captures), unread, passed)
        if current is not None:
            return current
        tell_mended(folder, log, todo)
        log.renew(clip.name for clip in todo)
        jobs = jobs or os.cpu_count() or 1
        try:
            with _run(log, todo, options, jobs):
                _do(todo, log, _spreading(cluster, jobs, limits, len(todo)), progress, tell)
        finally:
            write_library(list(captures), log, unread, passed, folder)
        return Library.open(folder)


@contextmanager
def _run(log: Log, todo: Sequence[Clip], options: LoopOptions, jobs: int) -> Iterator[None]:
    """Note what a run did, also one that was interrupted."""
    began, started = datetime.now(UTC).isoformat(), time.monotonic()
    try:
        yield
    finally:
        done = [log.entries[clip.name] for clip in todo if clip.name in log.entries]
        if done:
            log.add_run(
                {
                    "began": began,
                    "seconds": round(time.monotonic() - started, 3),
                    "roundelay": __version__,
                    "options": asdict(options),
                    "clips": len(done),
                    "refused": sum(entry.record["error"] is not None for entry in done),
                    "jobs": jobs,
                }
            )


def _rooted(source: Path) -> Path:
    """Return a source without the links and ".." that would lead names out of the library.

    A file keeps its own name, which tells its format.
    """
    return source.resolve() if source.is_dir() else source.parent.resolve() / source.name


def _current(
    folder: Path, names: Sequence[str], unread: Sequence[str], passed: dict[str, int]
) -> Library | None:
    """Return the library as it is, if it is of these clips."""
    try:
        library = Library.open(folder)
    except FormatError:
        return None
    told = library.record
    same = [clip["file"] for clip in library.clips] == names and told["unread"] == unread
    same = same and told.get("passed_over") == passed
    whole = all(is_intact(folder, name, told["checksums"]) for name in beside(folder))
    return library if same and whole else None


def _spreading(
    cluster: str | int | None, jobs: int, limits: Limits | None, count: int
) -> Spreading:
    """Return what does clips: processes here, or workers of Dask."""
    if cluster is None:
        return lambda clips: spread(
            made_entry, clips, min(jobs, count), lost_clip, limits=limits, late=late_clip
        )
    from roundelay.library.cluster import spread_by_dask

    return lambda clips: spread_by_dask(
        made_entry, clips, cluster, lost_clip, limits=limits or Limits(), late=late_clip
    )


def _do(
    clips: Sequence[Clip],
    log: Log,
    spreading: Spreading,
    progress: Progress | None,
    tell: Tell,
) -> None:
    """Make the entries of clips; the fraction done is that of their bytes."""
    sizes = {clip.name: clip.size for clip in clips}
    total, done = max(1, sum(sizes.values())), 0
    with closing(spreading(claimed(clips, log))) as entries:
        for number, entry in enumerate(entries, 1):
            log.add(entry)
            if entry.record["error"] is not None:
                tell(entry.record["error"])
            done += sizes[entry.record["file"]]
            report(progress, done / total, f"{number} of {len(clips)} clips")
