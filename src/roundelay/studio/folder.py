"""The folder that holds takes and work, and what may be put into it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from roundelay.base.errors import FormatError, Locked
from roundelay.base.files import fitting, is_part, name_of
from roundelay.base.texts import shown
from roundelay.formats import readers, suffixes_of
from roundelay.output.records import write_json
from roundelay.studio.work import ENDING, Work, read_work

__all__ = ["Folder"]

# Bytes of a name.
_LONGEST = 120
# What a take may need beside it: the skeleton of an AMC, the numbers of a glTF.
_BESIDES = (".asf", ".bin")


@dataclass
class Folder:
    """Where takes and work are kept.

    Parameters
    ----------
    path : Path
        Made if need be.
    """

    path: Path

    def __post_init__(self) -> None:
        self.path = self.path.resolve()
        self.path.mkdir(parents=True, exist_ok=True)

    def takes(self) -> list[dict[str, Any]]:
        """List the takes, by name: ``name``, ``bytes``, and whether there is ``work``."""
        suffixes = suffixes_of(readers)
        found = sorted(path for path in self.path.iterdir() if _is_take(path, suffixes))
        return [
            {
                "name": path.name,
                "bytes": path.stat().st_size,
                "work": self._work_path(path.name).is_file(),
            }
            for path in found
        ]

    def place(self, name: str) -> Path:
        """Return the path of a file of that name.

        Raises
        ------
        ValueError
            If the name would lead out of the folder, or is hidden, or is of no known format.
        """
        known = (*suffixes_of(readers), *_BESIDES)
        inside = name == Path(name).name and not name.startswith(".") and "\\" not in name
        if not inside or shown(name) != name:
            raise ValueError(f"expected the name of a file, found {shown(name)!r:.80}")
        if not name.lower().endswith((*known, *(f"{one}.gz" for one in known))):
            raise ValueError(
                f"{name}: expected a file of type {', '.join(known)}, found another one"
            )
        stem, dot, suffix = name.partition(".")
        return self.path / fitting(stem, dot + suffix, _LONGEST)

    def existing(self, name: str) -> Path:
        """Return the path of a take.

        Raises
        ------
        ValueError
            If there is none, or the name is no name of a take.
        """
        path = self.place(name)
        if not path.is_file():
            raise ValueError(f"{name}: expected a take in {self.path}, found none of that name")
        return path

    def work(self, name: str) -> tuple[dict[str, Any] | None, int]:
        """Return the work of a take as plain data, None if there is none, and its revision.

        Raises
        ------
        FormatError
            If its file is no work.
        """
        path, revision = self._work_path(name), self._revision(name)
        try:
            return read_work(path).to_dict(), revision
        except FileNotFoundError:
            return None, revision
        except FormatError as error:
            told = f"{error.message}; move it away, or mend it"
            raise FormatError(told, path=path.name) from None

    def keep(self, name: str, data: Any, revision: int) -> int:
        """Write the work of a take, and return its new revision.

        Parameters
        ----------
        name : str
            Of the take.
        data : dict
        revision : int
            That it was made from.

        Raises
        ------
        Locked
            If another window has written since.
        ValueError
            If it is no work.
        OSError
            If it cannot be written.
        """
        self.existing(name)
        Work.of_dict(data)
        path, now = self._work_path(name), self._revision(name)
        if revision != now:
            raise Locked(
                f"{path.name}: expected revision {revision}, found {now}: another window has "
                "changed this work; open the take again to go on from there"
            )
        write_json(data, path)
        return self._revision(name)

    def _work_path(self, name: str) -> Path:
        return self.path / f"{name_of(Path(name))}{ENDING}"

    def _revision(self, name: str) -> int:
        """Return a number that changes whenever the work is written, by whomever."""
        try:
            return self._work_path(name).stat().st_mtime_ns // 1000
        except FileNotFoundError:
            return 0


def _is_take(path: Path, suffixes: tuple[str, ...]) -> bool:
    named = path.name.lower().removesuffix(".gz")
    own = named.endswith(suffixes) and not named.endswith((ENDING, "_segments.csv"))
    return own and path.is_file() and not is_part(path.name) and not path.name.startswith(".")
