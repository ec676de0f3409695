"""Repeat the recorded cases with the wheels' kernels, where they run: ``python -m release.replay``.

Linux natively, and on a processor without AVX2; Linux on ARM under qemu; Windows under wine. What
the two other processors and systems need cannot be run here: `release.wheels` reads their files.
"""

from __future__ import annotations

import argparse
import os
import shutil
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.topology.recorded import CASES, RECORDED, asked, hashed

from release.targets import TARGETS, Target
from release.wheels import ROOT, ZIG, kernel
from roundelay.topology.kernel.compiled import _INTERFACE

__all__ = ["RUNNERS", "replayed"]

# By name of what runs: the target, and the command in front of the program.
RUNNERS = {
    "linux-x86_64": ("linux-x86_64", ()),
    "linux-x86_64 without AVX2": ("linux-x86_64", ("qemu-x86_64", "-cpu", "Westmere")),
    "linux-aarch64": ("linux-aarch64", ("qemu-aarch64", "-L", "/usr/aarch64-linux-gnu")),
    "win-amd64": ("win-amd64", ("wine64",)),
}
PACKAGES = "apt-get install qemu-user libc6-arm64-cross wine64 wine"
_WINE = "/usr/lib/wine"  # where Debian has wine64
_SECONDS = 300


def main() -> None:
    """Run all; a case that is answered otherwise is an exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--wheels", type=Path, default=ROOT / "dist")
    folder = parser.parse_args().wheels
    wrong = 0
    for name in RUNNERS:
        told = replayed(name, folder)
        wrong += len(told)
        print(f"{name}: {len(CASES)} cases repeated to the bit" if not told else f"{name}: {told}")
    sys.exit(bool(wrong))


def replayed(name: str, wheels: Path) -> list[str]:
    """Return what is answered otherwise than recorded, by one of `RUNNERS`."""
    which, runner = RUNNERS[name]
    (target,) = (one for one in TARGETS if one.name == which)
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        binary = folder / f"kernel{target.suffix}"
        binary.write_bytes(kernel(target.wheel(wheels)))
        (folder / "cases").write_bytes(b"".join(map(asked, CASES.values())))
        words = (*_found(runner), _program(target), f"./{binary.name}", "cases", "answers")
        told = _run(words, folder)
        if told != f"interface {_INTERFACE}":
            return [f"expected interface {_INTERFACE}, found {told}"]
        answers = _split((folder / "answers").read_bytes())
    return [
        f"{case}: expected {RECORDED[case]}, found {found}"
        for case, found in zip(RECORDED, map(hashed, answers), strict=True)
        if found != RECORDED[case]
    ]


def _found(runner: tuple[str, ...]) -> tuple[str, ...]:
    """Return a command with the place of its program."""
    if not runner:
        return ()
    program = shutil.which(runner[0], path=f"{os.environ['PATH']}{os.pathsep}{_WINE}")
    if program is None:
        raise SystemExit(f"expected {runner[0]}, found none: {PACKAGES}")
    return (program, *runner[1:])


def _program(target: Target) -> Path:
    """Compile the program that loads a kernel."""
    made = ROOT / "build" / "replay" / f"replay-{target.name}{'.exe' * (target.suffix == '.dll')}"
    made.parent.mkdir(parents=True, exist_ok=True)
    source = Path(__file__).with_name("replay.c")
    libraries = ["-ldl"] if target.suffix == ".so" else []
    words = ["-target", target.zig, "-O2", "-s", "-o", made, source, *libraries]
    subprocess.run([ZIG, "cc", *words], check=True)
    return made


def _run(command: tuple[str | Path, ...], folder: Path) -> str:
    """Return what the program says, of its failure, too."""
    done = subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, "WINEDEBUG": "-all"},
        capture_output=True,
        text=True,
        check=False,
        timeout=_SECONDS,
    )
    return done.stdout.strip() if done.returncode == 0 else f"{done.stdout}{done.stderr}".strip()


def _split(answers: bytes) -> list[bytes]:
    """Split what the program wrote: each answer with its length in front."""
    parts, place = [], 0
    while place < len(answers):
        (length,) = struct.unpack_from("<q", answers, place)
        parts.append(answers[place + 8 : place + 8 + length])
        place += 8 + length
    return parts


if __name__ == "__main__":
    main()
