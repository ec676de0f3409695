"""What of a library is as it was written, what is mended, and which files are its own."""

from __future__ import annotations

import errno
import os
import warnings
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from roundelay.base.errors import RoundelayWarning
from roundelay.base.files import is_part
from roundelay.library.captures import LOOPS
from roundelay.library.clips import Clip
from roundelay.library.database import PARQUET, database_files
from roundelay.library.log import Claim, Log
from roundelay.library.sealed import checksum_of
from roundelay.library.shelves import FOLDER, SHELVES
from roundelay.library.store import CATALOGUE, TABLE, read_catalogue

__all__ = ["claimed", "is_done", "is_intact", "opened", "tell_mended"]


def opened(folder: Path) -> Log:
    """Open the log of a library; refuse a folder whose files of these names are of no library.

    What a killed run was writing is removed.
    """
    log = Log(folder)
    known = _catalogue(folder)
    for clip in known["clips"] if known else ():
        log.claims.setdefault(clip["file"], Claim(clip["file"], tuple(clip["files"])))
    if not log.is_known and not log.damaged and known is None:
        _refuse_foreign(folder)
    for place, _, files in os.walk(folder / LOOPS):
        _remove_parts(Path(place), files)
    for top in (folder, folder / PARQUET, folder / FOLDER):
        _remove_parts(top, os.listdir(top) if top.is_dir() else ())
    return log


def _refuse_foreign(folder: Path) -> None:
    """Refuse a folder that would lose a file of the user's."""
    for path in (folder / name for name in (CATALOGUE, SHELVES, TABLE, *database_files())):
        if path.exists():
            told = "expected a library or a folder without such a file, found one of no library"
            raise FileExistsError(errno.EEXIST, told, str(path))


def _catalogue(folder: Path) -> dict[str, Any] | None:
    try:
        return read_catalogue(folder)
    except FileNotFoundError:
        return None


def _remove_parts(folder: Path, names: Iterable[str]) -> None:
    for name in filter(is_part, names):
        (folder / name).unlink()


def tell_mended(folder: Path, log: Log, todo: Sequence[Clip]) -> None:
    """Say in one line what of a library is not as it was written, and is made anew."""
    changed = [clip for clip in todo if clip.name in log.entries and _is_stamped(clip, log)]
    changed = [clip for clip in changed if not _has_files(clip, log)]
    found = [f"damaged records: {log.damaged}"] if log.damaged else []
    found += ["made anew, of an older format"] if log.older else []
    found += [f"clips whose loops are damaged or gone: {len(changed)}"] if changed else []
    if log.is_known and (folder / CATALOGUE).exists():
        damaged = _damaged(folder)
        found += [f"damaged: {', '.join(damaged)}"] if damaged else []
    if found:
        told = f"{folder}: mended: {'; '.join(found)}"
        warnings.warn(told, RoundelayWarning, stacklevel=3)


def _damaged(folder: Path) -> list[str]:
    known = read_catalogue(folder)
    if known is None:
        return [CATALOGUE]
    beside = known.get("checksums", {})
    names = dict.fromkeys([*beside, SHELVES, TABLE, *database_files()])
    return [name for name in names if not is_intact(folder, name, beside)]


def is_intact(folder: Path, name: str, known: dict[str, Any]) -> bool:
    """Tell whether a file below the library is as it was written."""
    path = folder / name
    try:
        return path.stat().st_size == known[name][0] and checksum_of(path) == known[name]
    except (FileNotFoundError, KeyError, TypeError):
        return False


def is_done(clip: Clip, log: Log) -> bool:
    """Tell whether nothing is to be done of a clip: its file is known, and its loops are whole."""
    return _is_stamped(clip, log) and _has_files(clip, log)


def _is_stamped(clip: Clip, log: Log) -> bool:
    """Tell whether the log has an entry of this version of a clip's file."""
    entry = log.entries.get(clip.name)
    return entry is not None and entry.stamp is not None and entry.stamp == clip.stamp()


def _has_files(clip: Clip, log: Log) -> bool:
    files = log.entries[clip.name].record["files"]
    return all(is_intact(clip.folder, name, files) for name in files)


def claimed(clips: Iterable[Clip], log: Log) -> Iterator[Clip]:
    """Write down, before each clip is done, which files of its folder are the library's."""
    for clip in clips:
        found, claim = clip.named_like_loops(), log.claims.get(clip.name, Claim(clip.name))
        # A run that was killed after it claimed the clip left loops that no list names.
        crashed = found - set(claim.kept) if clip.name in log.unfinished else set()
        old: dict[str, Any] = dict.fromkeys(sorted(crashed | set(claim.owned)))
        old |= log.files.get(clip.name, {})
        log.claim(Claim(clip.name, tuple(old), tuple(sorted(found - old.keys()))))
        yield replace(clip, old=old)
