"""The evidence.

Ten forward jumps with two turns between them (CMU 01_01). Two bars of the barcode stand out. The
circular coordinate of the first climbs one turn a jump in three parts of the capture; the second is
its companion, which counts the nine jumps that are like each other. The cycle runs through the
middle of the poses.
"""

import sys
from pathlib import Path

import roundelay as rl
from roundelay.output import figures

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
motion = rl.read(Path(__file__).parent.parent / "data" / "captures" / "01_01.bvh")
cycles = rl.find_cycles(motion)
for start, stop in cycles[0].evidence.runs:
    print(f"frames {start} to {stop}")
figures.save(figures.overview(motion, cycles), folder / "evidence_of_jumps.png")
