"""Naming the groups of a library."""

from __future__ import annotations

from os import PathLike

from roundelay.base.checks import as_path
from roundelay.base.locks import locked
from roundelay.library.catalogue import Library
from roundelay.library.log import Log
from roundelay.library.names import checked_name
from roundelay.library.writing import write_library

__all__ = ["name_group"]


def name_group(folder: str | PathLike[str], group: int, name: str | None) -> Library:
    """Say what a group of alike behaviours is called, in all clips, now and later.

    Parameters
    ----------
    folder : path-like
        Of the library.
    group : int
        The group's number.
    name : str or None
        None takes a name back.

    Returns
    -------
    Library
        As it is then.

    Raises
    ------
    ValueError
        If there is no such group, or the name is empty or more than one line.
    FormatError
        If the folder is no library.
    Locked
        If another run is at work on it.
    OSError
        If the library cannot be written.
    """
    folder = as_path(folder)
    name = None if name is None else checked_name(name)
    Library.open(folder)
    with locked(folder / "library.lock"):
        record = Library.open(folder).record
        if group not in {one["group"] for one in record["groups"]}:
            count = len(record["groups"])
            raise ValueError(f"expected one of the library's {count} groups, found {group}")
        log = Log(folder)
        log.name(group, name)
        names = [clip["file"] for clip in record["clips"]]
        waiting = record["waiting"]
        write_library([*names, *waiting], log, record["unread"], record["passed_over"], folder)
    return Library.open(folder)
