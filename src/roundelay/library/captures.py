"""Which captures there are below some folders, and what each is called."""

from __future__ import annotations

import errno
import os
from collections.abc import Sequence
from pathlib import Path

from roundelay.formats import in_words, readers, suffixes_of
from roundelay.library.log import LOG
from roundelay.library.sealed import SEAL

__all__ = ["LOOPS", "find_captures"]

LOOPS = "loops"
"""The folder of a library that holds the loops."""


def find_captures(sources: Sequence[Path], besides: Path) -> tuple[dict[str, Path], list[OSError]]:
    """List the files that a reader knows among files and below folders.

    Hidden ones are left out: what other systems keep beside each file has its suffix, too. So are
    the loops of libraries.

    Parameters
    ----------
    sources : sequence of Path
        Absolute, their folders without links and "..".
    besides : Path
        A folder to leave out.

    Returns
    -------
    captures : dict
        Files by their paths below what the sources have in common, with slashes, sorted.
    faults : list of OSError
        Folders further down that cannot be read.

    Raises
    ------
    OSError
        If a source cannot be read, or there is no capture.
    ValueError
        If a source is a file of another type.
    """
    found: set[Path] = set()
    faults: list[OSError] = []
    for source in sources:
        if source.is_dir():
            os.listdir(source)
            found.update(_below(source, besides, faults))
        else:
            source.stat()
            if source.suffix.lower() not in suffixes_of(readers):
                known = in_words(readers)
                raise ValueError(f"expected a folder, {known}, found {source.name!r}")
            found.add(source)
    if not found:
        named = ", ".join(map(str, sources))
        text = f"expected {in_words(readers)} files, found none"
        raise FileNotFoundError(errno.ENOENT, text, named)
    root = os.path.commonpath([s if s.is_dir() else s.parent for s in sources])
    return {path.relative_to(root).as_posix(): path for path in sorted(found)}, faults


def _is_library(folder: Path, files: Sequence[str]) -> bool:
    """Tell whether a folder is a library, whose loops are no captures."""
    if LOG not in files:
        return False
    try:
        with (folder / LOG).open("rb") as log:
            return log.read(len(SEAL)) == SEAL
    except OSError:
        return False


def _below(top: Path, besides: Path, faults: list[OSError]) -> list[Path]:
    found, suffixes = [], suffixes_of(readers)
    for place, folders, files in os.walk(top, onerror=faults.append):
        here = Path(place)
        ours = LOOPS if _is_library(here, files) else ""
        folders[:] = [
            f for f in folders if not f.startswith(".") and f != ours and here / f != besides
        ]
        found += [
            here / file
            for file in files
            if not file.startswith(".") and file.lower().endswith(suffixes)
        ]
    return found
