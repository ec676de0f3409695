"""Run the extension's tests inside a bpy wheel; Blender may crash on exit, so the word counts.

Usage: python blender/tests/run.py ENVIRONMENT ZIP [pytest arguments]
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
TIME_LIMIT = 900


def main() -> None:
    """Run in a process of its own, with a configuration of its own."""
    environment, archive, *others = sys.argv[1:]
    python = Path(environment) / "bin" / "python"
    with tempfile.TemporaryDirectory() as folder:
        variables = {
            **os.environ,
            "BLENDER_USER_RESOURCES": folder,
            "ROUNDELAY_ZIP": str(Path(archive).resolve()),
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
