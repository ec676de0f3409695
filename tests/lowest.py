"""Print the lowest versions that pyproject.toml allows, as constraints for pip."""

from __future__ import annotations

import tomllib
from pathlib import Path

__all__ = ["constraints"]


def constraints() -> list[str]:
    """Return one line a dependency of the package itself: ``numpy==1.24.*``."""
    text = (Path(__file__).parent.parent / "pyproject.toml").read_text(encoding="utf-8")
    pairs = [one.split(">=") for one in tomllib.loads(text)["project"]["dependencies"]]
    return [f"{name}=={version if '.' in version else version + '.0'}.*" for name, version in pairs]


if __name__ == "__main__":
    print(*constraints(), sep="\n")
