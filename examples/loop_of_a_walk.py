"""The loop of a walk.

Find the cycle of a walk, look at what it was found by, and write it as a loop that goes on for
ever. The walk is a made one, whose period is known; `roundelay.read` reads your own.
"""

import sys
from pathlib import Path

import roundelay as rl
from roundelay import synth
from roundelay.output import figures

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
made = synth.gait("walk", repetitions=3.6, rng=1)
cycle = rl.find_cycles(made.motion)[0]
print(f"period {cycle.period:.3f} s (true {made.period:.3f}), {cycle.evidence.confidence:.0%} sure")
print(f"seen {cycle.evidence.repetitions:.2f} times; one period travels {cycle.travel.round(2)}")

loop = cycle.sample(fps=30.0)
rl.write(loop, folder / "walk_loop.bvh")
figures.save(figures.strip(loop, poses=10), folder / "loop_of_a_walk.png")
