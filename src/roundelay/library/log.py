"""The log of a library: what is done, which files are the library's own, one sealed line each.

A line is the *claim* of a clip, written before its loops are, its *entry*, written when they are
done, what a *run* did, a *group* of alike behaviours or its *name*. A claim lists the files of the
clip's folder that are not the library's, so that after a crash in between it is known which ones
are.
"""

from __future__ import annotations

import base64
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from roundelay.base.errors import FormatError
from roundelay.base.files import written_beside
from roundelay.compare.packed import Packed
from roundelay.compare.spectra import Body, Spectra
from roundelay.compare.thresholds import SPECTRA
from roundelay.library.sealed import FORMAT, OLDER, SEAL, sealed, unsealed

__all__ = ["ARRAYS", "LOG", "Claim", "Entry", "Log"]

LOG = "clips.jsonl"
ARRAYS: dict[str, Any] = {"means": np.float32, "waves": np.complex64, "reflections": np.float32}


@dataclass(frozen=True, eq=False)
class Entry:
    """What is known of a clip.

    Attributes
    ----------
    record : dict
        For people and programs; its name is under ``file``, its files with their sizes and
        checksums under ``files``.
    stamp : dict or None
        The version of the file that was read.
    spectra : Spectra or None
        One a cycle, then one a segment that shows none.
    """

    record: dict[str, Any]
    stamp: dict[str, Any] | None
    spectra: Spectra | None = None

    @property
    def name(self) -> str:
        """The clip's name."""
        return str(self.record["file"])


@dataclass(frozen=True)
class Claim:
    """What a clip's folder held before its loops were made.

    Attributes
    ----------
    name : str
        The clip's.
    owned : tuple of str
        Files of the library, by their paths below it.
    kept : tuple of str
        Files named as loops are that are not the library's.
    """

    name: str
    owned: tuple[str, ...] = ()
    kept: tuple[str, ...] = ()


class Log:
    """The entries of clips by their names, each on disk as soon as it is known.

    Attributes
    ----------
    entries, claims : dict
        Of clips by their names.
    files : dict of dict
        The files of clips that are to be done again, with sizes and checksums.
    unfinished : set of str
        Clips that were claimed, and whose process ended before they were done.
    runs : list of dict
        What each run did.
    groups : dict
        Examples of groups of alike behaviours, by the groups' numbers.
    names : dict
        What a person called groups, by their numbers; None for a name that was taken back.
    damaged : int
        How many lines are not as they were written; they are left out.
    older : int
        How many lines are of an older format.

    Raises
    ------
    FormatError
        If there is a file of this name that is none, or of another version.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / LOG
        self.entries: dict[str, Entry] = {}
        self.claims: dict[str, Claim] = {}
        self.files: dict[str, dict[str, Any]] = {}
        self.runs: list[dict[str, Any]] = []
        self.groups: dict[int, Packed] = {}
        self.names: dict[int, str | None] = {}
        self.damaged = self.older = 0
        lines = self.path.read_bytes().split(b"\n") if self.path.exists() else []
        for line in filter(None, lines):
            self._take(unsealed(line))
        if self.damaged and not self.is_known:
            self._refuse(lines[0])
        lost = {name for name, entry in self.entries.items() if entry.stamp is None}
        self.unfinished = (self.claims.keys() - self.entries.keys() - self.files.keys()) | lost

    @property
    def is_known(self) -> bool:
        """Whether anything could be read from it."""
        return bool(self.entries or self.claims)

    def _take(self, line: dict[str, Any] | None) -> None:
        if line is None:
            self.damaged += 1
        elif line["format"] in OLDER:
            self._take_older(line)
        elif line["format"] != FORMAT:
            told = f"expected a library of format {FORMAT}, found {line['format']}"
            raise FormatError(f"{told}; use the roundelay that made it", path=self.path)
        elif "run" in line:
            self.runs.append(line["run"])
        elif "group" in line:
            self.groups[line["group"]] = _examples(line)
        elif "name" in line:
            self.names[line["named"]] = line["name"]
        elif "claim" in line:
            claim = Claim(*(_plain(part) for part in line["claim"]))
            self.claims[claim.name] = claim
            self.entries.pop(claim.name, None)
        else:
            entry = _entry(line)
            self.entries[entry.name] = entry

    def _take_older(self, line: dict[str, Any]) -> None:
        """Keep of an older format which files are the library's; what it knows is found anew."""
        self.older += 1
        if "claim" in line:
            claim = Claim(*(_plain(part) for part in line["claim"]))
            self.claims[claim.name] = claim
            self.files.pop(claim.name, None)
        elif "record" in line:
            name, files = line["record"]["file"], line["record"]["files"]
            kept = self.claims[name].kept if name in self.claims else ()
            self.claims[name] = Claim(name, tuple(files), kept)
            self.files[name] = files

    def _refuse(self, first: bytes) -> None:
        """Refuse a file of another program; what a crash left of the first line is none."""
        if not first.startswith(SEAL):
            told = f"expected a library of format {FORMAT}, found something else"
            raise FormatError(f"{told}; give another folder, or move it away", path=self.path)

    def renew(self, names: Iterable[str]) -> None:
        """Forget the entries of some clips, and write what is left anew.

        Which files are the library's is not forgotten.
        """
        for name in names:
            entry = self.entries.pop(name, None)
            if entry is not None:
                self.files[name] = entry.record["files"]
                kept = self.claims[name].kept if name in self.claims else ()
                self.claims[name] = Claim(name, tuple(entry.record["files"]), kept)
        with written_beside(self.path, durable=True) as part:
            part.write_bytes(b"".join(self._lines()))

    def _lines(self) -> Iterator[bytes]:
        yield from map(_run_line, self.runs)
        yield from (_group_line(number, one) for number, one in self.groups.items())
        yield from (_name_line(number, name) for number, name in self.names.items())
        for claim in self.claims.values():
            yield _claim_line(claim)
            if claim.name in self.entries:
                yield _entry_line(self.entries[claim.name])

    def claim(self, claim: Claim) -> None:
        """Write down what is the library's before a clip is done."""
        self.claims[claim.name] = claim
        self.entries.pop(claim.name, None)
        self._append(_claim_line(claim))

    def add(self, entry: Entry) -> None:
        """Add the entry of a clip that was claimed."""
        self.entries[entry.name] = entry
        self._append(_entry_line(entry))

    def add_run(self, run: dict[str, Any]) -> None:
        """Add what a run did."""
        self.runs.append(run)
        self._append(_run_line(run))

    def found(self, groups: Mapping[int, Packed]) -> None:
        """Add examples of new groups, by their numbers."""
        self.groups |= groups
        if groups:
            self._append(b"".join(_group_line(number, one) for number, one in groups.items()))

    def name(self, group: int, name: str | None) -> None:
        """Add what a person calls a group."""
        self.names[group] = name
        self._append(_name_line(group, name))

    def _append(self, line: bytes) -> None:
        """Add a line, on the disk before anything else happens."""
        try:
            with self.path.open("ab") as file:
                file.write(line)
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            error.filename = str(self.path)
            raise


