"""Which captures there are below some folders, and what each is called."""

from __future__ import annotations

import errno
import os
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from roundelay.base.files import unpacked
from roundelay.formats import in_words, is_capture, readers, suffixes_of
from roundelay.library.log import LOG
from roundelay.library.sealed import SEAL

# Formats of motion, whether there is a reader of them or not.
_OTHERS = {
    *(".abc", ".anim", ".bip", ".blend", ".bvh", ".amc", ".c3d", ".dae", ".fbx", ".gltf", ".glb"),
    *(".hanim", ".htr", ".ma", ".mb", ".mot", ".mvn", ".mvnx", ".sto", ".tak", ".trc"),
    *(".uasset", ".usd", ".usda", ".usdc", ".usdz", ".vmd", ".vrm", ".vrma"),
}

__all__ = ["LOOPS", "Found", "files_not_read", "find_captures"]

LOOPS = "loops"
"""The folder of a library that holds the loops."""
# What lies beside a capture and is read with it.
_PARTS = (".asf", ".bin")


@dataclass(frozen=True)
class Found:
    """What there is below some folders.

    Attributes
    ----------
    captures : dict
        Files by their paths below what the sources have in common, with slashes, sorted.
    faults : list of OSError
        Folders further down that cannot be read.
    passed : dict
        How many files of each kind are no captures: by suffix without its dot.
    """

    captures: dict[str, Path]
    faults: list[OSError]
    passed: dict[str, int]


def find_captures(sources: Sequence[Path], besides: Path | None = None) -> Found:
    """List the files that a reader knows, packed or not, among files and below folders.

    Hidden ones are left out: what other systems keep beside each file has its suffix, too. So are
    the loops of libraries, where a folder to leave out is given.

    Parameters
    ----------
    sources : sequence of Path
        Absolute, their folders without links and "..".
    besides : Path, optional
        A folder to leave out.

    Returns
    -------
    Found

    Raises
    ------
    OSError
        If a source cannot be read, or there is no capture.
    ValueError
        If a source is a file of another type.
    """
    found: set[Path] = set()
    faults: list[OSError] = []
    others: list[Path] = []
    for source in sources:
        if source.is_dir():
            os.listdir(source)
            below, left = _below(source, is_capture, faults, besides)
            found.update(below)
            others += left
        else:
            source.stat()
            if _suffix(source) not in suffixes_of(readers):
                known = in_words(readers)
                raise ValueError(f"expected a folder, {known}, found {source.name!r}")
            found.add(source)
    if not found:
        named = ", ".join(map(str, sources))
        text = f"expected {in_words(readers)} files, found none"
        raise FileNotFoundError(errno.ENOENT, text, named)
    root = os.path.commonpath([s if s.is_dir() else s.parent for s in sources])
    captures = {path.relative_to(root).as_posix(): path for path in sorted(found)}
    counts = Counter(_suffix(path)[1:] or "no suffix" for path in set(others) - found)
    return Found(captures, faults, dict(sorted(counts.items())))


def _is_library(folder: Path, files: Sequence[str]) -> bool:
    """Tell whether a folder is a library, whose loops are no captures."""
    if LOG not in files:
        return False
    try:
        with (folder / LOG).open("rb") as log:
            return log.read(len(SEAL)) == SEAL
    except OSError:
        return False


def files_not_read(folder: Path) -> list[Path]:
    """List the files below a folder that hold motion, by their suffix, and have no reader."""
    suffixes = _OTHERS - set(suffixes_of(readers))
    return sorted(_below(folder, lambda path: _suffix(path) in suffixes, [])[0])


def _suffix(path: Path) -> str:
    return unpacked(path).suffix.lower()


def _below(
    top: Path,
    wanted: Callable[[Path], bool],
    faults: list[OSError],
    besides: Path | None = None,
) -> tuple[list[Path], list[Path]]:
    """Return the files below a folder that are wanted, and the others."""
    found: list[Path] = []
    others: list[Path] = []
    for place, folders, files in os.walk(top, onerror=faults.append):
        here = Path(place)
        # Where a library is made, those of others are no captures.
        library = besides is not None and _is_library(here, files)
        ours = LOOPS if library else ""
        folders[:] = [
            f for f in folders if not f.startswith(".") and f != ours and here / f != besides
        ]
        visible = [here / file for file in files if not file.startswith(".")]
        for file in visible:
            if wanted(file):
                found.append(file)
            elif not library and _suffix(file) not in _PARTS:
                others.append(file)
    return found, others
