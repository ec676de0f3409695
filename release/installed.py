"""Say whether this Python has roundelay by itself, compiled: `python -m release.installed ENV`."""

from __future__ import annotations

import sys
from importlib.metadata import version
from pathlib import Path

import roundelay
from roundelay.topology.kernel import engine

__all__ = ["main"]


def main(environment: Path) -> None:
    """Print what is installed, and fail if it lies elsewhere or has no compiled kernel."""
    place = Path(roundelay.__file__).resolve()
    if environment.resolve() not in place.parents:
        sys.exit(f"expected roundelay in {environment}, found {place}")
    kind = type(engine()).__name__
    names = ("roundelay", "numpy", "matplotlib", "rich", "threadpoolctl", "typer", "pytest")
    told = ", ".join(f"{name} {version(name)}" for name in names)
    print(f"Python {sys.version.split()[0]}, {sys.platform}; {told}; kernel: {kind}")
    if kind != "Compiled":
        sys.exit("expected the compiled kernel, found its twin")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
