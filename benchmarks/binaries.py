"""What is given out: six wheels read, run where they can be, built twice, and Blender's zip.

Usage: make wheels blender-extension, then python -m benchmarks.binaries [--json] [--keep]

``targets`` tells of each wheel its size, hashes of both builds and what was read of its kernel;
``replayed``, in how many recorded cases the kernel answered otherwise, by where it ran: natively,
on a processor without AVX2, under qemu-user and wine64 (make wheels-test names the packages).
"""

from __future__ import annotations

import dataclasses
import hashlib
import zipfile
from pathlib import Path
from typing import Any

from benchmarks._harness import ROOT, Target, parser, report

DIST = ROOT / "dist"
ZIP = "roundelay-blender.zip"

TARGETS = (
    Target("wheels", "==", 6, "wheels without a fault"),
    Target("same_twice", "==", 6, "wheels of the same bytes when built again elsewhere"),
    Target("replayed", "==", 4, "machines on which all recorded cases are answered to the bit"),
    Target("zip.kernels", "==", 6, "kernels in Blender's zip, as in the wheels"),
    Target("zip.megabytes", "<=", 2, "size of Blender's zip"),
)


def main() -> None:
    arguments = parser(__doc__, data=None).parse_args()
    # They need what `make wheels` installs, which other benchmarks do without.
    from release import replay
    from release.targets import TARGETS as SYSTEMS

    rows = {one.name: _row(one) for one in SYSTEMS}
    replayed = {name: len(replay.replayed(name, DIST)) for name in replay.RUNNERS}
    summary = {
        "wheels": sum(not row["faults"] for row in rows.values()),
        "same_twice": sum(row["sha256"] == row["sha256_again"] for row in rows.values()),
        "wheel_kilobytes": {name: round(row["bytes"] / 1e3) for name, row in rows.items()},
        "kernel_kilobytes": {name: round(row["kernel_bytes"] / 1e3) for name, row in rows.items()},
        "replayed": sum(not wrong for wrong in replayed.values()),
        "zip": _zip(rows),
    }
    table = (f"{name}  {row['bytes']}  {row['sha256'][:16]}" for name, row in rows.items())
    result = {"summary": summary, "targets": rows, "replayed": replayed}
    report("binaries", result, TARGETS, arguments, table=table)


def _row(target: Any) -> dict[str, Any]:
    from release import binaries, wheels

    wheel, again = target.wheel(DIST), target.wheel(wheels.AGAIN)
    data = wheels.kernel(wheel)
    told = dataclasses.asdict(binaries.read(data, target))
    return {
        "wheel": wheel.name,
        "bytes": wheel.stat().st_size,
        "kernel_bytes": len(data),
        "kernel_sha256": _hash(data),
        "sha256": _hash(wheel.read_bytes()),
        "sha256_again": _hash(again.read_bytes()),
        "faults": wheels.checked(target, DIST),
        **told,
        "functions": len(told["functions"] & binaries.FUNCTIONS),
    }


def _zip(rows: dict[str, Any]) -> dict[str, Any]:
    """Return the size of Blender's zip, and how many kernels in it are those of the wheels."""
    path, right = DIST / ZIP, {row["kernel_sha256"] for row in rows.values()}
    with zipfile.ZipFile(path) as outer:
        (name,) = (name for name in outer.namelist() if name.endswith(".whl"))
        with outer.open(name) as wheel, zipfile.ZipFile(wheel) as inner:
            found = [
                _hash(inner.read(part))
                for part in inner.namelist()
                if Path(part).name.startswith("_kernel-")
            ]
    return {"megabytes": round(path.stat().st_size / 1e6, 2), "kernels": len(right & set(found))}


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


if __name__ == "__main__":
    main()