def _run_line(run: dict[str, Any]) -> bytes:
    return sealed({"run": run}) + b"\n"


def _name_line(group: int, name: str | None) -> bytes:
    return sealed({"named": group, "name": name}) + b"\n"


def _group_line(group: int, examples: Packed) -> bytes:
    packed = base64.b64encode(examples.values.tobytes()).decode()
    body = {"joints": examples.body.joints, "partners": examples.body.partners}
    return sealed({"group": group, **body, "values": packed}) + b"\n"


def _examples(line: dict[str, Any]) -> Packed:
    body = Body(tuple(line["joints"]), tuple(line["partners"]))
    values = np.frombuffer(base64.b64decode(line["values"]), np.float32)
    return Packed(body, values.reshape(-1, 3 * len(body.joints) * (1 + 2 * SPECTRA.harmonics)))


def _claim_line(claim: Claim) -> bytes:
    return sealed({"claim": [claim.name, claim.owned, claim.kept]}) + b"\n"


def _plain(part: Any) -> Any:
    return tuple(part) if isinstance(part, list) else part


def _entry_line(entry: Entry) -> bytes:
    packed = None if entry.spectra is None else _packed(entry.spectra)
    line = {"record": entry.record, "stamp": entry.stamp, "signatures": packed}
    return sealed(line) + b"\n"


def _entry(line: dict[str, Any]) -> Entry:
    packed = line["signatures"]
    return Entry(line["record"], line["stamp"], None if packed is None else _unpacked(packed))


def _packed(spectra: Spectra) -> dict[str, Any]:
    body = spectra.body
    arrays = {name: base64.b64encode(getattr(spectra, name).tobytes()).decode() for name in ARRAYS}
    return {"joints": body.joints, "partners": body.partners, **arrays}


def _unpacked(packed: dict[str, Any]) -> Spectra:
    body = Body(tuple(packed["joints"]), tuple(packed["partners"]))
    array = {
        name: np.frombuffer(base64.b64decode(packed[name]), kind) for name, kind in ARRAYS.items()
    }
    count, joints = array["reflections"].size // 3, len(body.joints)
    return Spectra(
        body,
        array["means"].reshape(count, joints, 3),
        array["waves"].reshape(count, -1, joints, 3),
        array["reflections"].reshape(count, 3),
    )
