"""Read keypoints of animals from HDF5 files of DeepLabCut and SLEAP, by the library `movement`.

It comes with the extra ``animals`` and runs in a process of its own, see `roundelay.formats.apart`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from roundelay.base.errors import FormatError
from roundelay.base.files import content
from roundelay.formats.apart import Library, read_apart
from roundelay.formats.arrays import NpzReader
from roundelay.formats.contents import Contents
from roundelay.formats.options import ReadOptions
from roundelay.formats.point_files import (
    Notes,
    checked_size,
    made,
    of_one_body,
    rate_assumed,
    subjects_of,
)
from roundelay.formats.points import ChoosesPoints
from roundelay.motion.points import Points

__all__ = ["AnimalsReader"]

_MAGIC = b"\x89HDF\r\n\x1a\n"
_MOVEMENT = Library(
    name="movement",
    module="movement",
    extra="animals",
    child="roundelay.formats.animals_child",
    holds="keypoints of DeepLabCut or SLEAP",
)


class AnimalsReader(ChoosesPoints):
    """The reader of HDF5 files of DeepLabCut (``.h5``) and SLEAP (``.h5``, ``.slp``)."""

    name = "animals"
    suffixes = (".h5", ".slp")

    def read_points(self, path: Path, wanted: ReadOptions | None = None) -> Points:
        """Read an HDF5 file.

        Parameters
        ----------
        path : Path
        wanted : ReadOptions, optional
            Which animal; the one with most keypoints by default.

        Returns
        -------
        Points
            In pixels, with likelihoods.

        Raises
        ------
        FormatError
            If the file is not sound, or `movement` is not installed; the message says how to.
        OSError
            If it cannot be read.
        """
        found = _read_apart(path)
        checked_size(path, len(found), len(found.names))
        notes = Notes(path)
        seen = np.asarray(found.seen.any(axis=0)).tolist()
        character = wanted.character if wanted else None
        kept = of_one_body(found.names, seen, notes, character, least=1)
        places, likelihoods = found.to_array(), found.likelihoods
        return made(
            path,
            [found.names[number] for number in kept],
            places[:, kept],
            rate_assumed(path),
            notes=notes,
            likelihoods=None if likelihoods is None else likelihoods[:, kept],
            units="px",
            image=found.dimensions == 2,
        )

    def contents(self, path: Path) -> Contents:
        """List the animals of a file."""
        return Contents(characters=subjects_of(_read_apart(path).names))


def _read_apart(path: Path) -> Points:
    """Read a file in another process.

    Raises
    ------
    FormatError
        If there is no `movement`, or it cannot read the file, dies or takes too long.
    """
    data = content(path)
    if not data.startswith(_MAGIC):
        raise FormatError("expected an HDF5 file, found another, at byte 0", path=path)
    suffix = ".slp" if ".slp" in path.suffixes else ".h5"
    with read_apart(_MOVEMENT, path, data, suffix) as found:
        return NpzReader().read_points(found)
