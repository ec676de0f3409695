"""Mutation testing: ``python -m tests.mutation MODULE.py TESTS...``, without the package installed.

mutmut changes a module in small ways, one at a time, and runs the tests that are named. What
survives is listed: a change of the code that no test notices. The package must not be installed,
or its own finder would load it in place of the changed one; the compiled kernel lies in the tree.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "build" / "mutated"
SETTINGS = """[mutmut]
paths_to_mutate={module}
tests_dir=
    {tests}
also_copy=
    src
    tests
    data
    benchmarks
    pyproject.toml
    cmake
    blender
    docs
    README.md
    Makefile
do_not_mutate=
mutate_only_covered_lines=false
"""


def prepared(module: str, tests: list[str]) -> Path:
    """Lay out a folder in which mutmut runs: links to the project, and its settings."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name in (
        "src",
        "tests",
        "data",
        "benchmarks",
        "pyproject.toml",
        "cmake",
        "blender",
        "docs",
    ):
        link = FOLDER / name
        if not link.is_symlink():
            link.symlink_to(ROOT / name)
    settings = SETTINGS.format(module=module, tests="\n    ".join(tests))
    (FOLDER / "setup.cfg").write_text(settings)
    return FOLDER


def main(module: str, tests: list[str]) -> int:
    """Run mutmut, then list what survived."""
    folder = prepared(module, tests)
    environment = os.environ | {"PYTHONPATH": f"{folder / 'mutants' / 'src'}:{folder / 'src'}"}
    command = [sys.executable, "-m", "mutmut"]
    run = subprocess.run([*command, "run"], cwd=folder, env=environment, check=False)
    subprocess.run([*command, "results"], cwd=folder, env=environment, check=False)
    return run.returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
