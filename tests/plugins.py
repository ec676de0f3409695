"""Packages of strangers: files in a scratch folder, with entry points as pip leaves them."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path


def install(
    folder: Path, files: Mapping[str, str], entries: Mapping[str, Mapping[str, str]]
) -> None:
    """Write modules into a folder, and the entry points that name them, by group."""
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    package = folder / "stranger-1.0.dist-info"
    package.mkdir()
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: stranger\nVersion: 1.0\n")
    lines = []
    for group, points in entries.items():
        lines += [f"[{group}]", *(f"{name} = {value}" for name, value in points.items())]
    (package / "entry_points.txt").write_text("\n".join([*lines, ""]))


def python(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run Python where the scratch folder is on its path, and the current one."""
    path = os.pathsep.join([str(folder), os.environ.get("PYTHONPATH", "")])
    return subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        text=True,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": path},
        check=False,
    )


def roundelay(folder: Path, line: str) -> subprocess.CompletedProcess[str]:
    """Run a command line there."""
    return python(folder, "-m", "roundelay", *line.split())
