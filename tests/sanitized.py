"""Run the tests of the kernel with a binary from another folder: ``python -m tests.sanitized DIR``.

`make sanitize` builds one with AddressSanitizer and UndefinedBehaviorSanitizer and preloads their
libraries; what they find ends the process.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from roundelay.topology.kernel import compiled, engine

TESTS = ["tests/topology/test_kernel.py", "tests/topology/test_rips.py"]


def main(folder: Path) -> int:
    """Return the exit status of the tests."""
    compiled._FOLDER = folder
    print(f"kernel: {type(engine()).__name__} of {folder}")
    return int(pytest.main(["-q", "-p", "no:cacheprovider", "-p", "no:xdist", *TESTS]))


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
