"""Draw the pictures of README.md: python docs/assets/make.py."""

from __future__ import annotations

from pathlib import Path

import roundelay as rl
from roundelay.output import figures

HERE = Path(__file__).parent
CAPTURE = HERE.parent.parent / "data" / "captures" / "01_01.bvh"


def main() -> None:
    """Overview, strip and moving picture of the jumps of CMU 01_01."""
    motion = rl.read(CAPTURE)
    cycle = rl.find_cycles(motion)[0]
    loop = cycle.sample()
    figures.save(figures.overview(motion, [cycle]), HERE / "overview.png", dpi=80)
    figures.save(figures.strip(loop, poses=10), HERE / "strip.png", dpi=80)
    figures.animation(loop, HERE / "loop.gif", fps=20.0, size=240)


if __name__ == "__main__":
    main()
