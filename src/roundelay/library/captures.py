"""Which captures there are below some folders, and what each is called."""

from __future__ import annotations

import errno
import os
from collections.abc import Collection, Sequence
from pathlib import Path

from roundelay.base.files import unpacked
from roundelay.formats import in_words, readers, suffixes_of
from roundelay.library.log import LOG
from roundelay.library.sealed import SEAL

# Formats of motion, whether there is a reader of them or not.
_OTHERS = {
    *(".abc", ".anim", ".bip", ".blend", ".bvh", ".amc", ".c3d", ".dae", ".fbx", ".gltf", ".glb"),
    *(".hanim", ".htr", ".ma", ".mb", ".mot", ".mvn", ".mvnx", ".sto", ".tak", ".trc"),
    *(".uasset", ".usd", ".usda", ".usdc", ".usdz", ".vmd", ".vrm", ".vrma"),
}

__all__ = ["LOOPS", "files_not_read", "find_captures"]

LOOPS = "loops"
"""The folder of a library that holds the loops."""


def find_captures(
    sources: Sequence[Path], besides: Path | None = None
) -> tuple[dict[str, Path], list[OSError]]:
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
            found.update(_below(source, suffixes_of(readers), faults, besides))
        else:
            source.stat()
            if not _is_of(source, suffixes_of(readers)):
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


def files_not_read(folder: Path) -> list[Path]:
    """List the files below a folder that hold motion, by their suffix, and have no reader."""
    suffixes = _OTHERS - set(suffixes_of(readers))
    return sorted(_below(folder, suffixes, []))


def _is_of(path: Path, suffixes: Collection[str]) -> bool:
    return unpacked(path).suffix.lower() in suffixes


def _below(
    top: Path, suffixes: Collection[str], faults: list[OSError], besides: Path | None = None
) -> list[Path]:
    found = []
    for place, folders, files in os.walk(top, onerror=faults.append):
        here = Path(place)
        # Where a library is made, those of others are no captures.
        ours = LOOPS if besides is not None and _is_library(here, files) else ""
        folders[:] = [
            f for f in folders if not f.startswith(".") and f != ours and here / f != besides
        ]
        visible = [here / file for file in files if not file.startswith(".")]
        found += [file for file in visible if _is_of(file, suffixes)]
    return found
