"""Build the extension's zip, with the compiled kernels of all systems or of this one.

With ``--kernels``, the folder that ``make wheels`` fills, one zip serves all; elsewhere the NumPy
twin of the kernel does the work. Without it the kernel is compiled here, for this system alone.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

HERE = Path(__file__).resolve().parent
PROJECT = HERE.parent
SOURCE = HERE / "roundelay_extension"
SOURCES = PROJECT / "src" / "roundelay" / "topology" / "kernel"
LIMIT = 2_000_000
KERNELS = 6
PLATFORMS = {
    "linux-x86_64": "linux-x64",
    "linux-aarch64": "linux-arm64",
    "win-amd64": "windows-x64",
    "win-arm64": "windows-arm64",
}


def main() -> None:
    """Build, validate and measure the zip."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bpy", type=Path, required=True, help="environment with a bpy wheel")
    parser.add_argument("--kernels", type=Path, help="folder with the kernels of all systems")
    parser.add_argument("--output", type=Path, default=PROJECT / "dist")
    arguments = parser.parse_args()
    tool = _tool(arguments.bpy)
    arguments.output.mkdir(parents=True, exist_ok=True)
    target = arguments.output / "roundelay-blender.zip"
    _build(tool, arguments.kernels, target)
    size = target.stat().st_size
    print(f"{target}: {size / 1e6:.2f} MB")
    if size > LIMIT:
        sys.exit(f"expected at most {LIMIT / 1e6:.0f} MB, found {size / 1e6:.2f} MB")


def _tool(environment: Path) -> Path:
    """Find Blender's own extension tool in an environment with a bpy wheel."""
    found = sorted(environment.rglob("bl_pkg/cli/blender_ext.py"))
    if not found:
        sys.exit(f"expected a bpy wheel in {environment}, found none")
    return found[0]


def _platform() -> str:
    """Name this platform as Blender does."""
    system = sysconfig.get_platform()
    if system.startswith("macosx"):
        return "macos-arm64" if system.endswith("arm64") else "macos-x64"
    return PLATFORMS.get(system, system)


def _build(tool: Path, kernels: Path | None, target: Path) -> None:
    stage = PROJECT / "build" / "blender-extension"
    shutil.rmtree(stage, ignore_errors=True)
    shutil.copytree(SOURCE, stage, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(HERE / "LICENSE", stage)
    wheel = _wheel(stage / "wheels", kernels)
    lines = [f'wheels = ["./wheels/{wheel.name}"]']
    if kernels is None:
        lines.append(f'platforms = ["{_platform()}"]')
    manifest = stage / "blender_manifest.toml"
    added = "\n".join(["", *lines, "", "[permissions]"])
    manifest.write_text(manifest.read_text().replace("\n[permissions]", added))
    _run(tool, "build", "--source-dir", stage, "--output-filepath", target)
    _run(tool, "validate", target)


def _wheel(folder: Path, kernels: Path | None) -> Path:
    command = ["-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", folder]
    if kernels is not None:
        _check(kernels)
        tags, define = "wheel.tags=py3-none-any", f"cmake.define.KERNELS={kernels.resolve()}"
        command += ["-C", tags, "-C", define, "-C", "install.strip=false"]
    _run(*command, PROJECT)
    (wheel,) = folder.glob("*.whl")
    if kernels is None and wheel.stem.endswith("any"):
        sys.exit("the kernel could not be compiled; a C compiler and CMake are needed")
    return wheel


def _check(kernels: Path) -> None:
    """Refuse kernels that are not there, or older than what they were compiled of."""
    found = sorted(kernels.glob("_kernel-*"))
    if len(found) != KERNELS:
        sys.exit(f"expected {KERNELS} kernels in {kernels}, found {len(found)}: make wheels")
    changed = max(path.stat().st_mtime for path in SOURCES.glob("*.[ch]"))
    for path in found:
        if path.stat().st_mtime < changed:
            sys.exit(f"expected a kernel newer than its sources, found {path}: make wheels")


def _run(*arguments: object) -> None:
    subprocess.run([sys.executable, *map(str, arguments)], check=True)


if __name__ == "__main__":
    main()
