"""Whether another roundelay makes the same loops: records and files of both, to 1e-12.

Usage: python -m benchmarks.unchanged --data FOLDER --before ROUNDELAY [--captures 20] [--json]

ROUNDELAY is the command of another installation, say of the state before a change. Both run
``roundelay loop CAPTURE --no-picture`` on captures spread over the folder's sources. Exit status,
files, records (but what was asked for), loops and, where nothing is found, the reason are
compared; every difference is printed.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator
from itertools import chain, zip_longest
from pathlib import Path
from typing import Any

from benchmarks._harness import Target, parser, report

TOLERANCE = 1e-12
ASIDE = ("options", "sampling", "roundelay")
NOW = Path(sys.executable).with_name("roundelay")
TARGETS = (
    Target("captures", ">=", 20, "captures looped by both"),
    Target("different", "<=", 0, "captures whose records or loops differ"),
)


def main() -> None:
    options = parser(__doc__, data="folder of captures")
    options.add_argument("--before", type=Path, required=True, help="the other command")
    options.add_argument("--captures", type=int, default=20, help="how many")
    arguments = options.parse_args()
    rows = [
        row(path, path.relative_to(arguments.data), arguments.before)
        for path in spread(arguments.data, arguments.captures)
    ]
    summary = {
        "captures": len(rows),
        "loops": sum(one["loops"] for one in rows),
        "refused": sum(one["status"] != 0 for one in rows),
        "different": sum(bool(one["differences"]) for one in rows),
    }
    result = {"summary": summary, "rows": rows}
    report("unchanged", result, TARGETS, arguments, table=chain.from_iterable(map(lines, rows)))


def spread(folder: Path, count: int) -> list[Path]:
    """Take captures of the folder's sources in turn, those in the middle of each first."""
    sources: dict[tuple[str, ...], list[Path]] = defaultdict(list)
    for path in sorted(folder.rglob("*")):
        if path.suffix.lower() in (".bvh", ".amc"):
            sources[path.parent.relative_to(folder).parts[:2]].append(path)
    turns = [paths[len(paths) // 2 :] + paths[: len(paths) // 2] for paths in sources.values()]
    return [path for turn in zip_longest(*turns) for path in turn if path is not None][:count]


def row(path: Path, name: Path, before: Path) -> dict[str, Any]:
    """Loop a capture with both commands and compare what they wrote."""
    with tempfile.TemporaryDirectory() as first, tempfile.TemporaryDirectory() as second:
        old, new = looped(before, path, Path(first)), looped(NOW, path, Path(second))
    return {
        "capture": str(name),
        "status": new["status"],
        "loops": sum(not file.endswith(".json") for file in new["files"]),
        "differences": list(differences(old, new)),
    }


def looped(command: Path, capture: Path, folder: Path) -> dict[str, Any]:
    """Return the exit status, what was written, and what was said where nothing was found."""
    words = [command, "loop", capture.resolve(), "--no-picture", "-o", "out"]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    return {
        "status": done.returncode,
        "said": done.stderr if done.returncode else "",
        "files": {path.name: content(path) for path in sorted((folder / "out").glob("*"))},
    }


def content(path: Path) -> Any:
    """A record without what is left aside; the words and numbers of a loop."""
    text = path.read_text()
    if path.suffix != ".json":
        return [as_number(word) for word in text.split()]
    return json.loads(text)


def as_number(word: str) -> str | float:
    try:
        return float(word)
    except ValueError:
        return word


def differences(old: Any, new: Any, place: str = "") -> Iterator[str]:
    """Say where two results differ by more than the tolerance."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in dict.fromkeys([*old, *new]):
            if key in ASIDE:
                continue
            if key in old and key in new:
                yield from differences(old[key], new[key], f"{place}/{key}")
            else:
                yield f"{place}/{key}: only {'before' if key in old else 'now'}"
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for number, (one, other) in enumerate(zip(old, new, strict=True)):
            yield from differences(one, other, f"{place}/{number}")
    elif not same(old, new):
        yield f"{place}: {short(old)} before, {short(new)} now"


def same(old: Any, new: Any) -> bool:
    numbers = all(isinstance(x, int | float) and not isinstance(x, bool) for x in (old, new))
    if not numbers:
        return bool(old == new)
    return abs(old - new) <= TOLERANCE * max(1.0, abs(old)) or (old != old and new != new)


def short(value: Any) -> str:
    text = f"{len(value)} entries" if isinstance(value, list) else repr(value)
    return text if len(text) <= 100 else f"{text[:97]}..."


def lines(one: dict[str, Any]) -> Iterator[str]:
    found = one["differences"]
    told = f"status {one['status']}, {one['loops']} loops, {len(found)} differences"
    yield f"{one['capture']}: {told}"
    yield from (f"  {difference}" for difference in found)


if __name__ == "__main__":
    main()
