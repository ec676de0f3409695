"""A page of a capture.

One self-contained HTML file with the capture, the evidence and the loop; ``roundelay view`` writes
the same.
"""

import sys
from pathlib import Path

import roundelay as rl
from roundelay.output.page import build_page

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
motion = rl.read(Path(__file__).parent.parent / "data" / "captures" / "01_01.bvh")
page = build_page(motion, rl.make_loops(motion), segmentation=rl.segment(motion))
(folder / "page.html").write_text(page, encoding="utf-8")
print(f"{len(motion)} frames, {len(page) / 1000:.0f} kB")
