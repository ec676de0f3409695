"""Run the extension's tests inside a bpy wheel; Blender may crash on exit, so the word counts.

Usage: python blender/tests/run.py ENVIRONMENT FOLDER [pytest arguments], the folder being the
one with the zip.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
INSIDE = """
import os, sys, pytest
code = int(pytest.main(["-q", "-p", "no:cacheprovider", *sys.argv[1:]]))
print("RESULT", code, flush=True)
os._exit(code)
"""
TIME_LIMIT = 1800


def main() -> None:
    """Run in a process of its own, with a configuration of its own."""
    environment, folder, *others = sys.argv[1:]
    archive = Path(folder) / "roundelay-blender.zip"
    if not archive.exists():
        sys.exit(f"expected {archive}, found none: make blender-extension")
    python = Path(environment) / "bin" / "python"
    with tempfile.TemporaryDirectory() as resources:
        variables = {
            **os.environ,
            "BLENDER_USER_RESOURCES": resources,
            "ROUNDELAY_ZIP": str(archive.resolve()),
        }
        command = [python, "-c", INSIDE, "--rootdir", HERE, HERE, *others]
        done = subprocess.run(
            list(map(str, command)),
            env=variables,
            stdout=subprocess.PIPE,
            text=True,
            timeout=TIME_LIMIT,
            check=False,
        )
    print(done.stdout)
    sys.exit(0 if "RESULT 0" in done.stdout.splitlines() else 1)


if __name__ == "__main__":
    main()
