"""Fetch the captures of the CMU database that a paper's tables name, for people with a network.

Usage: python -m benchmarks.fetch_cmu --table A|B|C [--out FOLDER] [--from ADDRESS]

Files go to FOLDER/acclaim/SS/, where the benchmarks look for them below ``--data``. A file that
is there whole is left alone; one that was cut off is gone on with; each is written beside its name
and renamed when it is whole. FOLDER/SHA256SUMS holds a line a file, as ``sha256sum --check`` reads
it: a file that no longer matches its line is told and not touched. The data are free for research
and commercial projects: "The data used in this project was obtained from mocap.cs.cmu.edu. The
database was created with funding from NSF EIA-0196217."
"""

from __future__ import annotations

import argparse
import hashlib
import sys
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

from benchmarks.paper_tables import TRIALS

SOURCE = "http://mocap.cs.cmu.edu/subjects"
SUMS = "SHA256SUMS"
BLOCK = 1 << 16
TIMEOUT = 60.0
MOST = 1 << 28
"""Bytes of one file: the longest of the database is far below."""


def main(words: list[str] | None = None) -> int:
    options = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    options.add_argument("--table", choices=sorted(TRIALS), required=True, help="whose captures")
    options.add_argument("--out", type=Path, default=Path("data/cmu"), help="the folder cmu")
    options.add_argument("--from", dest="source", default=SOURCE, help="address of the subjects")
    arguments = options.parse_args(words)
    failed = 0
    for name in names(arguments.table):
        try:
            told = fetched(arguments.source, name, arguments.out)
        except (OSError, ValueError) as error:
            told, failed = f"failed: {error}", failed + 1
        print(f"{name}: {told}", flush=True)
    if failed:
        print(f"{failed} files are missing; run it again to go on", file=sys.stderr)
    return 1 if failed else 0


def names(table: str) -> list[str]:
    """The files of a table below the address, skeletons first: 02/02.asf, 02/02_03.amc."""
    subjects = sorted({trial.partition("_")[0] for trial in TRIALS[table]})
    trials = sorted(set(TRIALS[table]))
    motions = [f"{trial.partition('_')[0]}/{trial}.amc" for trial in trials]
    return [*(f"{subject}/{subject}.asf" for subject in subjects), *motions]


def fetched(source: str, name: str, out: Path) -> str:
    """Make sure that a file is there; say what was done.

    Raises
    ------
    OSError
        If it cannot be had, or was cut off: what came stays beside it, for the next time.
    ValueError
        If it is there and is not what it was when it was fetched, or is no such file.
    """
    target = out / "acclaim" / name
    known = dict(_sums(out)).get(f"acclaim/{name}")
    if target.exists():
        found = digest(target)
        if known not in (None, found):
            raise ValueError(f"expected SHA-256 {known}, found {found}; remove it to fetch it anew")
        if known is None:
            _note(out, name, found)
        return "was there"
    part = target.with_name(f"{target.name}.part")
    part.parent.mkdir(parents=True, exist_ok=True)
    begun = _download(f"{source.rstrip('/')}/{name}", part)
    found = _checked(part, name, known)
    part.replace(target)
    if known is None:
        _note(out, name, found)
    return f"{'gone on with' if begun else 'fetched'}, {target.stat().st_size} bytes"


def _checked(part: Path, name: str, known: str | None) -> str:
    """Return the sum of a download; throw it away if it is none of these files.

    Raises
    ------
    ValueError
        If it begins like no capture or skeleton, or its sum is not the one that is known.
    """
    head, found = part.read_bytes()[:4096], digest(part)
    wanted = b":version" if name.endswith(".asf") else b":DEGREES"
    problem = ""
    if wanted.lower() not in head.lower():
        problem = f"expected {wanted.decode()!r} near its beginning, found {head[:40]!r}"
    elif known not in (None, found):
        problem = f"expected SHA-256 {known}, found {found}"
    if problem:
        part.unlink()
        raise ValueError(problem)
    return found


def _download(address: str, part: Path) -> bool:
    """Append what is missing to a file; tell whether some of it was there.

    Raises
    ------
    OSError
        If the address cannot be read, or its end is not reached.
    """
    there = part.stat().st_size if part.exists() else 0
    asked = urllib.request.Request(address, headers={"Range": f"bytes={there}-"} if there else {})
    try:
        answer = urllib.request.urlopen(asked, timeout=TIMEOUT)
    except urllib.error.HTTPError as error:
        # Nothing is left of a file that is there whole.
        if error.code == 416 and there:
            return True
        raise OSError(f"{address}: {error.code} {error.reason}") from None
    with answer:
        resumed = answer.status == 206
        length = answer.headers.get("Content-Length")
        whole = None if length is None else int(length) + (there if resumed else 0)
        with part.open("ab" if resumed else "wb") as file:
            while block := answer.read(BLOCK):
                file.write(block)
                if file.tell() > MOST:
                    raise OSError(f"{address}: expected at most {MOST} bytes, found more")
    size = part.stat().st_size
    if whole is not None and size < whole:
        raise OSError(f"{address}: expected {whole} bytes, found {size}")
    return resumed


def digest(path: Path) -> str:
    """The SHA-256 of a file, in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _sums(out: Path) -> Iterator[tuple[str, str]]:
    path = out / SUMS
    for line in path.read_text().splitlines() if path.exists() else ():
        found, _, name = line.partition("  ")
        yield name, found


def _note(out: Path, name: str, found: str) -> None:
    """Add a file's sum, in order of names."""
    rows = dict(_sums(out)) | {f"acclaim/{name}": found}
    beside = out / f"{SUMS}.part"
    beside.write_text("".join(f"{rows[key]}  {key}\n" for key in sorted(rows)))
    beside.replace(out / SUMS)


if __name__ == "__main__":
    sys.exit(main())
