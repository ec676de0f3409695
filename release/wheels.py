"""Build the six wheels, twice, and check them: ``python -m release.wheels``.

The second time the sources lie elsewhere and nothing compiled of them is kept from the first, so
that equal bytes tell that the build can be repeated. Kernels are left in ``build/kernels``, where
``blender/build.py`` takes them from.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import ziglang

from release import binaries
from release.targets import TARGETS, Target

__all__ = ["AGAIN", "KERNELS", "checked", "kernel"]

ROOT = Path(__file__).resolve().parent.parent
ZIG = Path(ziglang.__file__).parent / "zig"
KERNELS = ROOT / "build" / "kernels"
AGAIN = ROOT / "build" / "wheels-again"
SOURCES = ("pyproject.toml", "README.md", "LICENSE", "cmake", "src")
_PLACE = "roundelay/topology/kernel/_kernel"
_POLICY = re.compile(r'consistent\s+with\s+the\s+following\s+platform\s+tag:\s+"(\w+)"')
_GLIBC = re.compile(r"manylinux_(\d+)_(\d+)_(\w+)")


def main() -> None:
    """Build into a folder, build again, compare, check; any fault is an exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, default=ROOT / "dist")
    folder = parser.parse_args().output
    with tempfile.TemporaryDirectory() as made:
        first, second = Path(made) / "first", Path(made) / "elsewhere" / "second"
        for source in (first, second):
            _copy(source)
        shutil.rmtree(AGAIN, ignore_errors=True)
        for source, output in ((first, folder), (second, AGAIN)):
            for target in TARGETS:
                _build(source, target, output)
    found = [(target, checked(target, folder)) for target in TARGETS]
    _keep_kernels(folder)
    for target, wrong in found:
        print(*_lines(target, folder, wrong), sep="\n")
    sys.exit(any(wrong for _, wrong in found))


def kernel(wheel: Path) -> bytes:
    """Return the one kernel that a wheel holds; pip builds a wheel without where none compiles."""
    with zipfile.ZipFile(wheel) as archive:
        names = [name for name in archive.namelist() if name.startswith(_PLACE)]
        if len(names) != 1:
            raise SystemExit(f"expected one kernel in {wheel}, found {len(names)}")
        return archive.read(names[0])


def checked(target: Target, folder: Path) -> list[str]:
    """Return what is wrong with the wheel for a target."""
    wheel = target.wheel(folder)
    try:
        wrong = list(binaries.faults(binaries.read(kernel(wheel), target), target))
    except ValueError as error:
        wrong = [str(error)]
    if target.platform.startswith("manylinux") and not _serves(told := _policy(wheel), target):
        wrong.append(f"expected {target.platform} or an older one of auditwheel, found {told}")
    if (again := _hash(target.wheel(AGAIN))) != _hash(wheel):
        wrong.append(f"expected the same bytes twice, found {_hash(wheel)} and {again}")
    return wrong


def _serves(platform: str | None, target: Target) -> bool:
    """Whether what a wheel needs, as auditwheel tells it, is no more than its tag promises."""
    needed, promised = _GLIBC.fullmatch(platform or ""), _GLIBC.fullmatch(target.platform)
    if not needed or not promised or needed[3] != promised[3]:
        return False
    return tuple(map(int, needed.groups()[:2])) <= tuple(map(int, promised.groups()[:2]))


def _policy(wheel: Path) -> str | None:
    """Return the oldest platform that auditwheel finds a wheel consistent with."""
    command = [sys.executable, "-m", "auditwheel", "show", wheel]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found = _POLICY.search(told)
    return found and found[1]


def _build(source: Path, target: Target, folder: Path) -> None:
    """Build one wheel; what zig keeps of our sources lies beside them."""
    settings = {
        "wheel.tags": target.tag,
        "install.strip": "false",  # the toolchain links without symbols
        "cmake.args": f"-DCMAKE_TOOLCHAIN_FILE={source / 'cmake' / 'zig.cmake'}",
        "cmake.define.ZIG": str(ZIG),
        "cmake.define.ZIG_TARGET": target.zig,
    }
    options = [word for name in settings for word in ("-C", f"{name}={settings[name]}")]
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check"]
    environment = {**os.environ, "SOURCE_DATE_EPOCH": _last_change()}
    environment["ZIG_LOCAL_CACHE_DIR"] = str(source.with_name(f"{source.name}-cache"))
    subprocess.run(
        [*command, "--no-deps", "--wheel-dir", folder, *options, source],
        env=environment,
        check=True,
    )


def _last_change() -> str:
    """Return the second that stands in the wheels: that of the last commit, or of 2026 without."""
    command = ["git", "log", "-1", "--format=%ct"]
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "1767225600"
    return done.stdout.strip()


def _copy(source: Path) -> None:
    """Copy what is built, without binaries of this machine."""
    source.mkdir(parents=True)
    for name in SOURCES:
        if (ROOT / name).is_dir():
            left_out = shutil.ignore_patterns("_kernel*", "__pycache__")
            shutil.copytree(ROOT / name, source / name, ignore=left_out)
        else:
            shutil.copy2(ROOT / name, source)


def _keep_kernels(folder: Path) -> None:
    shutil.rmtree(KERNELS, ignore_errors=True)
    KERNELS.mkdir(parents=True)
    for target in TARGETS:
        path = KERNELS / f"_kernel-{target.name}{target.suffix}"
        path.write_bytes(kernel(target.wheel(folder)))


def _lines(target: Target, folder: Path, wrong: list[str]) -> list[str]:
    wheel = target.wheel(folder)
    data = kernel(wheel)
    found = binaries.read(data, target)
    more = ", ".join(f"{key.replace('_', ' ')} {value}" for key, value in found.more.items())
    return [
        f"{wheel.name}: {wheel.stat().st_size / 1e3:.0f} kB, kernel {len(data) / 1e3:.0f} kB",
        f"  sha256 {_hash(wheel)}, again {_hash(target.wheel(AGAIN))}",
        f"  {found.machine}, {len(found.functions & binaries.FUNCTIONS)} functions, "
        f"interface {found.interface}, asks for {', '.join(found.libraries)}; {more}",
        *(f"  WRONG: {fault}" for fault in wrong or ()),
    ]


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


if __name__ == "__main__":
    main()
