"""Three periods of capture and loop.

Joint angles of capture and loop over three periods, and their jerk over one ([A] figure 6): the
loop keeps the motion and loses the noise.
"""

import sys
from pathlib import Path

import roundelay as rl
from roundelay.loops.quality import quality
from roundelay.output import figures

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
motion = rl.read(Path(__file__).parent.parent / "data" / "captures" / "01_01.bvh")
cycle = rl.find_cycles(motion)[0]
measured = quality(cycle, motion)
print(f"mean jerk: capture {measured.capture_jerk:.0f}, loop {measured.loop_jerk:.0f}")
figures.save(figures.angles(motion, cycle), folder / "three_periods.png")
