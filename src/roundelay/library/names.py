"""Names of groups: given by a person, else suggested by likeness or by names of files."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from math import log
from pathlib import PurePosixPath
from typing import Any

__all__ = ["checked_name", "named_by_files", "resolved", "words_of"]

_WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
_SHORTEST, _LONGEST = 3, 100


def words_of(name: str) -> set[str]:
    """Return the words of a name: at least three letters, in small ones."""
    return {word.lower() for word in _WORD.findall(name) if len(word) >= _SHORTEST}


def named_by_files(clips: Sequence[dict[str, Any]]) -> dict[int, str]:
    """Return what files are called whose clips show a group, else their folders: by its number.

    It is a word that at least half of the group's clips share, two at least, and that few others
    are called by: the larger share, times the logarithm of its rareness, wins.
    """
    members: dict[int, set[str]] = {}
    for clip in clips:
        for one in (*clip["cycles"], *clip["segments"]):
            members.setdefault(one["group"], set()).add(clip["file"])
    paths = [PurePosixPath(clip["file"]) for clip in clips]
    files = {str(path): words_of(path.name.partition(".")[0]) for path in paths}
    folders = {str(path): words_of(path.parent.name) for path in paths}
    return _shared(members, folders) | _shared(members, files)


def _shared(members: Mapping[int, set[str]], words: Mapping[str, set[str]]) -> dict[int, str]:
    """Return the word that most members of each group share, if one tells anything."""
    total = Counter(word for own in words.values() for word in own)
    rare = {word: log(len(words) / count) for word, count in total.items()}
    found = {}
    for group, files in members.items():
        counts = Counter(word for file in files for word in words[file])
        shared = {word: count for word, count in counts.items() if 2 * count >= len(files)}
        shared = {word: count for word, count in shared.items() if count > 1 and rare[word] > 0}
        if shared:
            found[group] = min(shared, key=lambda word: (-shared[word] * rare[word], word))
    return found


def checked_name(name: str) -> str:
    """Return a name that a person gives, without spaces at its ends.

    Raises
    ------
    ValueError
        If it is empty, long, or more than one line.
    """
    name = name.strip()
    if not 1 <= len(name) <= _LONGEST or not name.isprintable():
        raise ValueError(f"expected a name of 1 to {_LONGEST} letters in one line, found {name!r}")
    return name


def resolved(
    given: Mapping[int, str], alike: Mapping[int, str], files: Mapping[int, str], group: int
) -> tuple[str | None, str | None]:
    """Return the name of a group and who gave it: a person, likeness or files."""
    for names, by in ((given, "person"), (alike, "likeness"), (files, "files")):
        if group in names:
            return names[group], by
    return None, None
