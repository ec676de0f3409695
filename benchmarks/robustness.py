"""Truncated, damaged and odd files: a motion or one FormatError, nothing else.

Usage: python -m benchmarks.robustness --data FOLDER [--json] [--keep] [--mutations N]

Reads evenly spaced prefixes and random mutations of a BVH, an AMC and an ASF, and every file of
the folder's odd/, in a process with limits on time (10 s a file) and memory (4 GB).
"""

from __future__ import annotations

import tempfile
import warnings
from collections import Counter
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

import roundelay as rl
from benchmarks import sandbox
from benchmarks._harness import Target, parser, report

PREFIXES = 300
TARGETS = (
    Target("other", "<=", 0, "files that raise anything but FormatError, or end the process"),
    Target("hang", "<=", 0, "files that take longer than the limit"),
)
SECONDS = 10.0
INSERTED = (
    b"nan inf 1e999 1_0 0x1F -- { } ( ) : # // JOINT ROOT End OFFSET CHANNELS MOTION Frames: "
    b"root begin end dof limits :root :hierarchy 999999999999 -1 0 \x00 \xff \xef\xbb\xbf \n \r"
).split(b" ")


def main() -> None:
    options = parser(__doc__, data="folder that holds cmu/ and odd/")
    options.add_argument("--mutations", type=int, default=2000, help="of all files together")
    arguments = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        result = _measure(arguments.data, Path(folder), arguments.mutations)
    told = {"summary": result["all"], **result}
    table = (f"{name}: {found}" for name, found in result.items())
    report("robustness", told, TARGETS, arguments, table=table)


def _measure(data: Path, folder: Path, mutations: int) -> dict[str, dict[str, int]]:
    result: dict[str, Counter[str]] = {}
    amc = data / "cmu" / "acclaim" / "35" / "35_17.amc"
    asf = amc.with_name("35.asf")
    work = partial(_outcome, str(folder), str(amc), str(asf))
    rng = np.random.default_rng(0)
    for path in (data / "cmu" / "bvh" / "35_26.bvh", amc, asf):
        whole = path.read_bytes()
        for kind, inputs in (
            ("prefixes", _prefixes(whole)),
            ("mutations", _mutations(whole, mutations // 3 + 1, rng)),
        ):
            pieces = ((path.suffix, piece) for piece in inputs)
            result[f"{kind} of {path.name}"] = Counter(sandbox.run(work, pieces, SECONDS))
    for path in sorted((data / "odd").iterdir()):
        one = [(path.suffix, path.read_bytes())]
        result[f"odd {path.name}"] = Counter(sandbox.run(work, one, SECONDS))
    total = sum(result.values(), Counter())
    kinds = ("motion", "FormatError", "hang")
    summary = {kind: total[kind] for kind in kinds}
    summary["other"] = sum(count for kind, count in total.items() if kind not in kinds)
    return {name: dict(found) for name, found in result.items()} | {"all": summary}


def _outcome(folder: str, amc: str, asf: str, one: tuple[str, bytes]) -> str:
    """Read a piece as the file its suffix says, the other half of an AMC and ASF left whole."""
    warnings.simplefilter("error", RuntimeWarning)
    warnings.simplefilter("ignore", rl.RoundelayWarning)
    suffix, content = one
    path = Path(folder) / f"piece{suffix}"
    path.write_bytes(content)
    try:
        if suffix == ".asf":
            rl.read(amc, skeleton=path)
        elif suffix == ".amc":
            rl.read(path, skeleton=asf)
        else:
            rl.read(path)
    except rl.FormatError:
        return "FormatError"
    except Exception as error:
        return f"{type(error).__name__}: {error}"[:200]
    return "motion"


def _prefixes(whole: bytes) -> Iterator[bytes]:
    for stop in np.linspace(0, len(whole) - 1, PREFIXES).astype(int):
        yield whole[:stop]


def _mutations(whole: bytes, count: int, rng: np.random.Generator) -> Iterator[bytes]:
    """Yield the file with one to three random changes, half of them in its first 4000 bytes."""
    for _ in range(count):
        changed = whole
        for _ in range(rng.integers(1, 4)):
            reach = min(len(changed), 4000) if rng.random() < 0.5 else len(changed)
            at = int(rng.integers(reach + 1))
            changed = _changed(changed, at, rng)
        yield changed


def _changed(text: bytes, at: int, rng: np.random.Generator) -> bytes:
    length = int(rng.integers(1, 200))
    match rng.integers(5):
        case 0:
            return text[:at] + bytes([rng.integers(256)]) + text[at + 1 :]
        case 1:
            return text[:at] + text[at + length :]
        case 2:
            return text[:at] + text[at : at + length] * 2 + text[at + length :]
        case 3:
            return text[:at] + b" " + INSERTED[rng.integers(len(INSERTED))] + b" " + text[at:]
        case _:
            other = int(rng.integers(len(text) + 1))
            return text[:at] + text[other : other + length] + text[at + length :]


if __name__ == "__main__":
    main()
