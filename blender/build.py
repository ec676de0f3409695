"""Build the extension's zips: one with the compiled kernel for this platform, one for any.

The second works wherever Blender does, with the NumPy twin of the kernel.
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
LIMIT = 3_000_000
PLATFORMS = {
    "linux-x86_64": "linux-x64",
    "linux-aarch64": "linux-arm64",
    "win-amd64": "windows-x64",
    "win-arm64": "windows-arm64",
}


def main() -> None:
    """Build, validate and measure both zips."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bpy", type=Path, required=True, help="environment with a bpy wheel")
    parser.add_argument("--output", type=Path, default=PROJECT / "dist")
    arguments = parser.parse_args()
    tool = _tool(arguments.bpy)
    arguments.output.mkdir(parents=True, exist_ok=True)
    platform = _platform()
    for name in filter(None, (platform, "any")):
        target = arguments.output / f"roundelay-blender-{name}.zip"
        _build(tool, name, target)
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


def _platform() -> str | None:
    """Name this platform as Blender does; None where no kernel is bundled for it."""
    system = sysconfig.get_platform()
    if system.startswith("macosx"):
        return "macos-arm64" if system.endswith("arm64") else "macos-x64"
    return PLATFORMS.get(system)


def _build(tool: Path, platform: str, target: Path) -> None:
    stage = PROJECT / "build" / "blender-extension" / platform
    shutil.rmtree(stage, ignore_errors=True)
    shutil.copytree(SOURCE, stage, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(HERE / "LICENSE", stage)
    wheel = _wheel(stage / "wheels", compiled=platform != "any")
    lines = [f'wheels = ["./wheels/{wheel.name}"]']
    if platform != "any":
        lines.append(f'platforms = ["{platform}"]')
    manifest = stage / "blender_manifest.toml"
    added = "\n".join(["", *lines, "", "[permissions]"])
    manifest.write_text(manifest.read_text().replace("\n[permissions]", added))
    _run(tool, "build", "--source-dir", stage, "--output-filepath", target)
    _run(tool, "validate", target)


def _wheel(folder: Path, *, compiled: bool) -> Path:
    settings = [] if compiled else ["--config-settings", "wheel.cmake=false"]
    command = ["-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", folder, *settings]
    _run(*command, PROJECT)
    (wheel,) = folder.glob("*.whl")
    if compiled and wheel.stem.endswith("any"):
        sys.exit("the kernel could not be compiled; a C compiler and CMake are needed")
    return wheel


def _run(*arguments: object) -> None:
    subprocess.run([sys.executable, *map(str, arguments)], check=True)


if __name__ == "__main__":
    main()
